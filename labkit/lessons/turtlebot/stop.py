"""Exercise: stop the robot, whatever ends the node."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.lessons.turtlebot.drive import TWIST
from labkit.lessons.turtlebot.mistakes import int_for_float

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


def _judge_stop(probe: Probe) -> str:
    name = expect.node(probe, '/cruiser')
    source = expect.publisher(probe, '/cmd_vel', by=name)
    commands = expect.messages(probe, source, count=3, hz=10.0)
    expect.each(
        commands,
        'linear.x',
        lambda v: 0.05 <= v <= 0.22,
        expected='linear.x = 0.1 (m/s) while the node runs',
        why='A robot that does not move need not be stopped. And this one drives at most '
        '0.22 m/s.',
        todo='msg.linear.x = 0.1',
    )
    expect.ends_with_node(probe, source)
    watched = commands.values('linear.x')
    probe.wait(lambda: commands.values('linear.x')[-1] == 0.0, 0.3)
    watched = commands.values('linear.x')
    expect.that(
        watched[-1] == 0.0 and commands.values('angular.z')[-1] == 0.0,
        expected='a last command with linear.x = 0.0 and angular.z = 0.0',
        seen=f'the last command says linear.x = {watched[-1]!r}',
        why='The node ends without a word. The robot goes on with the last command until it gives '
        'up waiting, one second later.',
        todo='destroy_node() is called whatever ends the node. Publish an empty Twist() there, '
        'then call super().destroy_node().',
    )
    return f'{len(watched)} commands, and the last one says stop.'


stop = Exercise(
    name='stop',
    task='A node `cruiser` drives at 0.1 m/s, and its last command says stop, whatever ends it.',
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    nodes=['/cruiser'],
    judge=_judge_stop,
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
        Style('a script with finally', _SCRIPT, process=True),
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
            'The node ends without a word.',
            outcome=Outcome.FAIL,
        ),
        int_for_float(_CRUISER, '= 0.1', '= 1'),
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
