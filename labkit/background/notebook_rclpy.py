"""Make code pasted from any ROS 2 tutorial work in a cell.

`rclpy.init(); rclpy.spin(node); rclpy.shutdown()` stands in every tutorial. In a kernel it would
block for good: `rcl_wait` does not hear the stop button, and a second `rclpy.init()` raises. While
labkit runs in a kernel, the functions below stand in for those of rclpy. They do what rclpy's
documentation says, with the node on labkit's background executor. In a script nothing is replaced.
"""

from __future__ import annotations

import functools
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import rclpy
import rclpy.action.client
import rclpy.action.server
import rclpy.client
import rclpy.executors
import rclpy.node
import rclpy.timer
from rclpy.utilities import get_default_context
from rclpy.validate_node_name import validate_node_name

from labkit import domain_ids, settings
from labkit.background import compat
from labkit.background.action_callbacks import guarded
from labkit.background.domains import number_for_ros
from labkit.background.nodes import made
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_node_name, full_topic_name

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions
    from rclpy.task import Future

    from labkit.background.nodes import NodeEntry
    from labkit.background.protocol import Background

__all__ = ['ORIGINALS', 'install', 'is_installed', 'uninstall']

# Python runs the handler of the stop button only between two waits in C.
SLICE_SEC = 0.1
# How long a topic that was given up may still be seen.
GONE_SEC = 0.2

# What is replaced: owner and name. A method of `_NotebookSafe` stands in for each.
REPLACED: tuple[tuple[Any, str, str], ...] = (
    (rclpy, 'init', 'init'),
    (rclpy, 'shutdown', 'shutdown'),
    (rclpy, 'try_shutdown', 'try_shutdown'),
    (rclpy, 'spin', 'spin'),
    (rclpy, 'spin_once', 'spin_once'),
    (rclpy, 'spin_until_future_complete', 'spin_until_future_complete'),
    (rclpy.client.Client, 'call', 'call'),
    (rclpy.action.client.ActionClient, 'send_goal', 'send_goal'),
    (rclpy.action.client.ActionClient, 'wait_for_server', 'wait_for_server'),
    (rclpy.action.client.ActionClient, 'send_goal_async', 'send_goal_async'),
    (rclpy.action.client.ClientGoalHandle, 'get_result_async', 'get_result_async'),
    (rclpy.action.client.ClientGoalHandle, 'cancel_goal_async', 'cancel_goal_async'),
    (rclpy.action.client.ClientGoalHandle, 'get_result', 'get_result'),
    (rclpy.action.client.ClientGoalHandle, 'cancel_goal', 'cancel_goal'),
    (rclpy.action.server.ActionServer, 'register_execute_callback', 'execute_with'),
    (rclpy.executors.Executor, 'spin', 'spin_executor'),
    (rclpy.timer.Rate, 'sleep', 'sleep'),
    (rclpy.node.Node, '__init__', 'make_node'),
    (rclpy.node.Node, 'destroy_node', 'destroy_node'),
    (rclpy.node.Node, 'create_publisher', 'create_publisher'),
    (rclpy.node.Node, 'create_subscription', 'create_subscription'),
)
ORIGINALS: dict[str, Callable[..., Any]] = {
    safe: getattr(owner, name) for owner, name, safe in REPLACED
}
"""The functions of rclpy as they are in a script, by the name of what stands in for each."""


def install(background: Background) -> None:
    """Put the notebook-safe functions in place. Calling it again changes nothing.

    Args:
        background: Runs the nodes that they are called with.
    """
    if is_installed():
        return
    made.follow()
    safe = _NotebookSafe(background)
    for owner, name, stand_in in REPLACED:
        setattr(owner, name, _replacement(ORIGINALS[stand_in], getattr(safe, stand_in)))


def is_installed() -> bool:
    """Tell whether the notebook-safe functions are in place."""
    return rclpy.init is not ORIGINALS['init']


def uninstall() -> None:
    """Put the functions of rclpy back. What somebody else has put there since stays."""
    for owner, name, stand_in in REPLACED:
        if getattr(getattr(owner, name), '_labkit', False):
            setattr(owner, name, ORIGINALS[stand_in])
    made.forget()


