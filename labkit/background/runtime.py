"""ROS in this process, started and stopped on demand: `start`, `spin`, `remove`, `stop`.

One context, one executor with its background thread, and one registry of nodes by name, so that a
cell can be run again without leaving a second node behind.
"""

from __future__ import annotations

import atexit
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_default_context, ok, try_shutdown

from labkit import domain_ids, settings, stop_button
from labkit.background import compat, domains
from labkit.background.console import Cell, Console
from labkit.background.executor import BackgroundExecutor
from labkit.background.foreground import Spin, ended_nodes, in_words, last_words, swallowed
from labkit.background.nodes import (
    NodeEntry,
    check_node,
    existing_nodes,
    find_half_made,
    full_name,
    half_made,
    helper_node,
    node_exists,
)
from labkit.background.notebook_rclpy import ORIGINALS, install
from labkit.background.registry import Registry
from labkit.background.shared_memory import look_at_shared_memory
from labkit.errors import LabError, nearest, quoted
from labkit.rosgraph.names import full_node_name
from labkit.rosgraph.whose import foreign_nodes

__all__ = ['Runtime', 'remove', 'runtime', 'spin', 'start', 'stop']

# How long stop() waits for a callback that is still running.
JOIN_SEC = 2.0
DUPLICATE_CHECK_SEC = 1.0
_OPEN = (
    'ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS or ROS_DISCOVERY_SERVER is set so that other '
    'computers can take part: anybody who reaches this one can hear all nodes of this notebook, '
    'publish to them and call their services, in domain {domain_id}.'
)

AnyNode = TypeVar('AnyNode', bound=Node)


