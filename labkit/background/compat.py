"""Every private name of rclpy and ipykernel that labkit touches, and nothing else.

Each function has a contract test in tests/background/test_compat.py: with a new rclpy or
ipykernel, those tests say in a minute whether it still fits.
"""

from __future__ import annotations

import ctypes
import sys
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy._rclpy_pybind11 import RCLError
from rclpy.event_handler import EventHandler
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import rclpy_implementation

if TYPE_CHECKING:
    from types import FrameType

    from rclpy.action.server import ActionServer
    from rclpy.clock import ROSClock
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.subscription import Subscription
    from rclpy.task import Task
    from rclpy.timer import Timer
    from rclpy.waitable import NumberOfEntities, Waitable

__all__ = [
    'RCLError',
    'answer_input',
    'call_in_kernel',
    'callback_of',
    'display_under',
    'end_type_descriptions',
    'event_of',
    'forget_executor',
    'handler_of',
    'hear_while_cells_run',
    'is_kernel_stream',
    'is_shut_down',
    'new_wait_set',
    'node_of_action',
    'own_guards',
    'rate_is_awaited',
    'rate_sleepers',
    'running_request',
    'set_ros_time_is_active',
    'set_thread_request',
    'take_all',
    'take_logs',
    'takers',
    'write_for',
]

# How long somebody may hold a service that was destroyed, s, such as an executor in its wait.
GONE_SEC = 1.0
POLL_SEC = 0.001

# --- rclpy ---------------------------------------------------------------------------------------


def takers(executor: Executor) -> dict[str, Callable[[Any], Any]]:
    """Return what takes from an entity that is ready, for each kind of entity.

    Each is called with the entity, and returns a function that makes the coroutine which runs the
    callback; None if there is nothing to take, because the entity was destroyed meanwhile or a
    message has gone. A guard condition is taken by the wait itself.
    """
    return {
        'subscription': executor._take_subscription,
        'timer': executor._take_timer,
        'client': executor._take_client,
        'service': executor._take_service,
        'guard_condition': executor._take_guard_condition,
        'waitable': executor._take_waitable,
    }


def own_guards(executor: Executor) -> list[Any]:
    """Return the guard conditions that wake an executor: `wake()`, and Ctrl-C."""
    return [guard for guard in (executor._guard, executor._sigint_gc) if guard is not None]


def new_wait_set(context_handle: Any, count: NumberOfEntities) -> Any:
    """Make a wait set for so many entities."""
    return rclpy_implementation.WaitSet(
        count.num_subscriptions,
        count.num_guard_conditions,
        count.num_timers,
        count.num_clients,
        count.num_services,
        count.num_events,
        context_handle,
    )


def event_of(waitable: Waitable) -> Any:
    """Return what a handler of an event waits for; None if the waitable is something else.

    An `EventHandler` is asked twice a wait, and each publisher and subscription has two of them.
    """
    return waitable._EventHandler__event if type(waitable) is EventHandler else None  # type: ignore[attr-defined]


def handler_of(task: Task) -> Any:
    """Return what a task runs, a function or a coroutine; None once it is done."""
    return task._handler


def callback_of(task: Task) -> Any:
    """Return what a task runs; of a goal of an action, the callback that does the work."""
    handler = handler_of(task)
    frame = getattr(handler, 'cr_frame', None)
    if frame is None or handler.__name__ != '_execute_goal':
        return handler
    return frame.f_locals['execute_callback']


def is_shut_down(executor: Executor) -> bool:
    """Tell whether `shutdown()` of an executor has been called."""
    return bool(executor._is_shutdown)


def forget_executor(node: Node) -> None:
    """Let `node.executor` be None: an executor that a node was removed from leaves it as it was.

    To set it in public asks the executor once more to remove the node.
    """
    node._Node__executor_weakref = None  # type: ignore[attr-defined]


def end_type_descriptions(node: Node) -> None:
    """End the service of a node that describes its types, before the node is destroyed.

    rclpy (7.1) frees that one without ending it: it stays in the graph, and 0.1 MB with it, until
    ROS is shut down, and each further node takes longer to make (ros2/rclpy, pull request 1711).
    It is no more than that if this can't help: the service is still in use after a second, or
    there is no `librcl`.

    Args:
        node: The node. Whether it has such a service, or was destroyed before, does not matter.
    """
    owner: Any = getattr(node, '_type_description_service', None)
    inner = getattr(owner, '_type_description_srv', None)
    if inner is None:
        return
    try:
        # One more owner of the service, and of its node: both are there until the last line.
        service, node_pointer = inner.impl, node.handle.pointer
    except (InvalidHandle, AttributeError):
        return
    known = [one for one in node.services if one.handle.pointer == service.pointer]
    for one in known:
        node.destroy_service(one)
    owner.destroy()
    # What has a pointer still is in use.
    end = time.monotonic() + GONE_SEC
    while (in_use := any(one.handle.pointer for one in known)) and time.monotonic() < end:
        time.sleep(POLL_SEC)
    if known and node_pointer and not in_use:
        try:
            rcl = ctypes.CDLL('librcl.so')  # loaded already; this only finds it
        except OSError:
            return
        rcl.rcl_service_fini(ctypes.c_void_p(service.pointer), ctypes.c_void_p(node_pointer))
    service.destroy_when_not_in_use()


def node_of_action(server: ActionServer) -> Node:
    """Return the node that an action server belongs to."""
    node: Node = server._node
    return node


