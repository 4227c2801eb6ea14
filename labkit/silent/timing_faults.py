"""Time: clocks that stand still or disagree, periods in the wrong unit, callbacks too long."""

from __future__ import annotations

from collections.abc import Iterator

from labkit.settings import LONG_SEC, SHORT_SEC
from labkit.silent.kinds import Fault, kind
from labkit.silent.scene import OwnNode, Scene

__all__ = ['FUTURE', 'OFF_SEC', 'look_at_callbacks', 'look_at_clocks', 'look_at_timers']

NO_CLOCK = kind(
    'time.no-clock',
    'Timers never fire: use_sim_time is true, and nobody publishes /clock',
    'Start what publishes /clock (the simulator, ros2 bag play --clock), or set use_sim_time to '
    'false.',
    '/clock has a publisher',
)
ONE_CLOCK = kind(
    'time.two-clocks',
    'Stamps do not fit: one node uses simulated time, the other one does not',
    'Set use_sim_time for both nodes, or for neither.',
    'the other node publishes /clock, or no message between the two has a stamp',
)
BACK = kind(
    'time.jumped-back',
    'The clock has jumped back: what waits for a time waits longer',
    'A bag that starts again, or a simulator that is reset, does that: start the nodes anew, or '
    'handle it with create_jump_callback.',
    'the clock goes on',
)
FUTURE = kind(
    'time.future',
    'The stamp of a message is in the future',
    'Take the stamp from the clock of the node: self.get_clock().now().to_msg().',
    'the stamp is now or earlier, or the node publishes /clock itself',
)
OTHER_CLOCK = kind(
    'time.other-clock',
    'The stamp of a message is years ago: it is of another clock',
    'Take the stamp from the clock of the node, self.get_clock().now().to_msg(), and not from '
    'time.monotonic() or a counter.',
    'the node uses simulated time, which begins with 0, or publishes it on /clock',
)
PERIOD_ZERO = kind(
    'time.period-zero',
    'One core is busy: the period of a timer is 0, or about that',
    'Give the period in seconds: create_timer(0.1, ...) calls ten times a second.',
    'the timer is cancelled after its first call',
)
MILLISECONDS = kind(
    'time.milliseconds',
    'The timer does not fire: its period is in milliseconds instead of seconds',
    'Give the period in seconds: 0.5 for twice a second.',
    'the period is shorter',
    guess='the period is a round number of some minutes',
    aloud=False,
)
RATE = kind(
    'time.rate',
    'The timer is much too slow: create_timer takes a period, not a rate',
    'Give the period in seconds: 1 / 30 for thirty times a second. create_rate takes a rate.',
    'the period is no usual rate',
    guess='the period is a whole number that is usual as a rate',
    aloud=False,
)
LONG = kind(
    'time.long-callback',
    'Other callbacks come late or not at all: one callback takes too long',
    'Return sooner: no sleep, no endless loop. A timer that is called again and again does one '
    'step each time; work that takes long belongs in a thread.',
    'no other callback of this process is due meanwhile',
)
OVERRUN = kind(
    'time.overrun',
    'The timer fires less often than its period says: its callback takes longer',
    'Return sooner, or give the timer a period that is longer than its callback takes.',
    'one of its last three calls returned within the period, or the clock is simulated',
)
STUCK = kind(
    'time.stuck-callback',
    'Nothing happens any more: a callback does not return',
    'If it never returns, restart the kernel (menu Kernel): neither the stop button nor '
    'lab.remove(node) ends a callback. Let it return: no endless loop, no wait for another one.',
    'the callback returns',
)

# What is off by more than this is no matter of when it was looked at, s.
OFF_SEC = 1.0
_YEARS_SEC = 1e8
_USUAL_RATES = (10, 15, 20, 25, 30, 40, 50, 60, 100)


def look_at_clocks(scene: Scene) -> Iterator[Fault]:
    """Find nodes whose clock stands still, jumps, or is not that of their partners."""
    for node in scene.nodes:
        if node.sim_time and not scene.publishers.get('/clock'):
            yield Fault(
                NO_CLOCK,
                (node.name,),
                '/clock',
                f'{node.name} uses simulated time (use_sim_time) and waits for /clock, which '
                'nobody publishes: its clock stands still, and its timers never fire.',
            )
        if node.went_back:
            yield Fault(
                BACK,
                (node.name,),
                'clock',
                f'The clock of {node.name} has jumped back by {node.went_back:.3g} s.',
            )
        yield from _stamps(node)
        yield from _partners(scene, node)


