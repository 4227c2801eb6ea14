"""The robot that a check drives: which one it is, who else drives it, what its scanner sees."""

from __future__ import annotations

import contextlib
import dataclasses
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError
from labkit.exercises import Fail, Probe, words_of
from labkit.exercises.figures import many
from labkit.lessons.turtlebot.drive import Point, Trial
from labkit.sim.kinematics import Pose
from labkit.sim.robots import BURGER
from labkit.sim.world import Post, Wall, World, playground

if TYPE_CHECKING:
    from labkit.exercises.messages_heard import Sample
    from labkit.rosgraph.endpoints import Endpoint
    from labkit.sim.physics.mujoco_world import PhysicsWorld

__all__ = [
    'find_robot',
    'in_room',
    'listed_others',
    'place',
    'refuse_copies',
    'refuse_others',
    'walls_near',
]

WORDS = words_of(__file__)

# Walls are drawn that are nearer to the end of a drive than this, m.
NEAR_WALL = 0.8
# As far as a short-sighted scanner sees, m.
SHORT_SIGHT = 1.0
NO_ROBOT = WORDS.mistake('robot/none')
NO_PHYSICS = WORDS.mistake('robot/no-physics')
TWO_ROBOTS = WORDS.mistake('robot/two')
SECOND_CLOCK = WORDS.mistake('robot/second-clock')
COPIES = WORDS.mistake('robot/copies')
OTHERS = WORDS.mistake('robot/others')


def find_robot(probe: Probe, *, physics: bool = False) -> Any:
    """Return the simulated robot of this notebook.

    Args:
        probe: The probe of the check.
        physics: Whether it is one with physics.

    Raises:
        Fail: There is none, or not the one of the lesson, or a second one.
    """
    from labkit.rosgraph.endpoints import publishers

    ends, clocks = publishers(probe.node, '/odom'), publishers(probe.node, '/clock')
    listed = ', '.join(f'{end.node} {probe.place(end)}' for end in ends)
    here = [(end.node, probe.node_object(end.node)) for end in ends]
    name, robot = next((pair for pair in here if hasattr(pair[1], 'simulator')), ('', None))
    expected = 'the robot of this lesson, in this notebook'
    if robot is None:
        seen = f'/odom comes from {listed}' if ends else 'no robot'
        raise Fail(expected, seen, NO_PHYSICS if physics else NO_ROBOT)
    if len(ends) > 1:
        other = next((end.node for end in ends if end.node != name), name)
        expected = 'one robot on /cmd_vel and /odom'
        raise Fail(expected, f'{listed} publish on /odom', TWO_ROBOTS.of(name=other))
    if any(end.node == name for end in clocks):
        seen = f'{name} has a clock of its own: it was made with speed=... or lockstep=...'
        raise Fail('a robot in real time', seen, NO_ROBOT)
    if clocks:
        seen = f'{clocks[0].node} {probe.place(clocks[0])} publishes there'
        raise Fail('nobody who publishes on /clock', seen, SECOND_CLOCK.of(name=clocks[0].node))
    if robot.executor is None:
        raise Fail(expected, f'{name} is there, but it is not spun', NO_ROBOT)
    if physics:
        if not robot.simulator.has_physics:
            raise Fail('a robot with physics', f'{name} has none', NO_PHYSICS)
        return robot
    if robot.simulator.world.fixed != playground().fixed or robot.simulator.robot != BURGER:
        raise Fail(expected, f'{name} is in a room of another kind', NO_ROBOT)
    return robot


def refuse_copies(probe: Probe, name: str, sign: str) -> None:
    """Raise Fail if several nodes hear the sign and drive."""
    drivers = {end.node for end in probe.publishers('/cmd_vel')}
    nodes = sorted(drivers.intersection(end.node for end in probe.subscriptions(sign)))
    names = nodes if len(nodes) > 1 else [name] * probe.node_names().count(name)
    if len(names) > 1:
        raise Fail(
            f'one node that hears {sign} and publishes on /cmd_vel',
            f'{len(names)} of them: {", ".join(names[:4])}',
            COPIES.of(name=names[0]),
        )