def set_ros_time_is_active(clock: ROSClock, active: bool) -> None:
    """Let a clock show the time that it is given, or the computer's again.

    The parameter `use_sim_time` does it too. But setting it is seen by the callbacks of the node
    and by everybody in the graph, and adds a subscription to `/clock`.
    """
    clock._set_ros_time_is_active(active)


def rate_is_awaited(timer: Timer) -> bool | None:
    """Tell whether a thread sleeps in the `Rate` of a timer, None if the timer is of no rate.

    It is false from the tick on until the thread has done its work and sleeps again.
    """
    event = getattr(timer.callback, '__self__', None)
    if not isinstance(event, threading.Event):
        return None
    return not event.is_set() and bool(event._cond._waiters)  # type: ignore[attr-defined]


def rate_sleepers(timer: Timer) -> set[int]:
    """Return the ids of the threads that sleep in the `Rate` of a timer, or wake up there."""
    event = getattr(timer.callback, '__self__', None)
    found = set()
    for ident, innermost in sys._current_frames().items():
        frame: FrameType | None = innermost
        while frame is not None:
            if frame.f_code is threading.Event.wait.__code__ and frame.f_locals['self'] is event:
                found.add(ident)
            frame = frame.f_back
    return found


def take_all(subscription: Subscription, most: int) -> int:
    """Take the messages that wait for a subscription which no executor serves, as bytes.

    Args:
        subscription: The subscription.
        most: How many to take at most.

    Returns:
        How many there were.
    """
    count = 0
    with subscription.handle:
        while count < most and subscription.handle.take_message(subscription.msg_type, True):
            count += 1
    return count


def take_logs(show: Callable[[int, str, str], None]) -> Callable[[], None]:
    """Let each log message of rclpy's be shown by a function, besides what rclpy does with it.

    Args:
        show: Called with severity, name of the logger and message, in the thread that logs.

    Returns:
        A function that takes it back.
    """
    original = rclpy_implementation.rclpy_logging_rcutils_log

    def log(severity: int, name: str, message: str, *place: object) -> None:
        original(severity, name, message, *place)
        show(int(severity), name, message)

    def give_back() -> None:
        rclpy_implementation.rclpy_logging_rcutils_log = original

    rclpy_implementation.rclpy_logging_rcutils_log = log
    return give_back


# --- ipykernel -----------------------------------------------------------------------------------


def running_request() -> dict[str, Any]:
    """Return the kernel's request that runs the current cell."""
    request: dict[str, Any] = _shell().get_parent()
    return request


def set_thread_request(request: dict[str, Any]) -> None:
    """Let what the calling thread writes belong to a request of the kernel, if it can do that."""
    shell = _shell()
    if hasattr(shell, 'set_thread_parent'):
        shell.set_thread_parent(request)
        return
    # Python 3.10 has an older ipykernel, which does the same for streams, but has no name for it.
    for name in ('stdout', 'stderr'):
        stream: Any = getattr(sys, name)
        stream = getattr(stream, 'target', stream)
        if hasattr(stream, '_parent_header'):
            stream._parent_header.set(request['header'])


def write_for(request: dict[str, Any], stream: Any, text: str) -> None:
    """Write what belongs to a request, in a thread for which `set_thread_request` was called."""
    if hasattr(stream, '_parent_header') or not is_kernel_stream(stream) or not request:
        stream.write(text)
        return
    # In that of Google Colab (6.17) a stream knows nothing of threads.
    publisher = _shell().display_pub
    content = {'name': stream.name, 'text': text}
    publisher.session.send(
        publisher.pub_socket, 'stream', content, parent=request, ident=stream.topic
    )


def display_under(
    request: dict[str, Any], data: dict[str, str], display_id: str, *, update: bool
) -> None:
    """Display something under the cell of a request, in any thread, after what is printed so far.

    Args:
        request: The kernel's request that runs the cell, or has run it.
        data: What to display, by types.
        display_id: What it is called when it is updated.
        update: Whether it is shown already.
    """
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    publisher = _shell().display_pub
    publisher.session.send(
        publisher.pub_socket,
        'update_display_data' if update else 'display_data',
        {'data': data, 'metadata': {}, 'transient': {'display_id': display_id}},
        parent=request,
        ident=publisher.topic,
    )


def is_kernel_stream(stream: object) -> bool:
    """Tell whether a stream is the kernel's own, which sends what is written to the notebook."""
    from ipykernel.iostream import OutStream

    return isinstance(stream, OutStream)


def answer_input(answer: Callable[[object], str]) -> None:
    """Let a function of the prompt answer each `input()` of a cell from now on."""
    # ipykernel puts this method in the place of `input` whenever it runs a cell.
    _shell().kernel.raw_input = answer


def call_in_kernel(function: Callable[[], None], *, delay_sec: float = 0.0) -> None:
    """Call a function in the kernel's main thread, as soon as no cell is running.

    Args:
        function: What to call.
        delay_sec: How long after that, in seconds.
    """
    loop = _shell().kernel.io_loop
    loop.add_callback(lambda: loop.call_later(delay_sec, function))


def hear_while_cells_run(comm: Any) -> None:
    """Let what the page says on a comm be heard in the thread that the page has asked for.

    ipykernel (7.4) sends it to the thread that has last spoken to the page on that comm instead.
    For what the background says that is the main thread, where it waits for the running cell.
    """
    comm._reply_subshell_for = None


def _shell() -> Any:
    return sys.modules['IPython'].get_ipython()
