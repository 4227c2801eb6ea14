"""Make code pasted from any ROS 2 tutorial work in a cell.

Every tutorial has `rclpy.init(); rclpy.spin(node); rclpy.shutdown()`. In a kernel it would block
for good: `rcl_wait` does not hear the stop button, and a second `rclpy.init()` raises. In a kernel
that has imported labkit, the functions below replace those of rclpy (`packages/imports.py`). They
do what rclpy's documentation says, with the node on labkit's background executor, and a program is
what lies between `init` and `shutdown` (`notebook_program.py`). In a script nothing is replaced.
"""

from __future__ import annotations

import functools
import inspect
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import rclpy
import rclpy.action.client
import rclpy.action.server
import rclpy.client
import rclpy.executors
import rclpy.node
import rclpy.service
import rclpy.task
import rclpy.timer
from rclpy.utilities import get_default_context
from rclpy.validate_node_name import validate_node_name

from labkit import domain_ids, settings, stop_button
from labkit.background import compat, exits, own_executors
from labkit.background.action_callbacks import guarded
from labkit.background.arguments import (
    check_args,
    check_callback,
    check_name,
    check_response,
    check_sent,
    check_type,
    one_type,
)
from labkit.background.domains import number_for_ros
from labkit.background.foreground import Spin
from labkit.background.nodes import Origin, check_node, existing_nodes, full_name, made
from labkit.background.notebook_program import Arguments, Program, look_at_files, renamed
from labkit.background.pending_tasks import answered_by
from labkit.errors import LabError, LabTimeout, first_few
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_node_name, full_topic_name, is_hidden

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions
    from rclpy.task import Future

    from labkit.background.nodes import NodeEntry
    from labkit.background.runtime import Runtime

__all__ = ['ORIGINALS', 'install', 'is_installed', 'uninstall']

# Python runs the handler of the stop button only between two waits in C.
SLICE_SEC = 0.1
# How long a destroyed publisher or subscription may stay in the graph, s.
GONE_SEC = 0.2

# Owner and name of each replaced function, and the method of `_NotebookSafe` that replaces it.
REPLACED: tuple[tuple[Any, str, str], ...] = (
    (rclpy, 'init', 'init'),
    (rclpy, 'ok', 'ok'),
    (rclpy, 'shutdown', 'shutdown'),
    (rclpy, 'try_shutdown', 'try_shutdown'),
    (rclpy, 'spin', 'spin'),
    (rclpy, 'spin_once', 'spin_once'),
    (rclpy, 'spin_until_future_complete', 'spin_until_future_complete'),
    (rclpy.client.Client, 'call', 'call'),
    (rclpy.client.Client, 'call_async', 'call_async'),
    (rclpy.service.Service, 'send_response', 'send_response'),
    (rclpy.task.Future, 'add_done_callback', 'add_done_callback'),
    (rclpy.task.Task, '__call__', 'run_task'),
    (rclpy.action.client.ActionClient, '__init__', 'make_action_client'),
    (rclpy.action.client.ActionClient, 'send_goal', 'send_goal'),
    (rclpy.action.client.ActionClient, 'wait_for_server', 'wait_for_server'),
    (rclpy.action.client.ActionClient, 'send_goal_async', 'send_goal_async'),
    (rclpy.action.client.ClientGoalHandle, 'get_result_async', 'get_result_async'),
    (rclpy.action.client.ClientGoalHandle, 'cancel_goal_async', 'cancel_goal_async'),
    (rclpy.action.client.ClientGoalHandle, 'get_result', 'get_result'),
    (rclpy.action.client.ClientGoalHandle, 'cancel_goal', 'cancel_goal'),
    (rclpy.action.server.ActionServer, '__init__', 'make_action_server'),
    (rclpy.action.server.ActionServer, 'register_execute_callback', 'execute_with'),
    (rclpy.executors.Executor, 'spin', 'spin_executor'),
    (rclpy.executors.Executor, 'wait_for_ready_callbacks', 'wait_for_ready_callbacks'),
    (rclpy.timer.Rate, 'sleep', 'sleep'),
    (rclpy.node.Node, '__init__', 'make_node'),
    (rclpy.node.Node, 'destroy_node', 'destroy_node'),
    (rclpy.node.Node, 'create_publisher', 'create_publisher'),
    (rclpy.node.Node, 'create_subscription', 'create_subscription'),
    (rclpy.node.Node, 'create_client', 'create_client'),
    (rclpy.node.Node, 'create_service', 'create_service'),
    (rclpy.node.Node, 'create_timer', 'create_timer'),
)
ORIGINALS: dict[str, Callable[..., Any]] = {
    safe: getattr(owner, name) for owner, name, safe in REPLACED
}
"""rclpy's own functions, by the names of the methods that replace them."""


