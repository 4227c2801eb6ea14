"""Exercise: change the period of a timer."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.lessons._script import in_process, two_copies

__all__ = ['four_a_second']

STRING = 'std_msgs/msg/String'

_BEACON = """
from rclpy.node import Node
from std_msgs.msg import String

period = 0.25  # in seconds


class Beacon(Node):
    def __init__(self):
        super().__init__('beacon')
        self.publisher = self.create_publisher(String, 'beacon', 10)
        self.timer = self.create_timer(period, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='I am here'))


if period is not ...:
    beacon = lab.spin(Beacon())
"""


def _judge_four_a_second(probe: Probe) -> str:
    source = expect.publisher(probe, '/beacon')
    watch = expect.messages(probe, source, count=4, hz=4.0, tolerance=0.25)
    return f'{source.node} publishes {expect.describe_rate(watch)}: 40 messages in 10 s.'


four_a_second = Exercise(
    name='four_a_second',
    task='Set the period so that `Beacon` publishes on /beacon four times a second.',
    publishes={'/beacon': STRING},
    judge=_judge_four_a_second,
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


def work():
    rate = node.create_rate(4)
    for _ in range(100):
        publisher.publish(String(data='I am here'))
        rate.sleep()


threading.Thread(target=work, daemon=True).start()
""",
        ),
        Style('own process', in_process(_BEACON), process=True),
    ],
    wrong=[
        Wrong('rate for period', changed(_BEACON, ('0.25', '4.0')), 'its period is 4 s'),
        Wrong('off by ten', changed(_BEACON, ('0.25', '0.025')), 'times too fast'),
        Wrong('half a second', changed(_BEACON, ('0.25', '0.5')), 'times too slow'),
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
