"""Exercise: design nodes for a task, and the topics between them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Fail, Mistake, Probe, expect, words_of
from labkit.exercises.clauses import (
    WITHIN,
    Answers,
    Asked,
    Evidence,
    GraphClause,
    Stream,
    Test,
)
from labkit.exercises.clauses.answering import WITHIN_SEC
from labkit.exercises.draws import draw_texts
from labkit.exercises.messages_heard import Lived
from labkit.lessons.my_name_is.stages import (
    COMPLETES,
    INNER,
    OPENING,
    STRING,
)

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['exercise']

WORDS = words_of(__file__)

OUTER, ENDING = '/welcome', '. Welcome!'
# An odd number of texts shows whether the host waits for another one.
FEW = 3

ALL_IN_ONE = WORDS.mistake('welcome/all-in-one')
SEVERAL_HOSTS = WORDS.mistake('welcome/several-hosts')
APART = WORDS.mistake('welcome/apart')
REPLACED = WORDS.mistake('welcome/replaced')
DEAF = WORDS.mistake('welcome/deaf')
NO_HOST = WORDS.mistake('welcome/no-host')
TOO_MANY = WORDS.mistake('welcome/too-many')
ELSEWHERE = WORDS.mistake('welcome/elsewhere')
PASSED_ON = WORDS.mistake('welcome/passed-on', str)
HEARS_THE_OTHER = WORDS.mistake('welcome/hears-the-other')
WAITS = WORDS.mistake('welcome/waits')
SHARED = WORDS.mistake('welcome/shared')


class _ThreeNodes(GraphClause):
    """Two nodes hear the beginning, and a third one hears those two."""

    text = WORDS.clause('three-nodes')

    def find(self, evidence: Evidence) -> None:
        """Look for the host by its topic, and for the guests by what it hears."""
        probe = evidence.probe
        _refuse_no_host(probe)
        host = evidence.publisher(OUTER).node
        ends = [end.node for end in probe.publishers(OUTER)]
        if len(ends) > 1:
            seen = f'{len(ends)} of them: {", ".join(sorted(ends))}'
            raise Fail(f'one publisher on {OUTER}', seen, SEVERAL_HOSTS)
        _is_here(probe, evidence.publisher(OUTER))
        hears = {end.topic: end for end in probe.all_subscriptions() if end.node == host}
        listeners = {end.node for end in probe.subscriptions(INNER)}
        said = [
            end
            for end in probe.all_publishers()
            if end.topic in hears and end.node in listeners - {host} and end.msg_type == STRING
        ]
        guests = sorted({end.node for end in said})
        if len(guests) != 2:
            raise Fail(
                f'two nodes that subscribe to {INNER} and publish on a topic to which {host} '
                'subscribes',
                f'{", ".join(guests) or "none"}; {host} subscribes to '
                f'{", ".join(sorted(hears)) or "nothing"}',
                _not_two(len(guests), all_in_one=host in listeners)
                if len(guests) != 1 or not _others_speak(probe, guests[0], host, hears)
                else DEAF.of(guest=guests[0]),
            )
        for end in said:
            evidence.ends['publisher', end.topic, end.node] = end
            evidence.ends['subscription', end.topic, host] = hears[end.topic]
            evidence.subscription(INNER, end.node)
        for (kind, _, _), end in evidence.ends.items():
            _is_here(probe, end)
            if kind == 'subscription':
                expect.spun(probe, end)

    def judge(self, evidence: Evidence) -> str:
        """Say who was found."""
        host, guests = _party(evidence)
        return f'{host} hears {" and ".join(guests)}.'


class _Flows(GraphClause):
    """While all three work, all texts arrive."""

    text = WORDS.of(within=WITHIN).clause('flows')
    own_life = True
    # The topics of the guests have names of the learner's.
    listens = (STRING,)

    def judge(self, evidence: Evidence) -> str:
        """Judge what each of them says."""
        host, guests = _party(evidence)
        tests = [
            Test(INNER, STRING, {'data': text}, (OUTER,), due=2)
            for text in [OPENING, *draw_texts()]
        ]
        also = dict.fromkeys(guests.values(), STRING)
        seen = evidence.alone(self, tests, host, *guests, also=also)
        life = seen.life
        for guest, topic in guests.items():
            # Who keeps the method `publish` itself, as `partial` does, is not known.
            mine = [sample for sample in life.on(topic, before=True) if sample.node == guest]
            if all(sample.node for sample in life.on(topic)):
                own = replace(life, samples={**life.samples, topic: mine})
                _completes(topic, guest).judge(replace(seen, life=own))
        first, *others = also
        both = sorted(
            (sample for topic in also for sample in life.on(topic, before=True)),
            key=lambda sample: sample.at,
        )
        heard = replace(life, samples={**life.samples, first: both})
        # What the host has said before, is known of one topic at a time.
        _welcomes(first, host, lasting=not others).judge(replace(seen, life=heard))
        evidence.streams[OUTER, ''] = Stream(OUTER, life.on(OUTER), True, life.seconds)
        return ''


class _OneIsEnough(GraphClause):
    """Nobody needs both guests."""

    text = WORDS.clause('one-is-enough')

    def find(self, evidence: Evidence) -> None:
        """Look at what the guests hear."""
        _, guests = _party(evidence)
        for topic in guests.values():
            for end in evidence.probe.subscriptions(topic):
                if end.node in guests:
                    raise Fail(
                        f'{end.node} hears {INNER} alone',
                        f'it subscribes to {topic}, where a guest speaks',
                        HEARS_THE_OTHER,
                    )

    def judge(self, evidence: Evidence) -> str:
        """Say texts to the host, one at a time."""
        host, guests = _party(evidence)
        for topic in sorted({*guests.values()}):
            tests = [Test(topic, STRING, {'data': text}, (OUTER,)) for text in draw_texts()[:FEW]]
            seen = evidence.alone(self, tests, host, also={topic: STRING})
            try:
                _welcomes(topic, host).judge(seen)
            except Fail as fail:
                raise Fail(fail.expected, fail.seen, WAITS) from None
        return ''


def _refuse_no_host(probe: Probe) -> None:
    """Raise Fail if guests are there, and no host: it is not that a topic has another name."""
    if probe.wait_to_appear(lambda: probe.publishers(OUTER)):
        return
    listeners = {end.node for end in probe.subscriptions(INNER)}
    said = [e for e in probe.all_publishers() if e.node in listeners and e.msg_type == STRING]
    known = probe.scope.known
    new = sorted({end.node for end in said if end.topic not in known})
    heard = {end.topic for end in probe.all_subscriptions()}
    if len(new) == 2 and not any(end.topic in heard for end in said if end.node in new):
        raise Fail(f'a publisher on {OUTER}', f'{" and ".join(new)}, and no host', NO_HOST)


def _others_speak(probe: Probe, guest: str, host: str, hears: Collection[str]) -> bool:
    """Tell whether another node than the one guest says something to the host."""
    ends = [end for end in probe.all_publishers() if end.topic in hears and end.msg_type == STRING]
    return any(end.node not in (guest, host) for end in ends)


def _is_here(probe: Probe, end: Endpoint) -> None:
    if probe.node_object(end.node) is None:
        raise Fail('nodes of this notebook', f'{end.node} {probe.place(end)}', ELSEWHERE)


def _names_differ(evidence: Evidence) -> str:
    """Compare what was made of the first text."""
    came = evidence.streams[OUTER, ''].samples
    samples = [sample for sample in came if isinstance(sample, Lived)]
    # Later texts may begin with the same words.
    first = [each for each in samples if each.at - samples[0].at < WITHIN_SEC]
    values = [each.message.data for each in first]
    said = sorted({value for value in values if value.startswith(OPENING)})
    if len(said) < 2:
        name = said[0].removeprefix(OPENING).removesuffix(ENDING)
        raise Fail(
            f'texts on {OUTER} with different names',
            f'data = {expect.show(said)}, twice',
            SHARED.of(name=name),
        )
    return f'Each text comes twice: {" and ".join(map(repr, said))}.'


def _not_two(count: int, *, all_in_one: bool) -> Mistake:
    """Return what is wrong where so many guests are there."""
    if count > 2:
        return TOO_MANY.of(count=count)
    return REPLACED if count else ALL_IN_ONE if all_in_one else APART


def _party(evidence: Evidence) -> tuple[str, dict[str, str]]:
    """Return the host, and the guests with the topics on which they speak to the host."""
    guests = {
        by: topic for kind, topic, by in evidence.ends if kind == 'publisher' and topic != OUTER
    }
    return evidence.publisher(OUTER).node, guests


def _completes(topic: str, guest: str) -> Answers:
    return Answers(INNER, topic, STRING, '', by=guest, **COMPLETES)


def _welcomes(topic: str, host: str, *, lasting: bool = False) -> Answers:
    return Answers(
        topic,
        OUTER,
        STRING,
        '',
        lambda text: f'{text}{ENDING}',
        by=host,
        mistakes=[PASSED_ON],
        lasting=lasting,
    )


exercise = Exercise(
    words=WORDS,
    subscribes={INNER: STRING},
    publishes={OUTER: STRING},
    shared=[OUTER],
    clauses=(
        _ThreeNodes(),
        _Flows(),
        _OneIsEnough(),
        Asked(WORDS.clause('names-differ'), _names_differ),
    ),
)
