"""Helpers of verbs that run until they are stopped: a subscription, and the loop that waits.

Messages arrive in the background and are queued; the loop prints them in the cell that runs the
command. It holds back the output of other callbacks, so the output is the same each time.
"""

from __future__ import annotations

import time
from argparse import Namespace
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.asking.discovery import poll_until
from labkit.asking.listener import Listener
from labkit.background.compat import RCLError
from labkit.background.wait import wait_for
from labkit.errors import LabError
from labkit.ros2.graph_queries import other_type, unknown
from labkit.ros2.parser import Parser, Usage, positive_float, positive_int
from labkit.rosgraph.listings import topic_types, topics

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__all__ = [
    'MAX_SHOWN',
    'Arrivals',
    'Filter',
    'Stop',
    'add_filter_option',
    'add_stop_options',
    'log',
    'subscribed',
    'tell',
    'wait_for_type',
]

# Most messages shown in a cell. A terminal forgets what scrolls away, a notebook keeps it.
MAX_SHOWN = 1000
# Most queued messages; further ones are lost.
MAX_WAITING = 1000


def add_stop_options(parser: Parser, what: str) -> None:
    """Add the options that end a stream, which the real verbs do not have.

    Args:
        parser: The parser to extend.
        what: What is counted, such as `'messages'`.
    """
    parser.add('--count', metavar='N', type=positive_int, help=f'Exit after N {what} (only here)')
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='Exit after N seconds (only here)'
    )


def add_filter_option(parser: Parser) -> None:
    """Add the option that leaves messages out."""
    parser.add(
        '--filter',
        dest='filter_expr',
        metavar='EXPRESSION',
        help='Take only messages for which an expression over m (the message) is true, such as '
        "'m.data > 5'",
    )


class Filter:
    """The messages that `--filter` lets through; all of them without that option.

    Args:
        args: The arguments, maybe with that of `add_filter_option`.
        sample: A message of the type, whatever it holds.

    Raises:
        LabError: The expression can't be understood.
    """

    def __init__(self, args: Namespace, sample: Any) -> None:
        self._expression = getattr(args, 'filter_expr', None)
        self._is_wanted: Callable[[Any], bool] = lambda message: True
        self._left_out = 0
        if self._expression is not None:
            # Loaded here: it costs only those who filter.
            from labkit.launching.expressions import message_filter

            self._is_wanted = message_filter(self._expression, sample)

    def passes(self, message: Any) -> bool:
        """Return whether a message is wanted.

        Raises:
            LabError: The expression has no value for it.
        """
        wanted = self._is_wanted(message)
        self._left_out += not wanted
        return wanted

    def why_none(self) -> str:
        """Return what to say if no message was wanted, '' if none came."""
        if not self._left_out:
            return ''
        return f'{self._left_out} messages came, and for none is {self._expression} true.'


class Stop:
    """The end of a stream: after a count, or after a time.

    Args:
        count: Number of calls of `count_one` before the end; None for no limit.
        timeout_sec: Seconds before the end; None for no limit.

    Raises:
        Usage: There is no limit, and nobody to press the stop button.
    """

    def __init__(self, count: int | None, timeout_sec: float | None) -> None:
        endless = count is None and timeout_sec is None
        if endless and settings.audience().patience_sec is not None:
            raise Usage(
                'This goes on until the stop button is pressed, and nobody is there to press it.',
                todo='Add --timeout N or --count N.',
            )
        self._left = count
        self._end = None if timeout_sec is None else time.monotonic() + timeout_sec

    def count_one(self) -> None:
        """Count one message or report."""
        if self._left is not None:
            self._left -= 1

    def now(self) -> None:
        """End the stream now."""
        self._left = 0

    @property
    def reached(self) -> bool:
        """Whether it is time to end."""
        return self._left == 0 or (self._end is not None and time.monotonic() >= self._end)


