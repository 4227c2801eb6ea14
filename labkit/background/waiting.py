"""Wait for what happens in ROS: for a condition, a message, a subscriber. Never for a time.

All of these wait in the cell while the background thread works. They can be interrupted with the
stop button, and when nothing comes they say what they saw instead.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from typing import Any, TypeVar

from rclpy.publisher import Publisher
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.subscription import Subscription

from labkit.background.runtime import runtime
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.matching import who_subscribes, why_silent
from labkit.rosgraph.names import full_topic_name

__all__ = ['listen', 'wait_for_message', 'wait_for_subscribers', 'wait_until']

Message = TypeVar('Message')

DEFAULT_DEPTH = 100


def wait_until(condition: Callable[[], object], *, timeout_sec: float | None = 5.0) -> None:
    """Wait until `condition()` is true. It is looked at after each callback of a node.

    Args:
        condition: A function without arguments, such as `lambda: talker.count >= 3`.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

    Raises:
        LabTimeout: It did not become true in time. The message says what the nodes were doing.
        LabError: `condition` can't be called, or a callback calls this.
    """
    if not callable(condition):
        raise LabError(
            f'lab.wait_until() expects a function, but got {condition!r}.',
            todo='Write lambda: before the condition: lab.wait_until(lambda: talker.count >= 3)',
        )
    _check_timeout(timeout_sec)
    errors = sum(error.count for error in runtime.console.errors)
    if not runtime.wait(condition, timeout_sec):
        raise LabTimeout(
            f'Waited {_seconds(timeout_sec)} for {_source(condition)}, '
            'but it did not become true.',
            todo=_why_nothing_happened(errors),
        )


def wait_for_message(
    topic: str,
    msg_type: type[Message],
    *,
    timeout_sec: float | None = 5.0,
    qos_profile: QoSProfile | int | None = None,
) -> Message:
    """Wait for the next message on a topic.

    Args:
        topic: The topic's name, such as `'/chatter'`.
        msg_type: The class of its messages, such as `std_msgs.msg.String`.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.
        qos_profile: QoS profile or queue depth. By default one that hears any publisher.

    Returns:
        The message.

    Raises:
        LabTimeout: None came. The message names the likeliest cause.
    """
    return listen(topic, msg_type, count=1, timeout_sec=timeout_sec, qos_profile=qos_profile)[0]


def listen(
    topic: str,
    msg_type: type[Message],
    *,
    count: int,
    timeout_sec: float | None = 5.0,
    qos_profile: QoSProfile | int | None = None,
) -> list[Message]:
    """Collect the next messages on a topic.

    Args:
        topic: The topic's name, such as `'/odds'`.
        msg_type: The class of its messages.
        count: How many messages to collect.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.
        qos_profile: QoS profile or queue depth. By default one that hears any publisher.

    Returns:
        `count` messages, in the order they came.

    Raises:
        LabTimeout: Fewer came. The message names the likeliest cause.
        LabError: `topic`, `msg_type` or `count` is not what it should be.
    """
    _check_message_type(msg_type)
    if not isinstance(count, int) or count < 1:
        raise LabError(f'count must be a whole number of at least 1, but it is {count!r}.')
    _check_timeout(timeout_sec)
    messages: list[Message] = []
    with _Listener(topic, msg_type, qos_profile, messages) as listener:
        if runtime.wait(lambda: len(messages) >= count, timeout_sec):
            return messages[:count]
        wanted = f'{count} messages' if count > 1 else 'a message'
        raise LabTimeout(
            f'Waited {_seconds(timeout_sec)} for {wanted} of {type_name(msg_type)} on '
            f'{listener.topic}, but {len(messages) or "none"} came.',
            todo=listener.why_silent() if not messages else 'They come slower than that.',
        )


def wait_for_subscribers(
    publisher: Publisher, *, count: int = 1, timeout_sec: float | None = 5.0
) -> None:
    """Wait until a publisher has subscribers, so that what it publishes next is heard.

    Args:
        publisher: What `create_publisher` returned.
        count: How many subscribers to wait for.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

    Raises:
        LabTimeout: Fewer came in time. The message says who subscribes to what.
    """
    if not isinstance(publisher, Publisher):
        raise LabError(
            f'lab.wait_for_subscribers() expects a publisher, but got {publisher!r}.',
            todo='Pass what create_publisher() returned, such as talker.publisher.',
        )
    _check_timeout(timeout_sec)
    if not runtime.wait(lambda: publisher.get_subscription_count() >= count, timeout_sec):
        seen, topic = publisher.get_subscription_count(), publisher.topic_name
        assert runtime.helper is not None
        raise LabTimeout(
            f'Waited {_seconds(timeout_sec)} for {count} subscriber(s) of {topic}, '
            f'but {seen or "none"} came.',
            todo=who_subscribes(runtime.helper, topic, publisher.msg_type, publisher.qos_profile),
        )


class _Listener:
    """A subscription of the hidden node, for as long as a `with` block lasts."""

    def __init__(
        self,
        topic: str,
        msg_type: type[Any],
        qos_profile: QoSProfile | int | None,
        messages: list[Any],
    ) -> None:
        runtime.refuse_in_callback('Waiting')
        runtime.start()
        assert runtime.helper is not None
        self._node = runtime.helper
        self._type = msg_type
        self._profile = _profile(qos_profile)
        self.topic = full_topic_name(topic, self._node)
        self._subscription: Subscription = self._node.create_subscription(
            msg_type, self.topic, messages.append, self._profile
        )

    def why_silent(self) -> str:
        return why_silent(self._node, self.topic, self._type, self._profile)

    def __enter__(self) -> _Listener:
        return self

    def __exit__(self, *_: object) -> None:
        self._node.destroy_subscription(self._subscription)


def _profile(qos_profile: QoSProfile | int | None) -> QoSProfile:
    if isinstance(qos_profile, QoSProfile):
        return qos_profile
    if qos_profile is not None:
        return QoSProfile(depth=qos_profile)  # type: ignore[no-untyped-call]
    # Asks for the least, so that a publisher of any profile is heard.
    return QoSProfile(  # type: ignore[no-untyped-call]
        depth=DEFAULT_DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
    )


def _why_nothing_happened(errors_before: int) -> str:
    """Say what the learner's nodes were doing while a condition stayed false."""
    running = runtime.executor.running_callback()
    if running is not None:
        return (
            f'The callback {running[1]} of {running[0]} is still running; while it runs, no other '
            'callback can. Let callbacks return soon.'
        )
    errors = runtime.console.errors
    if sum(error.count for error in errors) > errors_before:
        last = errors[-1]
        return (
            f'Meanwhile the callback {last.callback} of {last.node_name} failed: '
            f'{type(last.error).__name__}: {last.error}'
        )
    entries = runtime.nodes()
    if not entries:
        return 'No node runs in this notebook. Start one with lab.spin(node).'
    for entry in entries:
        for subscription in entry.node.subscriptions:
            if runtime.helper is not None and not _heard(subscription):
                return f'{entry.name} subscribes to {subscription.topic_name}. ' + why_silent(
                    runtime.helper,
                    subscription.topic_name,
                    subscription.msg_type,
                    subscription.qos_profile,
                )
    names = ', '.join(f'{entry.name} ({entry.callbacks} callbacks)' for entry in entries)
    return f'Running here: {names}. Is the condition the right one?'


