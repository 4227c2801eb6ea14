"""Exercise: two nodes of one class, each with its own name to say."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NoReturn

from labkit.exercises import Exercise, Fail, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Clause, Evidence, Test
from labkit.exercises.draws import draw_texts
from labkit.lessons.my_name_is.two_stages import OPENING, STRING, name_trouble

__all__ = ['two_names']

INNER, OUTER = '/incomplete', '/names'
# How soon an answer has to come, s.
WITHIN_SEC = 1.0

_NAMES = """
from rclpy.node import Node
from std_msgs.msg import String


class Introducer(Node):
    def __init__(self, node_name, first_name):
        super().__init__(node_name)
        self.first_name = first_name
        self.publisher = self.create_publisher(String, 'names', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + self.first_name))


ada = lab.spin(Introducer('ada', 'Ada'))
bob = lab.spin(Introducer('bob', 'Bob'))
"""
_PUBLISH = '        self.publisher.publish(String(data=msg.data + self.first_name))\n'
_START = _NAMES[_NAMES.index('ada = ') :].strip()


class _TwoNodes(Clause):
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


class _EachAnswers(Clause):
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
        heard = [(s.at, s.message.data) for s in life.on(INNER)]
        came = [(s.at, s.message.data) for s in life.on(OUTER)]
        names = _names(evidence)
        texts, answers = Counter(text for _, text in heard), Counter(text for _, text in came)
        # Of two equal texts of one check each may be answered twice, by mistake.
        pairs = [(text, name) for text in texts for name in names]
        often = any(answers[t + n] > 2 * texts[t] * names.count(n) for t, n in pairs)
        # The lesson's first stage speaks in between: what repeats its last answer forgets a test.
        if often and 2 * sum(answers[text + name] > 0 for text, name in pairs) > len(pairs):
            self._refuse_more(evidence, list(answers.elements()), often=True)
        left = list(came)
        due = [life.is_due(INNER, sample, WITHIN_SEC) for sample in life.on(INNER)]
        for (at, text), is_due in zip(heard, due, strict=True):
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
        extra = [text for _, text in life.without_strangers(INNER, late, known)]
        if extra:
            self._refuse_more(evidence, extra, often=False)
        shown = ' and '.join(repr(OPENING + name) for name in names)
        return f'Each of {len(heard)} texts was completed by {len(nodes)} nodes: {shown}.'

    def _refuse_more(self, evidence: Evidence, texts: Sequence[str], *, often: bool) -> NoReturn:
        raise Fail(
            f'{len(_nodes(evidence))} texts on {OUTER} for each one on {INNER}, one of each node',
            f'{len(texts)} texts{"" if often else " more"}: data = {expect.show(texts)}',
            why='The answers are repeated, again and again: a timer or a loop publishes them.'
            if often
            else 'A node publishes more than one text for each one that comes.',
            todo='Publish once, in the callback of the subscription, and nowhere else.',
        )


class _NamesDiffer(Clause):
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


two_names = Exercise(
    name='two_names',
    task='Two nodes of one class hear /incomplete. Each appends a first name of its own, and '
    'publishes on /names.',
    subscribes={'/incomplete': STRING},
    publishes={'/names': STRING},
    shared=['/names'],
    clauses=(_TwoNodes(), _EachAnswers(), _NamesDiffer()),
    hints=[
        'A class is a plan: two objects of it are two nodes. In what do the two differ?',
        'In two things: the name of the node and the first name. Both can be arguments of '
        '__init__.',
        'def __init__(self, node_name, first_name): then super().__init__(node_name) and '
        'self.first_name = first_name.',
    ],
    answer=Solution(
        _NAMES,
        'What differs is an argument and is kept in self, so each object has its own. Both '
        'publish on one topic, and both hear the same message.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String


def introduce(name):
    node = rclpy.create_node('stage_' + name.lower())
    publisher = node.create_publisher(String, '/names', 10)

    def answer(text):
        publisher.publish(String(data=text.data + name))

    node.create_subscription(String, '/incomplete', answer, 10)
    lab.spin(node)


for name in ('Eve', 'Finn', 'Gus'):
    introduce(name)
""",
        ),
        Style(
            'a class each',
            changed(
                _NAMES,
                (
                    _START,
                    """class Ada(Introducer):
    def __init__(self):
        super().__init__('lady', 'Ada')


class Bob(Introducer):
    def __init__(self):
        super().__init__('builder', 'Bob')


lab.spin(Ada())
lab.spin(Bob())
""",
                ),
            ),
        ),
        Style(
            'one more, and a list and a timer',
            """
from rclpy.node import Node
from std_msgs.msg import String


class Guest(Node):
    def __init__(self, name):
        super().__init__(f'{name.lower()}_node', namespace='party')
        self.name = name
        self.waiting = []
        self.publisher = self.create_publisher(String, '/names', 10)
        self.create_subscription(String, '/incomplete', self.waiting.append, 10)
        self.create_timer(0.3, self.speak)

    def speak(self):
        while self.waiting:
            self.publisher.publish(String(data=self.waiting.pop(0).data + self.name))


guests = [lab.spin(Guest(name)) for name in ('Ada', 'Bob', 'Zoe')]
""",
        ),
        Style(
            'names that the lesson has used',
            changed(
                _NAMES, ("'ada', 'Ada'", "'observer', 'Ada'"), ("'bob', 'Bob'", "'display', 'Bob'")
            ),
        ),
        Style(
            'executors of their own, in threads',
            changed(
                _NAMES,
                (
                    'from rclpy.node',
                    'import threading\n\nfrom rclpy.executors import SingleThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    _START,
                    """for name in ('Ada', 'Bob'):
    executor = SingleThreadedExecutor()
    executor.add_node(Introducer(name.lower(), name))
    threading.Thread(target=executor.spin, daemon=True).start()
""",
                ),
            ),
        ),
        Style(
            'own process',
            changed(
                _NAMES,
                (
                    'from rclpy.node',
                    'import rclpy\nfrom rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    _START,
                    """rclpy.init()
executor = MultiThreadedExecutor()
for node in (Introducer('ada', 'Ada'), Introducer('bob', 'Bob')):
    executor.add_node(node)
executor.spin()
""",
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'one node only',
            changed(_NAMES, ("bob = lab.spin(Introducer('bob', 'Bob'))\n", '')),
            'of /ada alone',
        ),
        Wrong(
            'same node name',
            changed(_NAMES, ("'bob', 'Bob'", "'ada', 'Bob'")),
            'lab.spin() ends the first of them',
        ),
        Wrong(
            'same first name',
            changed(_NAMES, ("'bob', 'Bob'", "'bob', 'Ada'")),
            "Both say 'Ada'",
        ),
        Wrong(
            'a variable for all',
            changed(
                _NAMES,
                ('self.first_name = first_name', 'Introducer.first_name = first_name'),
            ),
            "Both say 'Bob': they share the name.",
        ),
        Wrong(
            'second one not spun',
            changed(_NAMES, ("lab.spin(Introducer('bob', 'Bob'))", "Introducer('bob', 'Bob')")),
            '/bob is there, but it is not spun',
        ),
        Wrong(
            'string built once',
            changed(_NAMES, ('msg.data + self', "'My name is ' + self")),
            'The text that came in is not part of what goes out.',
        ),
        Wrong(
            'space too many',
            changed(_NAMES, ('msg.data + self', "msg.data + ' ' + self")),
            'There is a space too many beside the name.',
        ),
        Wrong(
            'one node with two publishers',
            changed(
                _NAMES,
                (_START, "ada = lab.spin(Introducer('ada', 'Ada'))"),
                (
                    '    def on_text',
                    "        self.other = self.create_publisher(String, 'names', 10)\n\n"
                    '    def on_text',
                ),
                (
                    'self.first_name))',
                    "self.first_name))\n        self.other.publish(String(data=msg.data + 'Bob'))",
                ),
            ),
            'One node has two publishers.',
        ),
        Wrong(
            'capital letter',
            changed(_NAMES, ("String, 'names', 10", "String, 'Names', 10")),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'answers twice',
            changed(_NAMES, (_PUBLISH, _PUBLISH + _PUBLISH)),
            'A node publishes more than one text',
        ),
        Wrong(
            'passes on, and answers',
            changed(_NAMES, (_PUBLISH, _PUBLISH + '        self.publisher.publish(msg)\n')),
            'A node publishes more than one text',
        ),
        Wrong(
            'a name that changes',
            changed(
                _NAMES,
                (_PUBLISH, _PUBLISH + '        self.first_name = self.first_name[::-1]\n'),
            ),
            'The names are others than those that came with the first text.',
        ),
        Wrong(
            'only the first time',
            changed(
                _NAMES,
                (
                    _PUBLISH,
                    '        if self.first_name:\n    '
                    + _PUBLISH
                    + "        self.first_name = ''\n",
                ),
            ),
            'nothing on /names',
        ),
        Wrong(
            'one of them knows one text only',
            changed(
                _NAMES,
                (
                    _PUBLISH,
                    "        if self.first_name == 'Ada' or msg.data == 'My name is ':\n    "
                    + _PUBLISH,
                ),
            ),
            'Only 1 of 2 nodes answered',
        ),
        Wrong(
            'repeats its answer',
            changed(
                _NAMES,
                (
                    '        self.first_name = first_name\n',
                    '        self.first_name = first_name\n        self.heard = None\n'
                    '        self.timer = self.create_timer(0.2, self.on_timer)\n',
                ),
                (
                    _PUBLISH,
                    '        self.heard = msg\n\n    def on_timer(self):\n'
                    '        if self.heard:\n'
                    '            self.publisher.publish('
                    'String(data=self.heard.data + self.first_name))\n',
                ),
            ),
            'a timer or a loop publishes them',
        ),
        Wrong(
            'one of them listens elsewhere',
            changed(
                _NAMES,
                ("String, 'incomplete', self", 'String, self.inner, self'),
                (
                    '        self.first_name = first_name\n',
                    '        self.first_name = first_name\n'
                    "        self.inner = 'incomplete' if first_name == 'Ada' else 'complete'\n",
                ),
            ),
            '/bob with a subscription to /incomplete',
        ),
    ],
)
