"""Every private name of rclpy and ipykernel that labkit uses, and nothing else.

Each function has a contract test in tests/background/test_compat.py, which shows within a minute
whether a new rclpy or ipykernel still fits.
"""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy._rclpy_pybind11 import RCLError
from rclpy.event_handler import EventHandler
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.task import Future
from rclpy.time_source import TimeSource

from labkit import settings

if TYPE_CHECKING:
    from rclpy.action.client import ActionClient, ClientGoalHandle
    from rclpy.action.server import ActionServer
    from rclpy.client import Client
    from rclpy.clock import ROSClock
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.subscription import Subscription
    from rclpy.task import Task
    from rclpy.timer import Rate, Timer
    from rclpy.waitable import NumberOfEntities, Waitable

__all__ = [
    'RCLError',
    'action_type_of',
    'answer_input',
    'awaited_by',
    'call_in_kernel',
    'callback_of',
    'client_of_goal',
    'display_under',
    'end_type_descriptions',
    'event_of',
    'forget_executor',
    'handler_of',
    'hear_while_cells_run',
    'is_kernel_stream',
    'is_of_rate',
    'is_shut_down',
    'keep_feedback',
    'new_wait_set',
    'node_of_action',
    'own_guards',
    'parameter_values',
    'parameters_of',
    'pending_requests',
    'running_number',
    'running_request',
    'set_ros_time_is_active',
    'set_thread_request',
    'take_all',
    'take_logs',
    'takers',
    'tasks_of',
    'timer_of_rate',
    'write_for',
]

# How long e.g. a waiting executor may hold a destroyed service, s.
GONE_SEC = 1.0
POLL_SEC = 0.001

# --- rclpy ---------------------------------------------------------------------------------------


def takers(executor: Executor) -> dict[str, Callable[[Any], Any]]:
    """Return the function that takes from a ready entity, for each kind of entity.

    Each returns a function that makes the coroutine which runs the callback, or None if the entity
    was destroyed meanwhile or the message is gone. The wait itself takes a guard condition.
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
    """Make a wait set for a number of entities."""
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
    """Return the event of an `EventHandler`, None for any other waitable.

    rclpy asks it twice a wait, and each publisher and subscription has two of them.
    """
    return waitable._EventHandler__event if type(waitable) is EventHandler else None  # type: ignore[attr-defined]


def handler_of(task: Task) -> Any:
    """Return the function or coroutine of a task; None once it is done."""
    return task._handler


def callback_of(task: Task) -> Any:
    """Return the function or coroutine of a task; for a goal, the action's execute callback."""
    handler = handler_of(task)
    frame = getattr(handler, 'cr_frame', None)
    if frame is None or handler.__name__ != '_execute_goal':
        return handler
    return frame.f_locals['execute_callback']


def awaited_by(task: Task) -> Any:
    """Return the future that a task's coroutine awaits, None if it awaits something else."""
    awaited: Any = handler_of(task)
    while hasattr(awaited, 'cr_await'):
        awaited = awaited.cr_await
    frame = getattr(awaited, 'gi_frame', None)  # of `Future.__await__`
    future = frame.f_locals.get('self') if frame is not None else None
    return future if isinstance(future, Future) else None


def is_of_rate(node: Node, *args: object) -> bool:
    """Return whether a timer with these arguments, from its callback group on, is a rate's."""
    return args[:1] == (node._rate_group,)


def action_type_of(client: ActionClient) -> Any:
    """Return the class of the action that an action client is for."""
    return client._action_type


def client_of_goal(handle: ClientGoalHandle) -> ActionClient:
    """Return the action client that has sent a goal."""
    client: ActionClient = handle._action_client
    return client


def keep_feedback(handle: ClientGoalHandle, result: Future) -> Callable[[], None]:
    """Let the feedback of a goal be heard that is taken only after its result.

    Of what has arrived, an action client takes the result and one feedback message at once, and
    with the result it forgets who hears the others.

    Args:
        handle: The handle of the goal.
        result: The future of its result, before the background could set it.

    Returns:
        A function that ends this.
    """
    callbacks = client_of_goal(handle)._feedback_callbacks
    goal = bytes(handle.goal_id.uuid)
    if (heard := callbacks.get(goal)) is not None:
        result.add_done_callback(lambda _: callbacks.setdefault(goal, heard))  # type: ignore[no-untyped-call]
    return lambda: callbacks.pop(goal, None)


def tasks_of(executor: Executor) -> list[tuple[Task, Any, Node | None]]:
    """Return the tasks of an executor that are not done, each with its entity and node."""
    with executor._tasks_lock:
        return [each for each in executor._tasks if not each[0].done()]  # type: ignore[no-untyped-call]


def is_shut_down(executor: Executor) -> bool:
    """Return whether `shutdown()` of an executor has been called."""
    return bool(executor._is_shutdown)


def forget_executor(node: Node) -> None:
    """Set `node.executor` to None, which `Executor.remove_node` does not.

    The public setter would ask the executor once more to remove the node.
    """
    node._Node__executor_weakref = None  # type: ignore[attr-defined]


