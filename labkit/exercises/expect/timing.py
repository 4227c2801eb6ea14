"""Matchers for what a publisher says in real time, and why it is silent.

A check lets time pass by itself, so that is for what does not follow: a process that sleeps in a
loop, and what a node says as it ends.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from itertools import accumulate, combinations, pairwise
from typing import TYPE_CHECKING

from labkit.exercises import common_mistakes
from labkit.exercises.expect.spinning import hanging, how_to_spin, not_spun
from labkit.exercises.messages_heard import Sample, Watch
from labkit.exercises.mistakes import Mistake
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail, NotAttempted

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['at_rate', 'ends_with_node', 'lasts', 'messages', 'silence']

# How long a topic may be silent before that is a finding, s. A process that has to find the
# subscription first, and whose first search is lost, asks again after 3 s.
FOUND_SEC = 4.0
# So many intervals tell a rate in real time, or those of so long a time, s, to this part of it.
INTERVALS = 8
RATE_SEC = 3.0
TOLERANCE = 0.1
# Who is silent for so many periods has ended.
PAUSE_PERIODS = 4.0
# Who goes on has sent so many messages, or all that are due in so long a time, s.
MANY, MANY_SEC = 32, 20.0


def messages(probe: Probe, source: Endpoint, *, count: int = 3) -> Watch:
    """Expect messages from a publisher.

    Args:
        probe: The probe of the check.
        source: What `publisher` returned.
        count: How many messages to wait for.

    Returns:
        The messages, in their order.

    Raises:
        Fail: They do not come.
        NotAttempted: The check has no time left to tell.
    """
    watch = probe.watch(source.topic, source.msg_type)
    probe.wait(
        lambda: len(watch) >= count or time.monotonic() > watch.last_arrival + FOUND_SEC,
    )
    if len(watch) >= count:
        return watch
    said = {0: 'no message', 1: 'one message'}.get(len(watch), f'{len(watch)} messages')
    waited = time.monotonic() - watch.last_arrival
    if waited < FOUND_SEC:
        raise NotAttempted(f'Too early to tell: {said} on {source.topic}. Run this cell again.')
    hanging()
    raise Fail(
        f'messages on {source.topic}, again and again',
        f'a publisher of {source.node}, but {said} for {waited:.1f} s',
        silence(probe, source, len(watch), waited),
    )


def at_rate(
    probe: Probe,
    source: Endpoint,
    hz: float,
    *,
    count: int = 1,
    at_least: bool = False,
    ends: bool = False,
) -> tuple[list[list[Sample]], Watch]:
    """Watch a topic in real time, until publishers of a rate are known or a while is over.

    Args:
        probe: The probe of the check.
        source: A publisher of the topic.
        hz: Messages a second.
        count: So many publishers are waited for.
        at_least: Whether more messages a second are right, too.
        ends: Whether they may end. Otherwise they are watched until they have sent so many that
            they will not, see `lasts`, or have ended, or the check has no time left.

    Returns:
        The messages of each publisher with this rate, and all that came.
    """
    watch = probe.watch(source.topic, source.msg_type)
    enough = max(2, min(INTERVALS, round(RATE_SEC * hz)))

    def fitting() -> list[list[Sample]]:
        return [
            stream
            for stream in watch.streams()
            if len(stream) > enough and _fits(_intervals(stream), 1.0 / hz, at_least)
        ]

    def is_over() -> bool:
        silent = time.monotonic() - watch.last_arrival > PAUSE_PERIODS / hz
        return silent or sum(lasts(stream, hz) for stream in fitting()) >= count

    if probe.wait(lambda: len(fitting()) >= count, FOUND_SEC + (enough + 1) / hz) and not ends:
        probe.wait(is_over)
    return fitting(), watch


def lasts(stream: Sequence[Sample], hz: float) -> bool:
    """Tell whether a publisher has sent so many messages that it is one that goes on.

    Each message has the number that its publisher gave it, so those before the check count.
    """
    sent = stream[-1].number or len(stream)
    return sent >= min(MANY, round(MANY_SEC * hz))


def ends_with_node(probe: Probe, source: Endpoint, end: Callable[[], None] | None = None) -> Watch:
    """Stop the publisher's node, and expect that its publisher goes.

    The node is gone afterwards, so an exercise that uses this has `once=True`. The last message
    of a node in another process may be lost when its publisher goes at once: such a node stays
    for a moment.

    Args:
        probe: The probe of the check.
        source: The publisher.
        end: Ends its node. By default it is removed, or its process gets Ctrl-C if this notebook
            has started it.

    Returns:
        The messages up to the end; the last one is what the node said as it ended.

    Raises:
        Fail: The topic still has that publisher, or messages.
    """
    watch = messages(probe, source, count=1)
    if end is None:
        probe.stop_node(source)
    else:
        end()

    def gone() -> bool:
        return source.gid not in {endpoint.gid for endpoint in probe.publishers(source.topic)}

    if not probe.wait(gone):
        raise Fail(
            f'no publisher on {source.topic} once {source.node} has ended',
            f'{source.node} still publishes there',
            common_mistakes.KEPT_ALIVE,
        )
    return watch


def silence(probe: Probe, source: Endpoint, count: int, seconds: float) -> Mistake:
    """Return why a publisher is silent, as its node shows it.

    Args:
        probe: The probe of the check.
        source: The publisher.
        count: How many messages have come.
        seconds: How long that took, s.
    """
    node = probe.node_object(source.node)
    if node is None:
        return common_mistakes.NEVER_PUBLISHED
    if node.executor is None:
        usual = common_mistakes.NEVER_RUN.of(spin=how_to_spin(probe, source.node))
        return not_spun(probe, source.node, usual)
    if node.get_clock().ros_time_is_active and not probe.node.count_publishers('/clock'):
        return common_mistakes.NO_CLOCK
    timers = [timer for timer in node.timers if not timer.is_canceled()]
    if timers:
        period = min(timer.timer_period_ns for timer in timers) * 1e-9
        # As often as it was due at least, it has published.
        is_rare = seconds < (count + 1) * period
        never = all(probe.callbacks.count(node, timer) == 0 for timer in timers)
        return (
            common_mistakes.NOT_CALLED.of(period=period)
            if is_rare or never
            else common_mistakes.NOT_PUBLISHED
        )
    heard = [s for s in node.subscriptions if not s.topic_name.startswith('/parameter_events')]
    return (
        common_mistakes.ONLY_ANSWERS.of(topic=heard[0].topic_name)
        if heard
        else common_mistakes.NO_TIMER
    )


def _intervals(stream: Sequence[Sample]) -> list[float]:
    return [later.stamp - earlier.stamp for earlier, later in pairwise(stream)]


def _fits(gaps: Sequence[float], period: float, at_least: bool) -> bool:
    """Tell whether intervals are those of a timer or of a sleep with this period.

    A timer that was late once is followed by a shorter interval: over all pairs of messages that
    does little. A sleep lasts longer than was asked for, and never shorter: then the quickest
    half, one interval after the other, counts as well.
    """
    times = [0.0, *accumulate(gaps)]
    pairs = combinations(enumerate(times), 2)
    seen = [statistics.median((later - sooner) / (j - i) for (i, sooner), (j, later) in pairs)]
    if min(gaps) >= (1.0 - TOLERANCE) * period:
        half = (len(gaps) + 1) // 2
        starts = range(len(times) - half)
        seen.append(min((times[i + half] - times[i]) / half for i in starts))
    if at_least:
        return min(seen) <= (1.0 + TOLERANCE) * period
    return any(abs(each / period - 1.0) <= TOLERANCE for each in seen)