def place(robot: Any, start: tuple[float, float, float]) -> None:
    """Put the robot somewhere.

    Raises:
        Fail: There is no room, since another robot or thing is there.
    """
    try:
        robot.place(*start)
    except LabError as error:
        expected = f'room for the robot at x = {start[0]:.2f} m, y = {start[1]:.2f} m'
        raise Fail(expected, str(error.message), NO_ROBOT) from None


@contextlib.contextmanager
def in_room(robot: Any, trial: Trial) -> Iterator[None]:
    """Put into the room what stands there in a drive, and let the scanner be as it is there."""
    if trial.make_world is not None:
        with _in_world(robot, trial, trial.make_world()):
            yield
        return
    simulator = robot.simulator
    before = simulator.robot, simulator.scan_nothing, simulator.world
    usual = playground()
    try:
        if trial.walls or trial.posts:
            posts = [*usual.posts, *(Post(*post) for post in trial.posts)]
            walls = [Wall(*wall) for wall in trial.walls]
            simulator.enter(World(walls, posts, corners=usual.corners))
        if trial.nothing != math.inf:
            simulator.robot = dataclasses.replace(simulator.robot, range_max=SHORT_SIGHT)
            simulator.scan_nothing = trial.nothing
        yield
    finally:
        simulator.robot, simulator.scan_nothing, _ = before
        if simulator.world is not before[2]:
            simulator.enter(before[2])


@contextlib.contextmanager
def _in_world(robot: Any, trial: Trial, world: PhysicsWorld) -> Iterator[None]:
    simulator = robot.simulator
    home, pose, drift = simulator.physics, robot.pose, simulator.drift
    try:
        robot.enter(world, *trial.start)
        simulator.drift = trial.drift
        yield
    finally:
        simulator.drift = drift
        robot.enter(home, *pose)


def walls_near(robot: Any, pose: Pose) -> list[Point | None]:
    """Return where the beams of the scanner end, as far as that is near, for the picture."""
    ranges, ahead = robot.simulator.scan(), robot.simulator.robot.scan_x
    eye = pose.x + ahead * math.cos(pose.yaw), pose.y + ahead * math.sin(pose.yaw)
    ends: list[Point | None] = []
    for beam, way in enumerate(ranges):
        angle = pose.yaw + math.tau * beam / len(ranges)
        end = eye[0] + way * math.cos(angle), eye[1] + way * math.sin(angle)
        ends.append(end if 0 < way < NEAR_WALL else None)
    return ends


def listed_others(probe: Probe, source: Endpoint) -> str:
    """Return who else publishes commands, and where, once each; '' if nobody does."""
    from labkit.rosgraph.endpoints import publishers

    found = publishers(probe.node, '/cmd_vel')
    places = (f'{end.node} {probe.place(end)}' for end in found if end.node != source.node)
    return ', '.join(dict.fromkeys(places))


def refuse_others(
    probe: Probe, source: Endpoint, commands: Sequence[Sample], *, unasked: bool = False
) -> None:
    """Raise Fail if not all commands are of the node under test, and name who else publishes.

    A message does not say who has sent it, but each publisher numbers its messages. Timers of
    other nodes of this process stand still meanwhile; a key of a teleop that is held does not.

    Args:
        probe: The probe of the check.
        source: The publisher of the node under test.
        commands: The commands.
        unasked: Whether they came before any drive, so that all may be of somebody else.
    """
    from labkit.rosgraph.endpoints import publishers

    ends = [end for end in publishers(probe.node, '/cmd_vel') if end.node != source.node]
    mixed = any(b.number != a.number + 1 for a, b in pairwise(commands))
    elsewhere = any(not probe.in_this_process(end) for end in ends)
    if (ends and mixed) or (elsewhere and unasked):
        listed = listed_others(probe, source)
        raise Fail(
            f'commands of {source.node} alone on /cmd_vel',
            f'{many(len(commands), "command")}, and {listed} can drive the robot as well',
            OTHERS.of(name=ends[0].node),
        )
