"""Exercise: stop the robot, whatever ends the node."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import (
    Messages,
    Named,
    Publishes,
    often,
)
from labkit.exercises.life import live
from labkit.exercises.variants import varied
from labkit.lessons.turtlebot.drive import TWIST
from labkit.lessons.turtlebot.mistakes import int_for_float
from labkit.lessons.turtlebot.stop_clauses import NODE, SPEED, SaysStop, cruises

if TYPE_CHECKING:
    from labkit.exercises import Probe

__all__ = ['stop']


_CRUISER = """
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Cruiser(Node):
    def __init__(self):
        super().__init__('cruiser')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        msg = Twist()
        msg.linear.x = 0.1
        self.publisher.publish(msg)

    def destroy_node(self):
        self.publisher.publish(Twist())
        super().destroy_node()


cruiser = lab.spin(Cruiser())
"""
_STOP = """
    def destroy_node(self):
        self.publisher.publish(Twist())
        super().destroy_node()
"""
_SCRIPT = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
node = Node('cruiser')
publisher = node.create_publisher(Twist, 'cmd_vel', 10)


def drive():
    msg = Twist()
    msg.linear.x = 0.1
    publisher.publish(msg)


node.create_timer(0.1, drive)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
finally:
    publisher.publish(Twist())
    publisher.wait_for_all_acked()
    rclpy.shutdown()
"""


