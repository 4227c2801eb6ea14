"""Exercise: two nodes in a row, of which the second completes what the first begins."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Publishes
from labkit.lessons.my_name_is.two_stages_clauses import (
    OPENING,
    STRING,
    Completes,
    TwoNodes,
    says_opening,
)

__all__ = ['two_stages']


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


two_stages = Exercise(
    name='two_stages',
    task=f'Node one publishes {OPENING!r} on /incomplete, twice a second. Node two appends your '
    'first name and publishes the whole on /complete.',
    publishes={'/incomplete': STRING, '/complete': STRING},
    subscribes={'/incomplete': STRING},
    clauses=(Publishes('/incomplete', 2.0, STRING), says_opening(), Completes(), TwoNodes()),
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
