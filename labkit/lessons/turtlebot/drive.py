"""What the checks of this lesson share: put the robot somewhere, watch it drive, draw what it did.

All is read off `/cmd_vel` and `/odom`. The robot of the exercises runs faster than real time, so
times here are those of its clock: a command happened when the odometry before it was published.
"""

from __future__ import annotations

import math
import statistics
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import Fail, Probe, Watch, expect
from labkit.sim.kinematics import Pose, Twist2, yaw_from_quaternion

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = [
    'EMPTY',
    'ODOMETRY',
    'TWIST',
    'Drive',
    'describe',
    'drive',
    'driver',
    'expect_end',
    'expect_rate',
    'expect_stop',
    'is_zero',
    'stands',
]

TWIST = 'geometry_msgs/msg/Twist'
ODOMETRY = 'nav_msgs/msg/Odometry'
EMPTY = 'std_msgs/msg/Empty'
ROBOT = '/turtlebot'

Point = tuple[float, float]

# Commands below this stand still, m/s and rad/s.
ZERO = 1e-6
# How long a robot that was put somewhere may take to say so, s.
PLACED_SEC = 1.0
# How soon the first command comes; after this it is looked at what the callbacks do, s.
FIRST_SEC = 0.6
# How long it is looked whether somebody else drives, s, and how many messages of the odometry have
# to come meanwhile: 15 are 0.5 s by the robot's clock, enough for a scan and a command upon it.
QUIET_SEC = 0.05
QUIET_ODOMETRY = 15
# Walls are drawn that are nearer to the end of a drive than this, m.
NEAR_WALL = 0.8


@dataclass
class Drive:
    """One drive of the robot, as its topics told it.

    Attributes:
        poses: Each odometry: time by the robot's clock, and pose.
        commands: Each command: time by the robot's clock, and speeds.
        seen: For each command, the pose that was known when it was sent.
        sent: For each command, when it was sent, by the computer's clock.
        goals: Where it should come by, m.
        walls: What the scanner saw near its end, beam by beam, m; None where that was nothing.
        cut: Whether the check had no time to see its end.
    """

    poses: list[tuple[float, Pose]] = field(default_factory=list)
    commands: list[tuple[float, Twist2]] = field(default_factory=list)
    seen: list[Pose] = field(default_factory=list)
    sent: list[float] = field(default_factory=list)
    goals: Sequence[Point] = ()
    walls: Sequence[Point | None] = ()
    cut: bool = False

    @property
    def start(self) -> Pose:
        """Where it began."""
        return self.poses[0][1]

    @property
    def end(self) -> Pose:
        """Where it is now."""
        return self.poses[-1][1]

    @property
    def duration(self) -> float:
        """Seconds of the robot's clock, from the first odometry to the last."""
        return self.poses[-1][0] - self.poses[0][0]

    @property
    def moving(self) -> list[Twist2]:
        """The commands that do not say stop."""
        return [twist for _, twist in self.commands if not is_zero(twist)]

    @property
    def silent(self) -> bool:
        """Tell whether no command came in the last half second."""
        return self.poses[-1][0] - self.commands[-1][0] > 0.5

    def period(self, times: Sequence[float]) -> float:
        """Return the mean time from one moving command to the next, s; 0 if there are too few.

        Args:
            times: One for each command. The robot's clock is read off odometry, which comes every
                0.033 s: so the mean, and not the median.
        """
        moving = [
            time
            for time, (_, twist) in zip(times, self.commands, strict=True)
            if not is_zero(twist)
        ]
        gaps = [later - earlier for earlier, later in pairwise(moving)]
        # Without pauses, as between the sides of a square.
        usual = statistics.median(gaps) if gaps else 0.0
        return statistics.mean(gap for gap in gaps if gap <= 2.5 * usual) if gaps else 0.0

    @property
    def stopped(self) -> bool:
        """Tell whether the last command says stop."""
        return bool(self.commands) and is_zero(self.commands[-1][1])

    def way(self) -> float:
        """Return how far it drove, m."""
        return sum(math.dist(a[1][:2], b[1][:2]) for a, b in pairwise(self.poses))


def is_zero(twist: Twist2) -> bool:
    """Tell whether a command says stop."""
    return abs(twist.v) < ZERO and abs(twist.w) < ZERO


