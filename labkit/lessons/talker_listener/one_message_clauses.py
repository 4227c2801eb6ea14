"""What the check of the exercise say_once asks for."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises import (
    Fail,
    Watch,
    expect,
)
from labkit.exercises.clauses import Clause, Evidence
from labkit.exercises.expect.timing import FOUND_SEC
from labkit.exercises.life import LIFE_SEC, live

__all__ = ['STRING', 'TEXT', 'TOPIC', 'SaysIt', 'SilentAfter', 'SilentBefore']

STRING = 'std_msgs/msg/String'
TOPIC = '/door'
# So long time passes while nobody listens, s: another one each time, but never so long that a node
# that looks once a minute is just about to.
ALONE_SEC = (20.0, 29.0)
# How long a thread of this process may take to see that somebody listens, s of real time.
LATE_SEC = 1.5
# What comes soon after a message comes from a node that keeps a time of its own, s of real time.
SOON_SEC = 1.2
TEXT = 'The door is open'
_AGAIN = 'Run the cell of your node again before each check: it speaks once only.'


@dataclass(frozen=True)
class SaysIt(Clause):
    """When somebody listens, the node says the text."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'within {LIFE_SEC:.0f} seconds of the first subscription to `{TOPIC}`, publish '
            f'`{TEXT}` there (`{STRING}`)'
        )

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher."""
        evidence.publisher(TOPIC)

    def judge(self, evidence: Evidence) -> str:
        """Judge the first message."""
        watch, source = _heard(evidence), evidence.publisher(TOPIC)
        here = evidence.probe.in_this_process(source)
        if not evidence.probe.wait(lambda: len(watch), LATE_SEC if here else FOUND_SEC):
            expect.hanging()
            raise Fail(
                f'one message on {TOPIC}, as soon as somebody subscribes',
                f'{source.node} has a publisher, but no message came',
                why='If it was published before somebody listened, it is lost: nobody keeps it '
                'for those who come later. Or publish() was not reached at all.',
                todo=f'Publish only when get_subscription_count() is not 0. {_AGAIN}',
            )
        first = watch.samples[0]
        if first.number <= 1 and first.message.data != TEXT:
            expect.equal(watch, 'data', TEXT, todo=_AGAIN)
        return f'{source.node} waited, and said {TEXT!r} once.'


@dataclass(frozen=True)
class SilentBefore(Clause):
    """As long as nobody listens, the node says nothing."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return 'publish nothing before that'

    def find(self, evidence: Evidence) -> None:
        """Let time pass while nobody listens, and then listen."""
        probe = evidence.probe
        _refuse_listeners(evidence)
        # Nothing is written down here, so its times need not be known.
        evidence.life = live(
            probe,
            {},
            random.uniform(*ALONE_SEC),
            nodes=[evidence.publisher(TOPIC).node],
            tick=0.5,
            rest=0.5,
        )
        evidence.refuse_trouble(())
        evidence.heard[TOPIC] = probe.watch(TOPIC, STRING)

    def judge(self, evidence: Evidence) -> str:
        """Judge as which one the first message came."""
        number = _heard(evidence).samples[0].number
        if number > 1:
            raise Fail(
                f'one message on {TOPIC}, as soon as somebody subscribes',
                f'the first message that came was number {number} of its publisher',
                why='The earlier ones were published while nobody listened.',
                todo=f'Look at get_subscription_count() before you publish. {_AGAIN}',
            )
        return ''


@dataclass(frozen=True)
class SilentAfter(Clause):
    """Once it is said, the node says nothing more."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return 'publish nothing after that'

    def judge(self, evidence: Evidence) -> str:
        """Judge what else came."""
        watch = _heard(evidence)
        if evidence.probe.wait(lambda: len(watch) > 1, SOON_SEC):
            raise Fail(
                f'one message on {TOPIC}, and no other',
                f'{len(watch)} messages: {expect.show(watch.values("data"))}',
                why='Nothing stops the node after its first message.',
                todo='self.timer.cancel() ends the timer.',
            )
        return ''


def _heard(evidence: Evidence) -> Watch:
    """Return what has come on the topic since the check listens."""
    watch = evidence.heard[TOPIC]
    watch.pump()
    return watch


def _refuse_listeners(evidence: Evidence) -> None:
    """Raise Fail if somebody else listens already: to him it has been said."""
    from labkit.rosgraph.endpoints import subscriptions
    from labkit.rosgraph.names import is_hidden

    found = subscriptions(evidence.probe.node, TOPIC)
    if found:
        names = sorted({'a view' if is_hidden(end.node) else end.node for end in found})
        _refuse_names(names)


def _refuse_names(names: Sequence[str]) -> NoReturn:
    raise Fail(
        f'nobody subscribes to {TOPIC} before the check does',
        f'{", ".join(names)} subscribes there',
        why='The node speaks once. If it has spoken to somebody else, the check hears nothing.',
        todo='End that one, and run the cell of your node again.',
    )
