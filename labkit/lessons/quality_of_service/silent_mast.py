"""Exercise: find the mast that hears nothing, and let a node stand in for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from labkit.exercises import (
    Exercise,
    Fail,
    NotAttempted,
    common_mistakes,
    expect,
    words_of,
)
from labkit.exercises.clauses import Asked, Evidence, GraphClause
from labkit.exercises.messages_heard import Watch
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION, Role
from labkit.lessons.quality_of_service.masts import (
    INT16,
    NODES,
    PERIOD_SEC,
    TOPICS,
    masts_are_open,
)

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['exercise']

WORDS = words_of(__file__)

LEVEL, *SAID = TOPICS
# On these a node of the learner's may take the place of a mast, and these it may hear.
STANDS_IN, HEARS = TOPICS[1:4], TOPICS[:3]
# How long the first number may take to go through two processes, s, and so many are looked at.
FIRST_SEC, SEVERAL = 5.0, 24

ELSEWHERE = WORDS.mistake('silent-mast/elsewhere')
NO_EAR = WORDS.mistake('silent-mast/no-ear')
NOT_SAID = WORDS.mistake('silent-mast/not-said')
OTHERS = WORDS.mistake('silent-mast/others')
MISSING = WORDS.mistake('silent-mast/missing')
TWICE = WORDS.mistake('silent-mast/twice')


class _Carries(GraphClause):
    """All numbers come through the chain."""

    text = WORDS.clause('carries')
    own_life = True

    @property
    def roles(self) -> dict[Role, str]:
        """A node may take the place of each mast."""
        publishes = {(PUBLISHER, topic): INT16 for topic in STANDS_IN}
        return publishes | {(SUBSCRIPTION, topic): INT16 for topic in HEARS}

    def find(self, evidence: Evidence) -> None:
        """Look for the masts, and for a node that stands in."""
        probe = evidence.probe
        if not masts_are_open():
            raise NotAttempted('The masts are closed. Run the cell with open_masts() first.')

        def places() -> list[str]:
            return [topic for topic in STANDS_IN if probe.publishers(topic)]

        if not probe.wait_to_appear(places):
            if not probe.attempt():
                raise NotAttempted
            raise Fail(
                f'a node of yours that publishes on {" or ".join(STANDS_IN)}',
                f'{", ".join(sorted(probe.attempt()))}, which publishes on none of them',
                todo='Take the place of the mast that hears nothing: hear what it should hear, '
                'and publish on its topic.',
            )
        for topic in places():
            expect.spun(probe, evidence.publisher(topic))
            for end in probe.publishers(topic):
                if end.node in {other.node for other in probe.subscriptions(topic)}:
                    seen = f'{end.node} publishes on {topic}, and subscribes to it'
                    raise Fail(
                        f'a node that hears the topic before {topic}',
                        seen,
                        common_mistakes.HEARS_ITSELF,
                    )

    def judge(self, evidence: Evidence) -> str:
        """Listen at each place, until the town has shown some numbers."""
        from labkit.asking.service_calls import wait_until_spun

        probe, heard = evidence.probe, evidence.heard
        for topic in TOPICS:
            heard[topic] = probe.watch(topic, INT16)
        with probe.uncounted():
            # Then the masts know the watches: a process takes what is new in its order.
            wait_until_spun(probe.spun_node, NODES[0])
        probe.wait(lambda: all(map(len, heard.values())), FIRST_SEC)
        for before, topic in pairwise(TOPICS):
            if not len(heard[topic]):
                raise _silent(evidence, before, topic)
        # Some were on their way when the first ones of these were heard.
        due = {topic: len(_numbers(watch)) + SEVERAL for topic, watch in heard.items()}

        def silent() -> list[str]:
            return [topic for topic, watch in heard.items() if len(watch) < due[topic]]

        if not probe.wait(lambda: not silent(), SEVERAL * PERIOD_SEC + FIRST_SEC):
            topic, *_ = silent()
            # On a busy machine the gauge itself is late, or some numbers are still on their way.
            last, numbers = _numbers(heard[topic])[-1], _numbers(heard[LEVEL])
            behind = len(numbers) - numbers.index(last) - 1 if last in numbers else 0
            if topic != LEVEL and behind > SEVERAL:
                raise Fail(
                    f'each number of {LEVEL} on {topic}',
                    f'{last} was the last one, and {behind} more came on {LEVEL}',
                    MISSING,
                )
        numbers = _numbers(heard[LEVEL])
        for topic in SAID:
            came = _numbers(heard[topic])
            both = [number for number in numbers if number in came]
            wanted = numbers[numbers.index(both[0]) : numbers.index(both[-1]) + 1] if both else []
            seen = list(dict.fromkeys(came[came.index(both[0]) :])) if both else came
            seen = seen[: seen.index(both[-1]) + 1] if both else seen
            if seen != wanted:
                raise Fail(
                    f'on {topic} the numbers of {LEVEL}: {expect.show(wanted or numbers)}',
                    expect.show(seen),
                    MISSING if {*seen} < {*wanted} else OTHERS,
                )
        return f'On {SAID[-1]} come the numbers of {NODES[0]}: {expect.show(numbers[-3:])}.'


def _once(evidence: Evidence) -> None:
    """Count them."""
    for topic in SAID:
        number, count = Counter(_numbers(evidence.heard[topic])).most_common(1)[0]
        if count > 1:
            who = ' and '.join(sorted(end.node for end in _publishers(evidence, topic)))
            raise Fail(
                f'on {topic} each number once',
                f'{number} came {count} times; {who} publish there',
                TWICE.of(topic=topic),
            )


def _numbers(watch: Watch) -> list[int]:
    watch.pump()
    return watch.values('data')


def _publishers(evidence: Evidence, topic: str) -> Sequence[Endpoint]:
    from labkit.rosgraph.endpoints import publishers

    return list(publishers(evidence.probe.node, topic))


def _silent(evidence: Evidence, before: str, topic: str) -> Fail:
    """Return why nothing comes on a topic, though something comes on the one before it."""
    probe, place = evidence.probe, TOPICS.index(topic)
    expected = f'the numbers of {LEVEL} on {topic}'
    for source, sink, reason in _apart(evidence, before):
        mine = sink if sink.node in probe.attempt() else source
        return Fail(
            f'{sink.node} hears {source.node} on {before}',
            f'the two do not match: {reason[:1].lower()}{reason[1:]}',
            common_mistakes.OFFER_AND_REQUEST.of(
                todo=f'Look at both profiles with %ros2 topic info --verbose {before}, and change '
                f'that of {mine.node}.'
            ),
        )
    values = {'topic': topic, 'hears': before, 'before': NODES[place - 1], 'node': NODES[place]}
    mistake = NOT_SAID
    if not probe.publishers(topic):
        mistake = ELSEWHERE
    elif not probe.subscriptions(before):
        mistake = NO_EAR
    return Fail(expected, f'nothing on {topic}', mistake.of(**values))


def _apart(evidence: Evidence, topic: str) -> Iterator[tuple[Endpoint, Endpoint, str]]:
    """Give the pairs that do not match, of which one end is the learner's."""
    from labkit.rosgraph.endpoints import subscriptions
    from labkit.rosgraph.matching import why_apart

    probe = evidence.probe
    mine = probe.attempt()
    for sink in subscriptions(probe.node, topic):
        found = [(source, why_apart(source, sink)) for source in _publishers(evidence, topic)]
        if sink.node not in mine and any(why and source.node not in mine for source, why in found):
            continue  # that is the silent mast
        for source, reason in found:
            if reason and mine & {source.node, sink.node}:
                yield source, sink, reason


exercise = Exercise(
    words=WORDS,
    clauses=(_Carries(), Asked(WORDS.clause('once'), _once)),
    shared=STANDS_IN,
)
