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
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import rclpy
import rclpy.client
import rclpy.executors
import rclpy.node
from rclpy.utilities import get_default_context
from rclpy.validate_node_name import validate_node_name

from labkit.errors import LabError
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_topic_name

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.task import Future

    from labkit.background.nodes import NodeEntry
    from labkit.background.runtime import Runtime

__all__ = ['install', 'originals']

# Python runs the handler of the stop button only between two waits in C.
SLICE_SEC = 0.1
# How long a topic that was given up may still be seen.
GONE_SEC = 0.2


class originals:
    """The functions of rclpy as they are in a script."""

    init = staticmethod(rclpy.init)
    shutdown = staticmethod(rclpy.shutdown)
    spin = staticmethod(rclpy.spin)
    spin_once = staticmethod(rclpy.spin_once)
    spin_until_future_complete = staticmethod(rclpy.spin_until_future_complete)
    call = rclpy.client.Client.call
    executor_spin = rclpy.executors.Executor.spin
    node_init = rclpy.node.Node.__init__
    create_publisher = rclpy.node.Node.create_publisher
    create_subscription = rclpy.node.Node.create_subscription


def install(runtime: Runtime) -> None:
    """Put the notebook-safe functions in place. Calling it again changes nothing.

    Args:
        runtime: The runtime whose background executor they use.
    """
    if rclpy.init is not originals.init:
        return
    safe = _NotebookSafe(runtime)
    for name in ('init', 'shutdown', 'spin', 'spin_once', 'spin_until_future_complete'):
        setattr(rclpy, name, _with_documentation(getattr(originals, name), getattr(safe, name)))
    client_call, executor_spin = originals.call, originals.executor_spin
    node_init = originals.node_init

    @functools.wraps(client_call)
    def call(client: Any, *args: Any, **kwargs: Any) -> Any:
        runtime.refuse_in_callback(f'Calling the service {client.srv_name!r} with call()')
        return client_call(client, *args, **kwargs)

    @functools.wraps(executor_spin)
    def spin(executor: Executor) -> None:
        safe.spin_executor(executor)

    @functools.wraps(node_init)
    def make_node(node: Node, node_name: str, *args: Any, **kwargs: Any) -> None:
        if isinstance(node_name, str):
            # rcl looks at the name too, but then adds a warning about its own clean-up.
            validate_node_name(node_name)
        if kwargs.get('context') is None:
            runtime.start()
        namespace = (kwargs.get('namespace') or '').strip('/')
        runtime.make_room(f'/{namespace}/{node_name}' if namespace else f'/{node_name}')
        node_init(node, node_name, *args, **kwargs)

    for name in ('create_publisher', 'create_subscription'):
        safe_create = _with_readable_error(getattr(originals, name), runtime)
        setattr(rclpy.node.Node, name, safe_create)
    rclpy.node.Node.__init__ = make_node  # type: ignore[method-assign,assignment]
    rclpy.client.Client.call = call  # type: ignore[method-assign,assignment]
    rclpy.executors.Executor.spin = spin  # type: ignore[method-assign,assignment]


def _with_documentation(original: Callable[..., Any], safe: Callable[..., Any]) -> Any:
    @functools.wraps(original)
    def function(*args: Any, **kwargs: Any) -> Any:
        return safe(*args, **kwargs)

    return function


def _with_readable_error(create: Callable[..., Any], runtime: Runtime) -> Callable[..., Any]:
    """Refuse a second type on a topic in words; rcl says "allocator", at great length."""

    @functools.wraps(create)
    def function(node: Node, msg_type: Any, topic: str, *args: Any, **kwargs: Any) -> Any:
        why = _second_type(runtime, node, topic, msg_type)
        if why:
            raise LabError(
                f'{why} In one notebook, a topic has one type.',
                todo=f'Use the same type on both sides, or another topic than {topic!r}. (Between '
                'two processes the same mistake is silent: nothing arrives.)',
            )
        return create(node, msg_type, topic, *args, **kwargs)

    return function


