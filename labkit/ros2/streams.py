"""What verbs share that go on until they are stopped: a subscription, and the loop that waits.

Messages are taken in the background and handed over; all printing is done by the loop, in the
cell that runs the command. The loop does not let the output of other callbacks through, so a
cell shows the same each time.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.background.compat import RCLError
from labkit.errors import LabError
from labkit.ros2.asking import other_type, unknown
from labkit.ros2.parser import Parser, Usage, positive_float, positive_int
from labkit.rosgraph.listings import topic_types, topics

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__all__ = [
    'MAX_SHOWN',
    'Arrivals',
    'Stop',
    'add_stop_options',
    'subscribed',
    'tell',
    'wait_for_type',
]

# So many messages a cell shows. A terminal forgets what has scrolled away, a notebook keeps it.
MAX_SHOWN = 1000
# While nothing comes, the loop looks this often whether it is time to stop.
POLL_SEC = 0.05
# Messages that wait to be printed; more than that are counted as lost.
MAX_WAITING = 1000


def add_stop_options(parser: Parser, what: str) -> None:
    """Add the options that end a stream, which the real verbs do not have.

    Args:
        parser: Where to add them.
        what: What is counted, such as `'messages'`.
    """
    parser.add('--count', metavar='N', type=positive_int, help=f'Exit after N {what} (only here)')
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='Exit after N seconds (only here)'
    )


class Stop:
    """Tells when a stream is to end: after a count, or after a time.

    Args:
        count: How often `count_one` is called before the end; None for no end.
        timeout_sec: Seconds before the end; None for no end.

    Raises:
        Usage: There is no end, and nobody to press the stop button.
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
        """End it now."""
        self._left = 0

    @property
    def reached(self) -> bool:
        """Tell whether it is time to end."""
        return self._left == 0 or self.left_sec == 0

    @property
    def left_sec(self) -> float:
        """Return how long to wait before looking again, in seconds."""
        if self._end is None:
            return POLL_SEC
        return min(POLL_SEC, max(0.0, self._end - time.monotonic()))


class Arrivals:
    """What has come in the background and waits to be printed."""

    def __init__(self) -> None:
        self._queue: queue.Queue[Callable[[], object]] = queue.Queue(MAX_WAITING)

    def put(self, show: Callable[[], object]) -> None:
        """Hand over what prints a message. Called in the background; never waits."""
        try:
            self._queue.put_nowait(show)
        except queue.Full:
            pass

    def show_until(self, stop: Stop, after: Callable[[], object] = lambda: None) -> None:
        """Print what comes until it is time to stop.

        Args:
            stop: When to stop.
            after: Called after each message, and some times a second.
        """
        while not stop.reached:
            try:
                self._queue.get(timeout=stop.left_sec or 0.001)()
            except queue.Empty:
                pass
            after()


def tell(text: str, end: str = '\n') -> None:
    """Print a part of a stream: at once in a terminal, soon in a cell.

    A kernel sends what is flushed as one message each. A client that is behind loses some of a
    thousand such messages; left alone, ipykernel sends what was printed five times a second.
    """
    print(text, end=end, flush=not settings.in_kernel())


def wait_for_type(node: Node, topic: str, stop: Stop, *, typed: str) -> str | None:
    """Return the type of a topic; wait for a topic that does not exist yet, and say so.

    Args:
        node: The node to ask the graph with.
        topic: Full name of the topic.
        stop: When to stop waiting.
        typed: The name of the topic as it was typed, which is how it is shown.

    Returns:
        The type's name, None if it was time to stop.

    Raises:
        LabError: The topic has more than one type.
    """
    said = False
    while True:
        types = topic_types(node, topic)
        if len(types) > 1:
            raise LabError(
                f"Cannot echo topic '{topic}', as it contains more than one type: "
                f'[{", ".join(types)}]',
                todo='Name the type that you want after the topic.',
            )
        if types:
            return types[0]
        if not said:
            said = True
            hint = unknown(topic, [name for name, _ in topics(node)], 'topic')
            print(f'WARNING: topic [{typed}] does not appear to be published yet', flush=True)
            if hint.startswith('Did you mean'):
                print(hint, flush=True)
        if stop.reached:
            return None
        time.sleep(stop.left_sec)


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
    """Listen to a topic for as long as a `with` block lasts.

    Args:
        node: The node that subscribes.
        topic: Full name of the topic.
        msg_type: Class of its messages.
        profile: QoS profile.
        callback: Called in the background with each message.
        say: Called in the background with what else there is to say.
        report_lost: Whether to say when a message was lost.
        raw: Whether to hand over serialized messages.

    Raises:
        LabError: Somebody in this process uses the topic with another type.
    """
    from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
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
        try:
            subscription = node.create_subscription(
                msg_type, topic, callback, profile, event_callbacks=events, raw=raw
            )
        except UnsupportedEventTypeError:
            subscription = node.create_subscription(msg_type, topic, callback, profile, raw=raw)
    except (RCLError, LabError) as error:
        raise other_type(node, topic, msg_type, error) from error
    try:
        yield
    finally:
        node.destroy_subscription(subscription)