def end_type_descriptions(node: Node) -> None:
    """Destroy the type description service of a node, before the node is destroyed.

    rclpy (7.1) frees it without finalizing it: it stays in the graph, and 0.1 MB with it, until
    ROS is shut down, and each further node takes longer to make (ros2/rclpy, pull request 1711).
    That is all that happens where this can't help: the service is still in use after a second, or
    there is no `librcl`. The node may lack the service, or be destroyed already.
    """
    owner: Any = getattr(node, '_type_description_service', None)
    inner = getattr(owner, '_type_description_srv', None)
    if inner is None:
        return
    try:
        # One more reference to the service and its node keeps both until the last line.
        service, node_pointer = inner.impl, node.handle.pointer
    except (InvalidHandle, AttributeError):
        return
    known = [one for one in node.services if one.handle.pointer == service.pointer]
    for one in known:
        node.destroy_service(one)
    owner.destroy()
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
    """Return the node of an action server."""
    node: Node = server._node
    return node


def parameters_of(node: Node) -> tuple[list[str], list[str]]:
    """Return the names of the parameters that a node was given, and of those it has declared."""
    return list(node._parameter_overrides), list(node._parameters)


def parameter_values(node: Node) -> dict[str, Any]:
    """Return the values of the parameters that a node has declared."""
    return {name: parameter.value for name, parameter in dict(node._parameters).items()}


def has_parameter_callbacks(node: Node) -> bool:
    """Return whether a node has callbacks for parameters, besides the one of its clock."""
    found = [*node._pre_set_parameters_callbacks, *node._on_set_parameters_callbacks]
    found += node._post_set_parameters_callbacks
    return any(not isinstance(getattr(each, '__self__', None), TimeSource) for each in found)


def pending_requests(client: Client) -> int:
    """Return the number of requests of a client that have no answer yet."""
    return len(client._pending_requests)


def timer_of_rate(rate: Rate) -> Timer:
    """Return the timer that a rate sleeps on."""
    timer: Timer = rate._timer
    return timer


def set_ros_time_is_active(clock: ROSClock, active: bool) -> None:
    """Switch a clock between the time that it is given and the system's.

    The parameter `use_sim_time` does so too, but callbacks of the node and the whole graph see it,
    and it adds a subscription to `/clock`.
    """
    clock._set_ros_time_is_active(active)


def take_all(subscription: Subscription, most: int) -> int:
    """Take at most so many messages of a subscription that no executor spins; return how many."""
    count = 0
    with subscription.handle:
        while count < most and subscription.handle.take_message(subscription.msg_type, True):
            count += 1
    return count


def take_logs(show: Callable[[int, str, str], None]) -> Callable[[], None]:
    """Call a function for each log message of rclpy, in addition to logging it.

    Args:
        show: Called with severity, name of the logger and message, in the thread that logs.

    Returns:
        A function that undoes this.
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
    """Return the request that runs the current cell."""
    request: dict[str, Any] = settings.shell().get_parent()
    return request


def running_number() -> int:
    """Return which execution the current cell is, as in `In[12]`, or the one that ran last."""
    # The count of the shell is one ahead while a cell runs.
    return len(settings.shell().history_manager.input_hist_raw) - 1


def set_thread_request(request: dict[str, Any]) -> None:
    """Assign the calling thread's output to a request, if the kernel can do that."""
    shell = settings.shell()
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
    """Write output of a request, in a thread for which `set_thread_request` was called."""
    if hasattr(stream, '_parent_header') or not is_kernel_stream(stream) or not request:
        stream.write(text)
        return
    # In Google Colab's ipykernel (6.17) a stream has no request per thread.
    publisher = settings.shell().display_pub
    content = {'name': stream.name, 'text': text}
    publisher.session.send(
        publisher.pub_socket, 'stream', content, parent=request, ident=stream.topic
    )


def display_under(
    request: dict[str, Any], data: dict[str, str], display_id: str, *, update: bool
) -> None:
    """Display something under the cell of a request, after what was printed so far.

    Args:
        request: The request that runs the cell, or has run it.
        data: The MIME bundle.
        display_id: Its id for updates.
        update: Whether to update what is displayed already.
    """
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    publisher = settings.shell().display_pub
    publisher.session.send(
        publisher.pub_socket,
        'update_display_data' if update else 'display_data',
        {'data': data, 'metadata': {}, 'transient': {'display_id': display_id}},
        parent=request,
        ident=publisher.topic,
    )


def is_kernel_stream(stream: object) -> bool:
    """Return whether a stream is the kernel's own, which sends its text to the notebook."""
    from ipykernel.iostream import OutStream

    return isinstance(stream, OutStream)


def answer_input(answer: Callable[[object], str]) -> None:
    """Answer each `input()` of a cell by a function of the prompt."""
    # ipykernel replaces `input` by this method whenever it runs a cell.
    settings.shell().kernel.raw_input = answer


def call_in_kernel(function: Callable[[], None], *, delay_sec: float = 0.0) -> None:
    """Call a function in the kernel's main thread, `delay_sec` after no cell is running."""
    loop = settings.shell().kernel.io_loop
    loop.add_callback(lambda: loop.call_later(delay_sec, function))


def hear_while_cells_run(comm: Any) -> None:
    """Receive messages of a comm in the thread that the page has asked for.

    ipykernel (7.4) delivers them in the thread that has last sent on that comm instead. For the
    background that is the main thread, where they wait for the running cell.
    """
    comm._reply_subshell_for = None