def _second_type(runtime: Runtime, node: Node, topic: str, msg_type: Any) -> str:
    """Say who uses a topic with another type in this process; '' if nobody does."""
    helper = runtime.helper
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


class _NotebookSafe:
    """The functions that stand in for those of rclpy, by the same names."""

    def __init__(self, runtime: Runtime) -> None:
        self._runtime = runtime

    def init(
        self,
        *,
        args: list[str] | None = None,
        context: Any = None,
        domain_id: int | None = None,
        signal_handler_options: Any = None,
    ) -> None:
        if context is not None and context is not get_default_context():
            none = rclpy.signals.SignalHandlerOptions.NO
            originals.init(
                args=args, context=context, domain_id=domain_id, signal_handler_options=none
            )
        else:
            self._runtime.start(domain_id=domain_id, args=args)

    def shutdown(self, *, context: Any = None, uninstall_handlers: bool | None = None) -> None:
        if context is not None and context is not get_default_context():
            originals.shutdown(context=context, uninstall_handlers=uninstall_handlers)
        elif self._runtime.started:
            self._runtime.stop()
        else:
            originals.shutdown()

    def spin(self, node: Node, executor: Executor | None = None) -> None:
        if executor is not None:
            executor.add_node(node)
            try:
                self.spin_executor(executor)
            finally:
                executor.remove_node(node)
            return
        entry, borrowed = self._borrow('rclpy.spin()', node)
        try:
            self._runtime.wait(lambda: not entry.alive, None)
        except KeyboardInterrupt:
            pass  # the stop button: the rest of the cell goes on, as a script does after Ctrl-C
        finally:
            if borrowed:
                self._runtime.release(entry)

    def spin_once(
        self, node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None
    ) -> None:
        if executor is not None:
            originals.spin_once(node, executor=executor, timeout_sec=timeout_sec)
            return
        entry, borrowed = self._borrow('rclpy.spin_once()', node, budget=1)
        before = entry.callbacks
        if timeout_sec is not None and 0 <= timeout_sec < SLICE_SEC / 5:
            # "Don't wait" still means: run what is ready. The background needs a moment for it.
            timeout_sec = SLICE_SEC / 5
        try:
            self._runtime.wait(lambda: entry.callbacks > before, timeout_sec)
        finally:
            if borrowed:
                self._runtime.release(entry)

    def spin_until_future_complete(
        self,
        node: Node,
        future: Future,
        executor: Executor | None = None,
        timeout_sec: float | None = None,
    ) -> None:
        if executor is not None:
            originals.spin_until_future_complete(node, future, executor, timeout_sec)
            return
        entry, borrowed = self._borrow('rclpy.spin_until_future_complete()', node)
        try:
            self._runtime.wait(lambda: _is_over(future), timeout_sec)
        finally:
            if borrowed:
                self._runtime.release(entry)

    def spin_executor(self, executor: Executor) -> None:
        """Spin an executor of the learner's own so that the stop button is heard."""
        self._runtime.refuse_in_callback('Executor.spin()')
        self._runtime.foreign_threads.add(threading.current_thread())
        try:
            while executor.context.ok() and not executor._is_shutdown:
                executor.spin_once(timeout_sec=SLICE_SEC)
        except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
            pass
        finally:
            self._runtime.foreign_threads.discard(threading.current_thread())

    def _borrow(
        self, what: str, node: Node, *, budget: int | None = None
    ) -> tuple[NodeEntry, bool]:
        """Return the node's entry, and whether it came to the background only for this call."""
        self._runtime.refuse_in_callback(what)
        entry = self._runtime.entry_of(node)
        if entry is not None:
            return entry, False
        return self._runtime.add(node, budget=budget), True


def _is_over(future: Any) -> bool:
    return bool(future.done() or future.cancelled())
