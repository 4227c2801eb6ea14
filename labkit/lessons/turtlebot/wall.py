"""Exercise: stop in front of a wall, by the laser scan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.exercises import (
    Exercise,
    Fail,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons._script import in_process
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import (
    EMPTY,
    TWIST,
    Drive,
    drive,
    driver,
    expect_end,
    expect_stop,
    stands,
)
from labkit.lessons.turtlebot.mistakes import int_for_float
from labkit.sim.kinematics import BURGER

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['wall']

SCAN = 'sensor_msgs/msg/LaserScan'
# The walls of the robot's room stand so far from the origin, m.
WALL = 2.5
# The robot shall stop when the wall is nearer than 0.5 m. The scan comes every 0.2 s, and it
# drives at 0.2 m/s: it may have come a few centimetres nearer.
NEAREST, FARTHEST = 0.36, 0.56

_GUARD = """
import math

from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Empty

SIM_TIME = Parameter('use_sim_time', value=True)


class Guard(Node):
    def __init__(self):
        super().__init__('guard', parameter_overrides=[SIM_TIME])
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(LaserScan, 'scan', self.on_scan, qos_profile_sensor_data)
        self.create_subscription(Empty, 'go_wall', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.ahead = math.inf
        self.driving = False

    def on_scan(self, msg):
        self.ahead = min(msg.ranges[:10] + msg.ranges[-10:])

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


def _judge_wall(probe: Probe) -> str:
    source = driver(probe, '/go_wall')
    scan = expect.subscription(probe, '/scan', by=source.node)
    _expect_sensor_qos(scan)
    go = probe.sender('/go_wall', EMPTY)
    ends = []
    with observed() as drives:
        # Ahead is a wall in both; in the second one there is another to the right.
        for start, along in (((1.4, 0.0, 0.0), 'x'), ((2.1, 1.3, 1.5708), 'y')):
            found = drive(probe, source, start, lambda: go({}), until=stands(0.4), seconds=14.0)
            drives.append(found)
            ends.append(_judge_drive(found, getattr(found.end, along)))
    return f'It stopped {ends[0]:.2f} m and {ends[1]:.2f} m in front of the walls.'


def _expect_sensor_qos(scan: Endpoint) -> None:
    if scan.qos.reliability.name != 'BEST_EFFORT':
        raise Fail(
            '/scan with reliability best_effort',
            f'{scan.node} subscribes with reliability {scan.qos.reliability.name.lower()}',
            why='A sensor sends without waiting for receipts: best effort. A subscription that '
            'asks for receipts does not match it, and never hears it.',
            todo='Pass qos_profile_sensor_data in the place of the depth.',
        )


def _judge_drive(found: Drive, reached: float) -> float:
    """Return how far before the wall it stopped, m."""
    gap = WALL - reached - BURGER.scan_x
    expected = 'it drives on, and stops when something ahead is nearer than 0.5 m'
    seen = f'it drove {found.way():.2f} m, and the wall ahead is {gap:.2f} m away'
    if found.way() < 0.05:
        raise Fail(
            expected,
            seen,
            why='Something beside or behind the robot was taken for the wall ahead, or inf '
            'for a wall. ranges[0] looks ahead, and the next beams go round to the left.',
            todo='Look at the beams around index 0 only: msg.ranges[:10] and msg.ranges[-10:]',
        )
    if gap < NEAREST:
        if found.silent:
            expect_stop(found)
        raise Fail(
            expected,
            seen,
            why='It saw the wall too late, or looked elsewhere: ranges[0] looks ahead, '
            'ranges[180] back.',
            todo='Compare the nearest of the beams ahead with 0.5 m at each step.',
        )
    if gap > FARTHEST:
        expect_end(found)
        raise Fail(
            expected,
            seen,
            why='It stopped too early: by its odometry, by a beam that does not look ahead, or '
            'at another distance.',
            todo='Look at msg.ranges[:10] and msg.ranges[-10:], and compare with 0.5 m.',
        )
    expect_stop(found)
    return gap


wall = Exercise(
    name='wall',
    task='On /go_wall a node drives ahead and stops when the scan sees a wall nearer than 0.5 m.',
    subscribes={'/scan': SCAN, '/go_wall': EMPTY},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    judge=_judge_wall,
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
            changed(_GUARD, ('min(msg.ranges[:10] + msg.ranges[-10:])', 'msg.ranges[0]')),
        ),
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
            changed(_GUARD, ('min(msg.ranges[:10] + msg.ranges[-10:])', 'msg.ranges[180]')),
            'ranges[180] back',
        ),
        Wrong(
            'does not wait for the next sign',
            changed(_GUARD, ('        else:\n            self.driving = False\n', '')),
            'drives without being asked',
        ),
        Wrong(
            'another distance',
            changed(_GUARD, ('self.ahead > 0.5', 'self.ahead > 1.0')),
            'It stopped too early',
        ),
        int_for_float(_GUARD, '= 0.2', '= 1'),
    ],
)
