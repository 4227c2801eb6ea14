"""One drive of the robot: what is to be made, and how its topics told it."""

from __future__ import annotations

import math
import statistics
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from labkit.exercises.watch import Lived, Sample, Watch
from labkit.sim.kinematics import Pose, Twist2, wrap_angle, yaw_from_quaternion

__all__ = [
    'EMPTY',
    'ODOMETRY',
    'SCAN',
    'TAIL_SEC',
    'TWIST',
    'Command',
    'Drive',
    'EndOfDrive',
    'Point',
    'Trial',
    'command_of',
]

TWIST = 'geometry_msgs/msg/Twist'
ODOMETRY = 'nav_msgs/msg/Odometry'
SCAN = 'sensor_msgs/msg/LaserScan'
EMPTY = 'std_msgs/msg/Empty'

Point = tuple[float, float]

# After the last command that moves the robot it is looked on for so long, s.
TAIL_SEC = 2.0
# If no command has come so long after the sign to start, none will, s.
NONE_SEC = 1.5
# A command whose numbers are all below this says stop, m/s and rad/s.
ZERO = 1e-9
# A robot that has moved by less than this since the last odometry stands, m.
STANDS = 1e-5
# Fields of a Twist, in the order of a `Command`.
FIELDS = ('linear.x', 'linear.y', 'linear.z', 'angular.x', 'angular.y', 'angular.z')


@dataclass(frozen=True)
class Trial:
    """A drive that is to be made.

    Attributes:
        start: Where the robot is put: x and y in m, yaw in rad.
        fields: Fields of the message that gives the sign.
        goals: Where the robot should come by, m.
        from_start: Whether that, and all that is told, is seen from the start.
        short_sighted: Whether the scanner says 0.0 where it sees nothing.
    """

    start: tuple[float, float, float]
    fields: Mapping[str, Any] = field(default_factory=dict)
    goals: Sequence[Point] = ()
    from_start: bool = False
    short_sighted: bool = False


@dataclass(frozen=True)
class Command:
    """A command as it was sent.

    Attributes:
        at: When, in seconds since the drive is looked at.
        numbers: The six numbers of the Twist.
    """

    at: float
    numbers: tuple[float, ...]

    @property
    def v(self) -> float:
        """Speed ahead, m/s."""
        return self.numbers[0]

    @property
    def w(self) -> float:
        """Turning rate to the left, rad/s."""
        return self.numbers[5]

    @property
    def twist(self) -> Twist2:
        """Both of them."""
        return Twist2(self.v, self.w)

    @property
    def stops(self) -> bool:
        """Tell whether it says stop. Not if a number is none: a comparison with it is false."""
        return all(abs(number) < ZERO for number in self.numbers)

    @property
    def others(self) -> dict[str, float]:
        """The numbers that a robot with two wheels does not use, as far as they are not 0."""
        used = zip(FIELDS[1:5], self.numbers[1:5], strict=True)
        return {name: number for name, number in used if not abs(number) < ZERO}

    def __str__(self) -> str:
        numbers = {'linear.x': self.v, 'angular.z': self.w, **self.others}
        return ', '.join(f'{name} = {number:.4g}' for name, number in numbers.items())


