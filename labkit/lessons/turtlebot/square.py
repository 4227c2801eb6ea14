"""Exercise: drive a square."""

from __future__ import annotations

import math
from typing import NoReturn

from labkit.exercises import Exercise, Fail, Probe, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process
from labkit.lessons.turtlebot.drawing import observed
from labkit.lessons.turtlebot.drive import (
    EMPTY,
    TWIST,
    Drive,
    describe,
    drive,
    driver,
    expect_end,
    expect_rate,
    expect_stop,
    stands,
)
from labkit.lessons.turtlebot.mistakes import int_for_float, own_clock
from labkit.sim.kinematics import Motion, Pose
from labkit.views.arena_picture import two

__all__ = ['square']

SIDE = 0.4
# How far it may be off a corner, m.
NEAR = 0.1
# As long as that a command counts, s.
STEP_SEC = 0.1
# Not in the origin, and not along an axis: a square is one wherever it begins.
START = (0.1, -0.4, 0.3)
# Seen from the start: x ahead, y to the left, m.
CORNERS = ((0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE), (0.0, 0.0))
SECONDS = 22.0

_SQUARE = """
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Empty

SIM_TIME = Parameter('use_sim_time', value=True)


class Square(Node):
    def __init__(self):
        super().__init__('square', parameter_overrides=[SIM_TIME])
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Empty, 'go_square', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.plan = []

    def on_go(self, msg):
        side = 20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]
        turn = 10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]
        self.plan = 4 * (side + turn)

    def on_timer(self):
        if not self.plan:
            return
        v, w = self.plan.pop(0)
        msg = Twist()
        msg.linear.x, msg.angular.z = v, w
        self.publisher.publish(msg)


square = lab.spin(Square())
"""

_BY_ODOMETRY = """
import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.parameter import Parameter
from std_msgs.msg import Empty

node = rclpy.create_node(
    'by_odometry', parameter_overrides=[Parameter('use_sim_time', value=True)]
)
pub = node.create_publisher(Twist, '/cmd_vel', 10)
state = {'pose': None, 'todo': []}


def on_odometry(msg):
    q, p = msg.pose.pose.orientation, msg.pose.pose.position
    state['pose'] = p.x, p.y, 2 * math.atan2(q.z, q.w)


def on_go(msg):
    x, y, yaw = state['pose']
    corners = [(0.4, 0.0), (0.4, 0.4), (0.0, 0.4), (0.0, 0.0)]
    state['todo'] = [
        (x + a * math.cos(yaw) - b * math.sin(yaw), y + a * math.sin(yaw) + b * math.cos(yaw))
        for a, b in corners
    ]


def on_timer():
    if not state['todo']:
        return
    x, y, yaw = state['pose']
    dx, dy = state['todo'][0][0] - x, state['todo'][0][1] - y
    error = math.remainder(math.atan2(dy, dx) - yaw, math.tau)
    msg = Twist()
    if math.hypot(dx, dy) < 0.03:
        state['todo'].pop(0)
    elif abs(error) > 0.2:
        msg.angular.z = 2.0 * error
    else:
        msg.linear.x, msg.angular.z = 0.2, 2.0 * error
    pub.publish(msg)


node.create_subscription(Odometry, 'odom', on_odometry, 10)
node.create_subscription(Empty, 'go_square', on_go, 10)
node.create_timer(0.1, on_timer)
lab.spin(node)
"""


def _judge_square(probe: Probe) -> str:
    source = driver(probe, '/go_square')
    go = probe.sender('/go_square', EMPTY)
    corners = [_on_floor(corner) for corner in CORNERS[1:]]
    at_rest = stands(1.2)
    with observed() as drives:
        found = drive(
            probe,
            source,
            START,
            lambda: go({}),
            until=lambda found: _degrees(found) or at_rest(found),
            seconds=SECONDS,
            goals=corners,
        )
        drives.append(found)
        _judge_drive(found)
    away = math.dist(found.end[:2], found.start[:2])
    return f'A square of {found.way():.2f} m, closed to {away:.2f} m, in {found.duration:.0f} s.'


def _judge_drive(found: Drive) -> None:
    if _degrees(found):
        raise Fail(
            'turns of 90 degrees, which are 1.57 rad',
            describe(max(found.moving, key=lambda twist: abs(twist.w))),
            why='Its angles are degrees. ROS measures angles in radians, and turning rates in '
            'radians a second. The robot can turn at 2.84 rad/s at most.',
            todo='math.pi / 2 is a right angle.',
        )
    expect_rate(found)
    path = _from_start(found)
    # A busy computer holds commands up. Then what was commanded counts, and the drive may be off
    # twice as far.
    near_enough = 2 * NEAR if _is_square(_as_commanded(found)) else NEAR
    expected = (
        f'corners at {", ".join(f"({x}, {y})" for x, y in CORNERS[1:])} m, seen from the start'
    )
    after = 0
    for number, corner in enumerate(CORNERS[1:], start=1):
        near = [i for i in range(after, len(path)) if math.dist(path[i], corner) <= near_enough]
        if not near:
            if found.silent and number == 4:
                expect_stop(found)
            _refuse_corner(found, path[after:], number, corner, expected)
        after = near[0]
    if found.silent:
        expect_stop(found)
    if math.dist(path[-1], CORNERS[-1]) > near_enough:
        expect_end(found)
        raise Fail(
            'it ends where it began',
            f'it ends {math.dist(path[-1], CORNERS[-1]):.2f} m away from there',
            why='It goes on after the fourth side.' + _no_stop(found),
            todo='After the fourth side publish an empty Twist().',
        )
    expect_stop(found)


