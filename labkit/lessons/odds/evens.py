"""Exercise: hear the odd numbers, and publish even ones."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers
from labkit.exercises.draws import draw_int16s
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['evens']

INT16 = 'std_msgs/msg/Int16'

_EVENS = """
from rclpy.node import Node
from std_msgs.msg import Int16


class Evens(Node):
    def __init__(self):
        super().__init__('evens')
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.subscription = self.create_subscription(Int16, 'odds', self.on_odd, 10)

    def on_odd(self, msg):
        even = Int16()
        even.data = msg.data + 1
        self.publisher.publish(even)


evens = lab.spin(Evens())
"""


def _explain(number: int, came: Sequence[int]) -> tuple[str, str]:
    if number in came:
        return (
            'The number is passed on as it came.',
            'Add 1 before you publish: even.data = msg.data + 1',
        )
    if number - 1 in came:
        return '1 is subtracted, and not added.', 'even.data = msg.data + 1'
    if number < 0 and 1 - number in came:
        return 'The sign of the number is lost.', 'even.data = msg.data + 1'
    if 2 * number in came:
        return 'The number is doubled. 1 becomes 2, but 3 becomes 6.', 'even.data = msg.data + 1'
    if came:
        return (
            'What is published does not depend on the number that came. Does the node count by '
            'itself?',
            'Use the number in the message: msg.data',
        )
    return '', ''


evens = Exercise(
    name='evens',
    task='Subscribe to /odds, add 1 to each number and publish the result on /evens (`Int16`).',
    subscribes={'/odds': INT16},
    publishes={'/evens': INT16},
    clauses=(
        Answers(
            '/odds',
            '/evens',
            'for each number on `/odds`, publish that number plus 1 on `/evens` '
            '(both `std_msgs/msg/Int16`), once, within a second',
            answer=lambda number: number + 1,
            draw=lambda: draw_int16s(-32767, 32765, 2),
            explain=_explain,
        ),
    ),
    hints=[
        'One node may have a publisher and a subscription. Make both in __init__.',
        'The callback of the subscription gets the odd number, in msg.data. There the even one is '
        'made and published.',
        'even = Int16(), then even.data = msg.data + 1, then self.publisher.publish(even). No '
        'timer is needed.',
    ],
    answer=Solution(
        _EVENS,
        'The subscription gives the beat: for each message that comes, one goes out. The node '
        'does not know who publishes on /odds, nor who listens to /evens.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('successor')
publisher = node.create_publisher(Int16, '/evens', 10)
node.create_subscription(
    Int16, '/odds', lambda odd: publisher.publish(Int16(data=odd.data + 1)), 10
)
lab.spin(node)
""",
        ),
        Style(
            'a list and a timer',
            """
from rclpy.node import Node
from std_msgs.msg import Int16


class Postman(Node):
    def __init__(self):
        super().__init__('postman')
        self.waiting = []
        self.create_subscription(Int16, 'odds', self.waiting.append, 10)
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.create_timer(0.05, self.deliver)

    def deliver(self):
        while self.waiting:
            self.publisher.publish(Int16(data=self.waiting.pop(0).data + 1))


postman = lab.spin(Postman())
""",
        ),
        Style(
            'a thread that takes from a queue',
            """
import queue
import threading

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('worker')
publisher = node.create_publisher(Int16, 'evens', 10)
todo = queue.Queue()
node.create_subscription(Int16, 'odds', lambda msg: todo.put(msg.data), 10)


def work(todo, publisher):
    while rclpy.ok():
        publisher.publish(Int16(data=todo.get() + 1))


threading.Thread(target=work, args=[todo, publisher], daemon=True).start()
lab.spin(node)
""",
        ),
        Style(
            'a name that the lesson has used',
            changed(_EVENS, ("super().__init__('evens')", "super().__init__('announcer')")),
        ),
        Style(
            'an executor of its own, in a thread',
            changed(
                _EVENS,
                (
                    'from rclpy.node',
                    'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    'evens = lab.spin(Evens())\n',
                    'executor = MultiThreadedExecutor()\nexecutor.add_node(Evens())\n'
                    'threading.Thread(target=executor.spin, daemon=True).start()\n',
                ),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_EVENS))),
        Style(
            'own process',
            in_process(_EVENS),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'publishes the odd number',
            changed(_EVENS, ('msg.data + 1', 'msg.data')),
            'The number is passed on as it came.',
        ),
        Wrong(
            'counts by itself',
            changed(
                _EVENS,
                ("super().__init__('evens')\n", "super().__init__('evens')\n        self.n = 0\n"),
                ('even.data = msg.data + 1', 'self.n += 2\n        even.data = self.n'),
            ),
            'does not depend on the number that came',
        ),
        Wrong(
            'doubles',
            changed(_EVENS, ('msg.data + 1', 'msg.data * 2')),
            'The number is doubled.',
        ),
        Wrong(
            'publishes where it listens',
            changed(_EVENS, ("Int16, 'evens', 10", "Int16, 'odds', 10")),
            'The node hears what it says itself',
        ),
        Wrong(
            'other topic',
            changed(_EVENS, ("Int16, 'evens', 10", "Int16, 'even', 10")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'forgot to publish',
            changed(_EVENS, ('        self.publisher.publish(even)\n', '')),
            'its callback did not publish',
        ),
        Wrong(
            'no publisher',
            changed(
                _EVENS,
                ("        self.publisher = self.create_publisher(Int16, 'evens', 10)\n", ''),
                ('        self.publisher.publish(even)\n', ''),
            ),
            'create_publisher() for this topic has not been called',
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                _EVENS,
                ("        self.publisher = self.create_publisher(Int16, 'evens', 10)\n", ''),
                ('self.publisher.pub', "self.create_publisher(Int16, 'evens', 10).pub"),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'adds to the message',
            changed(_EVENS, ('msg.data + 1', 'msg + 1')),
            'A message object (Int16) is not the value in it.',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'adds a float',
            changed(_EVENS, ('msg.data + 1', 'msg.data + 1.0')),
            'takes values of type int',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'callback called',
            changed(_EVENS, ('self.on_odd, 10', 'self.on_odd(), 10')),
            'A callback is passed, not called',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'blocks in the callback',
            changed(
                _EVENS,
                ('    def on_odd(self, msg):\n', '    def on_odd(self, msg):\n        sleep(3)\n'),
                ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'answers twice',
            changed(
                _EVENS,
                (
                    '        self.publisher.publish(even)\n',
                    '        self.publisher.publish(even)\n        self.publisher.publish(even)\n',
                ),
            ),
            'A message is answered more than once.',
        ),
        Wrong(
            'passes on, and answers',
            changed(
                _EVENS,
                (
                    '        even = Int16()',
                    '        self.publisher.publish(msg)\n        even = Int16()',
                ),
            ),
            'What came in goes out as well',
        ),
        Wrong(
            'repeats its answer',
            changed(
                _EVENS,
                (
                    "super().__init__('evens')\n",
                    "super().__init__('evens')\n        self.even = Int16()\n"
                    '        self.timer = self.create_timer(0.2, self.on_timer)\n',
                ),
                (
                    '        even = Int16()\n        even.data = msg.data + 1\n'
                    '        self.publisher.publish(even)\n',
                    '        self.even.data = msg.data + 1\n\n'
                    '    def on_timer(self):\n        self.publisher.publish(self.even)\n',
                ),
            ),
            'a timer or a loop publishes it',
        ),
        Wrong(
            'only the first time',
            changed(
                _EVENS,
                (
                    "super().__init__('evens')\n",
                    "super().__init__('evens')\n        self.even = None\n",
                ),
                (
                    '        even = Int16()\n        even.data = msg.data + 1\n'
                    '        self.publisher.publish(even)\n',
                    '        self.even = self.even or Int16(data=msg.data + 1)\n'
                    '        self.publisher.publish(self.even)\n',
                ),
            ),
            'does not depend on the number that came',
        ),
        Wrong(
            'positive numbers only',
            changed(_EVENS, ('even.data = msg.data + 1', 'even.data = abs(msg.data) + 1')),
            'The sign of the number is lost.',
        ),
        Wrong(
            'ends after five',
            changed(
                _EVENS,
                (
                    "super().__init__('evens')\n",
                    "super().__init__('evens')\n        self.count = 0\n",
                ),
                (
                    '        even = Int16()\n',
                    '        self.count += 1\n        if self.count > 5:\n            return\n'
                    '        even = Int16()\n',
                ),
            ),
            # The five may be of the lesson's own nodes, before the check.
            'nothing on /evens',
        ),
        Wrong(
            'answers another topic, too',
            changed(
                _EVENS,
                (
                    "Int16, 'odds', self.on_odd, 10)\n",
                    "Int16, 'odds', self.on_odd, 10)\n"
                    "        self.create_subscription(Int16, 'ones', self.on_odd, 10)\n",
                ),
            ),
            'What comes on /ones is answered, too.',
        ),
        Wrong(
            'answers three seconds later',
            changed(
                _EVENS,
                (
                    "super().__init__('evens')\n",
                    "super().__init__('evens')\n        self.waiting = []\n"
                    '        self.create_timer(3.0, self.on_timer)\n',
                ),
                (
                    '        even = Int16()\n        even.data = msg.data + 1\n'
                    '        self.publisher.publish(even)\n',
                    '        self.waiting.append(msg.data)\n\n    def on_timer(self):\n'
                    '        for number in self.waiting:\n'
                    '            self.publisher.publish(Int16(data=number + 1))\n'
                    '        self.waiting.clear()\n',
                ),
            ),
            'The answers wait for a timer',
        ),
    ],
)
