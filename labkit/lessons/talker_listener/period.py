"""Exercise: change the period of a timer."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Publishes
from labkit.lessons._script import (
    in_process,
    started_by_asyncio,
    started_by_subprocess,
    two_copies,
)

__all__ = ['four_a_second']

STRING = 'std_msgs/msg/String'

_BEACON = """
from rclpy.node import Node
from std_msgs.msg import String


class Beacon(Node):
    period = 0.25  # in seconds

    def __init__(self):
        super().__init__('beacon')
        self.publisher = self.create_publisher(String, 'beacon', 10)
        self.timer = self.create_timer(self.period, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='I am here'))


if Beacon.period is not ...:
    beacon = lab.spin(Beacon())
"""


_INIT = "        super().__init__('beacon')\n"
_PUBLISH = "        self.publisher.publish(String(data='I am here'))\n"
_COUNT = (_INIT, f'{_INIT}        self.calls = 0\n')

_THREAD = """
import threading
import time

from rclpy.node import Node
from std_msgs.msg import String

node = Node('lighthouse')
publisher = node.create_publisher(String, 'beacon', 10)


def work(publisher):
    while True:
        time.sleep(0.25)
        try:
            publisher.publish(String(data='I am here'))
        except Exception:
            return


threading.Thread(target=work, args=(publisher,), daemon=True).start()
"""

four_a_second = Exercise(
    name='four_a_second',
    task='Set the period so that `Beacon` publishes on /beacon four times a second.',
    publishes={'/beacon': STRING},
    clauses=(Publishes('/beacon', 4.0, STRING),),
    hints=[
        'create_timer() takes a period: the seconds from one call to the next. It is no rate.',
        'Four calls in one second: how long does each of them have?',
        'The period is 1 divided by the rate: 1 / 4.',
    ],
    answer=Solution(
        _BEACON,
        'The rate is 4 Hz, which means four times a second. The period is 1 / rate, 0.25 s.',
    ),
    styles=[
        Style('a fraction', changed(_BEACON, ('0.25', '1 / 4'))),
        Style(
            'a loop with a rate, in a thread',
            """
import threading

import rclpy
from std_msgs.msg import String

node = lab.spin(rclpy.create_node('lighthouse'))
publisher = node.create_publisher(String, '/beacon', 10)


def work(node, publisher):
    rate = node.create_rate(4)
    for _ in range(600):
        publisher.publish(String(data='I am here'))
        rate.sleep()


threading.Thread(target=work, args=(node, publisher), daemon=True).start()
""",
        ),
        Style('a loop that sleeps, in a thread', _THREAD),
        Style(
            'a fast timer, and every fifth call counts',
            changed(
                _BEACON,
                _COUNT,
                ('0.25', '0.05'),
                (
                    _PUBLISH,
                    f'        self.calls += 1\n        if self.calls % 5 == 0:\n    {_PUBLISH}',
                ),
            ),
        ),
        Style(
            'a fast timer that looks at the clock',
            changed(
                _BEACON,
                (_INIT, f'{_INIT}        self.due = self.get_clock().now()\n'),
                ('0.25  #', '0.05  #'),
                (
                    _PUBLISH,
                    '        if self.get_clock().now() >= self.due:\n'
                    f'            self.due += Duration(seconds=0.25)\n    {_PUBLISH}',
                ),
                ('from rclpy.node', 'from rclpy.duration import Duration\nfrom rclpy.node'),
            ),
        ),
        Style(
            "a fast timer that looks at the computer's clock",
            changed(
                _BEACON,
                (_INIT, f'{_INIT}        self.due = time.monotonic()\n'),
                ('0.25  #', '0.05  #'),
                (
                    _PUBLISH,
                    '        if time.monotonic() >= self.due:\n'
                    f'            self.due += 0.25\n    {_PUBLISH}',
                ),
                ('from rclpy.node', 'import time\n\nfrom rclpy.node'),
            ),
        ),
        Style(
            'kept for those who come late, by a node with the name of another one',
            changed(
                _BEACON,
                ("__init__('beacon')", "__init__('talker')"),
                ("String, 'beacon', 10", "String, 'beacon', latched"),
                (
                    '\n\nclass',
                    '\nlatched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
                    '\n\n\nclass',
                ),
                (
                    'from rclpy.node import Node\n',
                    'from rclpy.node import Node\n'
                    'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
                ),
            ),
        ),
        Style(
            'in a namespace, remapped, with an executor of its own',
            """