def _heard(subscription: Subscription) -> bool:
    return any(entry.counts.get(subscription) for entry in runtime.nodes())


def _source(condition: Callable[[], object]) -> str:
    """Return a condition as the learner wrote it."""
    try:
        text = textwrap.dedent(inspect.getsource(condition))
        tree = ast.parse(text)
    except (OSError, TypeError, SyntaxError):
        return _called(condition)
    for node in ast.walk(tree):
        if isinstance(node, ast.Lambda):
            return ast.get_source_segment(text, node.body) or _called(condition)
    return _called(condition)


def _called(condition: Callable[[], object]) -> str:
    return f'{getattr(condition, "__name__", condition)}()'


def _seconds(timeout_sec: float | None) -> str:
    return f'{timeout_sec:g} s' if timeout_sec is not None else 'until ROS was stopped'


def _check_timeout(timeout_sec: object) -> None:
    if timeout_sec is not None and not isinstance(timeout_sec, (int, float)):
        raise LabError(
            f'timeout_sec must be a number of seconds, or None, but it is {timeout_sec!r}.'
        )


def _check_message_type(msg_type: object) -> None:
    if isinstance(msg_type, type) and hasattr(msg_type, 'get_fields_and_field_types'):
        return
    raise LabError(
        f'The type of the messages must be a message class, but it is {msg_type!r}.',
        todo='Import one and pass it: from std_msgs.msg import String',
    )