def _stamps(node: OwnNode) -> Iterator[Fault]:
    if node.makes_clock:
        return
    for pub in node.publishers:
        if not pub.stamp or not node.now:
            continue
        ahead = (pub.stamp - node.now) * 1e-9
        if ahead > OFF_SEC:
            yield Fault(
                FUTURE,
                (node.name,),
                pub.topic,
                f'The stamp of the last message of {node.name} on {pub.topic} is '
                f'{ahead:.3g} s ahead of its clock.',
            )
        elif ahead < -_YEARS_SEC:
            yield Fault(
                OTHER_CLOCK,
                (node.name,),
                pub.topic,
                f'The stamp of the last message of {node.name} on {pub.topic} is '
                f'{pub.stamp * 1e-9:.6g} s, but its clock says {node.now * 1e-9:.0f} s.',
            )


def _partners(scene: Scene, node: OwnNode) -> Iterator[Fault]:
    """Find a node without simulated time that sends stamps to one with it, or the other way."""
    heard = {sub.topic for sub in node.subscriptions}
    for other in scene.nodes:
        if other.sim_time == node.sim_time or node.makes_clock or other.makes_clock:
            continue
        for pub in other.publishers:
            if pub.topic in heard and pub.stamp is not None:
                with_it, without = (node, other) if node.sim_time else (other, node)
                yield Fault(
                    ONE_CLOCK,
                    (without.name, with_it.name),
                    pub.topic,
                    f'{with_it.name} uses simulated time, {without.name} does not, and messages '
                    f'with stamps pass between them on {pub.topic}.',
                )


def look_at_timers(scene: Scene) -> Iterator[Fault]:
    """Find periods that can't be meant."""
    for node in scene.nodes:
        for timer in node.timers:
            if timer.is_canceled:
                continue
            period, name = timer.period, f'The timer of {node.name} that calls {timer.callback}'
            if period < 1e-4:
                yield Fault(
                    PERIOD_ZERO,
                    (node.name,),
                    timer.callback,
                    f'{name} has a period of {period:g} s: it fires all the time.',
                )
            elif period >= 200 and period % 50 == 0:
                text = f'{name} has a period of {period:g} s, {period / 60:.0f} minutes.'
                yield Fault(
                    MILLISECONDS,
                    (node.name,),
                    timer.callback,
                    text,
                    f'If {period:g} ms are meant, write {period / 1000:g}.',
                )
            elif period in _USUAL_RATES:
                text = f'{name} fires once in {period:g} s.'
                yield Fault(
                    RATE,
                    (node.name,),
                    timer.callback,
                    text,
                    f'If {period:g} times a second are meant, write 1 / {period:g}.',
                )


def look_at_callbacks(scene: Scene) -> Iterator[Fault]:
    """Find callbacks that keep others from running."""
    stuck = scene.running if scene.running and scene.running.seconds >= 2 * LONG_SEC else None
    if stuck is not None:
        yield Fault(
            STUCK,
            (stuck.node,),
            stuck.callback,
            f'{stuck.callback} of {"an earlier " * stuck.ended}{stuck.node} has been running for '
            f'{stuck.seconds:.0f} s; until it returns, no other callback of this process runs.',
            # The cell of its node; if that was made again, the cell which did.
            cell=None if scene.own(stuck.node) else stuck.cell,
        )
    for node in scene.nodes:
        for call in node.long_calls:
            if stuck and (stuck.node, stuck.callback) == (node.name, call.callback):
                continue
            if call.seconds >= LONG_SEC and _keeps_others(scene, node, call.callback):
                yield Fault(
                    LONG,
                    (node.name,),
                    call.callback,
                    f'{call.callback} of {node.name} takes {call.seconds:.1f} s; meanwhile '
                    'nothing else runs.',
                )
            elif not node.sim_time and call.least > max(call.period, SHORT_SEC):
                yield Fault(
                    OVERRUN,
                    (node.name,),
                    call.callback,
                    f'{call.callback} of {node.name} takes {call.least:.2g} s, but its timer '
                    f'has a period of {call.period:g} s: it fires only when it has returned.',
                )


def _keeps_others(scene: Scene, node: OwnNode, callback: str) -> bool:
    """Return whether something else may be due while a callback runs."""
    return any(
        other.subscriptions
        or other.offers
        or any(
            timer.callback != callback or other is not node or timer.period < LONG_SEC
            for timer in other.timers
            if not timer.is_canceled
        )
        for other in scene.nodes
        if other.is_spun
    )