@dataclass
class Drive:
    """One drive of the robot.

    Attributes:
        poses: Each odometry: time in s, and pose.
        commands: Each command.
        scans: Each scan: time in s, and the distances, m.
        sign: When the sign to start was given, s.
        number: The how manieth drive of the check it is, from 0.
        goals: Where it should come by, m, in the frame of `told`.
        from_start: Whether places are told as the robot saw them from its start.
        walls: What the scanner saw near its end, beam by beam, m; None where that was nothing.
        exact: Whether its times are exact. Else it was driven in real time.
        margin: How far its times may be off, s.
        slowness: How many times as long as told a thread of the check slept meanwhile, see `Naps`.
        late: How much longer it slept in the one case of ten that was held up least, s; 0 if the
            node is in another process, which is held up by other things.
        cut: Whether the check did not see its end.
    """

    poses: list[tuple[float, Pose]] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    scans: list[tuple[float, Sequence[float]]] = field(default_factory=list)
    sign: float = 0.0
    number: int = 0
    goals: Sequence[Point] = ()
    from_start: bool = False
    walls: Sequence[Point | None] = ()
    exact: bool = True
    margin: float = 1e-6
    slowness: float = 1.0
    late: float = 0.0
    cut: bool = False

    @property
    def start(self) -> Pose:
        """Where it began."""
        return self.poses[0][1]

    @property
    def end(self) -> Pose:
        """Where it is in the end."""
        return self.poses[-1][1]

    @property
    def duration(self) -> float:
        """Seconds from the sign to the last command."""
        end = self.commands[-1].at if self.commands else self.poses[-1][0]
        return max(end - self.sign, 0.0)

    @property
    def moving(self) -> list[Command]:
        """The commands up to the last one that does not say stop."""
        last = max((i for i, c in enumerate(self.commands) if not c.stops), default=-1)
        return self.commands[: last + 1]

    @property
    def ending(self) -> list[Command]:
        """The commands after that: all of them say stop."""
        return self.commands[len(self.moving) :]

    @property
    def gaps(self) -> list[float]:
        """The time from each command to the next one, s, until the first that ends the drive.

        Without the first one if that is short: a rate that has ticked before does not sleep, and
        the second command comes at once.
        """
        times = [command.at for command in self.commands[: len(self.moving) + 1]]
        gaps = [later - earlier for earlier, later in pairwise(times)]
        usual = statistics.median(gaps) if gaps else 0.0
        return gaps[1:] if len(gaps) > 3 and gaps[0] < usual / 2 else gaps

    @property
    def is_even(self) -> bool:
        """Tell whether commands come as evenly as only a timer that follows the time makes it."""
        times = [command.at for command in self.commands]
        gaps = self.gaps or [later - earlier for earlier, later in pairwise(times)]
        return len(gaps) > 3 and max(gaps) - min(gaps) < self.margin + 1e-6

    @property
    def period(self) -> float:
        """The usual time from one command to the next, s; 0 if there are too few."""
        gaps = self.gaps
        usual = statistics.median(gaps) if gaps else 0.0
        # Without pauses, as between the sides of a square.
        return statistics.mean(gap for gap in gaps if gap <= 1.5 * usual) if gaps else 0.0

    @property
    def meant(self) -> float:
        """The time from one command to the next where nothing was held up, s; 0 if too few.

        A thread may sleep longer than it was told to, on a busy machine much longer, and never
        shorter. What another thread slept too long at the same time is taken off.
        """
        gaps = sorted(self.gaps)
        return gaps[len(gaps) // 10] - self.late if gaps else 0.0

    def told(self, pose: Pose) -> Pose:
        """Return a pose in the frame in which verdict and picture tell it.

        Args:
            pose: Of the odometry.

        Returns:
            The same; seen from the start, where the task is about that: x ahead, y to the left.
        """
        if not self.from_start:
            return pose
        (x, y, yaw), c, s = self.start, math.cos(self.start.yaw), math.sin(self.start.yaw)
        dx, dy = pose.x - x, pose.y - y
        return Pose(c * dx + s * dy, c * dy - s * dx, wrap_angle(pose.yaw - yaw))

    def way(self) -> float:
        """Return how far it drove, m."""
        return sum(math.dist(a[1][:2], b[1][:2]) for a, b in pairwise(self.poses))

    def seen(self, at: float, *, since: float = 0.0) -> list[Pose]:
        """Return the odometry that was the newest one at some time, and `since` seconds before."""
        times = [time for time, _ in self.poses]
        last = max(bisect_right(times, at) - 1, 0)
        first = max(bisect_right(times, at - since) - 1, 0)
        return [pose for _, pose in self.poses[first : last + 1]]

    def take(
        self, odometry: Sequence[Sample], commands: Sequence[Sample], scans: Sequence[Sample] = ()
    ) -> None:
        """Take what has come since it was called last.

        Args:
            odometry: All messages on /odom so far.
            commands: All messages on /cmd_vel so far.
            scans: All messages on /scan so far.
        """
        for sample in odometry[len(self.poses) :]:
            self.poses.append((_time(sample), _pose(sample.message)))
        for sample in commands[len(self.commands) :]:
            self.commands.append(command_of(sample))
        for sample in scans[len(self.scans) :]:
            self.scans.append((_time(sample), sample.message.ranges))


class EndOfDrive:
    """Whether a drive is over: nothing that moves was commanded for long, and the robot stands.

    Args:
        sign: When the sign to start was given, s.
        tail: How long nothing may have been commanded, s.
    """

    def __init__(self, sign: float, tail: float = TAIL_SEC) -> None:
        self._sign, self._tail = sign, tail
        self._seen = 0
        self._moved: float | None = None
        self._first: float | None = None

    def __call__(self, now: float, watches: Mapping[str, Watch]) -> bool:
        """Look at what has come until now, and tell."""
        commands, odometry = watches['/cmd_vel'].samples, watches['/odom'].samples
        new, self._seen = commands[self._seen :], len(commands)
        if now < self._sign:
            return False
        if new and self._first is None:
            self._first = now
        if any(not command_of(sample).stops for sample in new):
            self._moved = now
        if self._moved is None:
            # It may say stop first, and drive then.
            return now > max(self._sign, self._first or 0.0) + NONE_SEC
        if now < self._moved + self._tail or len(odometry) < 2:
            return False
        before, last = (_pose(sample.message) for sample in odometry[-2:])
        return math.dist(before, last) < STANDS


def command_of(sample: Sample) -> Command:
    """Return a message on /cmd_vel as a command."""
    linear, angular = sample.message.linear, sample.message.angular
    numbers = linear.x, linear.y, linear.z, angular.x, angular.y, angular.z
    return Command(_time(sample), numbers)


def _time(sample: Sample) -> float:
    return sample.at if isinstance(sample, Lived) else sample.stamp


def _pose(message: Any) -> Pose:
    pose = message.pose.pose
    turn = pose.orientation
    yaw = yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)
    return Pose(pose.position.x, pose.position.y, yaw)
