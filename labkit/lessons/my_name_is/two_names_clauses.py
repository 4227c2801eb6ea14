"""What the check of the exercise two_names asks for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NoReturn

from labkit.exercises import Fail, expect
from labkit.exercises.clauses import Clause, Evidence, Test
from labkit.exercises.draws import draw_texts
from labkit.lessons.my_name_is.two_stages_clauses import OPENING, STRING, name_trouble

__all__ = ['EachAnswers', 'NamesDiffer', 'TwoNodes']

INNER, OUTER = '/incomplete', '/names'
# How soon an answer has to come, s.
WITHIN_SEC = 1.0


class TwoNodes(Clause):
    """There are at least two nodes of different names, and each has both ends."""

    text = (
        'two nodes of different names, or more, subscribe to `/incomplete` and publish on '
        '`/names` (both `std_msgs/msg/String`)'
    )

    def find(self, evidence: Evidence) -> None:
        """Look for the nodes."""
        probe = evidence.probe
        expect.publisher(probe, OUTER)
        # Nodes of a process of their own come into the graph one after the other.
        probe.wait_to_appear(lambda: len({end.node for end in probe.publishers(OUTER)}) > 1)
        publishers = [end.node for end in probe.publishers(OUTER)]
        if len(set(publishers)) == 1:
            self._refuse_one_node(evidence, publishers)
        for node in sorted(set(publishers)):
            evidence.publisher(OUTER, node)
            evidence.subscription(INNER, node)
        expect.that(
            len(publishers) == len(set(publishers)),
            expected=f'one publisher on {OUTER} for each node',
            seen=', '.join(f'{count} of {node}' for node, count in Counter(publishers).items()),
            why='A node has more than one publisher, or two nodes have the same name.',
            todo='Make one publisher in __init__, and give each node a name of its own.',
        )

    def _refuse_one_node(self, evidence: Evidence, publishers: Sequence[str]) -> NoReturn:
        name, count = publishers[0], len(publishers)
        why = (
            'Were two nodes of the same name started? lab.spin() ends the first of them when the '
            'second one comes.'
        )
        if evidence.probe.node_names().count(name) > 1:
            why = 'Two nodes have the same name. ROS allows it, and nobody can tell them apart.'
        elif count > 1:
            why = 'One node has two publishers. Two nodes are asked for.'
        raise Fail(
            f'two nodes, of different names, that publish on {OUTER}',
            f'{count} publisher{"s" * (count > 1)} on {OUTER}, of {name} alone',
            why=why,
            todo="Give the name of the node as an argument, too: Introducer('ada', 'Ada')",
        )


class EachAnswers(Clause):
    """Each node answers each text once. What it appends, the first answers tell."""

    text = (
        'for each text on `/incomplete`, each of them publishes that text with a first name right '
        'behind it, once, within a second'
    )

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return texts to be completed."""
        for (kind, _, _), end in evidence.ends.items():
            if kind == 'subscription':
                expect.spun(evidence.probe, end)
        texts = [OPENING, *draw_texts()]
        return [Test(INNER, STRING, {'data': text}, (OUTER,)) for text in texts]

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers to each text, of whomever it is."""
        life, nodes = evidence.life, _nodes(evidence)
        heard = life.heard(INNER, WITHIN_SEC)
        came = [(s.at, s.message.data) for s in life.on(OUTER)]
        names = _names(evidence)
        texts = Counter(sample.message.data for sample, _ in heard)
        answers = Counter(text for _, text in came)
        # Of two equal texts of one check each may be answered twice, by mistake.
        pairs = [(text, name) for text in texts for name in names]
        often = any(answers[t + n] > 2 * texts[t] * names.count(n) for t, n in pairs)
        # The lesson's first stage speaks in between: what repeats its last answer forgets a test.
        if often and 2 * sum(answers[text + name] > 0 for text, name in pairs) > len(pairs):
            self._refuse_more(evidence, list(answers.elements()), often=True)
        left = list(came)
        for sample, is_due in heard:
            at, text = sample.at, sample.message.data
            for name in names or ['']:
                answer = text + name if names else None
                found = next((i for i, (t, v) in enumerate(left) if t >= at and v == answer), None)
                if found is not None:
                    del left[found]
                elif is_due:
                    here = [v for t, v in came if at <= t < at + WITHIN_SEC]
                    others = {t + name for t in texts if t != text for name in names}
                    _refuse(text, [v for v in here if v not in others] or here, nodes)
        # The lesson's first stage says how a sentence begins, in a process of its own.
        known = {text + name for text in texts if text != OPENING for name in ['', *names]}
        late = [(at, text) for at, text in left if at >= WITHIN_SEC]
        extra = [text for _, text in life.without_strangers(INNER, late, known, len(nodes))]
        if extra:
            self._refuse_more(evidence, extra, often=False)
        shown = ' and '.join(repr(OPENING + name) for name in names)
        count = sum(is_due for _, is_due in heard)
        return f'Each of {count} texts was completed by {len(nodes)} nodes: {shown}.'

    def _refuse_more(self, evidence: Evidence, texts: Sequence[str], *, often: bool) -> NoReturn:
        raise Fail(
            f'{len(_nodes(evidence))} texts on {OUTER} for each one on {INNER}, one of each node',
            f'{len(texts)} texts{"" if often else " more"}: data = {expect.show(texts)}',
            why='The answers are repeated, again and again: a timer or a loop publishes them.'
            if often
            else 'A node publishes more than one text for each one that comes.',
            todo='Publish once, in the callback of the subscription, and nowhere else.',
        )


class NamesDiffer(Clause):
    """Each node has a first name of its own."""

    text = 'the first names are different, and each node stays with its own'

    def judge(self, evidence: Evidence) -> str:
        """Compare the names."""
        names = _names(evidence)
        same = next((name for name, count in Counter(names).items() if count > 1), '')
        expect.that(
            not same,
            expected=f'texts on {OUTER} with different names',
            seen=f'data = {expect.show([OPENING + name for name in names])}',
            why=f'Both say {same!r}: they share the name. A variable of the notebook or of the '
            'class is the same for all objects.',
            todo='Keep the name in the object: self.first_name = first_name in __init__',
        )
        return ''


def _nodes(evidence: Evidence) -> list[str]:
    """Return the names of the nodes that answer."""
    return sorted(by for kind, _, by in evidence.ends if kind == 'publisher')


def _names(evidence: Evidence) -> list[str]:
    """Return what was appended to a text that was sent; none if that is not known."""
    life = evidence.life
    sent = [(sent.fields['data'], sent.at) for sent in life.sent if sent.topic == INNER]
    found = []
    # The lesson's first stage opens sentences, too, and each one may be answered just then.
    for text, at in [*[pair for pair in sent if pair[0] != OPENING][:1], *sent[:1]]:
        answers = [s.message.data for s in life.on(OUTER) if at <= s.at < at + WITHIN_SEC]
        right = [answer for answer in answers if not any(name_trouble(text, answer))]
        found.append([answer.removeprefix(text) for answer in right][: len(_nodes(evidence))])
    return max(found, key=len, default=[])


def _refuse(text: str, came: Sequence[str], nodes: Sequence[str]) -> NoReturn:
    """Raise Fail with the reason why a text was not answered as it should be."""
    seen = f'data = {expect.show(came)}' if came else f'nothing on {OUTER}'
    troubles = [name_trouble(text, answer) for answer in came]
    why, todo = next((trouble for trouble in troubles if any(trouble)), ('', ''))
    if not came:
        why = 'The message came, but the callback of no node did publish.'
        todo = 'Publish in the callback of the subscription, and start both with lab.spin(...).'
    elif not why and len(came) < len(nodes):
        why = f'Only {len(came)} of {len(nodes)} nodes answered: {", ".join(nodes)}.'
        todo = 'Do the same in each node, for each text.'
    elif not why:
        why = 'The names are others than those that came with the first text.'
        todo = 'Keep the name in the object, self.first_name, and do not change it.'
    raise Fail(
        f'{len(nodes)} texts on {OUTER} when {expect.show([text])} comes on {INNER}',
        seen,
        why=why,
        todo=todo,
    )
