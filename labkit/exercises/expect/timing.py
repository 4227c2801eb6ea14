"""Matchers for what comes on a topic, and when: messages, rate, silence and its reasons."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises.expect.endpoints import alone
from labkit.exercises.expect.spinning import hanging
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail, NotAttempted
from labkit.exercises.watch import Sample, Watch

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = [
    'at_rate',
    'ends_with_node',
    'messages',
    'rate',
    'reason',
]

# How long a topic may be silent before that is a finding, where no rate is asked for.
QUIET_SEC = 2.0
# So long the first message of another process may take: that process has to find the subscription,
# and where its first search is lost, it asks again after 3 s.
FOUND_SEC = 4.0
# Intervals that a median is taken of: enough to bear a busy machine, few enough to be quick.
MAX_INTERVALS = 8
# How far a rate may be off in real time, as a part of it. A sleep lasts longer than was asked for,
# on a busy machine much longer, but never shorter. So the quicker quarter of the intervals counts.
TOLERANCE = 0.1
# So many calls of every timer, over so long, without a message: nothing is published there.
VAIN_TICKS = 5
VAIN_SEC = 0.5
# How long messages of a known rate may be collected.
COLLECT_SEC = 2.5
# How long a node may take to end.
END_SEC = 3.0


def messages(
    probe: Probe,
    source: Endpoint,
    *,
    count: int = 3,
    hz: float | None = None,
    tolerance: float = TOLERANCE,
    at_least: bool = False,
) -> Watch:
    """Expect messages from a publisher, at a rate if one is given.

    Args:
        probe: The probe of the check.
        source: What `publisher` returned.
        count: How many messages to wait for, at least; fewer if `hz` leaves no time for them.
        hz: Messages a second that are asked for; any number if None.
        tolerance: How far the usual interval may be off, as a part of it.
        at_least: Whether more messages a second are right, too.

    Returns:
        The messages, in their order.

    Raises:
        Fail: They do not come, or at another rate.
    """
    watch = probe.watch(source.topic, source.msg_type)
    quiet = QUIET_SEC
    if hz is not None:
        rate(probe, watch, hz, tolerance=tolerance, source=source, at_least=at_least)
        quiet = max(quiet, 2.0 / hz)
        # More than what a check has time for can't be asked of a slow topic.
        count = min(count, max(2, int(COLLECT_SEC * hz)))
    while len(watch) < count:
        if not _next_message(probe, watch, source, quiet, hz):
            _explain_silence(probe, watch, source)
    return watch


def at_rate(
    probe: Probe, topic: str, msg_type: str, hz: float, *, count: int, tolerance: float = TOLERANCE
) -> list[list[Sample]]:
    """Return the messages of those publishers of a topic that publish at a rate, in real time.

    Args:
        probe: The probe of the check.
        topic: Full name of the topic.
        msg_type: Name of its type.
        hz: Messages a second.
        count: So many publishers are waited for; not longer than it takes to tell.
        tolerance: How far the usual interval may be off, as a part of it.
    """
    watch = probe.watch(topic, msg_type)
    enough = max(1, min(MAX_INTERVALS, round(hz)))

    def fitting() -> list[list[Sample]]:
        return [
            stream
            for stream in watch.streams()
            if len(stream) > enough and _fits(_intervals(stream), 1.0 / hz, tolerance)
        ]

    probe.wait(lambda: len(fitting()) >= count, (enough + 2) / hz + FOUND_SEC / 4)
    return fitting()


def rate(
    probe: Probe,
    watch: Watch,
    hz: float,
    *,
    tolerance: float = TOLERANCE,
    source: Endpoint,
    at_least: bool = False,
) -> float:
    """Expect messages at a rate, judged by the median interval of the publisher's own stamps.

    It waits only as long as it takes: a rate that is far off shows soon.

    Args:
        probe: The probe of the check.
        watch: The messages of the topic.
        hz: Messages a second that are asked for.
        tolerance: How far the usual interval may be off, as a part of it.
        source: The publisher.
        at_least: Whether more messages a second are right, too.

    Returns:
        The rate that was seen, in Hz.

    Raises:
        Fail: The rate is another one, or nothing comes.
        NotAttempted: The check has no time left to tell.
    """
    period = 1.0 / hz
    enough = max(1, min(MAX_INTERVALS, round(hz)))
    # Long enough to see two messages of a rate that is ten times too low, and so to name it.
    quiet = max(2.5 * period, min(12.0 * period, QUIET_SEC))
    if not _next_message(probe, watch, source, max(quiet, QUIET_SEC), hz):
        _refuse_too_early(probe, watch, period)
        _explain_silence(probe, watch, source)

    def decided() -> bool:
        if time.monotonic() - watch.last_arrival > quiet or _crowded(probe, watch.topic):
            return True
        number = len(watch.intervals)
        if number < enough:
            return number > 1 and statistics.median(watch.intervals) > 2.0 * period
        # Where few intervals are enough, one that is odd asks for another one.
        return _fits(watch.intervals, period, tolerance, at_least) or number > enough + (hz >= 1.0)

    probe.wait(decided)
    if _crowded(probe, watch.topic):
        alone(probe, watch.topic)
    if watch.intervals and _fits(watch.intervals, period, tolerance, at_least):
        return 1.0 / statistics.median(watch.intervals)
    _refuse_too_early(probe, watch, period)
    _refuse_rate(probe, watch, source, hz)


def ends_with_node(probe: Probe, source: Endpoint) -> Watch:
    """Stop the publisher's node, and expect that its publisher goes.

    The node is gone afterwards, so an exercise that uses this has `once=True`. The last message
    of a node in another process may be lost when its publisher goes at once: such a node stays
    for a moment.

    Returns:
        The messages up to the end; the last one is what the node said as it ended.

    Raises:
        Fail: The topic still has that publisher, or messages.
    """
    from labkit.background.patience import answer_sec

    watch = messages(probe, source, count=1)
    probe.stop_node(source)

    def gone() -> bool:
        return source.gid not in {endpoint.gid for endpoint in probe.publishers(source.topic)}

    if not probe.wait(gone, answer_sec(END_SEC)):
        raise Fail(
            f'no publisher on {source.topic} once {source.node} has ended',
            f'{source.node} still publishes there',
            why='Something keeps the node alive: a thread or a loop that does not end with it.',
            todo='Let the loop end when rclpy.ok() is False or the node is destroyed.',
        )
    return watch


def _intervals(stream: Sequence[Sample]) -> list[float]:
    return [later.stamp - earlier.stamp for earlier, later in pairwise(stream)]


def _fits(gaps: Sequence[float], period: float, tolerance: float, at_least: bool = False) -> bool:
    intervals = sorted(gaps)
    usual = (statistics.median(intervals), intervals[len(intervals) // 4])
    if at_least:
        return min(usual) <= (1.0 + tolerance) * period
    return any(abs(seen / period - 1.0) <= tolerance for seen in usual)


def _refuse_rate(probe: Probe, watch: Watch, source: Endpoint, hz: float) -> NoReturn:
    period = 1.0 / hz
    expected = f'a message every {period:.3g} s ({hz:.3g} Hz) on {watch.topic}'
    todo = f'The first argument of create_timer() is the period in seconds: {period:.3g}'
    now = time.monotonic()
    waited = now - watch.last_arrival
    if len(watch.intervals) == 0 or waited > 3.0 * statistics.median(watch.intervals):
        node = probe.node_object(source.node)
        periods = [timer.timer_period_ns * 1e-9 for timer in _timers(node)]
        timers = f'; the period of its timer is {max(periods):.3g} s' if periods else ''
        raise Fail(
            expected,
            f'{_count(len(watch))} in {now - watch.started:.1f} s, the last one {waited:.1f} s ago'
            + timers,
            why='The messages come much too slowly, or have stopped coming.',
            todo=todo,
        )
    median = statistics.median(watch.intervals)
    factor = median * hz
    off = f'{factor:.3g} times too slow' if factor > 1 else f'{1 / factor:.3g} times too fast'
    swapped = abs(median / hz - 1.0) < 0.3 and abs(hz - period) > 0.3 * hz
    raise Fail(
        expected,
        f'a message every {median:.3g} s ({1 / median:.3g} Hz): {off}',
        why='A rate in Hz and a period in seconds were mixed up: the period is 1 / rate.'
        if swapped
        else 'The rate is set by the period of the timer, or by the time the loop sleeps.',
        todo=todo,
    )


def _refuse_too_early(probe: Probe, watch: Watch, period: float) -> None:
    """Raise NotAttempted if the check's time is used up before a next message was due.

    A publisher of another process comes into the graph when it likes.
    """
    waited = time.monotonic() - (watch.last_arrival if len(watch) else watch.started)
    if probe.time_left <= 0 and not watch.intervals and waited < 1.5 * period:
        raise NotAttempted(
            f'Too early to tell: {_count(len(watch))} so far on {watch.topic}, and the next one '
            'is not due yet. Run this cell again.'
        )


def _next_message(
    probe: Probe, watch: Watch, source: Endpoint, quiet: float, hz: float | None = None
) -> bool:
    """Wait for one more message; no longer than it takes to see that none will come."""
    before, start = len(watch), time.monotonic()
    if not before and not probe.in_this_process(source):
        quiet = max(quiet, FOUND_SEC)
    node = probe.node_object(source.node)
    timers = _timers(node)
    ticks = [_vain_ticks(probe, node, timer, hz) for timer in timers]
    no_executor = bool(timers) and node.executor is None
    found_before = False

    def in_vain() -> bool:
        return bool(ticks) and all(tick() for tick in ticks)

    def decided() -> bool:
        nonlocal found_before
        if len(watch) > before or _crowded(probe, watch.topic):
            return True
        if time.monotonic() - start < VAIN_SEC:
            return False
        # Seen twice: the first time, a message may be there that has not been taken yet.
        earlier, found_before = found_before, no_executor or in_vain()
        return found_before and earlier

    probe.wait(decided, quiet)
    if _crowded(probe, watch.topic):
        alone(probe, watch.topic)
    return len(watch) > before


def _crowded(probe: Probe, topic: str) -> bool:
    return topic in probe.scope.sole and len(probe.publishers(topic)) > 1


def _timers(node: Any) -> list[Any]:
    """Return the running timers of a node; none if it is not in this process."""
    return [] if node is None else [timer for timer in node.timers if not timer.is_canceled()]


def _vain_ticks(probe: Probe, node: Any, timer: Any, hz: float | None) -> Callable[[], bool]:
    """Return a function that tells whether a timer has ticked so often that a message is due."""
    before = probe.callbacks.count(node, timer) or 0
    due = VAIN_TICKS
    if hz is not None:
        periods = 1.0 / (hz * max(timer.timer_period_ns * 1e-9, 1e-3))
        due = max(1, round(periods))
    return lambda: (probe.callbacks.count(node, timer) or 0) - before >= due


def _explain_silence(probe: Probe, watch: Watch, source: Endpoint) -> NoReturn:
    """Raise Fail with the likeliest reason why messages do not come."""
    hanging()
    waited = time.monotonic() - (watch.last_arrival if len(watch) else watch.started)
    expected = f'messages on {source.topic}, again and again'
    seen = (
        f'a publisher of {source.node}, but {_count(len(watch))}, then none for {waited:.1f} s'
        if len(watch)
        else f'a publisher of {source.node}, but no message for {waited:.1f} s'
    )
    why, todo = reason(probe, source)
    raise Fail(expected, seen, why=why, todo=todo)


def reason(probe: Probe, source: Endpoint) -> tuple[str, str]:
    """Return why a publisher is silent, as its node shows it, and what to do."""
    node = probe.node_object(source.node)
    publish = 'Call self.publisher.publish(msg) in the callback.'
    if node is None:
        return 'publish() was called too early, once, or never.', 'Publish from a timer.'
    if node.executor is None:
        return (
            'The node exists, but nothing runs its callbacks, and no loop publishes.',
            'Hand the node over: lab.spin(node)',
        )
    timers = _timers(node)
    if not timers:
        own = [s for s in node.subscriptions if not s.topic_name.startswith('/parameter_events')]
        if own:
            return (
                f'The node publishes only when it hears something on {own[0].topic_name}, and '
                'nothing comes there, or its callback does not publish.',
                publish,
            )
        return (
            'The node has no timer: publish() ran once at most, when the node was made, and '
            'nobody was there to hear it.',
            'Make a timer in __init__ with self.create_timer(period, self.on_timer), and publish '
            'in on_timer.',
        )
    slowest = max(timer.timer_period_ns for timer in timers) * 1e-9
    if any(probe.callbacks.count(node, timer) for timer in timers):
        return (
            'The timer calls its callback, but publish() is not called there, or not any more.',
            publish,
        )
    return (
        f'The timer has not called its callback yet: its period is {slowest:.3g} s.',
        'The first argument of create_timer() is the period in seconds.',
    )


def _count(number: int) -> str:
    return {0: 'no message', 1: 'one message'}.get(number, f'{number} messages')


def describe_rate(watch: Watch) -> str:
    """Return the rate of messages in words, '' if there are too few: `'10.0 Hz'`."""
    intervals: list[Any] = watch.intervals
    return f'{1 / statistics.median(intervals):.1f} Hz' if intervals else ''
