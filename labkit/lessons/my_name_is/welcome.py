"""Exercise: design nodes for a task, and the topics between them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Fail, Mistake, Probe, Solution, expect
from labkit.exercises.clauses import (
    WITHIN,
    Answers,
    Asked,
    Evidence,
    GraphClause,
    Stream,
    Test,
)
from labkit.exercises.draws import draw_texts
from labkit.lessons.my_name_is.stages import (
    COMPLETES,
    INNER,
    OPENING,
    STRING,
)

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['exercise']

OUTER, ENDING = '/welcome', '. Welcome!'
# An odd number of texts shows whether the host waits for another one.
FEW = 3

_ONE_JOB = 'Give each job to a node: a guest appends a name, the host appends the rest.'
ALL_IN_ONE = Mistake(
    'welcome/all-in-one',
    f'This node does all of it, from {INNER} to {OUTER}.',
    _ONE_JOB,
    change=[
        ("'names', self", "'incomplete', self"),
        ("msg.data + '. Welcome!'", "msg.data + 'Ada. Welcome!'"),
    ],
)
SEVERAL_HOSTS = Mistake(
    'welcome/several-hosts',
    f'The words "{ENDING[2:]}" are the job of one node, and it does it for both names.',
    _ONE_JOB,
    change=[("'names', 10)", "'welcome', 10)")],
)
APART = Mistake(
    'welcome/apart',
    'What a guest publishes has to be what the host subscribes to.',
    'Look at the arrows of lab.graph(), and give both ends one name.',
    change=[("String, 'names', 10)", "String, 'guests', 10)")],
)
REPLACED = Mistake(
    'welcome/replaced',
    'Were two nodes of the same name started? lab.spin() ends the first of them when the second '
    'one comes.',
    "Give the name of the node as an argument, too: Guest('ada', 'Ada')",
    change=[("'bob', 'Bob'", "'ada', 'Bob'")],
)
TOO_MANY = Mistake(
    'welcome/too-many', 'Each text would come {count} times, and two are asked for.', 'End one.'
)
ELSEWHERE = Mistake(
    'welcome/elsewhere',
    'Who has said what, the check sees in this notebook alone.',
    'End the program, and start the node here with lab.spin().',
)
PASSED_ON = Mistake(
    'welcome/passed-on',
    'The host passes the text on as it came.',
    _ONE_JOB,
    model=str,
    change=[
        ("msg.data + '. Welcome!'", 'msg.data'),
        ('msg.data + self.first_name', "msg.data + self.first_name + '. Welcome!'"),
    ],
)
HEARS_THE_OTHER = Mistake(
    'welcome/hears-the-other',
    'When the other guest goes, this one may have nothing to say.',
    f'A guest needs {INNER}, and nothing else.',
)
WAITS = Mistake(
    'welcome/waits',
    'The host welcomes two guests, and not one alone: it waits for the other one.',
    'Publish in the callback, for each text that comes.',
)
SHARED = Mistake(
    'welcome/shared',
    'Both say {name!r}: they share the name. A variable of the notebook or of the class is the '
    'same for all objects.',
    'Keep the name in the object: self.first_name = first_name in __init__',
    change=[('self.first_name = first_name', 'Guest.first_name = first_name')],
)


class _ThreeNodes(GraphClause):
    """Two nodes hear the beginning, and a third one hears those two."""

    text = (
        'two nodes of this notebook append a first name each, and another one of it appends '
        f'`{ENDING}`'
    )

    def find(self, evidence: Evidence) -> None:
        """Look for the host by its topic, and for the guests by what it hears."""
        probe = evidence.probe
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
                _not_two(len(guests), all_in_one=host in listeners),
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

    text = (
        f'each text on `{INNER}` comes on `{OUTER}` once with each name (all `{STRING}`); each '
        f'node answers {WITHIN}'
    )
    own_life = True

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
        first, *_ = also
        both = sorted(
            (sample for topic in also for sample in life.on(topic, before=True)),
            key=lambda sample: sample.at,
        )
        heard = replace(life, samples={**life.samples, first: both})
        _welcomes(first, host).judge(replace(seen, life=heard))
        evidence.streams[OUTER, ''] = Stream(OUTER, life.on(OUTER), True, life.seconds)
        return ''


class _OneIsEnough(GraphClause):
    """Nobody needs both guests."""

    text = (
        'no guest hears the other one, and the host answers each text by itself: so each guest '
        'can go'
    )

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


def _is_here(probe: Probe, end: Endpoint) -> None:
    if probe.node_object(end.node) is None:
        raise Fail('nodes of this notebook', f'{end.node} {probe.place(end)}', ELSEWHERE)


def _names_differ(evidence: Evidence) -> str:
    """Compare what was made of the first text."""
    values = evidence.streams[OUTER, ''].values('data')
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


def _welcomes(topic: str, host: str) -> Answers:
    return Answers(
        topic, OUTER, STRING, '', lambda text: f'{text}{ENDING}', by=host, mistakes=[PASSED_ON]
    )


exercise = Exercise(
    name='welcome',
    task=f'Two guests complete each text of {INNER} with a first name, and a host welcomes both '
    f'on {OUTER}.',
    subscribes={INNER: STRING},
    publishes={OUTER: STRING},
    shared=[OUTER],
    clauses=(
        _ThreeNodes(),
        _Flows(),
        _OneIsEnough(),
        Asked('the two names are different, and each node keeps its own', _names_differ),
    ),
    hints=[
        'Draw three boxes, one for each job. Who has to hear whom? Each arrow between two of them '
        'is a topic.',
        f'Both guests hear {INNER}. They may publish on one topic, such as /names, and the host '
        'hears that.',
        'Two classes are enough: Host, and Guest with two arguments of __init__, the name of the '
        'node and the first name.',
    ],
    answer=Solution(
        __file__,
        'welcome.py',
        'Each job is a node, and each arrow of the plan a topic. The host knows a topic and not '
        'who speaks there: so a guest can go, and a third one can come, without a change to it.',
    ),
)