def driver(probe: Probe, topic: str) -> Endpoint:
    """Expect a node that subscribes to `topic` and publishes on /cmd_vel.

    Returns:
        Its publisher.
    """
    trigger = expect.subscription(probe, topic)
    return expect.publisher(probe, '/cmd_vel', by=trigger.node)


def drive(
    probe: Probe,
    source: Endpoint,
    start: tuple[float, float, float],
    send: Callable[[], object],
    *,
    until: Callable[[Drive], bool],
    seconds: float,
    goals: Sequence[Point] = (),
) -> Drive:
    """Put the robot somewhere, give the sign to start, and watch.

    Args:
        probe: The probe of the check.
        source: The learner's publisher on /cmd_vel.
        start: Where the robot is put: x and y in m, yaw in rad.
        send: Gives the sign.
        until: Looked at again and again: whether enough was seen.
        seconds: How long to watch at most, by the robot's clock.
        goals: Where it should come by, for the picture, m.
    """
    robot = _robot(probe)
    odometry, commands = probe.watch('/odom', ODOMETRY), probe.watch('/cmd_vel', TWIST)
    robot.place(*start)
    _expect_nobody_drives(probe, odometry, commands, source)
    # It may have been moved since, by a command that was on its way.
    robot.place(*start)
    heard = len(odometry)
    probe.wait(lambda: len(odometry) > heard + 2, PLACED_SEC)
    skip_poses, skip_commands = len(odometry), len(commands)
    found = Drive(goals=goals)

    def look() -> bool:
        _read(found, odometry.samples[skip_poses - 1 :], commands.samples[skip_commands:])
        return bool(found.poses) and (found.duration > seconds or until(found))

    send()
    if not probe.wait(lambda: len(commands) > skip_commands, FIRST_SEC):
        expect.hanging(probe)
    found.cut = not probe.wait(look)
    if not found.commands:
        _explain_no_command(probe, source)
    found.walls = _walls(robot.simulator, found.end)
    return found


def _read(found: Drive, odometry: Sequence[Any], commands: Sequence[Any]) -> None:
    """Take what has come since the last time."""
    for sample in odometry[len(found.poses) :]:
        message = sample.message
        stamp, pose = message.header.stamp, message.pose.pose
        turn = pose.orientation
        yaw = yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)
        at = Pose(pose.position.x, pose.position.y, yaw)
        found.poses.append((stamp.sec + stamp.nanosec * 1e-9, at))
    stamps = [sample.stamp for sample in odometry[: len(found.poses)]]
    for sample in commands[len(found.commands) :]:
        before = max(bisect_right(stamps, sample.stamp) - 1, 0)
        twist = Twist2(sample.message.linear.x, sample.message.angular.z)
        found.commands.append((found.poses[before][0], twist))
        found.seen.append(found.poses[before][1])
        found.sent.append(sample.stamp)


def _walls(simulator: Any, pose: Pose) -> list[Point | None]:
    ranges, ahead = simulator.scan(), simulator.robot.scan_x
    eye = pose.x + ahead * math.cos(pose.yaw), pose.y + ahead * math.sin(pose.yaw)
    ends: list[Point | None] = []
    for beam, way in enumerate(ranges):
        angle = pose.yaw + math.tau * beam / len(ranges)
        end = eye[0] + way * math.cos(angle), eye[1] + way * math.sin(angle)
        ends.append(end if 0 < way < NEAR_WALL else None)
    return ends


def _robot(probe: Probe) -> Any:
    """Return the simulated robot of the exercises."""
    robot = probe.node_object(ROBOT)
    if (
        robot is None
        or not hasattr(robot, 'simulator')
        or not probe.node.count_publishers('/clock')
    ):
        raise Fail(
            'the robot of the exercises, which has a clock of its own',
            'a robot in real time' if robot is not None else 'no robot in this notebook',
            why='The check puts the robot somewhere and watches it drive. Your node is there, '
            'the robot is not.',
            todo='Run the cell again that says: robot = lab.spin(lab.Turtlebot(speed=8))',
        )
    return robot


