"""A simulated robot in a world: takes commands, moves through time, scans. No ROS."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from labkit.errors import LabError
from labkit.sim.command_timeout import COMMAND_TIMEOUT, as_limit
from labkit.sim.kinematics import (
    STANDING,
    Motion,
    Pose,
    Twist2,
    believed,
    ramp,
    twist_of_wheels,
    wheel_speeds,
    wrap_angle,
    yaw_to_quaternion,
)
from labkit.sim.robots import BURGER, Robot
from labkit.sim.slip import Slip
from labkit.sim.world import Contact, Post, World, playground
from labkit.transforms.rotations import Quaternion, Vector

__all__ = ['GRAVITY', 'Simulator']

# Standard gravity, m/s². Source: BIPM, "The International System of Units" (3rd CGPM, 1901).
GRAVITY = 9.80665
# A command beyond this is an error, m/s or rad/s. Degrees instead of radians are below it, and
# clipped to the limits as on the real robot.
MAX_SENSIBLE = 1000.0
# Longest interval of a search for a contact, s, so that a day without commands is one step.
LONGEST_PIECE = 1.0
# Speeds this close to the target have reached it, m/s or rad/s.
SAME_SPEED = 1e-12


class Simulator:
    """A robot in a world. Time passes only in `step`.

    The result does not depend on the size of the steps. With slip, odometry depends on it a
    little: as on a real robot, it is summed up from what the encoders count in each step.

    Args:
        world: The surroundings; `playground()` if None. Robots in the same world see each other.
        start: Initial pose.
        robot: Its dimensions.
        command_timeout: Time without a command after which it stops, s. With None it keeps its
            last velocity.
        drift: Odometry error: difference of the wheels' radii relative to their mean.
        slip: Odometry error: by how much each wheel turns too far on average, relative to its
            way; see `Slip`.
        noise: Standard deviation of a measured range, m.
        seed: Seed of the slip and of the noise.
        scan_nothing: Value of a beam without a measurement, inf or 0.0; see `scan`.
        name: Its name in the world; a robot of the same name is replaced.

    Attributes:
        time: Simulated time since the start, s.
        pose: True pose.
        twist: True velocity.
        acceleration: Its rate of change. Stopping at a wall does not count.
        target: The last command, clipped to the limits.
        timed_out: Whether it stands, or brakes, because its command timeout has passed.
        odometry: Pose estimated from the wheels.
        wheels: Angles of the left and the right wheel by their encoders, rad.
        collisions: Contacts it has driven into since it was placed, with their times.

    Raises:
        LabError: An argument is invalid, or there is no room at `start`.
    """

    def __init__(
        self,
        world: World | None = None,
        *,
        start: Pose | tuple[float, float, float] = Pose(),  # noqa: B008 - it can't be changed
        robot: Robot = BURGER,
        command_timeout: float | None = COMMAND_TIMEOUT,
        drift: float = 0.0,
        slip: float = 0.0,
        noise: float = 0.0,
        seed: int = 0,
        scan_nothing: float = math.inf,
        name: str = 'turtlebot',
    ) -> None:
        _check('drift', drift, abs(drift) < 1, 'a share such as 0.01')
        _check('slip', slip, 0 <= slip < 1, 'a share such as 0.01')
        _check('noise', noise, 0 <= noise < math.inf, 'a distance in metres, 0 or more')
        _check('seed', seed, seed >= 0 and seed == int(seed), 'a whole number, 0 or more')
        _check('scan_nothing', scan_nothing, scan_nothing in (math.inf, 0.0), 'inf or 0.0')
        self.world = world if world is not None else playground()
        self.robot = robot
        self.command_timeout = as_limit(command_timeout)
        self.drift = drift
        self.slip = slip
        self.noise = noise
        self.scan_nothing = scan_nothing
        self.name = name
        self.time = 0.0
        self._seed = seed
        self.place(start)

    def __repr__(self) -> str:
        x, y, yaw = self.pose
        return f'<Simulator {self.name!r}: x={x:.3f} y={y:.3f} yaw={yaw:.3f} t={self.time:.3f} s>'

    def place(self, start: Pose | tuple[float, float, float]) -> None:
        """Move the robot to a pose, at rest; its odometry agrees.

        Everything but the time is reset: what follows does not depend on earlier motion.

        Raises:
            LabError: The pose is outside the room, too near to a wall or a post, or not finite.
        """
        x, y, yaw = start
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(yaw)):
            raise LabError(f'x, y and yaw must be finite numbers, but they are {x}, {y}, {yaw}.')
        if self.world.is_outside(x, y):
            xs, ys = zip(*self.world.corners, strict=True)
            raise LabError(
                f'The room reaches from x={min(xs):.4g} to {max(xs):.4g} m and from '
                f'y={min(ys):.4g} to {max(ys):.4g} m, but x={x}, y={y} is outside of it.',
                todo=f'Choose a place inside, {self.robot.radius} m or more from walls and posts.',
            )
        # Another robot may be there: it is about to be replaced, or they drive apart.
        spare = min((t.away(x, y)[0] for t in self.world.fixed), default=math.inf)
        if spare < self.robot.radius:
            raise LabError(
                f'The robot needs {self.robot.radius} m of room around it, but at x={x}, y={y} '
                f'the next wall or post is {max(spare, 0.0):.3f} m away.',
                todo='Let it start further away from walls and posts.',
            )
        self.pose = self.odometry = Pose(x, y, wrap_angle(yaw))
        self.twist = self.target = self.acceleration = STANDING
        self.wheels = (0.0, 0.0)
        self.collisions: list[Contact] = []
        self.timed_out = False
        self._command_left = math.inf
        # The command with which it pushes against a fixed thing, in vain.
        self._blocked_command: Twist2 | None = None
        self._random = np.random.default_rng(self._seed)
        sources = np.random.SeedSequence(self._seed).spawn(2)
        self._slips = [Slip(self.slip, source) for source in sources] if self.slip else []
        self._update_world()

    def enter(self, world: World) -> None:
        """Take the robot, as it is, out of its world and into another one."""
        self.close()
        self.world = world
        self._blocked_command = None
        self._update_world()

    def close(self) -> None:
        """Remove the robot from its world, unless another of its name has replaced it."""
        if self.world.robots.get(self.name) is self._post:
            del self.world.robots[self.name]

    def command(self, v: float, w: float) -> bool:
        """Set the target speeds until the next command.

        Args:
            v: Speed along the heading, m/s.
            w: Turning rate, rad/s.

        Returns:
            Whether the command is valid. If it is not finite, or absurdly large, the robot stops.
        """
        # In this form NaN, for which every comparison is false, is refused too.
        sensible = abs(v) <= MAX_SENSIBLE and abs(w) <= MAX_SENSIBLE
        self.target = self.robot.limits.clip(Twist2(v, w)) if sensible else STANDING
        self._command_left = self.command_timeout
        self.timed_out = False
        return sensible

    def step(self, dt: float) -> None:
        """Advance the simulation by `dt` seconds.

        Raises:
            LabError: `dt` is negative or not finite.
        """
        if not 0 <= dt < math.inf:
            raise LabError(f'dt must be a time in seconds, 0 or more, but it is {dt!r}.')
        while dt > 0:
            dt -= self._advance(dt)

    def scan(self) -> list[float]:
        """Return the ranges of a laser scan, m, beam by beam to the left.

        With `scan_nothing=inf` nothing in range is +inf, and something too near -inf. With 0.0
        both are 0.0, as on the LDS-01 of a real TurtleBot3.
        Sources: REP 117, "Informational Distance Measurements" (ros.org/reps/rep-0117.html);
        hlds_laser_publisher.cpp (whole millimetres), and a scan of a real one in
        github.com/ROBOTIS-GIT/turtlebot3/issues/404.
        """
        if not self.world.things(self.name):
            return [self.scan_nothing] * self.robot.scan_beams
        return self._measured(self.world.ranges(self.pose, robot=self.robot, but=self.name))

    def _measured(self, ranges: NDArray[np.float64]) -> list[float]:
        """Return ranges as the scanner tells them: with noise, and within its limits."""
        if self.noise:
            ranges += self._random.normal(0.0, self.noise, len(ranges))
        ranges[ranges > self.robot.range_max] = math.inf
        ranges[ranges < self.robot.range_min] = -math.inf
        if self.scan_nothing != math.inf:
            ranges[np.isinf(ranges)] = self.scan_nothing
        numbers: list[float] = ranges.tolist()
        return numbers

    # What a world with physics adds; see `labkit.sim.physics`.
    has_physics = False
    tipped_over = False
    real_time_factor = math.inf

    def reset_world(self) -> None:
        """Put the things in the world back to where they began; here all stand still."""

    @property
    def height(self) -> float:
        """How far the middle of the axle's shadow, `base_footprint`, is above the floor, m."""
        return 0.0

    @property
    def orientation(self) -> Quaternion:
        """The true turn in the world: a quaternion (x, y, z, w)."""
        return yaw_to_quaternion(self.pose.yaw)

    @property
    def angular_velocity(self) -> Vector:
        """The true turning rates about the robot's own axes, rad/s."""
        return 0.0, 0.0, self.twist.w

    @property
    def specific_force(self) -> Vector:
        """What an accelerometer in the middle of the axle measures, m/s²: 1 g up at rest."""
        return self.acceleration.v, self.twist.v * self.twist.w, GRAVITY

    @property
    def odometry_twist(self) -> Twist2:
        """Velocity estimated from the wheels."""
        if self._slips:
            return twist_of_wheels(*self.wheel_rates, self.robot)
        return believed(self.twist, self.drift, self.robot)

    @property
    def wheel_rates(self) -> tuple[float, float]:
        """Speeds of the left and the right wheel by their encoders, rad/s."""
        left, right = wheel_speeds(believed(self.twist, self.drift, self.robot), self.robot)
        if self._slips:
            return left * self._slips[0].rate, right * self._slips[1].rate
        return left, right

    def _advance(self, dt: float) -> float:
        """Move until something changes: a target speed, a contact, the end of the command."""
        if self.twist == self.target == STANDING:
            # At rest, any duration is one step.
            self.acceleration = STANDING
            self._pass(dt)
            return dt
        if self.target == self._blocked_command:
            used = min(dt, self._command_left)
            self._pass(used)
            return used
        acceleration, change = ramp(self.twist, self.target, self.robot.limits)
        used = min(dt, self._command_left, LONGEST_PIECE, change)
        motion = Motion(self.pose, self.twist, acceleration)
        contact = self.world.first_contact(motion, used, self.robot.radius, but=self.name)
        if contact is None:
            self._move(motion, used)
        elif contact.time == 0 and self.twist == STANDING:
            # It pushes against something: time passes, the robot does not move.
            used = min(dt, self._command_left, LONGEST_PIECE)
            self.acceleration = STANDING
            if contact.thing in self.world.fixed:
                self._blocked_command = self.target
            self._pass(used)
        else:
            used = contact.time
            self._move(motion, used)
            if self.twist.v:
                self.collisions.append(contact._replace(time=self.time))
            self.twist = self.acceleration = STANDING
        return used

    def _move(self, motion: Motion, time: float) -> None:
        self._blocked_command = None
        acceleration = motion.acceleration
        steady = acceleration == STANDING
        mean = motion.twist if steady else motion.twist_at(time / 2)
        left, right = wheel_speeds(believed(mean, self.drift, self.robot), self.robot)
        left, right = left * time, right * time
        if self._slips:
            radius = self.robot.wheel_radius
            left, right = (
                slip.counted(turn * radius) / radius
                for slip, turn in zip(self._slips, (left, right), strict=True)
            )
        self.wheels = (self.wheels[0] + left, self.wheels[1] + right)
        self.pose = motion.pose_at(time)
        if self._slips:
            # The encoders tell how far each wheel came, and nothing of the way between: an arc.
            arc = twist_of_wheels(left, right, self.robot)
            self.odometry = Motion(self.odometry, arc).pose_at(1.0)
        elif self.drift:
            # For the wheels it is the same kind of motion, with other numbers.
            seen = believed(self.twist, self.drift, self.robot)
            change = believed(acceleration, self.drift, self.robot)
            self.odometry = Motion(self.odometry, seen, change).pose_at(time)
        else:
            self.odometry = self.pose
        self.acceleration = acceleration
        if not steady:
            v, w = motion.twist_at(time)
            self.twist = Twist2(
                self.target.v if abs(self.target.v - v) < SAME_SPEED else v,
                self.target.w if abs(self.target.w - w) < SAME_SPEED else w,
            )
        self._update_world()
        self._pass(time)

    def _pass(self, time: float) -> None:
        self.time += time
        self._command_left -= time
        if self._command_left <= 0:
            # One that was told to stop, or stands at a wall, has not been stopped by this.
            self.timed_out = STANDING not in (self.target, self.twist)
            self.target = STANDING
            self._command_left = math.inf

    def _update_world(self) -> None:
        """Update the robot's position in the world, for the other robots."""
        x, y, _ = self.pose
        self._post = Post(x, y, self.robot.radius)
        self.world.robots[self.name] = self._post


def _check(name: str, value: float, right: bool, expected: str) -> None:
    if not right:
        raise LabError(f'{name} must be {expected}, but it is {value!r}.')
