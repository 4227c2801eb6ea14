"""Exercise: go to a point, with the heading too."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process
from labkit.lessons.turtlebot.clauses import (
    Begins,
    DriveClause,
    Hears,
    Rate,
    Sensible,
    Stops,
    look_at_time,
)
from labkit.lessons.turtlebot.drive import ODOMETRY, TWIST, Drive, Point, Trial
from labkit.lessons.turtlebot.judge import driven
from labkit.lessons.turtlebot.mistakes import first_time_only, int_for_float
from labkit.sim.kinematics import wrap_angle

__all__ = ['go_to']

POSE2D = 'geometry_msgs/msg/Pose2D'
SIGN = '/goal'
# How near it has to come, and how much further off it may stand after braking, m.
NEAR, BRAKING = 0.05, 0.01
SECONDS = 14.0
# Goals are so far away, m.
WAY = (0.4, 0.5)
# Turning by less than this from the start is no decision, rad.
TURNED = 0.15

_GO_TO = """
import math

from geometry_msgs.msg import Pose2D, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node


class GoTo(Node):
    def __init__(self):
        super().__init__('go_to')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.create_subscription(Pose2D, 'goal', self.on_goal, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.x = self.y = self.yaw = 0.0
        self.goal = None

    def on_odometry(self, msg):
        self.x = msg.pose.pose.position.x
        self.y = msg.pose.pose.position.y
        q = msg.pose.pose.orientation
        self.yaw = 2 * math.atan2(q.z, q.w)

    def on_goal(self, msg):
        self.goal = msg

    def on_timer(self):
        if self.goal is None:
            return
        dx, dy = self.goal.x - self.x, self.goal.y - self.y
        error = math.atan2(dy, dx) - self.yaw
        error = math.atan2(math.sin(error), math.cos(error))
        msg = Twist()
        if math.hypot(dx, dy) < 0.05:
            self.goal = None
        else:
            msg.angular.z = 1.5 * error
            if abs(error) < 0.5:
                msg.linear.x = 0.2
        self.publisher.publish(msg)


go_to = lab.spin(GoTo())
"""


@dataclass(frozen=True)
class _Turns(DriveClause):
    """It turns to the goal on the shorter way."""

    @property
    def text(self) -> str:
        return 'turn towards its `x` and `y` on the shorter way'

    def look(self, found: Drive) -> None:
        goal, start = found.goals[0], found.start
        bearing = math.atan2(goal[1] - start.y, goal[0] - start.x)
        error = wrap_angle(bearing - start.yaw)
        turns = [wrap_angle(pose.yaw - start.yaw) for _, pose in found.poses]
        first = next((turn for turn in turns if abs(turn) > TURNED), 0.0)
        if first * error >= 0:
            return
        expected = (
            f'it turns by {error:.2f} rad, from its heading {start.yaw:.2f} rad to the direction '
            f'of the goal, {bearing:.2f} rad'
        )
        if abs(bearing - start.yaw) > math.pi:
            raise Fail(
                expected,
                'it turns the other way, the long way round',
                why='Two angles were subtracted, and the difference was not wrapped: '
                f'{bearing:.2f} - {start.yaw:.2f} = {bearing - start.yaw:.2f} rad is nearly a '
                'full turn.',
                todo='error = math.atan2(math.sin(error), math.cos(error))',
            )
        raise Fail(
            expected,
            f'it turns to the {"left" if first > 0 else "right"}, away from the goal',
            why='The sign is wrong: the error is the direction of the goal minus the heading, and '
            'a positive angular.z turns to the left.',
            todo='error = math.atan2(dy, dx) - self.yaw',
        )


@dataclass(frozen=True)
class _Arrives(DriveClause):
    """It stands near the goal in the end."""

    @property
    def text(self) -> str:
        return (
            f'stop within {SECONDS:.0f} s, with `x` and `y` up to {NEAR} m off ({BRAKING} m more '
            'for braking)'
        )

    def look(self, found: Drive) -> None:
        look_at_time(found, SECONDS)
        goal, end = found.goals[0], found.end
        away = math.dist(end[:2], goal)
        if not found.ending or away <= NEAR + BRAKING:
            return
        nearest = min(math.dist(pose[:2], goal) for _, pose in found.poses)
        why = 'It does not keep turning towards the goal, or stops before it is there.'
        if nearest <= NEAR:
            why = f'It came as near as {nearest:.2f} m, and drove on past the goal.'
        elif away < 4 * NEAR and found.ending:
            why = f'It stops too early: {NEAR} m are asked for.'
        raise Fail(
            f'it stands at x = {goal[0]:.2f} m, y = {goal[1]:.2f} m, up to {NEAR} m off',
            f'it came to x = {end.x:.2f} m, y = {end.y:.2f} m after {found.duration:.1f} s, '
            f'{away:.2f} m away',
            why=why,
            todo='At each step: distance and direction of the goal, seen from the newest '
            'odometry.',
        )


def _draw() -> list[Trial]:
    """Return three drives: to a side, to where the angle jumps from pi to -pi, to the other side.

    In the second one the shorter way leads across the jump.
    """
    side = random.choice((-1, 1))
    turn = random.uniform(0.5, 1.2)
    return [
        _trial(random.uniform(-0.6, 0.6), side * random.uniform(0.6, 1.4)),
        _trial(side * (math.pi - turn / 2), side * turn),
        _trial(random.uniform(-0.6, 0.6), -side * random.uniform(0.6, 1.4)),
    ]


def _trial(yaw: float, turn: float) -> Trial:
    x, y = random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4)
    way = random.uniform(*WAY)
    goal: Point = x + way * math.cos(yaw + turn), y + way * math.sin(yaw + turn)
    fields = {'x': goal[0], 'y': goal[1], 'theta': random.uniform(-3, 3)}
    return Trial((x, y, yaw), fields, goals=[goal])


def _tell(drives: Sequence[Drive]) -> str:
    away = [math.dist(found.end[:2], found.goals[0]) for found in drives]
    return f'It came to {", ".join(f"{d:.2f} m" for d in away)} from its goals, and stands.'


_CLAUSES = (
    Begins(SIGN, POSE2D),
    Hears('/odom', ODOMETRY, SIGN),
    Sensible(),
    _Turns(),
    Rate(),
    _Arrives(),
    Stops(),
)

go_to = Exercise(
    name='go_to',
    task='For each Pose2D on /goal a node drives the robot to that x and y, and stops there.',
    subscribes={'/odom': ODOMETRY, '/goal': POSE2D},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=_CLAUSES,
    judge=driven((SIGN, POSE2D), _CLAUSES, _draw, _tell, seconds=SECONDS),
    hints=[
        'dx and dy lead from the robot to the goal. math.hypot(dx, dy) is how far it is, '
        'math.atan2(dy, dx) is its direction.',
        'The error of the heading is the direction minus the yaw. Wrap it: '
        'math.atan2(math.sin(error), math.cos(error)).',
        'angular.z = 1.5 * error. Drive with linear.x = 0.2 only while the error is small. Nearer '
        'than 0.05 m: stop, and forget the goal.',
    ],
    answer=Solution(
        _GO_TO,
        'Each step looks anew at where the robot is, so that no mistake of an earlier step '
        'remains. This is feedback.',
    ),
    styles=[
        Style(
            'turns while it drives',
            changed(
                _GO_TO,
                ('            if abs(error) < 0.5:\n                msg', '            msg'),
                ('= 0.2', '= max(0.0, 0.2 * math.cos(error))'),
            ),
        ),
        Style(
            'backs up where that is shorter, never',
            changed(_GO_TO, ('1.5 * error', 'max(-2.0, min(2.0, 3.0 * error))')),
        ),
        Style(
            'by math.remainder, with a cosine',
            changed(
                _GO_TO,
                (
                    'math.atan2(math.sin(error), math.cos(error))',
                    'math.remainder(error, math.tau)',
                ),
                (
                    '            if abs(error) < 0.5:\n                msg.linear.x = 0.2\n',
                    '            msg.linear.x = 0.15 * max(0.0, math.cos(error)) ** 3\n',
                ),
            ),
        ),
        Style(
            'each tenth call of a fast timer',
            changed(
                _GO_TO,
                ('create_timer(0.1,', 'create_timer(0.01,'),
                (
                    '        self.goal = None\n\n',
                    '        self.goal = None\n        self.calls = 0\n\n',
                ),
                (
                    '        if self.goal is None:\n',
                    '        self.calls += 1\n        if self.goal is None or self.calls % 10:\n',
                ),
            ),
        ),
        Style('own process', in_process(_GO_TO), process=True),
    ],
    wrong=[
        Wrong(
            'sign of the error',
            changed(_GO_TO, ('1.5 * error', '-1.5 * error')),
            'The sign is wrong',
        ),
        Wrong(
            'degrees for radians',
            changed(_GO_TO, ('1.5 * error', '1.5 * math.degrees(error)')),
            'Its angles are degrees',
        ),
        Wrong(
            'not wrapped',
            changed(
                _GO_TO, ('        error = math.atan2(math.sin(error), math.cos(error))\n', '')
            ),
            'was not wrapped',
        ),
        Wrong(
            'forgets to stop',
            changed(
                _GO_TO,
                (
                    '            self.goal = None\n',
                    '            self.goal = None\n            return\n',
                ),
            ),
            'leaves it driving',
        ),
        Wrong(
            'never there',
            changed(_GO_TO, ('< 0.05', '< 0.0')),
            'goes on and on',
        ),
        first_time_only(_GO_TO, 'self.goal = msg'),
        Wrong(
            'odometry from another topic',
            changed(_GO_TO, ("Odometry, 'odom'", "Odometry, 'odometry'")),
            'subscription to /odom',
        ),
        Wrong(
            'eight commands a second',
            changed(_GO_TO, ('create_timer(0.1,', 'create_timer(0.125,')),
            'a command every 0.125 s (8 Hz)',
        ),
        Wrong('stops too early', changed(_GO_TO, ('< 0.05', '< 0.15')), 'It stops too early'),
        Wrong(
            'too slow',
            changed(_GO_TO, ('= 0.2', '= 0.02')),
            'after the message',
        ),
        Wrong(
            'stops on its way',
            changed(
                _GO_TO,
                (
                    '        self.goal = None\n\n',
                    '        self.goal = None\n        self.rests = 1\n\n',
                ),
                (
                    '        if math.hypot',
                    '        if math.hypot(dx, dy) < 0.3 and self.rests:\n'
                    '            self.rests = 0\n        elif math.hypot',
                ),
            ),
            'It stops on its way',
        ),
        Wrong(
            'a root of a number below 0',
            changed(
                _GO_TO,
                (
                    '= 1.5 * error',
                    "= 1.5 * error if dx else 0.0\n            msg.linear.z = float('nan')",
                ),
            ),
            'linear.z = nan',
        ),
        int_for_float(_GO_TO, '= 0.2', '= 1'),
    ],
)