_USUAL = Exercise(
    name='stop',
    task='A node `cruiser` drives at 0.1 m/s, and its last command says stop, whatever ends it.',
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    nodes=['/cruiser'],
    clauses=(
        Named(NODE),
        Publishes('/cmd_vel', 10.0, TWIST, by=NODE),
        Messages(
            '/cmd_vel',
            f'each command says `linear.x` = {SPEED}, all else 0.0',
            cruises,
            by=NODE,
        ),
        SaysStop(),
    ),
    hints=[
        'Which method of a node is called when it is removed? You can write your own version.',
        'A new Twist() has 0.0 in all of its fields: it says stop.',
        'def destroy_node(self): publish Twist(), then super().destroy_node()',
    ],
    answer=Solution(
        _CRUISER,
        'lab.remove(), lab.stop() and the end of the kernel all call destroy_node(). In a script, '
        '`try: rclpy.spin(node)` with `finally:` does the same.',
    ),
    styles=[
        Style(
            'says stop twice',
            changed(
                _CRUISER,
                (
                    '        super().destroy_node()',
                    '        self.timer.cancel()\n'
                    '        self.publisher.publish(Twist())\n        super().destroy_node()',
                ),
            ),
        ),
        Style(
            'each fifth call of a fast timer',
            changed(
                _CRUISER,
                ('create_timer(0.1,', 'create_timer(0.02,'),
                (
                    '        self.publisher =',
                    '        self.calls = 0\n        self.publisher =',
                ),
                (
                    '    def on_timer(self):\n',
                    '    def on_timer(self):\n        self.calls += 1\n'
                    '        if self.calls % 5:\n            return\n',
                ),
            ),
        ),
        Style(
            'a thread with a rate',
            changed(
                _CRUISER,
                ('\nfrom geometry', '\nimport threading\n\nimport rclpy\nfrom geometry'),
                (
                    '        self.timer = self.create_timer(0.1, self.on_timer)\n',
                    '        self.rate = self.create_rate(10)\n'
                    '        self.driving = True\n'
                    '        self.thread = threading.Thread(target=self.drive, daemon=True)\n'
                    '        self.thread.start()\n\n'
                    '    def drive(self):\n'
                    '        while self.driving and rclpy.ok():\n'
                    '            self.on_timer()\n'
                    '            self.rate.sleep()\n',
                ),
                (
                    '    def destroy_node(self):\n',
                    '    def destroy_node(self):\n        self.driving = False\n'
                    '        self.rate.destroy()\n        self.thread.join(1.0)\n',
                ),
            ),
        ),
        Style('a script with finally', _SCRIPT, process=True),
        Style(
            'a script with a loop',
            changed(
                _SCRIPT,
                ('    rclpy.spin(node)\n', '    while True:\n        rclpy.spin_once(node)\n'),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong('forgets to stop', changed(_CRUISER, (_STOP, '')), 'The node ends without a word.'),
        Wrong(
            'stops too late',
            changed(
                _CRUISER,
                (
                    _STOP,
                    '\n    def destroy_node(self):\n        super().destroy_node()\n'
                    '        self.publisher.publish(Twist())\n',
                ),
            ),
            'destroy_node of /cruiser raised InvalidHandle',
            outcome=Outcome.ERROR,
        ),
        int_for_float(_CRUISER, '= 0.1', '= 1'),
        Wrong(
            'another name',
            changed(_CRUISER, ("__init__('cruiser')", "__init__('Cruiser')")),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'eight commands a second',
            changed(_CRUISER, ('create_timer(0.1,', 'create_timer(0.125,')),
            'a message every 0.125 s (8 Hz)',
        ),
        Wrong(
            'another speed',
            changed(_CRUISER, ('= 0.1\n', '= 0.15\n')),
            'The task asks for another speed',
        ),
        Wrong(
            'turns',
            changed(_CRUISER, ('= 0.1\n', '= 0.1\n        msg.angular.z = 0.1\n')),
            'linear.x is the speed ahead',
        ),
        Wrong(
            'a script with the signal handlers of rclpy',
            changed(
                _SCRIPT,
                ('rclpy.init(signal_handler_options=SignalHandlerOptions.NO)', 'rclpy.init()'),
                ('from rclpy.signals import SignalHandlerOptions\n', ''),
                ('    rclpy.shutdown()\n', '    rclpy.try_shutdown()\n'),
            ),
            'With Ctrl-C this handler shuts ROS down',
            process=True,
        ),
        Wrong(
            'publishes before the robot listens',
            changed(
                _CRUISER,
                (
                    '        self.timer = self.create_timer(0.1, self.on_timer)\n',
                    '        self.on_timer()\n',
                ),
            ),
            'nobody was there to hear it',
        ),
        Wrong(
            'a script that publishes before the robot listens',
            changed(_SCRIPT, ('node.create_timer(0.1, drive)', 'drive()')),
            'publish() was called too early',
            process=True,
        ),
        Wrong(
            'best effort',
            changed(
                _CRUISER,
                (
                    'import Node\n',
                    'import Node\nfrom rclpy.qos import qos_profile_sensor_data\n',
                ),
                ("'cmd_vel', 10", "'cmd_vel', qos_profile_sensor_data"),
            ),
            '/cruiser offers best effort',
        ),
        Wrong(
            'a second one drives on',
            changed(
                _CRUISER,
                ('(self):\n        super', "(self, name='cruiser'):\n        super"),
                ("__init__('cruiser')", '__init__(name)'),
                ('Cruiser())\n', "Cruiser())\nhelper = lab.spin(Cruiser('helper'))\n"),
            ),
            'The robot does what the newest command says',
        ),
        Wrong('does not move', changed(_CRUISER, ('= 0.1\n', '= 0.0\n')), 'need not be stopped'),
        Wrong(
            'a script without finally',
            changed(_SCRIPT, ('    publisher.publish(Twist())\n', '')),
            'The node ends without a word.',
            process=True,
        ),
    ],
    once=True,
)


def _variant(*, speed: float, hz: float) -> Exercise:
    code = changed(
        _CRUISER,
        ('create_timer(0.1,', f'create_timer({1 / hz:g},'),
        ('msg.linear.x = 0.1', f'msg.linear.x = {speed}'),
    )
    rate = often(hz).partition(' (')[0]
    return replace(
        _USUAL,
        task=f'A node `cruiser` drives at {speed} m/s, says so {rate}, and its last command says '
        'stop, whatever ends it.',
        clauses=(
            Named(NODE),
            Publishes('/cmd_vel', hz, TWIST, by=NODE),
            Messages(
                '/cmd_vel',
                f'each command says `linear.x` = {speed}, all else 0.0',
                partial(cruises, wanted=speed),
                by=NODE,
            ),
            SaysStop(),
        ),
        answer=Solution(code, _USUAL.answer.reason),
        styles=(),
        wrong=(),
    )


def _guess(probe: Probe) -> dict[str, float] | None:
    expect.publisher(probe, '/cmd_vel', by=NODE)
    samples = live(probe, {'/cmd_vel': TWIST}, 2.0, nodes=[NODE]).on('/cmd_vel')
    if len(samples) < 3 or samples[2].at == samples[1].at:
        return None
    hz = 1 / (samples[2].at - samples[1].at)
    return {'speed': round(samples[-1].message.linear.x, 6), 'hz': round(hz, 3)}


stop = varied(
    _USUAL,
    _variant,
    _guess,
    speed=[centimetres / 100 for centimetres in (5, 6, 7, 8, 9, *range(11, 22))],
    hz=(4.0, 5.0, 8.0),
)