def _replacement(original: Callable[..., Any], safe: Callable[..., Any]) -> Callable[..., Any]:
    """Return a plain function with the documentation of the original."""

    @functools.wraps(original)
    def function(*args: Any, **kwargs: Any) -> Any:
        return safe(*args, **kwargs)

    function._labkit = True  # type: ignore[attr-defined]
    return function


class _NotebookSafe:
    """The functions that stand in for those of rclpy, with the same parameters."""

    def __init__(self, background: Background) -> None:
        self._background = background

    def init(
        self,
        *,
        args: list[str] | None = None,
        context: Context | None = None,
        domain_id: int | None = None,
        signal_handler_options: SignalHandlerOptions | None = None,
    ) -> None:
        if context is not None and context is not get_default_context():
            none = rclpy.signals.SignalHandlerOptions.NO
            wanted = domain_id if domain_id is not None else domain_ids.read_domain_id() or 0
            number = number_for_ros(wanted)
            ORIGINALS['init'](
                args=args, context=context, domain_id=number, signal_handler_options=none
            )
        else:
            self._background.start(domain_id=domain_id, args=args)

    def shutdown(
        self, *, context: Context | None = None, uninstall_handlers: bool | None = None
    ) -> None:
        """End ROS in the notebook; in a callback, as in a program of its own, only its node."""
        if context is not None and context is not get_default_context():
            ORIGINALS['shutdown'](context=context, uninstall_handlers=uninstall_handlers)
        elif not self._background.started:
            ORIGINALS['shutdown']()
        elif not self._background.end_caller():
            self._background.stop()

    def try_shutdown(self, *, context: Context | None = None) -> None:
        if context is not None or not self._background.started:
            ORIGINALS['try_shutdown'](context=context)
        else:
            self.shutdown()

    def spin(self, node: Node, executor: Executor | None = None) -> None:
        """Spin a node until it is destroyed, ROS is shut down or the stop button is pressed.

        Afterwards it is as before: a node that `lab.spin` has started runs on in the background,
        any other one is spun no more.
        """
        if executor is not None:
            executor.add_node(node)
            try:
                self.spin_executor(executor)
            finally:
                executor.remove_node(node)
            return
        try:
            with self._spun('rclpy.spin()', node) as entry:
                self._background.wait(lambda: not entry.alive, None)
        except KeyboardInterrupt:
            pass  # the stop button: the rest of the cell goes on, as a script does after Ctrl-C

    def spin_once(
        self, node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None
    ) -> None:
        if executor is not None:
            ORIGINALS['spin_once'](node, executor=executor, timeout_sec=timeout_sec)
            return
        if timeout_sec is not None and 0 <= timeout_sec < SLICE_SEC / 5:
            # "Don't wait" still means: run what is ready. The background needs a moment for it.
            timeout_sec = SLICE_SEC / 5
        with self._spun('rclpy.spin_once()', node, budget=1) as entry:
            before = entry.callbacks
            self._background.wait(lambda: entry.callbacks > before, timeout_sec)

    def spin_until_future_complete(
        self,
        node: Node,
        future: Future,
        executor: Executor | None = None,
        timeout_sec: float | None = None,
    ) -> None:
        if executor is not None:
            ORIGINALS['spin_until_future_complete'](node, future, executor, timeout_sec)
            return
        with self._spun('rclpy.spin_until_future_complete()', node):
            self._background.wait(lambda: _is_over(future), timeout_sec)

    def spin_executor(self, executor: Executor) -> None:
        """Spin an executor of the learner's own so that the stop button is heard."""
        self._background.refuse_in_callback('Executor.spin()')
        self._background.foreign_threads.add(threading.current_thread())
        try:
            while executor.context.ok() and not compat.is_shut_down(executor):
                executor.spin_once(timeout_sec=SLICE_SEC)
        except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
            pass
        finally:
            self._background.foreign_threads.discard(threading.current_thread())

    def call(self, client: Any, *args: Any, **kwargs: Any) -> Any:
        self._background.refuse_in_callback(f'Calling the service {client.srv_name!r} with call()')
        return ORIGINALS['call'](client, *args, **kwargs)

    def send_goal(self, client: Any, *args: Any, **kwargs: Any) -> Any:
        """Send a goal, and wait for its result."""
        todo = 'Return from the callback. Use send_goal_async() and add_done_callback().'
        self._background.refuse_in_callback('Sending a goal with send_goal()', todo)
        future = client.send_goal_async(*args, **kwargs)
        handle = self._finished(future, 'the server accepts or rejects the goal')
        return self.get_result(handle)

    # rclpy sends, and then notes that it has sent: in a program with one thread nothing comes in
    # between. Here the answer may, and would be taken for one to a question that nobody asked.

    def send_goal_async(self, client: Any, *args: Any, **kwargs: Any) -> Any:
        with self._background.executor.between_callbacks():
            return ORIGINALS['send_goal_async'](client, *args, **kwargs)

    def get_result_async(self, handle: Any) -> Any:
        with self._background.executor.between_callbacks():
            return ORIGINALS['get_result_async'](handle)

    def cancel_goal_async(self, handle: Any) -> Any:
        with self._background.executor.between_callbacks():
            return ORIGINALS['cancel_goal_async'](handle)

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

    def execute_with(self, server: Any, execute_callback: Callable[..., Any]) -> None:
        """Let an action server show what its callback raises, as all other callbacks do."""
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
        ORIGINALS['sleep'](rate)

    def make_node(self, node: Node, node_name: str, *args: Any, **kwargs: Any) -> None:
        if isinstance(node_name, str):
            # rcl looks at the name too, but then adds a warning about its own clean-up.
            validate_node_name(node_name)
        context = kwargs.get('context')
        if context is None:
            self._background.start()
        if context in (None, get_default_context()):
            # In a domain of its own a name is another one.
            self._background.make_room(full_node_name(node_name, kwargs.get('namespace') or ''))
        made.add(node)
        ORIGINALS['make_node'](node, node_name, *args, **kwargs)

    def destroy_node(self, node: Node) -> None:
        """Destroy a node, and all of it."""
        compat.end_type_descriptions(node)
        ORIGINALS['destroy_node'](node)

    def create_publisher(
        self, node: Node, msg_type: Any, topic: str, *args: Any, **kwargs: Any
    ) -> Any:
        self._refuse_second_type(node, msg_type, topic)
        return ORIGINALS['create_publisher'](node, msg_type, topic, *args, **kwargs)

    def create_subscription(
        self, node: Node, msg_type: Any, topic: str, *args: Any, **kwargs: Any
    ) -> Any:
        self._refuse_second_type(node, msg_type, topic)
        return ORIGINALS['create_subscription'](node, msg_type, topic, *args, **kwargs)

    def _refuse_second_type(self, node: Node, msg_type: Any, topic: str) -> None:
        """Refuse a second type on a topic in words; rcl says "allocator", at great length."""
        why = self._second_type(node, topic, msg_type)
        if why:
            raise LabError(
                f'{why} In one notebook, a topic has one type.',
                todo=f'Use the same type on both sides, or another topic than {topic!r}. (Between '
                'two processes the same mistake is silent: nothing arrives.)',
            )

    def _second_type(self, node: Node, topic: str, msg_type: Any) -> str:
        """Say who uses a topic with another type in this process; '' if nobody does."""
        helper = self._background.helper
        if helper is None or not hasattr(msg_type, 'get_fields_and_field_types'):
            return ''
        try:
            name = full_topic_name(topic, node)
        except LabError:
            return ''  # rclpy says what is wrong with the name
        end = time.monotonic() + GONE_SEC
        # What was destroyed a moment ago may still be in the graph.
        while why := other_type_here(helper, name, msg_type):
            if time.monotonic() > end:
                return why
            time.sleep(GONE_SEC / 20)
        return ''

    @contextmanager
    def _spun(self, what: str, node: Node, *, budget: int | None = None) -> Iterator[NodeEntry]:
        """Let the background spin a node for a while, whenever the stop button ends that."""
        self._background.refuse_in_callback(what)
        entry = known = self._background.entry_of(node)
        try:
            if entry is None:
                entry = self._background.add(node, budget=budget)
            yield entry
        finally:
            borrowed = entry or self._background.entry_of(node)
            if known is None and borrowed is not None:
                self._background.release(borrowed)


def _patience(timeout_sec: float | None) -> float | None:
    """Return how long to wait: not for ever where nobody could press the stop button."""
    return settings.audience().patience_sec if timeout_sec is None else timeout_sec


def _is_over(future: Any) -> bool:
    return bool(future.done() or future.cancelled())
