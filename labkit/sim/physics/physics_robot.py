"""The robot in a world with physics: it has motors, wheels that slip, and a weight."""

from __future__ import annotations

import math

import numpy as np

from labkit.errors import LabError
from labkit.sim.kinematics import (
    STANDING,
    Motion,
    Pose,
    Twist2,
    twist_of_wheels,
    wheel_speeds,
    yaw_from_quaternion,
)
from labkit.sim.parts import WHEELS, description
from labkit.sim.physics.mjcf import ICE_THICKNESS
from labkit.sim.physics.mujoco_world import MOST_BEHIND, PhysicsWorld, yard
from labkit.sim.simulator import GRAVITY, Simulator
from labkit.sim.world import Contact, Post, Wall, World
from labkit.transforms.rotations import Quaternion, Vector, inverse, rotated

__all__ = ['PhysicsSimulator']

ROOT = 'base_footprint'
# Slower than this it stands, m/s and rad/s: a robot at rest trembles a little.
STILL = 1e-3
# A contact that comes again sooner than this is the same one: it trembles at a wall, s.
APART = 1.0
# From here on it has tipped over: its own z axis points down, or nearly so.
TIPPED = math.cos(math.radians(60))


class PhysicsSimulator(Simulator):
    """A robot in a world with physics. Time passes only in `step`, for all that is in the world.

    Its motors follow a command as those of `Simulator` do; what comes of it, physics says.
    Odometry believes the wheels. It has no model of slip: slip happens.

    Args:
        world: Its world; `yard()` if None. A `World` becomes one without crates.
        **options: As for `Simulator`.

    Attributes:
        physics: Its world.

    Raises:
        LabError: As for `Simulator`; or MuJoCo is not there.
    """

    def __init__(self, world: PhysicsWorld | World | None = None, **options: object) -> None:
        if world is None:
            world = yard()
        self.physics = world if isinstance(world, PhysicsWorld) else PhysicsWorld(world)
        self._touched: dict[int, float] = {}
        super().__init__(self.physics.plan, **options)  # type: ignore[arg-type]
        self.physics.join(self, description(), WHEELS)
        self.place(self.pose)

    # -- where it is ----------------------------------------------------------------------------

    @property
    def world(self) -> World:
        """What the camera sees: the walls, posts and robots of its world, and its crates."""
        return self.physics.seen()

    @world.setter
    def world(self, plan: World) -> None:
        assert plan is self.physics.plan

    def place(self, start: Pose | tuple[float, float, float]) -> None:
        """Move the robot to a pose, at rest on its wheels; its odometry agrees.

        Raises:
            LabError: As for `Simulator`; or a crate is in the way.
        """
        x, y, _ = start
        for pose, crate in zip(self.physics.crate_poses(), self.physics.crates, strict=True):
            room = math.hypot(pose.x - x, pose.y - y) - crate.size * math.sqrt(0.5)
            if room < self.robot.radius:
                raise LabError(
                    f'The robot needs {self.robot.radius} m of room around it, but a crate is at '
                    f'x={pose.x:.2f}, y={pose.y:.2f}.',
                    todo='Let it start further away, or put the crates back: '
                    'robot.simulator.physics.reset()',
                )
        super().place(start)
        self._wanted = STANDING
        self._touched = {}
        if not self.physics.has(self):
            return  # it is being made
        data = self.physics.data
        root = data.joint(f'{self.name}:root')
        half = self.pose.yaw / 2
        # It drops by a millimetre, so that it does not begin inside of ice.
        root.qpos[:] = (
            self.pose.x,
            self.pose.y,
            ICE_THICKNESS,
            math.cos(half),
            0.0,
            0.0,
            math.sin(half),
        )
        root.qvel[:] = 0
        for wheel in WHEELS:
            joint = data.joint(f'{self.name}:{wheel}')
            joint.qpos[:] = joint.qvel[:] = 0
            data.actuator(f'{self.name}:{wheel}').ctrl[:] = 0
        self.physics.forward()
        self._turned: tuple[float, ...] = (0.0, 0.0)
        self._looked = self.physics.time, (0.0, 0.0, 0.0)
        self._force = (0.0, 0.0, GRAVITY)
        self._look()

    def enter(
        self,
        world: PhysicsWorld | World,
        start: Pose | tuple[float, float, float] | None = None,
    ) -> None:
        """Take the robot, at rest, out of its world and into another one.

        Args:
            world: The other one. A `World` becomes one without crates.
            start: Where it is put there; where it was if None.
        """
        self.close()
        self.physics = world if isinstance(world, PhysicsWorld) else PhysicsWorld(world)
        self.physics.join(self, description(), WHEELS)
        self.place(self.pose if start is None else start)

    def close(self) -> None:
        """Remove the robot from its world."""
        self.physics.leave(self)
        super().close()

    @property
    def height(self) -> float:
        """How far `base_footprint` is above the floor, m."""
        return self._height

    @property
    def orientation(self) -> Quaternion:
        """The true turn in the world: a quaternion (x, y, z, w)."""
        return self._orientation

    @property
    def angular_velocity(self) -> Vector:
        """The turning rates about the robot's own axes, rad/s."""
        return self._turning

    @property
    def specific_force(self) -> Vector:
        """What an accelerometer in the middle of the axle measures, on average lately, m/s²."""
        return self._force

    has_physics = True
    _height = 0.0
    _turning: Vector = (0.0, 0.0, 0.0)
    _force: Vector = (0.0, 0.0, GRAVITY)
    # When it was looked at last, s, and its speed then along the axes of the world, m/s.
    _looked: tuple[float, Vector] = (0.0, (0.0, 0.0, 0.0))
    _orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)

    @property
    def real_time_factor(self) -> float:  # type: ignore[override]
        """How many seconds of its world this machine computes in one; see `PhysicsWorld`."""
        return self.physics.real_time_factor

    def reset_world(self) -> None:
        """Put the crates back to where they began, at rest."""
        self.physics.reset()

    @property
    def tipped_over(self) -> bool:  # type: ignore[override]
        """Whether it lies on its side, or on its back."""
        up: float = rotated(self._orientation, (0.0, 0.0, 1.0))[2]
        return up < TIPPED

    @property
    def odometry_twist(self) -> Twist2:
        """Velocity estimated from the wheels."""
        return twist_of_wheels(*self.wheel_rates, self.robot)

    @property
    def wheel_rates(self) -> tuple[float, float]:
        """Speeds of the left and the right wheel by their encoders, rad/s."""
        left, right = self.physics.data.qvel[self._bound().wheel_speeds].tolist()
        return left * (1 + self.drift / 2), right * (1 - self.drift / 2)

    # -- time -----------------------------------------------------------------------------------

    def step(self, dt: float) -> None:
        """Advance the simulation by `dt` seconds.

        Several robots share the time of their world: it is the time of the one that is ahead. One
        that has stood still meanwhile, as in a check, goes on from there.

        Raises:
            LabError: `dt` is negative or not finite.
        """
        if not 0 <= dt < math.inf:
            raise LabError(f'dt must be a time in seconds, 0 or more, but it is {dt!r}.')
        if self.physics.time - self.time > MOST_BEHIND:
            self.time = self.physics.time
        end = self.time + dt
        self.physics.advance(end)
        # Its own time passes by commands, too; see `drive`.
        self.time = end

    @property
    def is_steady(self) -> bool:
        """Whether its motors keep their speed."""
        return self._wanted == self.target

    def drive(self, seconds: float) -> None:
        """Set the motors for the next piece of time: the speeds follow the command by ramps."""
        limits = self.robot.limits
        self._wanted = Twist2(
            _toward(self._wanted.v, self.target.v, limits.v_rate * seconds),
            _toward(self._wanted.w, self.target.w, limits.w_rate * seconds),
        )
        self.physics.data.ctrl[self._bound().motors] = wheel_speeds(self._wanted, self.robot)
        time = self.time
        self._pass(seconds)
        self.time = time

    def sense(self) -> None:
        """Look at what has become of the robot: encoders, pose, contacts."""
        before = self._turned
        self._turned = tuple(self.physics.data.qpos[self._bound().wheels].tolist())
        left = (self._turned[0] - before[0]) * (1 + self.drift / 2)
        right = (self._turned[1] - before[1]) * (1 - self.drift / 2)
        if self._slips:
            radius = self.robot.wheel_radius
            left, right = (
                slip.counted(turn * radius) / radius
                for slip, turn in zip(self._slips, (left, right), strict=True)
            )
        self.wheels = (self.wheels[0] + left, self.wheels[1] + right)
        arc = twist_of_wheels(left, right, self.robot)
        self.odometry = Motion(self.odometry, arc).pose_at(1.0)
        self._look()
        self._feel()

    def _look(self) -> None:
        """Read pose and velocity from the world."""
        data, bound = self.physics.data, self._bound()
        w, x, y, z = data.xquat[bound.body].tolist()
        # Of the two quaternions of a turn it is the one with w >= 0, as of the light robot.
        self._orientation = (x, y, z, w) if w >= 0 else (-x, -y, -z, -w)
        place_x, place_y, self._height = data.xpos[bound.body].tolist()
        yaw = yaw_from_quaternion(x, y, z, w)
        self.pose = Pose(place_x, place_y, yaw)
        speed = data.qvel[bound.speeds].tolist()
        self._turning = (speed[3], speed[4], speed[5])
        before, old = self._looked
        passed = self.physics.time - before
        self._looked = self.physics.time, (speed[0], speed[1], speed[2])
        if passed > 0:
            x, y, z = ((new - last) / passed for new, last in zip(speed, old, strict=False))
            back = inverse(self._orientation)
            self._force = rotated(back, (x, y, z + GRAVITY))
        ahead = speed[0] * math.cos(yaw) + speed[1] * math.sin(yaw)
        self.twist = STANDING if max(map(abs, speed)) < STILL else Twist2(ahead, speed[5])
        self._update_world()

    def _feel(self) -> None:
        """Note walls and posts that it has begun to touch."""
        data, bound = self.physics.data, self._bound()
        pairs = data.contact.geom
        own, fixed = bound.own[pairs], bound.fixed[pairs]
        felt = np.flatnonzero((own & fixed[:, ::-1]).any(axis=1))
        time = self.physics.time
        for number in felt.tolist():
            one, other = pairs[number].tolist()
            geom = other if bound.own[one] else one
            before = self._touched.get(geom, -math.inf)
            self._touched[geom] = time
            if time - before > APART:
                x, y, _ = data.contact.pos[number].tolist()
                self.collisions.append(Contact(time, x, y, bound.things[geom]))

    def _update_world(self) -> None:
        """Update where the robot is on the plan, for the cameras of the others."""
        self._post = Post(self.pose.x, self.pose.y, self.robot.radius)
        self.physics.plan.robots[self.name] = self._post

    def _bound(self) -> _Bound:
        """Return where its numbers are in the model of its world, which may be another one now."""
        if self._bound_to is None or self._bound_to.model is not self.physics.model:
            self._bound_to = _Bound(self.physics, self.name)
        return self._bound_to

    _bound_to: _Bound | None = None

    # -- sensors --------------------------------------------------------------------------------

    def scan(self) -> list[float]:
        """Return the ranges of a laser scan, m, beam by beam to the left; see `Simulator.scan`.

        The scanner looks where it stands: of a robot that is tilted, at the floor as well.
        """
        spec = self.robot
        world = self.physics
        own = self._bound().body
        turn = world.data.xmat[own].reshape(3, 3)
        eye = world.data.xpos[own] + turn @ np.array((spec.scan_x, 0.0, _SCAN_Z))
        angles = np.arange(spec.scan_beams) * (math.tau / spec.scan_beams)
        fan = np.stack((np.cos(angles), np.sin(angles), np.zeros_like(angles)), axis=1)
        rays = np.ascontiguousarray((fan @ turn.T).ravel())
        ranges = np.zeros(spec.scan_beams)
        hit = np.zeros(spec.scan_beams, np.int32)
        # Its own body is left out. Its wheels are below the beams.
        cutoff = spec.range_max + 1.0
        world.ray(
            *(world.model, world.data, eye, rays, None, True, own),
            *(hit, ranges, None, spec.scan_beams, cutoff),
        )
        ranges[hit < 0] = math.inf
        return self._measured(ranges)