class Runtime:
    """ROS in this process: a singleton, `runtime`.

    Attributes:
        console: Output of callbacks.
        domain_id: The ROS domain, None while ROS is not started.
        started_at: `time.monotonic()` when ROS was started.
        helper: A hidden node for labkit's own subscriptions and graph queries.
        ended: Full names of nodes that have ended themselves, with the callback and what it did.
        foreign_threads: Threads that spin the learner's own executors, see `notebook_rclpy`.
        on_exit: Called when a cell ends with `sys.exit()`, out of no spin.
        waits: What threads wait for: a rate's timer or a client, with words for it, the cell, and
            the number of the thread.
    """

    def __init__(self) -> None:
        self.console = Console()
        self.domain_id: int | None = None
        self.started_at = 0.0
        self.helper: Node | None = None
        self.ended: dict[str, str] = {}
        self.foreign_threads: set[threading.Thread] = set()
        self.waits: dict[Any, tuple[str, Cell, int]] = {}
        self.on_exit: Callable[[], None] = lambda: None
        self._starting = threading.RLock()  # never taken by a callback, see `start`
        self._ending = threading.Lock()
        self._registry = Registry(self.console, self._count_nodes)
        self._reported: set[str] = set()
        self._executor: BackgroundExecutor | None = None
        self._claim: domains.DomainClaim | None = None
        self.console.after_cell = self._after_cell
        self.console.last_words = last_words
        self.console.uncaught = self._end_after

    @property
    def started(self) -> bool:
        """Return whether ROS is up completely: the stop button may end `start` half way."""
        executor = self._executor
        return executor is not None and executor.is_open and executor.context.ok()

    @property
    def own_domain(self) -> bool:
        """Return whether the domain was chosen so that no other notebook has it."""
        return self._claim is not None and self._claim.domain_id == self.domain_id

    @property
    def executor(self) -> BackgroundExecutor:
        """Return the background executor, and start ROS if it is not up."""
        if not self.started:
            self.start()
        assert self._executor is not None
        return self._executor

    # -- starting and stopping ------------------------------------------------------------------

    def start(self, *, domain_id: int | None = None, args: list[str] | None = None) -> None:
        """Start ROS in the background; without effect when it is up.

        The stop button waits until that is done.

        Args:
            domain_id: See `labkit.start`.
            args: Command line arguments for ROS, as `rclpy.init` takes them.
        """
        domain_ids.check_domain_id(domain_id)
        if self.called_by_callback() or self._is_up_in(domain_id):
            return
        with stop_button.held(), self._starting:
            if self._is_up_in(domain_id):
                return
            if self.started:
                self._refuse_move_with_nodes(domain_id)
            self.stop()
            self._end_foreign_start()
            domain_id = self._choose_domain(domain_id)
            if domain_id is not None:
                # The processes that the notebook starts read it.
                domain_ids.set_domain(domain_id)
            domains.follow_profile()
            look_at_shared_memory()
            number = domains.number_for_ros(domain_id or 0)
            # No log files: nobody reads them in a course, and ROS does not start if the home
            # directory is not writable.
            ros_args = [*(args or ()), '--ros-args', '--disable-external-lib-logs']
            if settings.in_kernel():
                ros_args.append('--disable-stdout-logs')
            ORIGINALS['init'](
                args=ros_args,
                domain_id=number,
                signal_handler_options=SignalHandlerOptions.NO,
            )
            self.domain_id = domain_id or 0
            self.started_at = time.monotonic()
            self.console.open()
            self._executor = BackgroundExecutor(self.console, self.end_program)
            self._add_helper(self._executor)
            domains.first_node_is_made()
            if settings.in_kernel():
                install(self)
                if settings.audience().same_each_time:
                    # `text = input('Your message: ') or 'Hello'` runs with nobody there to type.
                    compat.answer_input(_press_enter)
                if not domain_ids.stays_here():
                    print(_OPEN.format(domain_id=self.domain_id))
            self._executor.start()
        for action in tuple(settings.after_start):
            action()

    def stop(self) -> None:
        """Destroy all nodes, join the thread, and shut ROS down."""
        executor = self._executor
        if executor is None:
            return
        # First: a running callback may still make nodes, which are to end too.
        executor.close(JOIN_SEC)
        nodes = [*executor.get_nodes(), *self.unspun_nodes()]
        with self._ending:
            if self._executor is not executor:
                return
            self._executor = self.helper = self.domain_id = None
        interrupt = self._destroy_all(nodes)
        self._registry.clear()
        self._reported.clear()
        self.ended.clear()
        context = executor.context
        executor.shutdown(timeout_sec=0)
        if context is get_default_context():
            try_shutdown()
        for thread in self.foreign_threads - {threading.current_thread()}:
            thread.join(JOIN_SEC)
        self.console.close()
        if interrupt is not None:
            raise interrupt

    # -- nodes ----------------------------------------------------------------------------------

    def end_caller(self) -> Node | None:
        """End the node whose callback calls this, and return it; None outside of callbacks."""
        caller = self._executor.caller() if self._executor is not None else None
        if caller is None or caller[0].node is self.helper:
            return None
        self._end(*caller, 'called rclpy.shutdown()')
        return caller[0].node

    def end_program(self, entry: NodeEntry, callback: str, error: BaseException) -> None:
        """End the node whose callback has raised what ends a program."""
        if entry.node is self.helper:  # a function of a cell, which belongs to no node
            self.console.show_error(entry.name, callback, error)
        else:
            self._end(entry, callback, in_words(error))

    def _end(self, entry: NodeEntry, callback: str, what: str) -> None:
        print(
            f'{callback} of {entry.name} has {what}. In a program of its own '
            f'that ends all of its nodes; in a notebook it ends {entry.name} alone.'
        )
        self.discard(entry)
        self.ended[entry.name] = f'{callback} {what}'

    def add(self, node: Node, *, budget: int | None = None, spin: Spin | None = None) -> NodeEntry:
        """Run a node in the background, and destroy an earlier one of the same name.

        Args:
            node: The node.
            budget: Number of callbacks to run before it leaves the executor, None for no limit.
            spin: The foreground spin that adds it, None to let it run on.

        Raises:
            LabError: It is not a node, or it has been destroyed.
        """
        check_node(node)
        return self._registry.add(self.executor, node, budget=budget, spin=spin)

    def discard(self, entry: NodeEntry) -> BaseException | None:
        """Remove a node from the executor and destroy it, see `destroy`."""
        return self._registry.discard(self._executor, entry)

    def destroy(self, node: Node) -> BaseException | None:
        """Destroy a node, show an error of its own `destroy_node`, and return it."""
        entry = self.entry_of(node)
        if entry is not None:
            return self.discard(entry)
        return self._registry.destroy(node, full_name(node))

    def release(self, entry: NodeEntry) -> None:
        """Remove a node from the executor without destroying it."""
        self._registry.release(self._executor, entry)

    def nodes(self) -> list[NodeEntry]:
        """Return the nodes that run in the background, in the order they were started."""
        entries = self._registry.entries()
        for entry in entries:
            if not entry.alive:
                self.release(entry)
        # A node may have moved to an executor of the learner's own.
        return [entry for entry in entries if entry.alive and self.entry_of(entry.node) is entry]

    def entry_of(self, node: Node) -> NodeEntry | None:
        """Return the entry of a node, None if it does not run in the background."""
        return self._executor.entry_of(node) if self._executor is not None else None

    def unspun_nodes(self) -> list[Node]:
        """Return the nodes of this process that don't run in the background."""
        return [
            node
            for node in existing_nodes()
            if node is not self.helper and self.entry_of(node) is None
        ]

    def make_room(self, name: str) -> None:
        """Destroy the node of a name before another one of the same name is made."""
        self.ended.pop(name, None)
        self._registry.make_room(self._executor, name)

    def _count_nodes(self, name: str) -> int:
        if self.helper is None or not node_exists(self.helper):
            return 0
        names = self.helper.get_node_names_and_namespaces()
        return sum(full_node_name(*pair) == name for pair in names)

    def foreign_nodes(self) -> set[str]:
        """Return the full names of other processes' nodes in this domain."""
        return foreign_nodes(self.helper) if self.helper is not None else set()

    # -- waiting --------------------------------------------------------------------------------

    def wait(self, condition: Callable[[], object], timeout_sec: float | None) -> bool:
        """Wait until `condition()` is true, see `BackgroundExecutor.wait`.

        Raises:
            LabError: Called from a callback, which would wait for itself.
        """
        self.refuse_in_callback('Waiting')
        return self.executor.wait(condition, timeout_sec)

    def refuse_in_callback(self, what: str, todo: str = '') -> None:
        """Raise a LabError when called by a callback, see `BackgroundExecutor`."""
        if self._executor is not None:
            self._executor.refuse_in_callback(what, todo)

    def called_by_callback(self) -> bool:
        """Return whether a callback calls this: ROS is then up, or about to end.

        Starting and stopping wait for callbacks, so a callback must not wait for them.
        """
        if threading.current_thread() in self.foreign_threads:
            return self._executor is not None
        return self._executor is not None and self._executor.in_callback()

    def running(self) -> tuple[NodeEntry, str] | None:
        """Return the node whose callback is running, and the callback's name, or None."""
        running = self._executor.running_for() if self._executor is not None else None
        return running[:2] if running is not None else None

    @contextmanager
    def waiting_for(self, entity: Any, words: str) -> Iterator[None]:
        """Note in a `with` block that a thread waits for a rate's timer or for a client."""
        self.waits[entity] = (words, self.console.current_cell(), threading.get_ident())
        try:
            yield
        finally:
            self.waits.pop(entity, None)

    # -- details --------------------------------------------------------------------------------

    def _destroy_all(self, nodes: list[Node]) -> KeyboardInterrupt | None:
        """Destroy nodes; return the interrupt if the stop button was pressed meanwhile."""
        interrupt = None
        for node in nodes:
            try:
                self._registry.destroy(node, full_name(node))
            except KeyboardInterrupt as pressed:
                interrupt = pressed
        return interrupt

    def _is_up_in(self, domain_id: int | None) -> bool:
        return self.started and domain_id in (None, self.domain_id)

    def _choose_domain(self, domain_id: int | None) -> int | None:
        if domain_id is None:
            domain_id = domain_ids.read_domain_id()
        if domain_id is None and settings.in_kernel():
            self._claim = self._claim or domains.claim_domain()
            domain_id = self._claim.domain_id
        return domain_id

    def _refuse_move_with_nodes(self, domain_id: int | None) -> None:
        names = [entry.name for entry in self.nodes()]
        if names:
            raise LabError(
                f'ROS runs in domain {self.domain_id} with {", ".join(names)}; '
                f'it can move to domain {quoted(domain_id)} only without nodes.',
                todo='Call lab.stop() first, then lab.start(domain_id=...), then start the nodes.',
            )

    def _end_foreign_start(self) -> None:
        """Undo an `rclpy.init()` from before labkit was started."""
        if not ok():
            return
        names = [node.get_fully_qualified_name() for node in self.unspun_nodes()]
        if names:
            raise LabError(
                f'rclpy.init() was called before labkit was started, and {", ".join(names)} '
                'was made since.',
                todo='Restart the kernel and run the setup cell first.',
            )
        ORIGINALS['shutdown']()

    def _add_helper(self, executor: BackgroundExecutor) -> None:
        # Scripts know the node of `ros2` by its name, and leave it out of a list.
        who = '_ros2cli' if settings.is_ros2_command else '_labkit'
        self.helper = helper_node(
            f'{who}_{os.getpid()}',
            context=executor.context,
            enable_rosout=settings.is_ros2_command,
        )
        self.helper.create_timer(DUPLICATE_CHECK_SEC, self._report_duplicates)
        name = self.helper.get_fully_qualified_name()
        executor.add_entry(NodeEntry(self.helper, name, self.console.current_cell()))

    def _end_after(self, error: BaseException) -> None:
        """End what an error has ended that nobody has caught."""
        cell = self.console.current_cell()
        for node in find_half_made(error):
            half_made.setdefault(node, cell)
        for node, what in ended_nodes(error).items():
            if node_exists(node):
                self.ended[full_name(node)] = what
                self.destroy(node)
        if isinstance(error, SystemExit) and not last_words(error):
            self.on_exit()

    def _after_cell(self, cell: Cell) -> None:
        """End what IPython keeps to itself; report nodes that an edited cell has left behind."""
        for error in swallowed():
            if any(map(node_exists, ended_nodes(error))):
                print(last_words(error))
                self._end_after(error)
        for entry in self._registry.left_over(cell):
            print(
                f'{entry.name}, which this cell started before, still runs. '
                f'lab.remove({quoted(entry.name)}) ends it.'
            )

    def _report_duplicates(self) -> None:
        """Report once when another process has a node of the same name as one of ours."""
        foreign = self.foreign_nodes()
        for entry in self.nodes():
            if entry.name not in foreign:
                self._reported.discard(entry.name)
            elif entry.name not in self._reported:
                self._reported.add(entry.name)
                self.console.speak_for(entry.cell)
                print(
                    f'Two nodes are called {entry.name} in domain {self.domain_id}: this one, '
                    'and one of another notebook or process. ROS allows it, but tools and '
                    'people mix them up. Give each a name of its own.'
                )