def install(background: Runtime) -> None:
    """Put the notebook-safe functions in place, unless they are already."""
    if is_installed():
        return
    made.follow()
    exits.install()
    safe = _NotebookSafe(background)
    background.on_exit = safe.exit_program
    for owner, name, stand_in in REPLACED:
        setattr(owner, name, _replacement(ORIGINALS[stand_in], getattr(safe, stand_in)))


def is_installed() -> bool:
    """Return whether the notebook-safe functions are in place."""
    return rclpy.init is not ORIGINALS['init']


def uninstall() -> None:
    """Put the functions of rclpy back, except those that other code has replaced since."""
    for owner, name, stand_in in REPLACED:
        if getattr(getattr(owner, name), '_labkit', False):
            setattr(owner, name, ORIGINALS[stand_in])
    made.forget()
    exits.uninstall()


def _replacement(original: Callable[..., Any], safe: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap the replacement in a plain function with the documentation of the original."""
    parameters = inspect.signature(original)

    @functools.wraps(original)
    def function(*args: Any, **kwargs: Any) -> Any:
        try:
            parameters.bind(*args, **kwargs)
        except TypeError:
            pass  # the original says so below under its own name, and as the only error
        else:
            return safe(*args, **kwargs)
        return original(*args, **kwargs)

    function._labkit = True  # type: ignore[attr-defined]
    return function


class _NotebookSafe:
    """The replacements of rclpy's functions, with the same parameters."""

    def __init__(self, background: Runtime) -> None:
        self._background = background
        self._program: Program | None = None
        # A thread asks `rclpy.ok()` about the program that has started it.
        self._programs: WeakKeyDictionary[threading.Thread, Program] = WeakKeyDictionary()

    def init(
        self,
        *,
        args: list[str] | None = None,
        context: Context | None = None,
        domain_id: int | None = None,
        signal_handler_options: SignalHandlerOptions | None = None,
    ) -> None:
        check_args('rclpy.init', 'args', args)
        look_at_files(args or ())
        if context is not None and context is not get_default_context():
            none = rclpy.signals.SignalHandlerOptions.NO
            wanted = domain_id if domain_id is not None else domain_ids.read_domain_id() or 0
            number = number_for_ros(wanted)
            ORIGINALS['init'](
                args=args, context=context, domain_id=number, signal_handler_options=none
            )
        elif not self._background.called_by_callback():
            arguments = Arguments.read(args)
            if self._background.started and arguments.for_process:
                raise LabError(
                    f'rclpy.init(args=...) says {" ".join(arguments.for_process)}. That holds for '
                    'a whole process, and ROS runs in this one already.',
                    todo='Call lab.stop() first. It ends all nodes of this notebook.',
                )
            self._background.start(domain_id=domain_id, args=arguments.for_process)
            if self._program is not None:
                self._program.forget_levels()
            self._program = Program(args, self._request_id, self._background.started_at)

    def ok(self, *, context: Context | None = None) -> bool:
        """Return whether ROS is up, and the program that asks has not shut it down for itself."""
        up = bool(ORIGINALS['ok'](context=context))
        if context not in (None, get_default_context()) or self._background.called_by_callback():
            return up
        thread, program = threading.current_thread(), self._running_program()
        if program is None or thread is threading.main_thread():
            return up and not self._has_just_ended() and not self._has_just_left()
        program = self._programs.setdefault(thread, program)
        return up and program.ended_in is None and program.left_in is None

    def shutdown(
        self, *, context: Context | None = None, uninstall_handlers: bool | None = None
    ) -> None:
        """End the nodes that the program has made, and ROS with the last node.

        In a callback, end only the callback's node.
        """
        if context is not None and context is not get_default_context():
            ORIGINALS['shutdown'](context=context, uninstall_handlers=uninstall_handlers)
        elif not self._background.started:
            ORIGINALS['shutdown']()
        elif (node := self._background.end_caller()) is not None:
            program = self._running_program()
            if program is not None and program.made(node):
                program.left_in = self._request_id
        else:
            if self._has_just_ended():
                raise LabError(
                    'rclpy.shutdown() was called already. It has ended all that was made since '
                    'rclpy.init(); nodes of other cells go on.',
                    todo='To end them, too, call lab.stop().',
                )
            self._end_program()

    def try_shutdown(self, *, context: Context | None = None) -> None:
        if context is not None or not self._background.started:
            ORIGINALS['try_shutdown'](context=context)
        elif not self._has_just_ended():
            self.shutdown()

    @property
    def _request_id(self) -> str:
        return self._background.console.current_cell().request_id

    def _running_program(self) -> Program | None:
        """Return the program that was begun last, unless ROS was stopped since."""
        program = self._program
        since = self._background.started_at
        return program if program is not None and program.started_at == since else None

    def _has_just_ended(self) -> bool:
        """Return whether the program in this cell has called `shutdown` already."""
        program = self._running_program()
        return program is not None and program.ended_in == self._request_id

    def _has_just_left(self) -> bool:
        """Return whether a callback of a node of this cell has called `shutdown`."""
        program = self._running_program()
        return program is not None and program.left_in == self._request_id

    def exit_program(self) -> None:
        """End the program that this cell has begun, as its `sys.exit()` does in a terminal."""
        program = self._running_program()
        begun_here = program is not None and program.request_id == self._request_id
        if program is None or not begun_here or program.ended_in is not None:
            return
        names = [full_name(node) for node in existing_nodes() if program.made(node)]
        self._end_program()
        if names:
            print(f'The end of this program has ended {first_few(names)}.')

    def _end_program(self) -> None:
        """End what was made since the last `init`; everything, if nothing else would remain."""
        program = self._running_program()
        if program is not None and program.ended_in is not None:
            program = None
        nodes = [
            node
            for node in existing_nodes()
            if node.context is get_default_context() and not is_hidden(full_name(node))
        ]
        own = [node for node in nodes if program is None or program.made(node)]
        here = self._request_id
        cells = [here, program.request_id if program is not None else here]
        ended = [
            entry.name
            for entry in self._background.nodes()
            if entry.node in own and entry.cell.request_id not in cells
        ]
        if program is not None:
            program.ended_in = here  # first: its threads ask `ok`
        if len(own) < len(nodes):
            for node in own:
                self._background.destroy(node)
        else:
            self._background.stop()
        if ended:
            print(
                f'rclpy.shutdown() has ended {first_few(ended)}, started by other cells. What a '
                'program makes between its own rclpy.init() and rclpy.shutdown() is all it ends.'
            )

    def spin(self, node: Node, executor: Executor | None = None) -> None:
        """Spin a node until it is destroyed or ROS is shut down.

        The stop button and what a callback raises come out of it. A node started by `lab.spin`
        then goes on running in the background; any other one stops.
        """
        check_node(node, 'rclpy.spin')
        spin = Spin('rclpy.spin()', [node])
        if executor is not None:
            with self._lent(spin, executor):
                self.spin_executor(executor)
            return
        with self._spun(spin) as entry:
            self._background.wait(lambda: spin.is_over or not entry.alive, None)

    def spin_once(
        self, node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None
    ) -> None:
        check_node(node, 'rclpy.spin_once')
        spin = Spin('rclpy.spin_once()', [node])
        if executor is not None:
            with self._lent(spin, executor):
                executor.spin_once(timeout_sec)
            return
        if timeout_sec is not None and 0 <= timeout_sec < SLICE_SEC / 5:
            # "Don't wait" still means: run what is ready. The background needs a moment for it.
            timeout_sec = SLICE_SEC / 5
        # Before it is spun: a new entry has run none, and may have run its one by the next line.
        known = self._background.entry_of(node)
        before = known.callbacks if known is not None else 0
        with self._spun(spin, budget=1) as entry:
            self._wait_spun(spin, entry, lambda: entry.callbacks > before, timeout_sec)

    def spin_until_future_complete(
        self,
        node: Node,
        future: Future,
        executor: Executor | None = None,
        timeout_sec: float | None = None,
    ) -> None:
        check_node(node, 'rclpy.spin_until_future_complete')
        spin = Spin('rclpy.spin_until_future_complete()', [node])
        if executor is not None:
            with self._lent(spin, executor):
                executor.spin_until_future_complete(future, timeout_sec)
            return
        with self._spun(spin) as entry:
            self._wait_spun(spin, entry, lambda: _is_over(future), timeout_sec)

    def spin_executor(self, executor: Executor) -> None:
        """Spin the learner's own executor so that the stop button is heard."""
        self._background.refuse_in_callback('executor.spin()')
        self._background.foreign_threads.add(threading.current_thread())
        program = self._running_program()
        if program is not None and program.ended_in is not None and _in_cell():
            # What was made after its end, in another cell, is spun as by `rclpy.spin`.
            program = program if self._has_just_ended() else None
        try:
            while executor.context.ok() and not compat.is_shut_down(executor):
                if program is not None and program.ended_in is not None:
                    break
                executor.spin_once(timeout_sec=SLICE_SEC)
        except rclpy.executors.ExternalShutdownException:
            pass
        except BaseException as error:
            Spin('executor.spin()', executor.get_nodes()).mark(error)
            raise
        finally:
            self._background.foreign_threads.discard(threading.current_thread())

    def wait_for_ready_callbacks(self, executor: Any, *args: Any, **kwargs: Any) -> Any:
        """Wait for work of the learner's own executor, so that the stop button is heard."""
        with own_executors.waiting(executor):
            return self._wait_for_ready_callbacks(executor, *args, **kwargs)

    def _wait_for_ready_callbacks(self, executor: Any, *args: Any, **kwargs: Any) -> Any:
        wait = ORIGINALS['wait_for_ready_callbacks']
        first, *rest = args or (kwargs.pop('timeout_sec', None),)
        given = getattr(first, 'timeout', first)
        if given is None or given < 0:
            given = float('inf')
        if given <= SLICE_SEC or not _in_cell():
            return wait(executor, first, *rest, **kwargs)
        end = time.monotonic() + given
        while True:
            try:
                # The same each time: what is left of a wait with other arguments is dropped.
                return wait(executor, SLICE_SEC, *rest, **kwargs)
            except rclpy.executors.TimeoutException:
                if time.monotonic() >= end:
                    raise

    def call(self, client: Any, *args: Any, **kwargs: Any) -> Any:
        self._background.refuse_in_callback(f'Calling the service {client.srv_name!r} with call()')
        with self._background.waiting_for(client, f'call() of {client.srv_name}'):
            return ORIGINALS['call'](client, *args, **kwargs)

    def call_async(self, client: Any, request: Any) -> Any:
        check_sent('call_async', request, client.srv_type, 'Request')
        future = ORIGINALS['call_async'](client, request)
        answered_by[future] = client
        return future

    def send_response(self, service: Any, response: Any, header: Any) -> None:
        check_response(service, response)
        ORIGINALS['send_response'](service, response, header)

    def run_task(self, task: Any) -> None:
        try:
            with own_executors.in_task(task):
                ORIGINALS['run_task'](task)
        except BaseException as error:
            if _in_cell():
                raise
            # A MultiThreadedExecutor would never see it: rclpy notes only an Exception.
            task.set_exception(error)

    def add_done_callback(self, future: Any, callback: Any) -> None:
        check_callback('add_done_callback', callback, 0)
        ORIGINALS['add_done_callback'](future, callback)

    def send_goal(self, client: Any, *args: Any, **kwargs: Any) -> Any:
        """Send a goal, and wait for its result."""
        todo = 'Return from the callback. Use send_goal_async() and add_done_callback().'
        self._background.refuse_in_callback('Sending a goal with send_goal()', todo)
        future = client.send_goal_async(*args, **kwargs)
        handle = self._finished(future, 'the server accepts or rejects the goal')
        return self.get_result(handle)

    # rclpy records a request only after sending it. In a program with one thread nothing can come
    # in between; here the response can, and rclpy would drop it as one to an unknown request.

    def send_goal_async(self, client: Any, goal: Any, *args: Any, **kwargs: Any) -> Any:
        check_sent('send_goal_async', goal, compat.action_type_of(client), 'Goal')
        return self._asked(client, 'send_goal_async', client, goal, *args, **kwargs)

    def get_result_async(self, handle: Any) -> Any:
        return self._asked(compat.client_of_goal(handle), 'get_result_async', handle)

    def cancel_goal_async(self, handle: Any) -> Any:
        return self._asked(compat.client_of_goal(handle), 'cancel_goal_async', handle)

    def _asked(self, client: Any, what: str, *args: Any, **kwargs: Any) -> Any:
        with self._background.executor.between_callbacks():
            future = ORIGINALS[what](*args, **kwargs)
        answered_by[future] = client
        return future

    def get_result(self, handle: Any) -> Any:
        todo = 'Return from the callback. Use get_result_async() and add_done_callback().'
        self._background.refuse_in_callback('Waiting with get_result()', todo)
        return self._finished(handle.get_result_async(), 'the result of the goal comes')

    def cancel_goal(self, handle: Any) -> Any:
        todo = 'Return from the callback. Use cancel_goal_async() and add_done_callback().'
        self._background.refuse_in_callback('Cancelling with cancel_goal()', todo)
        return self._finished(handle.cancel_goal_async(), 'the server answers')

    def wait_for_server(self, client: Any, timeout_sec: float | None = None) -> bool:
        if client.server_is_ready():
            return True
        todo = 'Wait in __init__ or in a cell, or look: client.server_is_ready().'
        self._background.refuse_in_callback('Waiting with wait_for_server()', todo)
        self._background.wait(client.server_is_ready, _patience(timeout_sec))
        return bool(client.server_is_ready())

    def make_action_client(
        self,
        client: Any,
        node: Node,
        action_type: Any,
        action_name: str,
        *args: Any,
        **kwargs: Any,
    ) -> None:
        check_type('ActionClient', 'action', action_type)
        check_name('ActionClient', action_name, 'count')
        with one_type(self._background.helper, action_type):
            _make('make_action_client', client, node, action_type, action_name, *args, **kwargs)

    def make_action_server(
        self,
        server: Any,
        node: Node,
        action_type: Any,
        action_name: str,
        execute_callback: Any,
        *args: Any,
        **kwargs: Any,
    ) -> None:
        check_type('ActionServer', 'action', action_type)
        check_name('ActionServer', action_name, 'count')
        check_callback('ActionServer', execute_callback, 3, 'execute_callback')
        given = node, action_type, action_name, execute_callback
        with one_type(self._background.helper, action_type):
            _make('make_action_server', server, *given, *args, **kwargs)

    def execute_with(self, server: Any, execute_callback: Callable[..., Any]) -> None:
        """Show what the callback of an action server raises, as for all other callbacks."""
        if callable(execute_callback):
            execute_callback = guarded(execute_callback, server, self._background.console)
        ORIGINALS['execute_with'](server, execute_callback)

    def _finished(self, future: Any, what: str) -> Any:
        """Wait until a future is done, and return its result; the stop button is heard."""
        if not self._background.wait(lambda: _is_over(future), _patience(None)):
            raise LabTimeout(
                f'Waited until {what}, but it did not.',
                todo='Does a node serve the action, is it spun, and do its callbacks return?',
            )
        return future.result()

    def sleep(self, rate: Any) -> None:
        self._background.refuse_in_callback(
            'sleep() of a rate',
            'Return from the callback. A timer calls one again and again: '
            'self.create_timer(0.1, self.on_timer).',
        )
        with self._background.waiting_for(compat.timer_of_rate(rate), 'sleep() of a rate'):
            ORIGINALS['sleep'](rate)

    def make_node(self, node: Node, node_name: str, *args: Any, **kwargs: Any) -> None:
        _refuse_hiding(type(node))
        check_name('Node', node_name, 'talker')
        # rcl validates the name too, but then adds a warning about its own clean-up.
        validate_node_name(node_name)
        context = kwargs.get('context')
        if context is None:
            self._background.start()
        program = None
        check_args('Node', 'cli_args', kwargs.get('cli_args'))
        own: tuple[str, ...] = tuple(kwargs.get('cli_args') or ())
        look_at_files(own)
        shared: tuple[str, ...] = ()
        if context in (None, get_default_context()):
            program = self._running_program()
            if program is not None and program.ended_in is None:
                kwargs = program.options(kwargs)
                if kwargs.get('use_global_arguments', True):
                    shared = program.for_nodes
            given = node_name, kwargs.get('namespace') or ''
            # Another context may be in another domain, where the same name does not clash.
            name = full_node_name(*renamed(*given, kwargs.get('cli_args') or ()))
            self._background.make_room(name)
        made.add(node, Origin(self._background.console.current_cell(), own, shared))
        _make('make_node', node, node_name, *args, **kwargs)
        if program is not None and program.ended_in is None:
            program.set_level(node)

    def destroy_node(self, node: Node) -> None:
        """Destroy a node, its type description service included."""
        compat.end_type_descriptions(node)
        ORIGINALS['destroy_node'](node)

    def create_publisher(
        self, node: Node, msg_type: Any, topic: str, *args: Any, **kwargs: Any
    ) -> Any:
        check_type('create_publisher', 'message', msg_type)
        check_name('create_publisher', topic, 'chatter')
        self._refuse_second_type(node, msg_type, topic)
        return _make('create_publisher', node, msg_type, topic, *args, **kwargs)

    def create_subscription(
        self, node: Node, msg_type: Any, topic: str, callback: Any, *args: Any, **kwargs: Any
    ) -> Any:
        check_type('create_subscription', 'message', msg_type)
        check_name('create_subscription', topic, 'chatter')
        check_callback('create_subscription', callback, 2)
        self._refuse_second_type(node, msg_type, topic)
        began = time.monotonic()
        found = _make('create_subscription', node, msg_type, topic, callback, *args, **kwargs)
        found._labkit_since = began
        return found

    def create_client(
        self, node: Node, srv_type: Any, srv_name: str, *args: Any, **kwargs: Any
    ) -> Any:
        check_type('create_client', 'service', srv_type)
        check_name('create_client', srv_name, 'reset')
        with one_type(self._background.helper, srv_type):
            return _make('create_client', node, srv_type, srv_name, *args, **kwargs)

    def create_service(
        self, node: Node, srv_type: Any, srv_name: str, callback: Any, *args: Any, **kwargs: Any
    ) -> Any:
        check_type('create_service', 'service', srv_type)
        check_name('create_service', srv_name, 'reset')
        check_callback('create_service', callback, 2)
        with one_type(self._background.helper, srv_type):
            return _make('create_service', node, srv_type, srv_name, callback, *args, **kwargs)

    def create_timer(
        self, node: Node, timer_period_sec: float, callback: Any, *args: Any, **kwargs: Any
    ) -> Any:
        if not compat.is_of_rate(node, *args):  # a rate sets the callback of its timer itself
            check_callback('create_timer', callback, 1)
        return _make('create_timer', node, timer_period_sec, callback, *args, **kwargs)

    def _refuse_second_type(self, node: Node, msg_type: Any, topic: str) -> None:
        """Refuse a second type on a topic; rcl's own message is long and about an "allocator"."""
        why = self._second_type(node, topic, msg_type)
        if why:
            raise LabError(
                f'{why} In one notebook, a topic has one type.',
                todo=f'Use the same type on both sides, or another topic than {topic!r}. (Between '
                'two processes the same mistake is silent: nothing arrives.)',
            )

    def _second_type(self, node: Node, topic: str, msg_type: Any) -> str:
        """Describe another use of the topic with another type in this process, if there is one."""
        helper = self._background.helper
        if helper is None or not hasattr(msg_type, 'get_fields_and_field_types'):
            return ''
        try:
            name = full_topic_name(topic, node)
        except LabError:
            return ''  # rclpy will raise for the name
        end = time.monotonic() + GONE_SEC
        while why := other_type_here(helper, name, msg_type):
            if time.monotonic() > end:
                return why
            time.sleep(GONE_SEC / 20)
        return ''

    @contextmanager
    def _spun(self, spin: Spin, *, budget: int | None = None) -> Iterator[NodeEntry]:
        """Spin a node in the background for a `with` block, and raise what a callback raises."""
        self._background.refuse_in_callback(spin.what)
        (node,) = spin.nodes
        with _marking(spin), stop_button.held():
            entry = self._background.entry_of(node)
            try:
                if entry is None:
                    entry = self._background.add(node, budget=budget, spin=spin)
                else:
                    entry.spins.append(spin)
                yield entry
            finally:
                spin.close()
                if entry is not None:
                    self._end_spin(spin, entry)
            if spin.error is not None:
                raise spin.error

    def _wait_spun(
        self,
        spin: Spin,
        entry: NodeEntry,
        done: Callable[[], bool],
        timeout_sec: float | None,
    ) -> None:
        if self._background.wait(lambda: spin.is_over or done(), timeout_sec) or entry.lasts:
            return
        if self._running_callback(entry):
            # The timeout is none for a callback that has begun, and it may still raise.
            self._background.wait(lambda: True, None)

    def _running_callback(self, entry: NodeEntry) -> str:
        """Return the name of the callback that its node is running, '' if it runs none."""
        caller = self._background.running()
        return caller[1] if caller is not None and caller[0].node is entry.node else ''

    def _end_spin(self, spin: Spin, entry: NodeEntry) -> None:
        entry.spins.remove(spin)
        spin.lasts = entry.lasts and self._background.entry_of(entry.node) is entry
        if not (entry.lasts or entry.spins):
            self._background.release(entry)
            spin.busy = self._running_callback(entry)

    @contextmanager
    def _lent(self, spin: Spin, executor: Executor) -> Iterator[None]:
        """Give a node to the learner's own executor for a `with` block."""
        (node,) = spin.nodes
        known = self._background.entry_of(node)
        added = executor.add_node(node)
        with _marking(spin):
            try:
                yield
            finally:
                if added:
                    executor.remove_node(node)
                if known is not None and known.alive:
                    self._background.executor.add_entry(known)
                    spin.lasts = True


@contextmanager
def _marking(spin: Spin) -> Iterator[None]:
    """Mark what leaves a `with` block as having left a spin."""
    try:
        yield
    except BaseException as error:
        spin.mark(error)
        raise


def _make(what: str, *args: Any, **kwargs: Any) -> Any:
    """Call a function of rclpy that makes something; the stop button waits until it is done.

    The first use of a type loads its functions one by one. rclpy looks for one of them alone, and
    half of them end the process.
    """
    with stop_button.held():
        return ORIGINALS[what](*args, **kwargs)


def _patience(timeout_sec: float | None) -> float | None:
    """Return the timeout, bounded where nobody could press the stop button."""
    return settings.audience().patience_sec if timeout_sec is None else timeout_sec


def _refuse_hiding(kind: type[Node]) -> None:
    """Refuse a class that hides what rclpy and labkit look up in each node."""
    for name, value in vars(rclpy.node.Node).items():
        inherited = inspect.getattr_static(kind, name)
        hides = isinstance(value, property) and not isinstance(inherited, property)
        other = name != '__init__' and _is_another_thing(inherited, value)
        if hides or other:
            raise LabError(
                f'{kind.__name__} has something called {name}, and rclpy uses that name in each '
                'node for a thing of its own.',
                todo=f'Choose another name, such as my_{name}.',
            )


def _is_another_thing(method: Any, own: Any) -> bool:
    """Tell whether a method has the name of one of rclpy's by chance.

    It can't be called as rclpy calls its own one; or it takes something else, by the names of its
    parameters, and never calls that one.
    """
    if method is own or not (inspect.isfunction(method) and inspect.isfunction(own)):
        return False
    parameters = inspect.signature(own).parameters.values()
    least = [p for p in parameters if p.default is p.empty and p.kind is p.POSITIONAL_OR_KEYWORD]
    try:
        inspect.signature(method).bind(*least)
    except TypeError:
        return True
    taken = inspect.signature(method).parameters.values()
    names = [p.name for p in taken if p.kind is p.POSITIONAL_OR_KEYWORD]
    differ = any(name != p.name for name, p in zip(names[1:], least[1:], strict=False))
    return differ and own.__name__ not in inspect.unwrap(method).__code__.co_names


def _in_cell() -> bool:
    return threading.current_thread() is threading.main_thread()


def _is_over(future: Any) -> bool:
    return bool(future.done() or future.cancelled())


# An error about the number of arguments has this name.
for _owner, _name, _stand_in in REPLACED:
    getattr(_NotebookSafe, _stand_in).__qualname__ = ORIGINALS[_stand_in].__qualname__
