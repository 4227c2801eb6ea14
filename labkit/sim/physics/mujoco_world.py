"""A world with physics, for one robot or several: it knows what is where, and steps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from labkit.descriptions.links_and_joints import Description
from labkit.errors import LabError, quoted
from labkit.sim.kinematics import Pose, yaw_from_quaternion
from labkit.sim.physics.mjcf import STEP, mjcf_of_robot, mjcf_of_world
from labkit.sim.physics.things import Crate, Ice, Ramp
from labkit.sim.world import Wall, World, room

if TYPE_CHECKING:
    import mujoco

__all__ = ['MOST_BEHIND', 'PhysicsWorld', 'Rider', 'has_mujoco', 'outline', 'yard']

# Steps between two looks at wheels and contacts, and at motors that change their speed.
CHUNK, SHORT = 16, 4
# A robot that is further behind than this has stood still, and goes on from now, s.
MOST_BEHIND = 0.1
# Over how much computed time the real-time factor is measured, s.
MEASURED = 1.0


class Rider(Protocol):
    """A robot in a world."""

    name: str
    time: float

    @property
    def is_steady(self) -> bool:
        """Whether its motors keep their speed."""

    def drive(self, seconds: float) -> None:
        """Set the motors for the next piece of time."""

    def sense(self) -> None:
        """Look at what has become of it."""


class PhysicsWorld:
    """Walls and posts that stand, crates that are pushed, ice, ramps, and robots.

    Args:
        plan: Walls and posts; a room of 5 m by 5 m if None.
        crates: Boxes that can be pushed.
        ice: Slippery parts of the floor.
        ramps: Slopes.

    Attributes:
        plan: Walls and posts, and the robots among them.
        time: How much time has passed in it, s.

    Raises:
        LabError: MuJoCo is not installed, or a number makes no sense.
    """

    def __init__(
        self,
        plan: World | None = None,
        *,
        crates: Iterable[Crate] = (),
        ice: Iterable[Ice] = (),
        ramps: Iterable[Ramp] = (),
    ) -> None:
        if plan is not None and not isinstance(plan, World):
            raise LabError(
                f'A plan is a World, with walls and posts, and this is {quoted(plan)}.',
                todo='PhysicsWorld(room(4.0, 4.0)), with room from labkit.sim.world',
            )
        self._mujoco = _mujoco()
        self.plan = plan if plan is not None else room()
        self.crates = tuple(Crate(*each) for each in crates)
        self.ice = tuple(Ice(*each) for each in ice)
        self.ramps = tuple(Ramp(*each) for each in ramps)
        things: tuple[Crate | Ice | Ramp, ...] = (*self.crates, *self.ice, *self.ramps)
        for thing in things:
            _check(thing)
        self.time = 0.0
        self._riders: dict[str, Rider] = {}
        self._parts: dict[str, tuple[str, str]] = {}
        self._computed = self._needed = 0.0
        self._factor = math.inf
        self._compile({})

    def __repr__(self) -> str:
        return (
            f'<PhysicsWorld: {len(self.plan.walls)} walls, {len(self.plan.posts)} posts, '
            f'{len(self.crates)} crates, {len(self.ice)} ice, {len(self.ramps)} ramps>'
        )

    # -- robots ---------------------------------------------------------------------------------

    def join(self, rider: Rider, robot: Description, wheels: tuple[str, str]) -> None:
        """Take a robot in, in the place of one of its name. All else stays where it is."""
        kept = self._state()
        kept = {name: each for name, each in kept.items() if not _is_of(name, rider.name)}
        self._parts[rider.name] = mjcf_of_robot(rider.name, robot, wheels)
        self._riders[rider.name] = rider
        rider.time = self.time
        self._compile(kept)

    def leave(self, rider: Rider) -> None:
        """Let a robot out, unless another one of its name has replaced it."""
        if self._riders.get(rider.name) is rider:
            del self._riders[rider.name], self._parts[rider.name]
            self._compile(self._state())

    def has(self, rider: Rider) -> bool:
        """Return whether a robot is in this world."""
        return self._riders.get(rider.name) is rider

    def reset(self) -> None:
        """Put all crates back to where they began, at rest. Robots stay."""
        kept = {name: each for name, each in self._state().items() if ':' in name}
        self._compile(kept)

    # -- time -----------------------------------------------------------------------------------

    def advance(self, until: float) -> None:
        """Let time pass for all that is in it, in whole steps, up to a time, s."""
        begun = time.perf_counter()
        before = self.time
        riders = list(self._riders.values())
        # The tolerance keeps a step from being late by rounding.
        left = round((until - self.time) / STEP)
        while left > 0:
            steady = all(rider.is_steady for rider in riders)
            count = min(left, CHUNK if steady else SHORT)
            left -= count
            for rider in riders:
                rider.drive(count * STEP)
            self._mujoco.mj_step(self.model, self.data, count)
            self.time += count * STEP
            for rider in riders:
                rider.sense()
        if not np.isfinite(self.data.qpos).all():
            raise LabError(
                'The world has come to numbers that are none: something was pushed into something '
                'else with more force than a simulation can bear.',
                todo='Reset it, and let things begin further apart.',
            )
        self._measure(self.time - before, time.perf_counter() - begun)

    def _measure(self, computed: float, needed: float) -> None:
        self._computed += computed
        self._needed += needed
        if self._computed >= MEASURED:
            self._factor = self._computed / max(self._needed, 1e-9)
            self._computed = self._needed = 0.0

    @property
    def real_time_factor(self) -> float:
        """How many seconds this machine could compute in a second, lately; inf at the beginning.

        Below 1 the world falls behind real time. What Gazebo shows under this name is never more
        than 1, since it waits.
        """
        return self._factor

    # -- what is where --------------------------------------------------------------------------

    def crate_poses(self) -> list[Pose]:
        """Return where the crates are, seen from above."""
        return [self._pose(f'crate{number}') for number in range(len(self.crates))]

    def _pose(self, name: str) -> Pose:
        body = self.data.body(name)
        w, x, y, z = body.xquat
        return Pose(float(body.xpos[0]), float(body.xpos[1]), yaw_from_quaternion(x, y, z, w))

    def seen(self) -> World:
        """Return the world as a map: walls, posts, robots, and crates as walls around them."""
        if not self.crates:
            return self.plan
        outlines = [
            wall
            for pose, crate in zip(self.crate_poses(), self.crates, strict=True)
            for wall in outline(pose, crate.size / 2, crate.size / 2)
        ]
        inner = self.plan.walls[len(self.plan.corners) :] if self.plan.corners else self.plan.walls
        found = World((*inner, *outlines), self.plan.posts, corners=self.plan.corners)
        found.robots = self.plan.robots
        return found

    # -- the model ------------------------------------------------------------------------------

    def _compile(self, kept: dict[str, Any]) -> None:
        """Make the model anew, with what was where as before."""
        bodies, motors = ([each[i] for each in self._parts.values()] for i in range(2))
        text = mjcf_of_world(self.plan, self.crates, self.ice, self.ramps, bodies, motors)
        self.model: mujoco.MjModel = self._mujoco.MjModel.from_xml_string(text)
        self.data: mujoco.MjData = self._mujoco.MjData(self.model)
        for number in range(self.model.njnt):
            joint = self.model.joint(number)
            if joint.name in kept:
                self.data.joint(joint.name).qpos[:], self.data.joint(joint.name).qvel[:] = kept[
                    joint.name
                ]
        self._mujoco.mj_forward(self.model, self.data)

    def _state(self) -> dict[str, Any]:
        found = {}
        for number in range(self.model.njnt):
            name = self.model.joint(number).name
            joint = self.data.joint(name)
            found[name] = joint.qpos.copy(), joint.qvel.copy()
        return found

    def forward(self) -> None:
        """Bring all that is computed of positions up to date, after one was set."""
        self._mujoco.mj_forward(self.model, self.data)

    @property
    def ray(self) -> Callable[..., None]:
        """MuJoCo's function for many rays from one point."""
        function: Callable[..., None] = self._mujoco.mj_multiRay
        return function