import threading

from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

node = Node('reader', namespace='sea', cli_args=['--ros-args', '-r', 'light:=/beacon'])
publisher = node.create_publisher(String, 'light', 10)
node.create_timer(0.25, lambda: publisher.publish(String(data='I am here')))
executor = MultiThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
""",
        ),
        Style('own process', in_process(_BEACON), process=True),
        Style('own process, by subprocess', started_by_subprocess(in_process(_BEACON))),
        Style('own process, by asyncio', started_by_asyncio(in_process(_BEACON))),
        Style(
            'a command',
            """
import subprocess
import sys

options = ['--rate', '4', '--times', '600', '-w', '0']
message = ['/beacon', 'std_msgs/msg/String', '{data: I am here}']
process = subprocess.Popen([f'{sys.prefix}/bin/ros2', 'topic', 'pub', *options, *message])
""",
        ),
    ],
    wrong=[
        Wrong(
            'rate for period',
            changed(_BEACON, ('0.25', '4.0')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong('off by ten', changed(_BEACON, ('0.25', '0.025')), 'times too fast'),
        Wrong('half a second', changed(_BEACON, ('0.25', '0.5')), 'times too slow'),
        Wrong('five a second', changed(_BEACON, ('0.25', '0.2')), '1.25 times too fast'),
        Wrong('a third of a second', changed(_BEACON, ('0.25', '0.3')), '1.2 times too slow'),
        Wrong('a little too fast', changed(_BEACON, ('0.25', '0.24')), '1.04 times too fast'),
        Wrong(
            'twice each time',
            changed(_BEACON, (_PUBLISH, 2 * _PUBLISH)),
            'is publish() called twice',
        ),
        Wrong(
            'four at once, once a second',
            changed(
                _BEACON,
                ('0.25', '1.0'),
                (_PUBLISH, f'        for _ in range(4):\n    {_PUBLISH}'),
            ),
            'They come in bursts, or with pauses.',
        ),
        Wrong(
            'stops after a minute',
            changed(
                _BEACON,
                _COUNT,
                (
                    _PUBLISH,
                    f'        self.calls += 1\n        if self.calls <= 80:\n    {_PUBLISH}',
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'ends after forty',
            changed(
                _BEACON,
                _COUNT,
                (
                    _PUBLISH,
                    f'{_PUBLISH}        self.calls += 1\n        if self.calls == 40:\n'
                    '            self.timer.cancel()\n',
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'right at first, slower later',
            changed(
                _BEACON,
                _COUNT,
                (
                    _PUBLISH,
                    '        self.calls += 1\n'
                    f'        if self.calls < 60 or self.calls % 2:\n    {_PUBLISH}',
                ),
            ),
            ' on /beacon',
        ),
        Wrong(
            'a thread that sleeps too long',
            changed(_THREAD, ('0.25', '0.3')),
            'times too slow',
        ),
        Wrong(
            'another topic', changed(_BEACON, ("'beacon', 10", "'bacon', 10")), 'A slip of the pen'
        ),
        Wrong(
            'not spun', changed(_BEACON, ('lab.spin(Beacon())', 'Beacon()')), 'Hand the node over'
        ),
        Wrong(
            'decimal comma',
            changed(_BEACON, ('0.25', '0,25')),
            'the pair of 0 and 25',
            outcome=Outcome.ERROR,
            refused='A formatter writes a space after the comma.',
        ),
        Wrong(
            'two copies running',
            two_copies(_BEACON),
            'Two copies of the node run at once',
            process=True,
        ),
    ],
)
