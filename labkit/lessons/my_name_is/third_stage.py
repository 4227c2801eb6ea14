"""Exercise: one more stage at the end of the chain."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.exercises.draws import draw_texts
from labkit.exercises.life import Stimulus, live
from labkit.exercises.variants import varied
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.my_name_is.third_stage_clauses import ENDING, AtTheEnd, explain
from labkit.lessons.my_name_is.two_stages_clauses import STRING

__all__ = ['third_stage']


_POLITE = """
from rclpy.node import Node
from std_msgs.msg import String


class Polite(Node):
    def __init__(self):
        super().__init__('polite')
        self.publisher = self.create_publisher(String, 'greeting', 10)
        self.subscription = self.create_subscription(String, 'complete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + '. Nice to meet you.'))


polite = lab.spin(Polite())
"""
_SUM = "msg.data + '. Nice to meet you.'"


_USUAL = Exercise(
    name='third_stage',
    task=f'A node that appends {ENDING!r} to each text of /complete, and publishes it on '
    '/greeting.',
    subscribes={'/complete': STRING},
    publishes={'/greeting': STRING},
    clauses=(
        AtTheEnd(
            '/complete',
            '/greeting',
            f'for each text on `/complete`, publish that text with `{ENDING}` right behind it on '
            '`/greeting` (both `std_msgs/msg/String`), once, within a second',
            answer=lambda text: f'{text}{ENDING}',
            draw=draw_texts,
            explain=explain,
        ),
    ),
    hints=[
        'Stage three is like stage two: it hears one topic and publishes on another one.',
        'It hears /complete. Stages one and two need not be changed.',
        f'In the callback: self.publisher.publish(String(data=msg.data + {ENDING!r}))',
    ],
    answer=Solution(
        _POLITE,
        'A chain grows at its end without a change to what is there. Stage two does not know '
        'that somebody listens to it now.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('butler')
publisher = node.create_publisher(String, '/greeting', 5)


def bow(text):
    publisher.publish(String(data=f'{text.data}. Nice to meet you.'))


node.create_subscription(String, '/complete', bow, 5)
lab.spin(node)
""",
        ),
        Style(
            'a list and a timer',
            """
from rclpy.node import Node
from std_msgs.msg import String


class Patient(Node):
    def __init__(self):
        super().__init__('converter')
        self.waiting = []
        self.create_subscription(String, 'complete', self.waiting.append, 10)
        self.publisher = self.create_publisher(String, 'greeting', 10)
        self.create_timer(0.2, self.greet)

    def greet(self):
        while self.waiting:
            text = self.waiting.pop(0).data
            self.publisher.publish(String(data=text + '. Nice to meet you.'))


patient = lab.spin(Patient())
""",
        ),
        Style(
            'names that are remapped',
            """
from rclpy.node import Node
from std_msgs.msg import String

names = ['--ros-args', '-r', 'heard:=/complete', '-r', 'said:=/greeting']
node = Node('polite', namespace='house', cli_args=names)
publisher = node.create_publisher(String, 'said', 10)


def bow(text):
    publisher.publish(String(data=''.join([text.data, '. Nice to meet you.'])))


node.create_subscription(String, 'heard', bow, 10)
lab.spin(node)
""",
        ),
        Style(
            'an executor of its own, in a thread',
            changed(
                _POLITE,
                (
                    'from rclpy.node',
                    'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    'polite = lab.spin(Polite())\n',
                    'executor = MultiThreadedExecutor()\nexecutor.add_node(Polite())\n'
                    'threading.Thread(target=executor.spin, daemon=True).start()\n',
                ),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_POLITE))),
        Style(
            'own process',
            in_process(_POLITE),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'listens to stage one',
            changed(_POLITE, ("String, 'complete'", "String, 'incomplete'")),
            'It hears stage one and goes past stage two',
        ),
        Wrong(
            'publishes where it listens',
            changed(_POLITE, ("String, 'greeting', 10", "String, 'complete', 10")),
            'The node hears what it says itself',
        ),
        Wrong(
            'space missing',
            changed(_POLITE, (_SUM, "msg.data + '.Nice to meet you.'")),
            'The spaces are not where they should be.',
        ),
        Wrong(
            'full stop missing',
            changed(_POLITE, (_SUM, "msg.data + '. Nice to meet you'")),
            "The text ends too early: '.' is missing.",
        ),
        Wrong(
            'string built once',
            changed(_POLITE, (_SUM, "'My name is Ada. Nice to meet you.'")),
            'the string is made beforehand',
        ),
        Wrong(
            'nothing added',
            changed(_POLITE, (_SUM, 'msg.data')),
            'The text is passed on as it came',
        ),
        Wrong(
            'publishes a text',
            changed(_POLITE, (f'String(data={_SUM})', _SUM)),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'misspelt',
            changed(_POLITE, ("'greeting'", "'greetings'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'answers twice',
            changed(
                _POLITE,
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    f'        msg.data = {_SUM}\n        self.publisher.publish(msg)\n'
                    '        self.publisher.publish(msg)\n',
                ),
            ),
            'A message is answered more than once.',
        ),
        Wrong(
            'passes on, and answers',
            changed(
                _POLITE,
                (
                    '        self.publisher.publish(',
                    '        self.publisher.publish(msg)\n        self.publisher.publish(',
                ),
            ),
            'What came in goes out as well',
        ),
        Wrong(
            'small letters',
            changed(_POLITE, ('msg.data + ', 'msg.data.lower() + ')),
            'Make the string in the callback, of msg.data as it is.',
        ),
        Wrong(
            'only texts of the chain',
            changed(
                _POLITE,
                (
                    '        self.publisher.publish(',
                    "        if not msg.data.startswith('My name is '):\n            return\n"
                    '        self.publisher.publish(',
                ),
            ),
            'nothing on /greeting',
        ),
        Wrong(
            'no empty text',
            changed(
                _POLITE,
                (
                    '        self.publisher.publish(',
                    '        if not msg.data:\n            return\n'
                    '        self.publisher.publish(',
                ),
            ),
            'messages were answered rightly, others not',
        ),
        Wrong(
            'repeats its answer',
            changed(
                _POLITE,
                (
                    "super().__init__('polite')\n",
                    "super().__init__('polite')\n        self.text = ''\n"
                    '        self.timer = self.create_timer(0.5, self.on_timer)\n',
                ),
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    f'        self.text = {_SUM}\n\n    def on_timer(self):\n'
                    '        self.publisher.publish(String(data=self.text))\n',
                ),
            ),
            'a timer or a loop publishes it',
        ),
        Wrong(
            'answers both stages',
            changed(
                _POLITE,
                (
                    "String, 'complete', self.on_text, 10)\n",
                    "String, 'complete', self.on_text, 10)\n"
                    "        self.create_subscription(String, 'incomplete', self.on_text, 10)\n",
                ),
            ),
            'What comes on /incomplete is answered, too.',
        ),
        Wrong(
            'only the first text',
            changed(
                _POLITE,
                (
                    "super().__init__('polite')\n",
                    "super().__init__('polite')\n        self.text = ''\n",
                ),
                (
                    f'        self.publisher.publish(String(data={_SUM}))\n',
                    f'        self.text = self.text or {_SUM}\n'
                    '        self.publisher.publish(String(data=self.text))\n',
                ),
            ),
            'does not hold the text that came in',
        ),
    ],
)


