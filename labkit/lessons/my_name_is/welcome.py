"""Exercise: design nodes for a task, and the topics between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from labkit.exercises import Exercise, Fail, Mistake, Solution, expect
from labkit.exercises.clauses import (
    WITHIN,
    Answers,
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

__all__ = ['welcome']

OUTER, ENDING = '/welcome', '. Welcome!'
# So many texts show whether one guest needs the other.
FEW = 4

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
    'The check lets one guest stand still, which it can do in this notebook alone.',
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
NEEDS_THE_OTHER = Mistake(
    'welcome/needs-the-other',
    'While {other} stands still, nothing of {guest} arrives: it waits for the other one.',
    f'Let each guest hear {INNER}, and the host publish what comes, when it comes.',
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
    recognises = (ALL_IN_ONE, SEVERAL_HOSTS, APART, REPLACED, PASSED_ON)

    def find(self, evidence: Evidence) -> None:
        """Look for the host by its topic, and for the guests by what it hears."""
        probe = evidence.probe
        host = evidence.publisher(OUTER).node
        ends = [end.node for end in probe.publishers(OUTER)]
        if len(ends) > 1:
            seen = f'{len(ends)} of them: {", ".join(sorted(ends))}'
            raise Fail(f'one publisher on {OUTER}', seen, SEVERAL_HOSTS)
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
            if probe.node_object(end.node) is None:
                seen = f'{end.node} {probe.place(end)}'
                raise Fail('three nodes of this notebook', seen, ELSEWHERE)
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
        _judge(_lived(self, evidence, guests, draw_texts()), host, guests)
        return ''


class _OneIsEnough(GraphClause):
    """While one guest stands still, the texts of the other one arrive."""

    text = 'while one of the two stands still, the texts of the other one come all the same'
    recognises = (NEEDS_THE_OTHER,)

    def judge(self, evidence: Evidence) -> str:
        """Let each guest be alone with the host."""
        host, guests = _party(evidence)
        for guest, topic in guests.items():
            seen = _lived(self, evidence, {guest: topic}, draw_texts()[:FEW])
            if not seen.life.on(OUTER):
                (other,) = guests.keys() - {guest}
                raise Fail(
                    f'texts of {guest} on {OUTER} while {other} stands still',
                    f'nothing on {OUTER}',
                    NEEDS_THE_OTHER.of(guest=guest, other=other),
                )
            _judge(seen, host, {guest: topic})
            evidence.streams[OUTER, guest] = Stream(
                OUTER, seen.life.on(OUTER), exact=True, seconds=seen.life.seconds
            )
        return ''


class _NamesDiffer(GraphClause):
    """Each guest has a first name of its own."""

    text = 'the two names are different, and each node keeps its own'
    recognises = (SHARED,)

    def judge(self, evidence: Evidence) -> str:
        """Compare what the two have said first, to the same text."""
        said = [evidence.streams[OUTER, guest].values('data')[0] for guest in _party(evidence)[1]]
        if said[0] == said[1]:
            name = said[0].removeprefix(OPENING).removesuffix(ENDING)
            raise Fail(
                f'texts on {OUTER} with different names',
                f'data = {expect.show(said)}',
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


def _lived(
    clause: GraphClause, evidence: Evidence, guests: Mapping[str, str], texts: Sequence[str]
) -> Evidence:
    """Let time pass for the host and some guests, and say the beginning of sentences to them."""
    tests = [
        Test(INNER, STRING, {'data': text}, (OUTER,), due=len(guests))
        for text in [OPENING, *texts]
    ]
    nodes = [evidence.publisher(OUTER).node, *guests]
    return evidence.alone(clause, tests, *nodes, also=dict.fromkeys(guests.values(), STRING))


def _judge(seen: Evidence, host: str, guests: Mapping[str, str]) -> None:
    """Judge what each guest has said, and what the host has made of it."""
    life = seen.life
    said = {topic: life.on(topic, before=True) for topic in guests.values()}
    for guest, topic in guests.items():
        mine = [sample for sample in said[topic] if sample.node in (guest, '')]
        # Who keeps the method `publish` itself, as `partial` does, is not known.
        if len(guests) == 1 or all(sample.node for sample in said[topic]):
            own = replace(life, samples={**life.samples, topic: mine})
            Answers(INNER, topic, STRING, '', by=guest, **COMPLETES).judge(replace(seen, life=own))
    first, *_ = said
    both = sorted((sample for each in said.values() for sample in each), key=lambda s: s.at)
    heard = replace(life, samples={**life.samples, first: both})
    Answers(
        first, OUTER, STRING, '', lambda text: f'{text}{ENDING}', by=host, mistakes=[PASSED_ON]
    ).judge(replace(seen, life=heard))


welcome = Exercise(
    name='welcome',
    task=f'Two guests complete each text of {INNER} with a first name, and a host welcomes both '
    f'on {OUTER}.',
    subscribes={INNER: STRING},
    publishes={OUTER: STRING},
    shared=[OUTER],
    clauses=(_ThreeNodes(), _Flows(), _OneIsEnough(), _NamesDiffer()),
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
