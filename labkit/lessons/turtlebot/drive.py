"""One drive of the robot: what is to be made, and how its topics told it."""

from __future__ import annotations

import math
import statistics
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from labkit.exercises.clauses import Evidence
from labkit.exercises.figures import figure
from labkit.exercises.history import Note
from labkit.exercises.messages_heard import Sample, Watch
from labkit.exercises.observation import Life
from labkit.sim.kinematics import Pose, wrap_angle, yaw_from_quaternion

if TYPE_CHECKING:
    from labkit.sim.physics.mujoco_world import PhysicsWorld

__all__ = [
    'EMPTY',
    'ODOMETRY',
    'SAME',
    'SCAN',
    'STEP_SEC',
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

# From one command to the next, s.
STEP_SEC = 0.1
# Numbers that differ by less are the same: times in s, speeds in m/s.
SAME = 1e-6
# A drive is over when nothing that moves the robot was commanded for the first time, s, or no
# command at all for the second time after the sign to start.
TAIL_SEC, NONE_SEC = 2.0, 1.5
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
        goals: As for `Drive`.
        from_start: As for `Drive`.
        nothing: What the scanner says where it sees nothing. It sees less far if that is not inf.
        walls: What else stands in the room, m: walls from (x1, y1) to (x2, y2),
        posts: and posts at (x, y) with a radius.
        make_world: Makes the world with physics in which it takes place; None in the usual room.
        drift: Error of the odometry there: see `Turtlebot`.
    """

    start: tuple[float, float, float]
    fields: Mapping[str, Any] = field(default_factory=dict)
    goals: Sequence[Point] = ()
    from_start: bool = False
    nothing: float = math.inf
    walls: Sequence[tuple[float, float, float, float]] = ()
    posts: Sequence[tuple[float, float, float]] = ()
    make_world: Callable[[], PhysicsWorld] | None = None
    drift: float = 0.0


@dataclass(frozen=True)
class Command:
    """A command as it was sent: when, s, and the six numbers of the Twist."""

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
        return ', '.join(f'{name} = {figure(number, 7)}' for name, number in numbers.items())


@dataclass
class Drive:
    """One drive of the robot; before the first one, what was found in the graph.

    Attributes:
        evidence: What was found.
        poses: Each odometry: time in s, and pose.
        commands: Each command.
        scans: Each scan: time in s, and the distances, m.
        sign: When the sign to start was given, s.
        number: How many drives of the check came before it.
        goals: Where it should come by, m, in the frame of `told`.
        from_start: Whether places are told as the robot saw them from its start.
        walls: What the scanner saw near its end, beam by beam, m; None where that was nothing.
        margin: How far its times may be off, s: a step of time, for a process of its own.
        cut: Whether the check did not see its end.
        true_poses: In a world with physics, where it really was: time in s, and pose.
        crate: And where the first crate was.
    """

    evidence: Evidence
    poses: Sequence[tuple[float, Pose]] = ()
    commands: Sequence[Command] = ()
    scans: Sequence[tuple[float, Sequence[float]]] = ()
    sign: float = 0.0
    number: int = 0
    goals: Sequence[Point] = ()
    from_start: bool = False
    walls: Sequence[Point | None] = ()
    margin: float = SAME
    cut: bool = False
    true_poses: list[tuple[float, Pose]] = field(default_factory=list)
    crate: list[tuple[float, Pose]] = field(default_factory=list)

    def take(self, life: Life) -> None:
        """Take what came while time passed."""
        self.poses = [(sample.at, _pose(sample.message)) for sample in life.on('/odom')]
        self.commands = [command_of(sample, sample.at) for sample in life.on('/cmd_vel')]
        self.scans = [(sample.at, sample.message.ranges) for sample in life.on('/scan')]

    @property
    def came(self) -> Sequence[tuple[float, Pose]]:
        """How it came along: what it believes, or what is so where that is another thing."""
        return self.true_poses or self.poses

    @property
    def start(self) -> Pose:
        """Where it began."""
        return self.came[0][1]

    @property
    def end(self) -> Pose:
        """Where it is in the end."""
        return self.came[-1][1]

    @property
    def duration(self) -> float:
        """Seconds from the sign to the last command."""
        end = self.commands[-1].at if self.commands else self.poses[-1][0]
        return max(end - self.sign, 0.0)

    @property
    def moving(self) -> Sequence[Command]:
        """The commands up to the last one that does not say stop."""
        last = max((i for i, c in enumerate(self.commands) if not c.stops), default=-1)
        return self.commands[: last + 1]

    @property
    def ending(self) -> Sequence[Command]:
        """The commands after that: all of them say stop."""
        return self.commands[len(self.moving) :]

    @property
    def gaps(self) -> list[float]:
        """The time from each command to the next one, s, until the first that ends the drive.

        Without the first one if that is shorter: a rate that has ticked before does not sleep, and
        the second command comes at once.
        """
        times = [command.at for command in self.commands[: len(self.moving) + 1]]
        gaps = [later - earlier for earlier, later in pairwise(times)]
        usual = statistics.median(gaps) if gaps else 0.0
        return gaps[1:] if len(gaps) > 3 and gaps[0] < usual else gaps

    def told(self, pose: Pose) -> Pose:
        """Return a pose in the frame in which verdict and picture tell it.

        Where the task is about that, it is seen from the start: x ahead, y to the left.
        """
        if not self.from_start:
            return pose
        (x, y, yaw), c, s = self.start, math.cos(self.start.yaw), math.sin(self.start.yaw)
        dx, dy = pose.x - x, pose.y - y
        return Pose(c * dx + s * dy, c * dy - s * dx, wrap_angle(pose.yaw - yaw))

    def way(self) -> float:
        """Return how far it drove, m."""
        return sum(math.dist(a[1][:2], b[1][:2]) for a, b in pairwise(self.came))

    def seen(self, at: float, *, since: float = 0.0) -> list[Pose]:
        """Return the odometry that was the newest one at some time, and `since` seconds before."""
        times = [time for time, _ in self.poses]
        last = max(bisect_right(times, at) - 1, 0)
        first = max(bisect_right(times, at - since) - 1, 0)
        return [pose for _, pose in self.poses[first : last + 1]]


class EndOfDrive:
    """Whether a drive is over: nothing that moves was commanded for long, and the robot stands.

    Args:
        sign: When the sign to start was given, s.
    """

    def __init__(self, sign: float) -> None:
        self._sign = self._first = sign
        self._seen = 0
        self._moved: float | None = None

    def __call__(self, now: float, watches: Mapping[str, Watch]) -> bool:
        """Look at what has come until now, and tell."""
        commands, odometry = watches['/cmd_vel'].samples, watches['/odom'].samples
        new = commands[self._seen :]
        if new and not self._seen:
            self._first = max(now, self._sign)
        self._seen = len(commands)
        if any(not command_of(sample).stops for sample in new):
            self._moved = now
        if now < self._sign:
            return False
        if self._moved is None:
            # It may say stop first, and drive then.
            return now > self._first + NONE_SEC
        if now < self._moved + TAIL_SEC or len(odometry) < 2:
            return False
        before, last = (_pose(sample.message) for sample in odometry[-2:])
        return math.dist(before, last) < STANDS


def command_of(sample: Sample | Note, at: float = 0.0) -> Command:
    """Return a message on /cmd_vel as a command."""
    linear, angular = sample.message.linear, sample.message.angular
    return Command(at, (linear.x, linear.y, linear.z, angular.x, angular.y, angular.z))


def _pose(message: Any) -> Pose:
    pose = message.pose.pose
    turn = pose.orientation
    yaw = yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)
    return Pose(pose.position.x, pose.position.y, yaw)
