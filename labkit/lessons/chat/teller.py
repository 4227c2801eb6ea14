"""Exercise: say what was typed, with the name of who says it."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers
from labkit.exercises.draws import draw_texts
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.chat.clauses import STRING

__all__ = ['teller']

INNER, OUTER = '/typed', '/hall'
WHO = 'Ada'

_TELLER = """
from rclpy.node import Node
from std_msgs.msg import String


class Teller(Node):
    def __init__(self):
        super().__init__('teller')
        self.publisher = self.create_publisher(String, 'hall', 10)
        self.subscription = self.create_subscription(String, 'typed', self.on_typed, 10)

    def on_typed(self, msg):
        text = msg.data.strip()
        if text:
            self.publisher.publish(String(data=f'Ada: {text}'))


teller = lab.spin(Teller())
"""
_STRIP = 'msg.data.strip()'
_IF = '        if text:\n            self.publisher'
_SAID = "f'Ada: {text}'"


def _say(text: str) -> str | None:
    return f'{WHO}: {text.strip()}' if text.strip() else None


def _draw() -> list[str]:
    texts = [*draw_texts(), ' ' * random.randint(1, 5), 'Bo: ' + random.choice('abc')]
    random.shuffle(texts)
    return texts


def _explain(text: str, came: Sequence[str]) -> tuple[str, str]:
    said = came[-1] if came else ''
    if text.strip() in came:
        return 'It does not say who says it.', f"String(data=f'{WHO}: {{text}}')"
    if said == f'{WHO}: {text}':
        return 'There are blanks at an end of what was typed.', 'text = msg.data.strip()'
    if said.removeprefix(f'{WHO}:').strip() == text.strip():
        return 'Between the name and the text stand a colon and one blank.', "f'Ada: {text}'"
    if said and said.casefold() != f'{WHO}: {text.strip()}'.casefold():
        return 'What is said is not what was typed.', 'Use the message that came: msg.data'
    return '', ''


teller = Exercise(
    name='teller',
    task='Publish what was typed on /hall, with the name of who says it.',
    subscribes={INNER: STRING},
    publishes={OUTER: STRING},
    clauses=(
        Answers(
            INNER,
            OUTER,
            f'for each text on `{INNER}`, publish `{WHO}: ` and that text, without the blanks at '
            f'its two ends, on `{OUTER}` (both `{STRING}`), once, within a second; upon a text '
            'that is empty, or all blanks, publish nothing',
            answer=_say,
            draw=_draw,
            explain=_explain,
        ),
    ),
    hints=[
        'The node has a subscription and a publisher. The callback of the one uses the other.',
        'strip() returns a text without the blanks at its two ends. What is left of blanks alone?',
        "text = msg.data.strip(), then if text: publish String(data=f'Ada: {text}')",
    ],
    answer=Solution(
        _TELLER,
        'A text that is empty counts as False, so `if text` leaves out what holds nothing.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('mouthpiece')
publisher = node.create_publisher(String, '/hall', 10)


def say(msg):
    words = msg.data.strip()
    if words != '':
        publisher.publish(String(data='Ada: ' + words))


node.create_subscription(String, '/typed', say, 10)
lab.spin(node)
""",
        ),
        Style(
            'a list and a timer',
            changed(
                _TELLER,
                (
                    "'typed', self.on_typed, 10)\n",
                    "'typed', self.note, 10)\n        self.waiting = []\n"
                    '        self.create_timer(0.1, self.on_timer)\n\n'
                    '    def note(self, msg):\n        self.waiting.append(msg)\n\n'
                    '    def on_timer(self):\n        while self.waiting:\n'
                    '            self.on_typed(self.waiting.pop(0))\n',
                ),
            ),
        ),
        Style(
            'returns early',
            changed(
                _TELLER,
                (
                    f'{_IF}.publish(String(data={_SAID}))\n',
                    '        if not text:\n            return\n'
                    f'        self.publisher.publish(String(data={_SAID}))\n',
                ),
            ),
        ),
        Style('own process', in_process(_TELLER), process=True),
        Style('started by subprocess', started_by_subprocess(in_process(_TELLER))),
    ],
    wrong=[
        Wrong('without a name', changed(_TELLER, (_SAID, 'text')), 'It does not say who says it.'),
        Wrong(
            'with the blanks',
            changed(_TELLER, (_STRIP, 'msg.data'), ('if text:', 'if text.strip():')),
            'There are blanks at an end',
        ),
        Wrong(
            'says blanks, too',
            changed(_TELLER, (_IF, '        if True:\n            self.publisher')),
            'nothing is to be said',
        ),
        Wrong(
            'without a blank after the colon',
            changed(_TELLER, ('Ada: {text}', 'Ada:{text}')),
            'a colon and one blank',
        ),
        Wrong(
            'in capital letters',
            changed(_TELLER, (_STRIP, f'{_STRIP}.upper()')),
            'Capital and small letters differ',
        ),
        Wrong(
            'twice',
            changed(
                _TELLER,
                (
                    f'            self.publisher.publish(String(data={_SAID}))\n',
                    '            for _ in range(2):\n'
                    f'                self.publisher.publish(String(data={_SAID}))\n',
                ),
            ),
            'A message is answered more than once.',
        ),
        Wrong(
            'the first one again and again',
            changed(
                _TELLER,
                (
                    "        super().__init__('teller')\n",
                    "        super().__init__('teller')\n        self.text = ''\n",
                ),
                (
                    '        text = msg.data.strip()\n',
                    '        self.text = self.text or '
                    'msg.data.strip()\n        text = self.text\n',
                ),
            ),
            'What is said is not what was typed.',
        ),
        Wrong(
            'on another topic',
            changed(_TELLER, ("String, 'hall'", "String, 'halls'")),
            'on /halls',
        ),
        Wrong(
            'the text and not a message',
            changed(_TELLER, (f'String(data={_SAID})', _SAID)),
            'it got one of type str',
            outcome=Outcome.ERROR,
        ),
        Wrong('not spun', changed(_TELLER, ('lab.spin(Teller())', 'Teller()')), 'takes them out'),
    ],
)
