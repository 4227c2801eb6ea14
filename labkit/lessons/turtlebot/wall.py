"""Exercise: stop in front of a wall, by the laser scan."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process
from labkit.lessons.turtlebot.clauses import Begins, Stops
from labkit.lessons.turtlebot.drive import EMPTY, SCAN, TWIST
from labkit.lessons.turtlebot.judge import driven
from labkit.lessons.turtlebot.mistakes import first_time_only, int_for_float
from labkit.lessons.turtlebot.wall_clauses import (
    SIGN,
    DrivesOn,
    Scans,
    Speed,
    StopsInTime,
    draw,
    tell,
)

__all__ = ['wall']

# The longest drive is 1 m, which takes 5 s.
SECONDS = 9.0

_GUARD = """
import math

from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Empty


class Guard(Node):
    def __init__(self):
        super().__init__('guard')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(LaserScan, 'scan', self.on_scan, qos_profile_sensor_data)
        self.create_subscription(Empty, 'go_wall', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.ahead = math.inf
        self.driving = False

    def on_scan(self, msg):
        # A distance of 0.0 means that the beam met nothing.
        ahead = [way for way in msg.ranges[:10] + msg.ranges[-10:] if way > 0.0]
        self.ahead = min(ahead, default=math.inf)

    def on_go(self, msg):
        self.driving = True

    def on_timer(self):
        if not self.driving:
            return
        msg = Twist()
        if self.ahead > 0.5:
            msg.linear.x = 0.2
        else:
            self.driving = False
        self.publisher.publish(msg)


guard = lab.spin(Guard())
"""


_CLAUSES = (
    Begins(SIGN, EMPTY),
    Scans(),
    Speed(),
    StopsInTime(),
    DrivesOn(),
    Stops(),
)

_LOOP = """
import math
import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Empty

node = lab.spin(rclpy.create_node('look_out'))
pub = node.create_publisher(Twist, '/cmd_vel', 10)
state = {'ahead': math.inf}
started = threading.Event()


def on_scan(msg):
    state['ahead'] = msg.ranges[0] or math.inf


def run():
    rate = node.create_rate(10)
    while True:
        started.wait()
        started.clear()
        while state['ahead'] >= 0.5:
            msg = Twist()
            msg.linear.x = 0.2
            pub.publish(msg)
            rate.sleep()
        pub.publish(Twist())


node.create_subscription(LaserScan, '/scan', on_scan, qos_profile_sensor_data)
node.create_subscription(Empty, '/go_wall', lambda msg: started.set(), 1)
threading.Thread(target=run, daemon=True).start()
"""

wall = Exercise(
    name='wall',
    task='On /go_wall a node drives ahead and stops when the scan sees a wall nearer than 0.5 m.',
    subscribes={'/scan': SCAN, '/go_wall': EMPTY},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=_CLAUSES,
    judge=driven((SIGN, EMPTY), _CLAUSES, draw, tell, seconds=SECONDS),
    hints=[
        'The scan has 360 distances. Number 0 looks ahead, number 90 to the left, 180 back.',
        'msg.ranges[:10] and msg.ranges[-10:] are the beams ahead. min() finds the nearest. A '
        'beam that meets nothing is inf, and that is far.',
        '/scan is best effort: subscribe with qos_profile_sensor_data.',
    ],
    answer=Solution(
        _GUARD,
        'The callback of the scan keeps one number, the timer decides ten times a second, and '
        'the last command says stop.',
    ),
    styles=[
        Style(
            'one beam',
            changed(_GUARD, ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[:1]')),
        ),
        Style(
            'in the callback of the scan',
            changed(
                _GUARD,
                ('        self.timer = self.create_timer(0.1, self.on_timer)\n', ''),
                ('default=math.inf)\n', 'default=math.inf)\n        self.on_timer()\n'),
            ),
        ),
        Style(
            'twenty commands a second, by the range of the sensor',
            changed(
                _GUARD,
                ('create_timer(0.1,', 'create_timer(0.05,'),
                ('if way > 0.0', 'if way >= msg.range_min'),
            ),
        ),
        Style('functions and a loop with a rate', _LOOP),
        Style('own process', in_process(_GUARD), process=True),
    ],
    wrong=[
        Wrong(
            'forgets to stop',
            changed(
                _GUARD,
                (
                    '            self.driving = False\n',
                    '            self.driving = False\n            return\n',
                ),
            ),
            'leaves it driving',
        ),
        Wrong(
            'reliable',
            changed(_GUARD, ('self.on_scan, qos_profile_sensor_data', 'self.on_scan, 10')),
            'A sensor sends without waiting for receipts',
        ),
        Wrong(
            'looks all round',
            changed(_GUARD, ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges')),
            'Something beside or behind the robot',
        ),
        Wrong(
            'looks back',
            changed(_GUARD, ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[180:181]')),
            'ranges[180] back',
        ),
        Wrong(
            'does not wait for the next sign',
            changed(_GUARD, ('        else:\n            self.driving = False\n', '')),
            'It stands, and still publishes',
        ),
        Wrong(
            'another distance',
            changed(_GUARD, ('self.ahead > 0.5', 'self.ahead > 1.0')),
            'It stopped too early',
        ),
        first_time_only(_GUARD, 'self.driving = True'),
        Wrong(
            '0.0 is a wall',
            changed(_GUARD, ('if way > 0.0', 'if way >= 0.0')),
            'A real scanner says 0.0 where a beam met nothing',
        ),
        Wrong('another speed', changed(_GUARD, ('= 0.2', '= 0.22')), 'It has another speed'),
        Wrong('backwards', changed(_GUARD, ('= 0.2', '= -0.2')), 'It drives backwards'),
        Wrong(
            'says it once',
            changed(
                _GUARD,
                (
                    '            msg.linear.x = 0.2\n',
                    '            msg.linear.x = 0.2\n            self.driving = False\n',
                ),
            ),
            'has to say so again and again',
        ),
        Wrong(
            'two commands a second',
            changed(_GUARD, ('create_timer(0.1,', 'create_timer(0.5,')),
            'has to say so again and again',
        ),
        Wrong('too near', changed(_GUARD, ('> 0.5', '> 0.4')), 'It saw the wall too late'),
        Wrong(
            'to the left',
            changed(_GUARD, ('msg.ranges[:10] + msg.ranges[-10:]', 'msg.ranges[80:100]')),
            'or looked elsewhere',
        ),
        int_for_float(_GUARD, '= 0.2', '= 1'),
    ],
)
