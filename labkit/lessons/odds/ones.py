"""Exercise: the number 1, without end."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Publishes, Says
from labkit.lessons._script import in_process, started_by_asyncio, started_by_subprocess

__all__ = ['ones']

INT16 = 'std_msgs/msg/Int16'

_ONES = """
from rclpy.node import Node
from std_msgs.msg import Int16


class Ones(Node):
    def __init__(self):
        super().__init__('ones')
        self.publisher = self.create_publisher(Int16, 'ones', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        msg = Int16()
        msg.data = 1
        self.publisher.publish(msg)


ones = lab.spin(Ones())
"""


def _explain(values: Sequence[int]) -> tuple[str, str]:
    if not any(values):
        return (
            'The message was published as it was made: its field data is 0 at first.',
            'Set the field before you publish: msg.data = 1',
        )
    if len(set(values)) > 1:
        return (
            'The number changes from message to message. Here it is the same each time.',
            'Write msg.data = 1 in the callback.',
        )
    return 'Another number is put into the message.', 'Write msg.data = 1'


ones = Exercise(
    name='ones',
    task='Publish the `Int16` 1 on /ones ten times a second, without end.',
    publishes={'/ones': INT16},
    clauses=(
        Publishes('/ones', 10.0, INT16),
        Says('/ones', 1, words='the number is always 1', explain=_explain),
    ),
    hints=[
        'The talker of the lesson "Talker and listener" does nearly the same. Its type is String, '
        'and its text changes.',
        'Four things are needed: a name for the node, create_publisher(Int16, ...), a timer with '
        'a period of 0.1 s, and a callback that publishes.',
        'In the callback: msg = Int16(), then msg.data = 1, then self.publisher.publish(msg).',
    ],
    answer=Solution(
        _ONES,
        'A rate of 10 Hz is a period of 0.1 s. The number goes into the field data: publish() '
        'takes a message, never a bare number.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('unity')
publisher = node.create_publisher(Int16, '/ones', 1)
message = Int16(data=1)
node.create_timer(1 / 10, lambda: publisher.publish(message))
lab.spin(node)
""",
        ),
        Style(
            'a loop with a rate, in a thread',
            """
import threading

import rclpy
from std_msgs.msg import Int16

node = lab.spin(rclpy.create_node('loop'))
publisher = node.create_publisher(Int16, 'ones', 10)


def work(publisher):
    rate = node.create_rate(10)
    for _ in range(600):
        publisher.publish(Int16(data=1))
        rate.sleep()


threading.Thread(target=work, args=[publisher], daemon=True).start()
""",
        ),
        Style(
            'a loop that sleeps, in a thread',
            """
import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('sleeper')
publisher = node.create_publisher(Int16, 'ones', 10)


def work(publisher):
    while rclpy.ok():
        publisher.publish(Int16(data=1))
        time.sleep(0.1)


threading.Thread(target=work, args=[publisher], daemon=True).start()
""",
        ),
        Style(
            'a fast timer, and every tenth call counts',
            changed(
                _ONES,
                (
                    "super().__init__('ones')\n",
                    "super().__init__('ones')\n        self.calls = 0\n",
                ),
                ('create_timer(0.1,', 'create_timer(0.01,'),
                (
                    '        msg = Int16()\n',
                    '        self.calls += 1\n        if self.calls % 10:\n            return\n'
                    '        msg = Int16()\n',
                ),
            ),
        ),
        Style(
            'a fast timer that looks at the clock',
            changed(
                _ONES,
                (
                    "super().__init__('ones')\n",
                    "super().__init__('ones')\n        self.due = self.get_clock().now()\n",
                ),
                ('create_timer(0.1,', 'create_timer(0.01,'),
                (
                    '        msg = Int16()\n',
                    '        if self.get_clock().now() < self.due:\n            return\n'
                    '        self.due += Duration(seconds=0.1)\n        msg = Int16()\n',
                ),
                ('from rclpy.node', 'from rclpy.duration import Duration\nfrom rclpy.node'),
            ),
        ),
        Style(
            "a fast timer that looks at the computer's clock",
            changed(
                _ONES,
                (
                    "super().__init__('ones')\n",
                    "super().__init__('ones')\n        self.due = time.monotonic()\n",
                ),
                ('create_timer(0.1,', 'create_timer(0.02,'),
                (
                    '        msg = Int16()\n',
                    '        if time.monotonic() < self.due:\n            return\n'
                    '        self.due += 0.1\n        msg = Int16()\n',
                ),
                ('from rclpy.node', 'import time\n\nfrom rclpy.node'),
            ),
        ),
        Style(
            'kept for those who come late',
            changed(
                _ONES,
                (
                    "create_publisher(Int16, 'ones', 10)",
                    "create_publisher(\n            Int16, 'ones', "
                    'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n        )',
                ),
                (
                    'from rclpy.node import Node\n',
                    'from rclpy.node import Node\n'
                    'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
                ),
            ),
        ),
        Style(
            'a name that the lesson has used, and a name that is remapped',
            """
from rclpy.node import Node
from std_msgs.msg import Int16

counter = Node('counter', cli_args=['--ros-args', '-r', 'number:=/ones'])
publisher = counter.create_publisher(Int16, 'number', 10)
counter.create_timer(0.1, lambda: publisher.publish(Int16(data=1)))
lab.spin(counter)
""",
        ),
        Style(
            'an executor of its own, in a thread',
            """
import threading

import rclpy
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Int16

node = rclpy.create_node('ones')
publisher = node.create_publisher(Int16, 'ones', 10)
node.create_timer(0.1, lambda: publisher.publish(Int16(data=1)))
executor = MultiThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
""",
        ),
        Style(
            'on the command line',
            "%ros2 topic pub --rate 10 /ones std_msgs/msg/Int16 '{data: 1}' &\n",
        ),
        Style('own process', in_process(_ONES), process=True),
        Style('own process, started here', started_by_subprocess(in_process(_ONES))),
        Style('own process, started by asyncio', started_by_asyncio(in_process(_ONES))),
    ],
    wrong=[
        Wrong(
            'capital letter',
            changed(_ONES, ("'ones', 10", "'Ones', 10")),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'in the namespace of the node',
            changed(_ONES, ("'ones', 10", "'~/ones', 10")),
            'it lies in another namespace',
        ),
        Wrong(
            'wrong type',
            changed(_ONES, ('Int16', 'Int32')),
            'A topic carries one type of message.',
        ),
        Wrong(
            'publishes a bare number',
            changed(_ONES, ('publish(msg)', 'publish(1)')),
            'publish() takes a message of the type that the publisher was made for, Int16',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'a text for a number',
            changed(_ONES, ('msg.data = 1', "msg.data = '1'")),
            'takes values of type int',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'field never set',
            changed(_ONES, ('        msg.data = 1\n', '')),
            'its field data is 0 at first',
        ),
        Wrong(
            'counts',
            changed(
                _ONES,
                ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
                ('msg.data = 1', 'self.n += 1\n        msg.data = self.n'),
            ),
            'The number changes from message to message.',
        ),
        Wrong(
            'self forgotten',
            changed(_ONES, ('self.publisher = ', 'publisher = ')),
            'Ones has nothing called publisher',
            outcome=Outcome.ERROR,
            refused='The variable is never used.',
        ),
        Wrong(
            'rate for period',
            changed(_ONES, ('create_timer(0.1,', 'create_timer(10,')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'ten times too fast',
            changed(_ONES, ('create_timer(0.1,', 'create_timer(0.01,')),
            'times too fast',
        ),
        Wrong(
            'a fifth too slow',
            changed(_ONES, ('create_timer(0.1,', 'create_timer(0.125,')),
            '1.25 times too slow',
        ),
        Wrong(
            'a quarter too fast',
            changed(_ONES, ('create_timer(0.1,', 'create_timer(0.08,')),
            '1.25 times too fast',
        ),
        Wrong(
            'ends after ten',
            changed(
                _ONES,
                ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
                (
                    '        msg = Int16()\n',
                    '        self.n += 1\n        if self.n == 10:\n'
                    '            self.timer.cancel()\n        msg = Int16()\n',
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'ten at once, each second',
            changed(
                _ONES,
                ('create_timer(0.1,', 'create_timer(1.0,'),
                (
                    '        self.publisher.publish(msg)\n',
                    '        for _ in range(10):\n            self.publisher.publish(msg)\n',
                ),
            ),
            'They come in bursts, or with pauses.',
        ),
        Wrong(
            'publishes twice',
            changed(
                _ONES,
                (
                    '        self.publisher.publish(msg)\n',
                    '        self.publisher.publish(msg)\n        self.publisher.publish(msg)\n',
                ),
            ),
            'Twice as many messages come as were asked for',
        ),
        Wrong(
            'right first, wrong later',
            changed(
                _ONES,
                ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
                ('msg.data = 1', 'self.n += 1\n        msg.data = 1 if self.n < 100 else 0'),
            ),
            'that were right',
        ),
        Wrong(
            'a single message',
            """
import rclpy
from std_msgs.msg import Int16

node = lab.spin(rclpy.create_node('ones'))
publisher = node.create_publisher(Int16, 'ones', 10)
publisher.publish(Int16(data=1))
""",
            'The node has no timer',
        ),
        Wrong(
            'not spun',
            changed(_ONES, ('lab.spin(Ones())', 'Ones()')),
            'Hand the node over: lab.spin(node)',
        ),
        Wrong(
            'a quarter too fast, in a process of its own',
            changed(in_process(_ONES), ('create_timer(0.1,', 'create_timer(0.08,')),
            'times too fast',
            process=True,
        ),
    ],
)