def _refuse_corner(
    found: Drive,
    path: list[tuple[float, float]],
    number: int,
    corner: tuple[float, float],
    expected: str,
) -> NoReturn:
    x, y = min(path, key=lambda point: math.dist(point, corner))
    mirrored = (corner[0], -corner[1])
    if number == 2 and any(math.dist(point, mirrored) <= NEAR for point in path):
        why, todo = (
            'It turns to the right. A positive angular.z turns to the left.',
            'msg.angular.z above 0',
        )
    elif number == 1:
        why, todo = (
            'The first side has another length, or it did not drive straight on.',
            'Way = speed times time: 0.2 m/s for 2 s, which is 20 steps of 0.1 s.',
        )
    elif number == 4:
        expect_end(found)
        why, todo = (
            'The fourth side is missing, or the corners are no right angles.',
            'Four times the same: a side, then a turn.',
        )
    else:
        why, todo = (
            'The turn is no right angle, or the side has another length. A right angle is '
            '1.57 rad.' + _no_stop(found),
            'Angle = turning rate times time: 1.57 rad/s for 1 s, which is 10 steps of 0.1 s.',
        )
    seen = f'it came no nearer to corner {number}, {corner}, than ({two(x)}, {two(y)})'
    raise Fail(expected, seen, why=why, todo=todo)


def _as_commanded(found: Drive) -> list[tuple[float, float]]:
    """Return the path of a robot that obeys each command for 0.1 s, seen from the start."""
    pose = Pose(0.0, 0.0, 0.0)
    path = [(pose.x, pose.y)]
    for _, twist in found.commands:
        pose = Motion(pose, twist).pose_at(STEP_SEC)
        path.append((pose.x, pose.y))
    return path


def _is_square(path: list[tuple[float, float]]) -> bool:
    """Tell whether a path comes by all corners, in their order, and ends at the last one."""
    after = 0
    for corner in CORNERS[1:]:
        near = [i for i in range(after, len(path)) if math.dist(path[i], corner) <= NEAR]
        if not near:
            return False
        after = near[0]
    return math.dist(path[-1], CORNERS[-1]) <= NEAR


def _degrees(found: Drive) -> bool:
    """Tell whether it was told to turn as no robot can."""
    return any(abs(twist.w) > 10 for twist in found.moving)


def _no_stop(found: Drive) -> str:
    return '' if found.stopped else ' And it ends without a stop command.'


def _on_floor(corner: tuple[float, float]) -> tuple[float, float]:
    """Return a corner in the frame of the odometry."""
    (x, y, yaw), (ahead, left) = START, corner
    c, s = math.cos(yaw), math.sin(yaw)
    return x + c * ahead - s * left, y + s * ahead + c * left


def _from_start(found: Drive) -> list[tuple[float, float]]:
    """Return the path as the robot saw it at the start: x ahead, y to the left."""
    start = found.start
    c, s = math.cos(start.yaw), math.sin(start.yaw)
    path = []
    for _, pose in found.poses:
        dx, dy = pose.x - start.x, pose.y - start.y
        path.append((c * dx + s * dy, c * dy - s * dx))
    return path


square = Exercise(
    name='square',
    task='On /go_square a node drives a square of 0.4 m to the left, and stops where it began.',
    subscribes={'/go_square': EMPTY},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    judge=_judge_square,
    hints=[
        'A square is four times the same: a side, then a turn of 90 degrees to the left.',
        'Way = speed * time. 0.2 m/s for 2 s are 0.4 m: 20 steps of 0.1 s. Angle = turning rate '
        '* time. 1.57 rad/s for 1 s are 90 degrees: 10 steps.',
        'Make a list of (v, w), one for each step, and let the timer take one at a time. '
        'Let it rest for some steps, (0.0, 0.0), after each side and each turn.',
    ],
    answer=Solution(
        _SQUARE,
        'Nothing is measured here: it relies on speed and time. By odometry it would be more '
        'exact, as in the exercise before.',
    ),
    styles=[
        Style('by odometry', _BY_ODOMETRY),
        Style('own process', in_process(_SQUARE), process=True),
    ],
    wrong=[
        Wrong(
            'degrees for radians', changed(_SQUARE, ('1.5708', '90.0')), 'Its angles are degrees'
        ),
        Wrong('to the right', changed(_SQUARE, ('1.5708', '-1.5708')), 'It turns to the right'),
        Wrong('turns too little', changed(_SQUARE, ('1.5708', '1.0')), 'no right angle'),
        Wrong(
            'sides too long',
            changed(_SQUARE, ('20 *', '35 *')),
            'the side has another length',
        ),
        Wrong('three sides', changed(_SQUARE, ('4 *', '3 *')), 'The fourth side is missing'),
        Wrong(
            'forgets to stop',
            changed(
                _SQUARE,
                ('4 * (side + turn)', '3 * (side + turn) + 17 * [(0.2, 0.0)]'),
            ),
            'leaves it driving',
        ),
        own_clock(_SQUARE),
        int_for_float(_SQUARE, '(0.0, 1.5708)', '(0, 1.5708)'),
    ],
)
