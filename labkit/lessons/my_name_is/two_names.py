"""Exercise: two nodes of one class, each with its own name to say."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from labkit.exercises import Exercise, Fail, Mistake, Solution, expect
from labkit.exercises.clauses import WITHIN, Answers, Evidence, GraphClause, Test
from labkit.exercises.draws import draw_texts
from labkit.exercises.life import Life
from labkit.exercises.watch import Lived, streams_of
from labkit.lessons.my_name_is.stages import (
    CHANGED,
    INNER,
    NOTHING_ADDED,
    OPENING,
    STRING,
    name_trouble,
)

__all__ = ['two_names']

OUTER = '/names'

_NAME_EACH = "Give the name of the node as an argument, too: Introducer('ada', 'Ada')"
REPLACED = Mistake(
    'two-names/replaced',
    'Were two nodes of the same name started? lab.spin() ends the first of them when the second '
    'one comes.',
    _NAME_EACH,
    change=[("'bob', 'Bob'", "'ada', 'Bob'")],
)
SAME_NODE_NAME = Mistake(
    'two-names/same-node-name',
    'Two nodes have the same name. ROS allows it, and nobody can tell them apart.',
    _NAME_EACH,
)
TWO_PUBLISHERS = Mistake(
    'two-names/two-publishers',
    'One node has two publishers. Two nodes are asked for, with one publisher each.',
    _NAME_EACH,
)
ONLY_SOME = Mistake(
    'two-names/only-some',
    'Only {answered} of {count} nodes answered: {nodes}.',
    'Do the same in each node, for each text.',
)
SHARED = Mistake(
    'two-names/shared',
    'Both say {name!r}: they share the name. A variable of the notebook or of the class is the '
    'same for all objects.',
    'Keep the name in the object: self.first_name = first_name in __init__',
    change=[('self.first_name = first_name', 'Introducer.first_name = first_name')],
)


class _TwoNodes(GraphClause):
    """There are at least two nodes of different names, and each has both ends."""

    text = (
        f'two nodes of different names, or more, subscribe to `{INNER}` and publish on `{OUTER}` '
        f'(both `{STRING}`)'
    )
    recognises = (REPLACED, SHARED)

    def find(self, evidence: Evidence) -> None:
        """Look for the nodes."""
        probe = evidence.probe
        expect.publisher(probe, OUTER)
        # Nodes of a process of their own come into the graph one after the other.
        probe.wait_to_appear(lambda: len({end.node for end in probe.publishers(OUTER)}) > 1)
        count = Counter(end.node for end in probe.publishers(OUTER))
        node, number = count.most_common(1)[0]
        if len(count) == 1 or number > 1:
            same = probe.node_names().count(node) > 1
            mistake = SAME_NODE_NAME if same else TWO_PUBLISHERS if number > 1 else REPLACED
            raise Fail(
                f'two nodes, of different names, that publish on {OUTER}',
                f'{number} publisher{"s" * (number > 1)} on {OUTER} of {node} alone',
                mistake,
            )
        for node in sorted(count):
            evidence.publisher(OUTER, node)
            evidence.subscription(INNER, node)


class _EachAnswers(GraphClause):
    """Each node answers each text once. What it appends, the first answers tell."""

    text = (
        f'for each text on `{INNER}`, each of them publishes it with a first name appended, once, '
        f'{WITHIN}'
    )

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return texts to be completed."""
        for (kind, _, _), end in evidence.ends.items():
            if kind == 'subscription':
                expect.spun(evidence.probe, end)
        texts = [OPENING, *draw_texts()]
        due = len(_nodes(evidence))
        return [Test(INNER, STRING, {'data': text}, (OUTER,), due=due) for text in texts]

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers of each node. Which name is whose, its first answer tells."""
        life, nodes, found = evidence.life, _nodes(evidence), _said(evidence)
        # One that has said something before the check does not answer each text, but does answer.
        speak = [said for said in found if said.samples or evidence.said_by(said.node, OUTER)]
        if 0 < len(speak) < len(nodes):
            raise Fail(
                f'{len(nodes)} texts on {OUTER} for each one on {INNER}, one of each node',
                f'data = {expect.show([OPENING + said.name for said in speak])}',
                ONLY_SOME.of(answered=len(speak), count=len(nodes), nodes=', '.join(nodes)),
            )
        for said in found:
            own = replace(life, samples={**life.samples, OUTER: said.samples})
            _appends(said.name or 'Ada', said.node).judge(replace(evidence, life=own))
        shown = ' and '.join(repr(OPENING + said.name) for said in found)
        return f'Each text was completed by {len(nodes)} nodes: {shown}.'


class _NamesDiffer(GraphClause):
    """Each node has a first name of its own."""

    text = 'the first names are different, and each node keeps its own'

    def judge(self, evidence: Evidence) -> str:
        """Compare the names."""
        names = [said.name for said in _said(evidence)]
        if len({*names}) < len(names):
            raise Fail(
                f'texts on {OUTER} with different names',
                f'data = {expect.show([OPENING + name for name in names])}',
                SHARED.of(name=names[0]),
            )
        return ''


@dataclass(frozen=True)
class _Said:
    """The messages of a node, and the name that it appends; empty if that is not known."""

    node: str
    samples: list[Lived]
    name: str


def _nodes(evidence: Evidence) -> list[str]:
    """Return the names of the nodes that answer."""
    return sorted(by for kind, _, by in evidence.ends if kind == 'publisher')


def _said(evidence: Evidence) -> list[_Said]:
    """Return what each node has said.

    Nobody knows which messages are whose in another process: there each name is taken for a node.
    """
    life, nodes = evidence.life, _nodes(evidence)
    said = life.on(OUTER, before=True)
    samples = {node: [sample for sample in said if sample.node == node] for node in nodes}
    others = [node for node in nodes if not samples[node]]
    rest = [sample for sample in said if sample.node not in nodes]
    streams, names = streams_of(rest), _names(life, rest)
    if len(streams) < len(others) or len(names) < len(others):
        # One speaks for several, or they share a name: what each publisher has said is known.
        samples.update(zip(others, streams, strict=False))
    else:
        texts = {sample.message.data for sample in life.on(INNER, before=True)}
        of = {text + name: name for text in texts for name in names}
        for node, name in zip(others, names, strict=False):
            # What is nobody's may be anybody's.
            samples[node] = [each for each in rest if of.get(each.message.data, name) == name]
    return [_Said(node, own, next(iter(_names(life, own)), '')) for node, own in samples.items()]


def _names(life: Life, said: Sequence[Lived]) -> Counter[str]:
    """Return how often each name was appended to a test; none if that is not known."""
    came = [(sample.at, sample.message.data) for sample in said]
    sent = [(sent.at, str(sent.fields['data'])) for sent in life.sent if sent.topic == INNER]
    # The lesson's first stage opens sentences, too, and each one may be answered just then.
    found = [
        Counter(
            answer.removeprefix(text)
            for t, answer in came
            if at <= t < at + 1.0 and name_trouble(text, answer) is None
        )
        for at, text in [*[each for each in sent if each[1] != OPENING][:1], *sent[:1]]
    ]
    return max(found, key=len, default=Counter())


def _trouble(text: str, came: Sequence[str]) -> Mistake | None:
    return (name_trouble(text, came[-1]) or CHANGED) if came else None


def _appends(name: str, node: str) -> Answers:
    return Answers(
        INNER,
        OUTER,
        STRING,
        _EachAnswers.text,
        answer=lambda text: f'{text}{name}',
        by=node,
        mistakes=[NOTHING_ADDED],
        explain=_trouble,
    )


two_names = Exercise(
    name='two_names',
    task=f'Two nodes of one class hear {INNER}. Each appends a first name of its own, and '
    f'publishes on {OUTER}.',
    subscribes={INNER: STRING},
    publishes={OUTER: STRING},
    shared=[OUTER],
    clauses=(_TwoNodes(), _EachAnswers(), _NamesDiffer()),
    hints=[
        'A class is a plan: two objects of it are two nodes. In what do the two differ?',
        'In two things: the name of the node and the first name. Both can be arguments of '
        '__init__.',
        'def __init__(self, node_name, first_name): then super().__init__(node_name) and '
        'self.first_name = first_name.',
    ],
    answer=Solution(
        __file__,
        'two_names.py',
        'What differs is an argument and is kept in self, so each object has its own. Both '
        'publish on one topic, and both hear the same message.',
    ),
)