def _is_of(name: str, robot: str) -> bool:
    return name.startswith(f'{robot}:')


def outline(pose: Pose, half_x: float, half_y: float) -> list[Wall]:
    """Return walls around a rectangle, m."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    corners = [
        (
            pose.x + a * half_x * cos - b * half_y * sin,
            pose.y + a * half_x * sin + b * half_y * cos,
        )
        for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
    return [Wall(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]


def _check(thing: Crate | Ice | Ramp) -> None:
    if not all(math.isfinite(number) for number in thing):
        raise LabError(f'All numbers of a thing must be finite, but this is {thing!r}.')
    sizes = [value for name, value in thing._asdict().items() if name not in ('x', 'y', 'yaw')]
    small = [value for value in sizes if value <= 0]
    if small and not (isinstance(thing, Ice) and thing.friction == 0 and len(small) == 1):
        raise LabError(f'Sizes, masses and friction are more than 0, but this is {thing!r}.')


def has_mujoco() -> bool:
    """Tell whether worlds with physics can be made here; if not, print why, and what to do."""
    try:
        _mujoco()
    except LabError as error:
        print(error)
        return False
    return True


def _mujoco() -> Any:
    try:
        import mujoco
    except ImportError as error:
        import sys

        if sys.version_info < (3, 11):
            raise LabError(
                'A world with physics needs MuJoCo, which has wheels for Python 3.11 and newer; '
                f'this is Python {sys.version_info[0]}.{sys.version_info[1]}.',
                todo='Without physics the robot runs here, too: lab.Turtlebot()',
            ) from error
        raise LabError(
            'A world with physics needs MuJoCo, which is not installed.',
            todo='In a terminal, in the folder of the course: python3 -m labkit physics\n'
            'Then restart the kernel.',
        ) from error
    return mujoco


def yard() -> PhysicsWorld:
    """Return a room of 5 m by 5 m: two crates ahead, ice on the left, a ramp behind."""
    return PhysicsWorld(
        room(),
        crates=[Crate(1.0, 0.0), Crate(1.4, -1.2, 0.4)],
        ice=[Ice(0.5, 1.4, 2.0, 0.8)],
        ramps=[Ramp(-0.8, 0.0, math.pi)],
    )
