"""Exercise: go to a point, with the heading too."""

from __future__ import annotations

import math

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
    ODOMETRY,
    TWIST,
    Drive,
    drive,
    driver,
    expect_end,
    expect_rate,
    expect_stop,
    stands,
)
from labkit.lessons.turtlebot.mistakes import int_for_float, own_clock
from labkit.sim.kinematics import wrap_angle

__all__ = ['go_to']

POSE2D = 'geometry_msgs/msg/Pose2D'
NEAR = 0.1
SECONDS = 14.0
# Turning by less than this from the start is no decision, rad.
TURNED = 0.15

_GO_TO = """
import math

from geometry_msgs.msg import Pose2D, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.parameter import Parameter

SIM_TIME = Parameter('use_sim_time', value=True)


class GoTo(Node):
    def __init__(self):
        super().__init__('go_to', parameter_overrides=[SIM_TIME])
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


def _judge_go_to(probe: Probe) -> str:
    source = driver(probe, '/goal')
    expect.subscription(probe, '/odom', by=source.node)
    send = probe.sender('/goal', POSE2D)
    # The second goal lies where the angle jumps from pi to -pi.
    trials = (((0.0, 0.0, 0.0), (0.5, 0.3)), ((0.3, 0.2, 2.6), (-0.2, -0.05)))
    with observed() as drives:
        for start, goal in trials:
            found = drive(
                probe,
                source,
                start,
                lambda goal=goal: send({'x': goal[0], 'y': goal[1]}),  # type: ignore[misc]
                until=stands(0.4),
                seconds=SECONDS,
                goals=[goal],
            )
            drives.append(found)
            _judge_drive(found, goal)
    away = [
        math.dist(found.end[:2], goal) for found, (_, goal) in zip(drives, trials, strict=True)
    ]
    return f'It came to {away[0]:.2f} m and {away[1]:.2f} m from its goals, and stands.'


def _judge_drive(found: Drive, goal: tuple[float, float]) -> None:
    _expect_turn(found, goal)
    expect_rate(found)
    away = math.dist(found.end[:2], goal)
    if found.silent:
        expect_stop(found)
    if away > NEAR:
        expect_end(found)
        raise Fail(
            f'it comes to within {NEAR} m of x = {goal[0]} m, y = {goal[1]} m, in less than '
            f'{SECONDS:.0f} s',
            f'it came to x = {found.end.x:.2f} m, y = {found.end.y:.2f} m after '
            f'{found.duration:.0f} s, {away:.2f} m away',
            why='It does not keep turning towards the goal, or stops before it is there, or '
            'drives on past it.' + _degrees(found),
            todo='At each step: distance and direction of the goal, seen from the newest '
            'odometry.',
        )
    expect_stop(found)


def _expect_turn(found: Drive, goal: tuple[float, float]) -> None:
    """Expect that it turns to the goal on the shorter way."""
    start = found.start
    bearing = math.atan2(goal[1] - start.y, goal[0] - start.x)
    error = wrap_angle(bearing - start.yaw)
    turns = [wrap_angle(pose.yaw - start.yaw) for _, pose in found.poses]
    first = next((turn for turn in turns if abs(turn) > TURNED), 0.0)
    expected = (
        f'it turns by {error:.2f} rad, from its heading {start.yaw:.2f} rad to the direction of '
        f'the goal, {bearing:.2f} rad'
    )
    strong = [abs(twist.w) for _, twist in found.commands[:5]]
    if strong and max(strong) > 20 * abs(error):
        raise Fail(
            expected,
            f'angular.z = {max(strong):.0f} rad/s at the start',
            why=_degrees(found).strip() or 'The gain is much too high.',
            todo='Leave out math.degrees(): math.atan2() gives radians, and ROS wants them.',
        )
    if first * error >= 0:
        return
    if abs(bearing - start.yaw) > math.pi:
        raise Fail(
            expected,
            'it turns the other way, the long way round',
            why='Two angles were subtracted, and the difference was not wrapped: '
            f'{bearing:.2f} - {start.yaw:.2f} = {bearing - start.yaw:.2f} rad is nearly a full '
            'turn.',
            todo='error = math.atan2(math.sin(error), math.cos(error))',
        )
    raise Fail(
        expected,
        f'it turns to the {"left" if first > 0 else "right"}, away from the goal',
        why='The sign is wrong: the error is the direction of the goal minus the heading, and a '
        'positive angular.z turns to the left.',
        todo='error = math.atan2(dy, dx) - self.yaw',
    )


def _degrees(found: Drive) -> str:
    if max(abs(twist.w) for _, twist in found.commands) < 10:
        return ''
    return ' Its angles are degrees: angular.z of more than 10 rad/s is no turn of a robot.'


go_to = Exercise(
    name='go_to',
    task='For each Pose2D on /goal a node drives the robot to that x and y, and stops there.',
    subscribes={'/odom': ODOMETRY, '/goal': POSE2D},
    publishes={'/cmd_vel': TWIST},
    shared=['/cmd_vel'],
    judge=_judge_go_to,
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
            'It does not end',
        ),
        own_clock(_GO_TO),
        int_for_float(_GO_TO, '= 0.2', '= 1'),
    ],
)
