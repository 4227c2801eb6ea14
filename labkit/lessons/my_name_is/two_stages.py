"""Exercise: two nodes in a row, of which the second completes what the first begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Answers, Clause, Evidence, Publishes, Says, Test
from labkit.exercises.draws import draw_texts

__all__ = ['OPENING', 'STRING', 'name_trouble', 'says_opening', 'two_stages']

STRING = 'std_msgs/msg/String'
OPENING = 'My name is '

_CHAIN = """
from rclpy.node import Node
from std_msgs.msg import String


class Opener(Node):
    def __init__(self):
        super().__init__('opener')
        self.publisher = self.create_publisher(String, 'incomplete', 10)
        self.timer = self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='My name is '))


class Completer(Node):
    def __init__(self):
        super().__init__('completer')
        self.publisher = self.create_publisher(String, 'complete', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + 'Ada'))


completer = lab.spin(Completer())
opener = lab.spin(Opener())
"""
_START = 'completer = lab.spin(Completer())\nopener = lab.spin(Opener())'
_SUM = "msg.data + 'Ada'"


@dataclass(frozen=True)
class _Completes(Clause):
    """A stage appends a first name to each text. Which one that is, its first answer tells."""

    inner: str = '/incomplete'
    outer: str = '/complete'
    text = (
        'for each text on `/incomplete`, publish that text with your first name right behind it '
        'on `/complete` (both `std_msgs/msg/String`), once, within a second'
    )

    def find(self, evidence: Evidence) -> None:
        """Look for the stage."""
        self._answers('').find(evidence)

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers to what stage one says, and to texts of the check alone."""
        hears = evidence.subscription(self.inner)
        texts = [OPENING, *draw_texts()]
        tests = [Test(self.inner, STRING, {'data': text}, (self.outer,)) for text in texts]
        # Stage one stands still meanwhile, so that its own messages are its own.
        tested = evidence.alone(self, tests, hears.node)
        came = [sample.message.data for sample in tested.life.on(self.outer)]
        name = self._name(came) if came else ''
        answers = self._answers(name)
        answers.judge(tested)
        answers.judge(evidence)
        one = evidence.publisher(self.inner)
        return (
            f'{one.node} -> {self.inner} -> {hears.node} -> {self.outer}: {OPENING + name!r}\n'
            f'{len(texts)} texts of the check have got the name, too.'
        )

    def _answers(self, name: str) -> Answers:
        return Answers(
            self.inner,
            self.outer,
            self.text,
            answer=lambda text: f'{text}{name}',
            draw=lambda: [OPENING],
            explain=_explain,
        )

    def _name(self, came: Sequence[str]) -> str:
        name = came[0].removeprefix(OPENING)
        why, todo = name_trouble(OPENING, came[0])
        if why:
            raise Fail(
                f'{OPENING!r} and your first name',
                f'data = {expect.show(came[:1])}',
                why=why,
                todo=todo,
            )
        return name


class _TwoNodes(Clause):
    """Each stage is a node."""

    text = 'the two stages are two nodes'

    def find(self, evidence: Evidence) -> None:
        """Compare their names."""
        one = evidence.publisher('/incomplete').node
        expect.that(
            evidence.subscription('/incomplete').node != one,
            expected='two nodes, one for each stage',
            seen=f'{one} publishes on /incomplete and subscribes to it',
            why='One node does the work of both stages, so neither can be replaced without the '
            'other.',
            todo='Write a class for each stage.',
        )


def says_opening() -> Says:
    """Return what the messages of stage one have to say."""
    return Says(
        '/incomplete',
        OPENING,
        words=f'each message says `{OPENING}`, with the space at the end',
        todo=f'Publish {OPENING!r}, with a space at the end.',
    )


def name_trouble(text: str, answer: str) -> tuple[str, str]:
    """Say what is wrong with a text and a name that was appended, and what to do.

    Args:
        text: The text that came.
        answer: What was made of it.

    Returns:
        Two empty texts if it is the text with a name right behind it.
    """
    put = 'String(data=msg.data + ...), with your name for the dots.'
    name = answer.removeprefix(text)
    if answer == text or not name.strip():
        return 'The text is passed on as it came: no name is added.', put
    if answer.startswith(text):
        if text in name:
            return (
                'The texts of earlier messages are still in it: the string grows.',
                'Make a new string from msg.data each time.',
            )
        if name != name.strip():
            return 'There is a space too many beside the name.', put
        return '', ''
    if answer.startswith(text.rstrip()):
        return 'The space between the text and the name is missing.', put
    if text.strip() in answer:
        return 'The name stands before the text.', put
    return 'The text that came in is not part of what goes out.', put


