"""Wait for a condition, a message or a subscriber.

All of these wait in the cell while the background thread works. The stop button interrupts them,
and when they time out they report what happened instead.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable
from typing import TypeVar

from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from labkit.asking.delivery import MATCH_SEC, wait_until_found
from labkit.asking.listener import Listener, least_profile
from labkit.asking.silence import Failures, stuck_callback, why_silent
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabError, LabTimeout, quoted
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.matching import who_subscribes
from labkit.rosgraph.names import full_topic_name

__all__ = ['listen', 'wait_for_message', 'wait_for_subscribers', 'wait_until']

Message = TypeVar('Message')


def wait_until(condition: Callable[[], object], *, timeout_sec: float | None = 5.0) -> None:
    """Wait until `condition()` is true. It is evaluated after each callback of a node.

    Args:
        condition: A function without arguments, such as `lambda: talker.count >= 3`.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

    Raises:
        LabTimeout: It did not become true in time. The message says what the nodes were doing.
        LabError: `condition` can't be called, or a callback calls this.
    """
    if not callable(condition):
        raise LabError(
            f'lab.wait_until() expects a function, but got {quoted(condition)}.',
            todo='Write lambda: before the condition: lab.wait_until(lambda: talker.count >= 3)',
        )
    _check_timeout(timeout_sec)
    failures = Failures()
    if not runtime.wait(condition, timeout_sec):
        raise LabTimeout(
            f'Waited {_seconds(timeout_sec)} for {_source(condition)}, '
            'but it did not become true.',
            todo=_why_nothing_happened(failures),
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
        LabTimeout: None came. The message says what was seen instead.
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
        count: Number of messages to collect.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.
        qos_profile: QoS profile or queue depth. By default one that hears any publisher.

    Returns:
        `count` messages, in the order they came.

    Raises:
        LabTimeout: Fewer came. The message says what was seen instead.
        LabError: `topic`, `msg_type` or `count` is invalid.
    """
    _check_message_type(msg_type)
    if not isinstance(count, int) or count < 1:
        raise LabError(f'count must be a whole number of at least 1, but it is {quoted(count)}.')
    _check_timeout(timeout_sec)
    messages: list[Message] = []
    failures = Failures()
    runtime.refuse_in_callback('Waiting')
    runtime.start()
    node = runtime.helper
    assert node is not None
    topic = full_topic_name(topic, node)
    profile = least_profile() if qos_profile is None else qos_profile
    with Listener(node, topic, msg_type, messages.append, qos_profile=profile) as listener:
        if runtime.wait(lambda: len(messages) >= count, timeout_sec):
            return messages[:count]
        wanted = f'{count} messages' if count > 1 else 'a message'
        raise LabTimeout(
            f'Waited {_seconds(timeout_sec)} for {wanted} of {type_name(msg_type)} on {topic}, '
            f'but {len(messages) or "none"} came.',
            todo=why_silent(
                node,
                topic,
                msg_type,
                listener.profile,
                heard=len(messages),
                failures=failures,
            ),
        )


def wait_for_subscribers(
    publisher: Publisher, *, count: int = 1, timeout_sec: float | None = 5.0
) -> None:
    """Wait until a publisher has subscribers, so that what it publishes next is heard.

    Args:
        publisher: The publisher that `create_publisher` returned.
        count: Number of subscribers to wait for.
        timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

    Raises:
        LabTimeout: Fewer came in time. The message says who subscribes to what.
    """
    if not isinstance(publisher, Publisher):
        raise LabError(
            f'lab.wait_for_subscribers() expects a publisher, but got {quoted(publisher)}.',
            todo='Pass what create_publisher() returned, such as talker.publisher.',
        )
    _check_timeout(timeout_sec)

    def found() -> bool:
        return bool(publisher.get_subscription_count() >= count)

    if runtime.executor.in_callback():
        # Subscribers are found without callbacks. That they have found the publisher can't be
        # asked: their answers would wait for this callback.
        endless = timeout_sec is None or timeout_sec < 0
        if wait_for(found, None if endless else timeout_sec):
            return
    elif runtime.wait(found, timeout_sec):
        assert runtime.helper is not None
        wait_until_found(runtime.helper, [publisher], MATCH_SEC if timeout_sec else 0.0)
        return
    seen, topic = publisher.get_subscription_count(), publisher.topic_name
    assert runtime.helper is not None
    raise LabTimeout(
        f'Waited {_seconds(timeout_sec)} for {count} subscriber(s) of {topic}, '
        f'but {seen or "none"} came.',
        todo=who_subscribes(runtime.helper, topic, publisher.msg_type, publisher.qos_profile),
    )


def _why_nothing_happened(failures: Failures) -> str:
    """Describe what the learner's nodes were doing while a condition stayed false."""
    if stuck := stuck_callback():
        return stuck
    if failed := failures.seen():
        return failed
    entries = runtime.nodes()
    if not entries:
        return 'No node runs in this notebook. Start one with lab.spin(node).'
    for entry in entries:
        for subscription in entry.node.subscriptions:
            if runtime.helper is not None and not entry.counts.get(subscription):
                return f'{entry.name} subscribes to {subscription.topic_name}. ' + why_silent(
                    runtime.helper,
                    subscription.topic_name,
                    subscription.msg_type,
                    subscription.qos_profile,
                )
    names = ', '.join(f'{entry.name} ({entry.callbacks} callbacks)' for entry in entries)
    return f'Running here: {names}. Is the condition the right one?'


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
            f'timeout_sec must be a number of seconds, or None, but it is {quoted(timeout_sec)}.'
        )


def _check_message_type(msg_type: object) -> None:
    if isinstance(msg_type, type) and hasattr(msg_type, 'get_fields_and_field_types'):
        return
    raise LabError(
        f'The type of the messages must be a message class, but it is {quoted(msg_type)}.',
        todo='Import one and pass it: from std_msgs.msg import String',
    )