class Arrivals:
    """Queue of messages that arrived in the background."""

    def __init__(self) -> None:
        self._waiting: deque[Callable[[], object]] = deque()

    def put(self, show: Callable[[], object]) -> None:
        """Queue the printing of a message. Called in the background; never blocks."""
        if len(self._waiting) < MAX_WAITING:
            self._waiting.append(show)

    def show_until(self, stop: Stop, after: Callable[[], object] = lambda: None) -> None:
        """Print messages until it is time to stop.

        Args:
            stop: When to stop.
            after: Called after each message, and many times a second.
        """

        def is_due() -> bool:
            after()
            return stop.reached or bool(self._waiting)

        while wait_for(is_due, None) and not stop.reached:
            self._waiting.popleft()()

    def show_rest(self) -> None:
        """Print what has arrived since it was time to stop."""
        while self._waiting:
            self._waiting.popleft()()


def tell(text: str, end: str = '\n') -> None:
    """Print a part of a stream: at once in a terminal, soon in a cell.

    A kernel sends each flush as one message, and a slow client loses some of a thousand. Without
    flushes, ipykernel sends the output five times a second.
    """
    print(text, end=end, flush=not settings.in_kernel())


def log(level: str, node_name: str, text: str) -> None:
    """Print a line like the log of a node, without the time, which differs each time."""
    tell(f'[{level}] [{node_name}]: {text}')


def wait_for_type(
    node: Node, topic: str, stop: Stop, *, typed: str, is_patient: bool = True
) -> str | None:
    """Return the type of a topic; wait for a topic that does not exist yet, and say so.

    Args:
        node: The node to query the graph with.
        topic: Full name of the topic.
        stop: When to stop waiting.
        typed: The name of the topic as typed, for messages.
        is_patient: Whether to wait for it.

    Returns:
        The type's name, None if it was time to stop.

    Raises:
        LabError: The topic has more than one type.
    """
    types = poll_until(lambda: topic_types(node, topic))
    if not types:
        hint = unknown(topic, [name for name, _ in topics(node)], 'topic')
        print(f'WARNING: topic [{typed}] does not appear to be published yet', flush=True)
        if hint.startswith('Did you mean') and settings.audience().wants_reasons:
            print(hint, flush=True)
        if not is_patient:
            return None
        wait_for(lambda: topic_types(node, topic) or stop.reached, None)
        types = topic_types(node, topic)
    if len(types) > 1:
        raise LabError(
            f"Cannot echo topic '{topic}', as it contains more than one type: "
            f'[{", ".join(types)}]',
            todo='Name the type that you want after the topic.',
        )
    return types[0] if types else None


@contextmanager
def subscribed(
    node: Node,
    topic: str,
    msg_type: Any,
    profile: QoSProfile,
    callback: Callable[..., None],
    *,
    say: Callable[[str], None] | None = None,
    report_lost: bool = False,
    raw: bool = False,
) -> Iterator[None]:
    """Subscribe to a topic while a `with` block runs.

    Args:
        node: The node that subscribes.
        topic: Full name of the topic.
        msg_type: Class of its messages.
        profile: QoS profile.
        callback: Called in the background with each message.
        say: Called in the background with remarks.
        report_lost: Whether to report lost messages.
        raw: Whether to pass serialized messages.

    Raises:
        LabError: Somebody in this process uses the topic with another type.
    """
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.qos import qos_policy_name_from_kind

    def lost(event: Any) -> None:
        assert say is not None
        say(
            f'A message was lost!!!\n\ttotal count change:{event.total_count_change}'
            f'\n\ttotal count: {event.total_count}---'
        )

    def incompatible(event: Any) -> None:
        if say is not None:
            policy = qos_policy_name_from_kind(event.last_policy_kind)
            say(
                f"[WARN] [ros2]: New publisher discovered on topic '{topic}', offering "
                'incompatible QoS. No messages will be received from it. Last incompatible '
                f'policy: {policy}'
            )

    events = SubscriptionEventCallbacks(
        incompatible_qos=incompatible,
        message_lost=lost if report_lost else None,
        use_default_callbacks=False,
    )
    try:
        listener = Listener(
            node, topic, msg_type, callback, qos_profile=profile, raw=raw, events=events
        )
    except (RCLError, LabError) as error:
        raise other_type(node, topic, msg_type, error) from error
    with listener:
        yield