_GREETINGS = (
    'Good to see you',
    'How nice to be here',
    'It is a pleasure',
    'Pleased to meet you',
    'Thank you for having me',
    'What a lovely day',
)
_CITIES = [
    'Aarhus',
    'Athens',
    'Bergen',
    'Berlin',
    'Bilbao',
    'Bogota',
    'Cairo',
    'Dublin',
    'Geneva',
    'Ghent',
    'Hanoi',
    'Helsinki',
    'Jena',
    'Kyoto',
    'Leiden',
    'Lima',
    'Lisbon',
    'Lyon',
    'Malmo',
    'Nairobi',
    'Odessa',
    'Oslo',
    'Paris',
    'Perth',
    'Porto',
    'Prague',
    'Quito',
    'Riga',
    'Rome',
    'Seoul',
    'Sofia',
    'Tartu',
    'Tunis',
    'Turin',
    'Utrecht',
    'Vienna',
    'Warsaw',
    'York',
    'Zagreb',
]


def _variant(*, ending: str) -> Exercise:
    return replace(
        _USUAL,
        task=_USUAL.task.replace(repr(ENDING), repr(ending)),
        clauses=(
            AtTheEnd(
                '/complete',
                '/greeting',
                _USUAL.clauses[0].text.replace(ENDING, ending),
                answer=lambda text: f'{text}{ending}',
                draw=draw_texts,
                explain=partial(explain, ending=ending),
            ),
        ),
        hints=[hint.replace(repr(ENDING), repr(ending)) for hint in _USUAL.hints],
        answer=Solution(changed(_POLITE, (ENDING, ending)), _USUAL.answer.reason),
        styles=(),
        wrong=(),
    )


def _guess(probe: Probe) -> dict[str, str] | None:
    node = expect.publisher(probe, '/greeting').node
    text = 'My name is Ada'
    test = Stimulus(1.0, '/complete', STRING, {'data': text}, ['/greeting'])
    topics = {'/complete': STRING, '/greeting': STRING}
    came = live(probe, topics, 3.0, stimuli=[test], nodes=[node]).on('/greeting')
    said = came[-1].message.data if came else ''
    return {'ending': said.removeprefix(text)} if said.startswith(text) else None


third_stage = varied(
    _USUAL,
    _variant,
    _guess,
    ending=[f'. {greeting} in {city}.' for greeting in _GREETINGS for city in _CITIES],
)