class _Bound:
    """Where the numbers of a robot are in the model of its world.

    Attributes:
        model: The model.
        body: Number of its body.
        speeds: Where its velocity is: three numbers along the world's axes, m/s, and three about
            its own, rad/s.
        wheels: Where the angles of its wheels are, the left one first.
        wheel_speeds: Where their speeds are.
        motors: Where what is wanted of them is.
        own: Per shape in the world, whether it is one of the robot.
        fixed: Per shape, whether it is a wall or a post.
        things: Walls and posts by the numbers of their shapes.
    """

    def __init__(self, world: PhysicsWorld, name: str) -> None:
        model = self.model = world.model
        self.body = int(model.body(f'{name}:{ROOT}').id)
        start = int(model.joint(f'{name}:root').dofadr[0])
        self.speeds = slice(start, start + 6)
        joints = [model.joint(f'{name}:{wheel}') for wheel in WHEELS]
        self.wheels = np.array([joint.qposadr[0] for joint in joints])
        self.wheel_speeds = np.array([joint.dofadr[0] for joint in joints])
        self.motors = np.array([model.actuator(f'{name}:{wheel}').id for wheel in WHEELS])
        self.own = model.body_rootid[model.geom_bodyid] == self.body
        self.fixed = np.zeros(model.ngeom, bool)
        self.things: dict[int, Wall | Post] = {}
        named: dict[str, Wall | Post] = {
            **{f'wall{number}': wall for number, wall in enumerate(world.plan.walls)},
            **{f'post{number}': post for number, post in enumerate(world.plan.posts)},
        }
        for name_of_thing, thing in named.items():
            geom = int(model.geom(name_of_thing).id)
            self.fixed[geom], self.things[geom] = True, thing


# Height of the scanner above `base_footprint`, m, as in `burger.urdf`.
_SCAN_Z = 0.182


def _toward(value: float, target: float, most: float) -> float:
    return value + min(max(target - value, -most), most)