def _explain(text: str, came: Sequence[str]) -> tuple[str, str]:
    if came and text.strip() and not any(text in other for other in came):
        return (
            'The string is always the same, or is changed: it is not made of the message that '
            'came, as it came.',
            'Use msg.data in the callback.',
        )
    return '', ''


two_stages = Exercise(
    name='two_stages',
    task=f'Node one publishes {OPENING!r} on /incomplete, twice a second. Node two appends your '
    'first name and publishes the whole on /complete.',
    publishes={'/incomplete': STRING, '/complete': STRING},
    subscribes={'/incomplete': STRING},
    clauses=(Publishes('/incomplete', 2.0, STRING), says_opening(), _Completes(), _TwoNodes()),
    hints=[
        'Thermometer and Converter are such a chain. Which lines have to change?',
        'Stage one: a timer of 0.5 s and a publisher. Stage two: a subscription and a publisher, '
        'and no timer.',
        "In the callback of stage two: self.publisher.publish(String(data=msg.data + 'Ada')).",
    ],
    answer=Solution(
        _CHAIN,
        'Each stage has one task and knows two topics at most. Stage two makes its text from the '
        'message that came, so it goes on working when stage one says something else.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

one, two = rclpy.create_node('first'), rclpy.create_node('second')
begin = one.create_publisher(String, '/incomplete', 1)
end = two.create_publisher(String, '/complete', 1)
one.create_timer(1 / 2, lambda: begin.publish(String(data='My name is ')))
two.create_subscription(
    String, '/incomplete', lambda text: end.publish(String(data=f'{text.data}Jean-Luc')), 1
)
lab.spin(one)
lab.spin(two)
""",
        ),
        Style(
            'stage one is a loop with a rate, in a thread',
            changed(
                _CHAIN,
                ('        self.timer = self.create_timer(0.5, self.on_timer)\n', ''),
                (
                    'opener = lab.spin(Opener())',
                    """
import threading

opener = lab.spin(Opener())


def work():
    rate = opener.create_rate(2)
    for _ in range(120):
        opener.on_timer()
        rate.sleep()


threading.Thread(target=work, daemon=True).start()
""",
                ),
            ),
        ),
        Style(
            'stage one sleeps in a thread',
            changed(
                _CHAIN,
                ('        self.timer = self.create_timer(0.5, self.on_timer)\n', ''),
                (
                    'opener = lab.spin(Opener())',
                    """
import threading
import time

opener = lab.spin(Opener())


def work(opener):
    for _ in range(240):
        opener.on_timer()
        time.sleep(0.5)


threading.Thread(target=work, args=[opener], daemon=True).start()
""",
                ),
            ),
        ),
        Style(
            'names that the lesson has used, and a fast timer',
            changed(
                _CHAIN,
                (
                    "super().__init__('opener')\n",
                    "super().__init__('thermometer')\n        self.n = 0\n",
                ),
                ("'completer'", "'observer'"),
                ('create_timer(0.5,', 'create_timer(0.1,'),
                (
                    "        self.publisher.publish(String(data='My name is '))\n",
                    '        self.n += 1\n        if self.n % 5 == 0:\n'
                    "            self.publisher.publish(String(data='My name is '))\n",
                ),
            ),
        ),
        Style(
            'both in a process of its own',
            changed(
                _CHAIN,
                (
                    'from rclpy.node',
                    'import rclpy\nfrom rclpy.executors import SingleThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    _START,
                    """rclpy.init()
executor = SingleThreadedExecutor()
for stage in (Completer(), Opener()):
    executor.add_node(stage)
executor.spin()
""",
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'space missing',
            changed(_CHAIN, ("'My name is '", "'My name is'")),
            'A space is missing at the end of the text.',
        ),
        Wrong('no name', changed(_CHAIN, (_SUM, 'msg.data')), 'no name is added'),
        Wrong(
            'string built once',
            changed(_CHAIN, (_SUM, "'My name is Ada'")),
            'it is not made of the message that came',
        ),
        Wrong(
            'string grows',
            changed(
                _CHAIN,
                (
                    "super().__init__('completer')\n",
                    "super().__init__('completer')\n        self.text = ''\n",
                ),
                (
                    f'self.publisher.publish(String(data={_SUM}))',
                    'self.text += msg.data\n'
                    "        self.publisher.publish(String(data=self.text + 'Ada'))",
                ),
            ),
            'The texts of earlier messages are still in it',
        ),
        Wrong(
            'name in front',
            changed(_CHAIN, (_SUM, "'Ada' + msg.data")),
            'The name stands before the text.',
        ),
        Wrong(
            'publishes where it listens',
            changed(_CHAIN, ("String, 'complete', 10", "String, 'incomplete', 10")),
            'The node hears what it says itself',
        ),
        Wrong(
            'blocks in the callback',
            changed(
                _CHAIN,
                ('def on_text(self, msg):\n', 'def on_text(self, msg):\n        sleep(3)\n'),
                ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                _CHAIN,
                ("        self.publisher = self.create_publisher(String, 'complete', 10)\n", ''),
                (
                    f'self.publisher.publish(String(data={_SUM}',
                    f"self.create_publisher(String, 'complete', 10).publish(String(data={_SUM}",
                ),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'one node for both',
            """
from rclpy.node import Node
from std_msgs.msg import String


class Both(Node):
    def __init__(self):
        super().__init__('both')
        self.begin = self.create_publisher(String, 'incomplete', 10)
        self.end = self.create_publisher(String, 'complete', 10)
        self.create_subscription(String, 'incomplete', self.on_text, 10)
        self.create_timer(0.5, lambda: self.begin.publish(String(data='My name is ')))

    def on_text(self, msg):
        self.end.publish(String(data=msg.data + 'Ada'))


lab.spin(Both())
""",
            'One node does the work of both stages',
        ),
        Wrong(
            'second stage missing',
            changed(_CHAIN, ('completer = lab.spin(Completer())\n', '')),
            'create_subscription() for this topic has not been called',
        ),
        Wrong(
            'callback called',
            changed(_CHAIN, ('self.on_timer)', 'self.on_timer())')),
            'Pass the name alone',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'off by ten',
            changed(_CHAIN, ('create_timer(0.5,', 'create_timer(0.05,')),
            'times too fast',
        ),
        Wrong(
            'three times in two seconds',
            changed(_CHAIN, ('create_timer(0.5,', 'create_timer(0.6,')),
            '1.2 times too slow',
        ),
        Wrong(
            'stage one ends after ten',
            changed(
                _CHAIN,
                (
                    "super().__init__('opener')\n",
                    "super().__init__('opener')\n        self.n = 0\n",
                ),
                (
                    "        self.publisher.publish(String(data='My name is '))\n",
                    '        self.n += 1\n        if self.n <= 10:\n'
                    "            self.publisher.publish(String(data='My name is '))\n",
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'stage one says something else later',
            changed(
                _CHAIN,
                (
                    "super().__init__('opener')\n",
                    "super().__init__('opener')\n        self.n = 0\n",
                ),
                (
                    "        self.publisher.publish(String(data='My name is '))\n",
                    '        self.n += 1\n'
                    "        text = 'My name is ' if self.n < 30 else 'Hello, '\n"
                    '        self.publisher.publish(String(data=text))\n',
                ),
            ),
            'that were right',
        ),
        Wrong(
            'stage two answers twice',
            changed(
                _CHAIN,
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    f'        msg.data = {_SUM}\n        self.publisher.publish(msg)\n'
                    '        self.publisher.publish(msg)\n',
                ),
            ),
            'A message is answered more than once.',
        ),
        Wrong(
            'stage two passes on, and answers',
            changed(
                _CHAIN,
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    f'        self.publisher.publish(String(data={_SUM}))\n'
                    '        self.publisher.publish(msg)\n',
                ),
            ),
            'What came in goes out as well',
        ),
        Wrong(
            'stage two has a timer',
            changed(
                _CHAIN,
                (
                    "super().__init__('completer')\n",
                    "super().__init__('completer')\n        self.text = 'My name is '\n"
                    '        self.timer = self.create_timer(0.5, self.on_timer)\n',
                ),
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    '        self.text = msg.data\n\n    def on_timer(self):\n'
                    "        self.publisher.publish(String(data=self.text + 'Ada'))\n",
                ),
            ),
            'a timer or a loop publishes it',
        ),
        Wrong(
            'stage two knows one text only',
            changed(
                _CHAIN,
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    "        if msg.data == 'My name is ':\n"
                    f'            self.publisher.publish(String(data={_SUM}))\n',
                ),
            ),
            'nothing on /complete',
        ),
        Wrong(
            'a name that changes',
            changed(
                _CHAIN,
                (
                    "super().__init__('completer')\n",
                    "super().__init__('completer')\n        self.names = ['Ada', 'Bob']\n",
                ),
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    '        self.names.reverse()\n'
                    '        self.publisher.publish(String(data=msg.data + self.names[0]))\n',
                ),
            ),
            'messages were answered rightly, others not',
        ),
    ],
)
