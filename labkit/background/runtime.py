"""ROS in this process, started and stopped as a notebook needs it.

One context, one executor, one background thread (`executor`), one registry of nodes by name, so
that a cell can be run again without leaving a second node behind.
"""

from __future__ import annotations

import atexit
import os
import threading
import time
from collections.abc import Callable

from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_default_context, ok, try_shutdown

from labkit import domain_ids, settings
from labkit.background import domains
from labkit.background.console import Cell, Console
from labkit.background.executor import BackgroundExecutor
from labkit.background.keyboard import press_enter_for_nobody
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
from labkit.errors import LabError
from labkit.rosgraph.names import full_node_name
from labkit.rosgraph.whose import foreign_nodes

__all__ = ['Runtime', 'runtime']

# How long stop() waits for a callback that is still running.
JOIN_SEC = 2.0
DUPLICATE_CHECK_SEC = 1.0


class Runtime:
    """ROS in this process: one of it exists, `runtime`.

    Attributes:
        console: Where the output of callbacks goes.
        domain_id: The ROS domain, None while ROS is not started.
        started_at: When ROS was started, as `time.monotonic()` tells it.
        helper: A hidden node for labkit's own subscriptions and questions to the graph.
        ended: Nodes that have called `rclpy.shutdown()`, and in which callback, by full name.
        foreign_threads: Threads that spin an executor of the learner's own, see `notebook_rclpy`.
        after_start: Called each time ROS has been started, in the thread that started it.
    """

    def __init__(self) -> None:
        self.console = Console()
        self.domain_id: int | None = None
        self.started_at = 0.0
        self.helper: Node | None = None
        self.ended: dict[str, str] = {}
        self.foreign_threads: set[threading.Thread] = set()
        self.after_start: list[Callable[[], None]] = []
        # Held for as long as a start takes. No callback asks for it, see `start`.
        self._starting = threading.RLock()
        self._ending = threading.Lock()
        self._registry = Registry(self.console, self._count_nodes)
        self._reported: set[str] = set()
        self._executor: BackgroundExecutor | None = None
        self._claim: domains.DomainClaim | None = None
        self.console.after_cell = self._after_cell

    @property
    def started(self) -> bool:
        """Tell whether ROS is up, all of it: the stop button may end `start` half way."""
        executor = self._executor
        return executor is not None and executor.is_open and executor.context.ok()

    @property
    def own_domain(self) -> bool:
        """Tell whether the domain was chosen so that no other notebook has it."""
        return self._claim is not None and self._claim.domain_id == self.domain_id

    @property
    def executor(self) -> BackgroundExecutor:
        """Return the background executor; ROS is started if it is not up."""
        if not self.started:  # asked for at each moment of virtual time
            self.start()
        assert self._executor is not None
        return self._executor

    # -- starting and stopping ------------------------------------------------------------------

    def start(self, *, domain_id: int | None = None, args: list[str] | None = None) -> None:
        """Start ROS in the background; without effect when it is up.

        Args:
            domain_id: See `labkit.start`.
            args: Command line arguments for ROS, as `rclpy.init` takes them.
        """
        domain_ids.check_domain_id(domain_id)
        if self._is_called_by_a_callback() or self._is_up_in(domain_id):
            return
        with self._starting:
            if self._is_up_in(domain_id):
                return
            if self.started:
                self._refuse_move_with_nodes(domain_id)
            self.stop()
            self._end_foreign_start()
            domain_id = self._choose_domain(domain_id)
            number = domains.number_for_ros(domain_id or 0)
            if domain_id is not None:
                # The processes that the notebook starts read it.
                domain_ids.set_domain(domain_id)
            # Log files: nobody looks for them in a course, and a home that can't be written to
            # would keep ROS from starting.
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
            self._executor = BackgroundExecutor(self.console)
            self._add_helper(self._executor)
            domains.first_node_is_made()
            if settings.in_kernel():
                install(self)
                press_enter_for_nobody()
            self._executor.start()
        for action in tuple(self.after_start):
            action()

    def stop(self) -> None:
        """Destroy all nodes, join the thread, shut ROS down."""
        executor = self._executor
        if executor is None:
            return
        # A callback that is running may make nodes meanwhile: they end with the others.
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

    def end_caller(self) -> bool:
        """End the node whose callback wants to shut ROS down: the others are none of its business.

        Returns:
            Whether a callback calls this.
        """
        caller = self._executor.caller() if self._executor is not None else None
        if caller is None or caller[0].node is self.helper:
            return False
        entry, callback = caller
        self.ended[entry.name] = callback
        print(
            f'{callback} of {entry.name} has called rclpy.shutdown(). In a program of its own '
            f'that ends all of its nodes; in a notebook it ends {entry.name} alone.'
        )
        self.discard(entry)
        return True

    def add(self, node: Node, *, budget: int | None = None) -> NodeEntry:
        """Put a node on the background executor; one of the same name is destroyed.

        Args:
            node: The node.
            budget: How many callbacks to run before it leaves the executor; None for no end.

        Raises:
            LabError: It is not a node, or it exists no more.
        """
        check_node(node)
        return self._registry.add(self.executor, node, budget=budget)

    def discard(self, entry: NodeEntry) -> BaseException | None:
        """Take a node from the executor and destroy it, see `destroy`."""
        return self._registry.discard(self._executor, entry)

    def destroy(self, node: Node) -> BaseException | None:
        """Destroy a node for certain, and show what its own `destroy_node` raises.

        Returns:
            What that was, None if nothing. Also in `console.errors`, as `destroy_node`.
        """
        entry = self.entry_of(node)
        if entry is not None:
            return self.discard(entry)
        return self._registry.destroy(node, full_name(node))

    def release(self, entry: NodeEntry) -> None:
        """Take a node from the executor and leave it alive."""
        self._registry.release(self._executor, entry)

    def nodes(self) -> list[NodeEntry]:
        """Return the nodes that run in the background, in the order they were started."""
        entries = self._registry.entries()
        for entry in entries:
            if not entry.alive:
                self.release(entry)
        # Not one that has gone over to an executor of the learner's own.
        return [entry for entry in entries if entry.alive and self.entry_of(entry.node) is entry]

    def entry_of(self, node: Node) -> NodeEntry | None:
        """Return the entry of a node, None if it does not run in the background."""
        return self._executor.entry_of(node) if self._executor is not None else None

    def unspun_nodes(self) -> list[Node]:
        """Return the nodes of this process that exist but don't run in the background."""
        return [
            node
            for node in existing_nodes()
            if node is not self.helper and self.entry_of(node) is None
        ]

    def make_room(self, name: str) -> None:
        """Destroy the node of a name before another one of that name is made."""
        self.ended.pop(name, None)
        self._registry.make_room(self._executor, name)

    def _count_nodes(self, name: str) -> int:
        if self.helper is None or not node_exists(self.helper):
            return 0
        names = self.helper.get_node_names_and_namespaces()
        return sum(full_node_name(*pair) == name for pair in names)

    def foreign_nodes(self) -> set[str]:
        """Return the full names of the nodes that other processes have in this domain."""
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

    # -- details --------------------------------------------------------------------------------

    def _destroy_all(self, nodes: list[Node]) -> KeyboardInterrupt | None:
        """Destroy nodes; the stop button ends what one of them does, and no other one's end."""
        interrupt = None
        for node in nodes:
            try:
                self._registry.destroy(node, full_name(node))
            except KeyboardInterrupt as pressed:
                interrupt = pressed
        return interrupt

    def _is_called_by_a_callback(self) -> bool:
        """Tell whether a callback runs this: its ROS is up, or about to end and not to be begun.

        Whoever starts or stops ROS waits for callbacks, so they can't wait for that.
        """
        if threading.current_thread() in self.foreign_threads:
            return self._executor is not None
        return self._executor is not None and self._executor.in_callback()

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
                f'it can move to domain {domain_id!r} only without nodes.',
                todo='Call lab.stop() first, then lab.start(domain_id=...), then start the nodes.',
            )

    def _end_foreign_start(self) -> None:
        """Put right what `rclpy.init()` did before labkit was there."""
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
        self.helper = helper_node(f'_labkit_{os.getpid()}', context=executor.context)
        self.helper.create_timer(DUPLICATE_CHECK_SEC, self._report_duplicates)
        name = self.helper.get_fully_qualified_name()
        executor.add_entry(NodeEntry(self.helper, name, self.console.current_cell()))

    def _after_cell(self, cell: Cell, error: BaseException | None) -> None:
        """Say so when a cell that was edited has left the node of its earlier run behind."""
        if error is not None:
            half_made.update((node, cell) for node in find_half_made(error))
        for entry in self._registry.left_over(cell):
            print(
                f'{entry.name}, which this cell started before, still runs. '
                f'lab.remove({entry.name!r}) ends it.'
            )

    def _report_duplicates(self) -> None:
        """Say so, once, when another process has a node of the same name as one of ours."""
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