def _expect_nobody_drives(
    probe: Probe, odometry: Watch, commands: Watch, source: Endpoint
) -> None:
    heard = len(odometry)
    probe.wait(lambda: False, QUIET_SEC)
    probe.wait(lambda: len(odometry) >= heard + QUIET_ODOMETRY, PLACED_SEC)
    moving = [m for m in commands if not is_zero(Twist2(m.linear.x, m.angular.z))]
    if moving:
        names = sorted({other.node for other in probe.publishers('/cmd_vel')})
        raise Fail(
            'a robot that nobody drives, before the sign to start is given',
            f'{len(moving)} commands on /cmd_vel, where {", ".join(names)} publish',
            why=f'{source.node} drives without being asked to, or another node does.',
            todo='Begin when the message comes. Another node of yours ends with lab.remove(...).',
        )


def _explain_no_command(probe: Probe, source: Endpoint) -> NoReturn:
    """Raise Fail with the likeliest reason why no command came."""
    expect.hanging(probe)
    expect.spun(probe, source)
    raise Fail(
        f'commands of {source.node} on /cmd_vel',
        'nothing, though the sign to start was given',
        why='The callback of the sign does not start anything, or the timer does not publish.',
        todo='Let the callback set what the timer looks at, and publish in the timer.',
    )


def expect_stop(found: Drive) -> None:
    """Expect that the last command says stop."""
    if found.stopped:
        return
    expected = 'a last command with all speeds 0.0'
    seen = f'the last command says {describe(found.commands[-1][1])}'
    if not found.silent:
        raise Fail(
            expected,
            f'{seen}, and more commands come',
            why='It does not end: it goes on to send commands that move the robot.',
            todo='When it is there: publish an empty Twist() once, and then nothing more.',
        )
    raise Fail(
        expected,
        seen,
        why='A robot obeys the last command that it heard. Whoever ends without a stop command '
        'leaves it driving.',
        todo='At the end publish an empty Twist(): all of its fields are 0.0.',
    )


def expect_end(found: Drive) -> None:
    """Expect that the check had the time to see the end of the drive."""
    if found.cut:
        raise Fail(
            'an end of the drive within the time of a check',
            f'after {found.duration:.1f} s of the clock of the robot it was still driving',
            why='It takes too long, or this computer is busy with something else, so that the '
            'clock of the robot is slow.',
            todo='Check again. If it stays: let it drive at 0.2 m/s, and turn at 1.5 rad/s.',
        )


def expect_rate(found: Drive) -> None:
    """Expect ten commands a second by the robot's clock."""
    period = found.period([time for time, _ in found.commands])
    real = found.period(found.sent)
    if not period or 0.07 <= period <= 0.14:
        return
    expected = 'a command every 0.1 s (10 Hz) by the clock of the robot'
    seen = f'a command every {period:.2g} s ({1 / period:.3g} Hz)'
    if period > 0.16 and 0.08 <= real <= 0.13:
        raise Fail(
            expected,
            seen,
            why='The node follows its own clock. The clock of this robot is eight times as fast.',
            todo="super().__init__('...', parameter_overrides=[SIM_TIME])",
        )
    if 0.02 <= period <= 0.05:
        raise Fail(
            expected,
            seen,
            why='The odometry comes 30 times a second, and its callback sends a command each '
            'time. So the sensor sets the rate of the control.',
            todo='Let the callback only keep the newest value, and publish in a timer of 0.1 s.',
        )
    raise Fail(
        expected,
        seen,
        why='The rate is set by the period of the timer, in seconds.',
        todo='create_timer(0.1, self.on_timer)',
    )


def describe(twist: Twist2) -> str:
    """Return a command in words."""
    return f'linear.x = {twist.v:.2f} m/s, angular.z = {twist.w:.2f} rad/s'


def stands(seconds: float) -> Callable[[Drive], bool]:
    """Return a condition: it was driven, and then neither commanded nor moved for so long, s."""

    def over(found: Drive) -> bool:
        since = found.poses[-1][0] - seconds
        driven = [time for time, twist in found.commands if not is_zero(twist)]
        if not driven or driven[-1] > since:
            return False
        past = [pose for time, pose in found.poses if time >= since]
        return all(math.dist(pose, found.end) < 1e-4 for pose in past)

    return over