runtime = Runtime()
atexit.register(runtime.stop)
if settings.in_kernel():
    install(runtime)


def start(*, domain_id: int | None = None) -> None:
    """Start ROS in the background.

    Everything in labkit that needs ROS does this by itself; call it to choose a domain.

    Args:
        domain_id: The ROS domain to take part in, 0 to 101, or that of another notebook. By
            default `ROS_DOMAIN_ID` if it is set, else, in a notebook, a domain that no other
            notebook on this machine has.

    Raises:
        LabError: ROS runs in another domain already, with nodes in it.
    """
    runtime.start(domain_id=domain_id)


def spin(node: AnyNode) -> AnyNode:
    """Run a node in the background: its callbacks are called while cells come and go.

    A node of the same name that this notebook started before is destroyed first, so a cell may
    be run again as often as you like.

    Args:
        node: An instance of a subclass of `rclpy.node.Node`.

    Returns:
        The node.

    Raises:
        LabError: It is not a node, or it has been destroyed.
    """
    runtime.add(node)
    return node


def remove(node: Node | str) -> None:
    """End a node: it is taken from the background and destroyed.

    Args:
        node: The node, or its name: `'talker'` or `'/talker'`, with its namespace if it has one.

    Raises:
        LabError: No node of that name runs here.
    """
    for each in [node] if isinstance(node, Node) else _find(node):
        runtime.destroy(each)


def stop() -> None:
    """Destroy all nodes, end the background thread and shut ROS down.

    `lab.start()`, `lab.spin()` and the rest work again afterwards.
    """
    runtime.stop()


def _find(name: str) -> list[Node]:
    """Return the nodes of a name: usually one, spun or not."""
    running = [entry.node for entry in runtime.nodes()]
    wanted = name if name.startswith('/') else f'/{name}'
    found = [node for node in [*running, *runtime.unspun_nodes()] if full_name(node) == wanted]
    if found:
        return found
    names = [full_name(node) for node in running]
    near = nearest(wanted, names)
    if wanted in runtime.foreign_nodes():
        todo = 'It runs in another process: end it where that was started.'
    elif near:
        todo = f'Did you mean {near!r}?'
    elif names:
        todo = f'Running here: {", ".join(names)}.'
    else:
        todo = 'No node runs here.'
    raise LabError(f'No node called {quoted(name)} runs in this notebook.', todo=todo)


def _press_enter(prompt: object = '') -> str:
    print(prompt)
    return ''
