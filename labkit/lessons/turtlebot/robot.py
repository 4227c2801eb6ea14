"""The robot that a check drives: which one it is, who else drives it, what its scanner sees."""

from __future__ import annotations

import contextlib
import dataclasses
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError
from labkit.exercises import Fail, Probe
from labkit.lessons.turtlebot.drive import ODOMETRY, TWIST, Point
from labkit.sim.kinematics import BURGER, Pose
from labkit.sim.world import playground

if TYPE_CHECKING:
    from labkit.exercises.watch import Sample
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['OtherDrivers', 'find_robot', 'place', 'short_sighted', 'walls_near']

CELL = 'robot = lab.spin(lab.Turtlebot())'
RUN_AGAIN = f'Run the cell again that says: {CELL}'
# Walls are drawn that are nearer to the end of a drive than this, m.
NEAR_WALL = 0.8
# As far as a short-sighted scanner sees, m.
SHORT_SIGHT = 1.0
# How long it is looked whether somebody else drives, in rounds of the robot, of which there are 30
# in a second; and s at most. Commands mostly come ten times a second.
ROUNDS, OTHERS_SEC = 8, 2.0


def find_robot(probe: Probe) -> Any:
    """Return the simulated robot of this notebook.

    Raises:
        Fail: There is none, or not the one of the lesson, or a second one.
    """
    from labkit.rosgraph.endpoints import publishers

    ends = publishers(probe.node, '/odom')
    names = sorted({end.node for end in ends})
    here = [(name, probe.node_object(name)) for name in names]
    robots = [(name, node) for name, node in here if hasattr(node, 'simulator')]
    expected = 'the robot of this lesson, in this notebook'
    if not robots:
        elsewhere = [f'{end.node} {probe.place(end)}' for end in ends]
        raise Fail(
            expected,
            f'/odom comes from {", ".join(elsewhere)}' if elsewhere else 'no robot',
            why='The check puts the robot somewhere and watches it drive. Your node is there, '
            'the robot is not.',
            todo=RUN_AGAIN,
        )
    name, robot = robots[0]
    if len(ends) > 1:
        other = next((end for end in ends if end.node != name), ends[1])
        raise Fail(
            'one robot on /cmd_vel and /odom',
            f'{", ".join(f"{end.node} {probe.place(end)}" for end in ends)} publish on /odom',
            why='Two robots hear the same commands, and nobody can tell their odometry apart.',
            todo=f'End the other one, such as lab.remove({other.node!r}).',
        )
    _expect_real_time(probe, name, robot)
    if robot.executor is None:
        raise Fail(
            expected, f'{name} is there, but it is not spun', todo=f'{RUN_AGAIN}, with lab.spin.'
        )
    if robot.simulator.world.fixed != playground().fixed or robot.simulator.robot != BURGER:
        raise Fail(
            expected,
            f'{name} is in a room of another kind',
            why='The check has to know where the walls are.',
            todo=RUN_AGAIN,
        )
    return robot


def _expect_real_time(probe: Probe, name: str, robot: Any) -> None:
    from labkit.rosgraph.endpoints import publishers

    clocks = publishers(probe.node, '/clock')
    if any(end.node == name for end in clocks):
        raise Fail(
            'a robot in real time',
            f'{name} has a clock of its own: it was made with speed=... or lockstep=...',
            why='The check lets the time of your node and of the robot pass by itself.',
            todo=RUN_AGAIN,
        )
    if clocks:
        raise Fail(
            'nobody who publishes on /clock',
            f'{clocks[0].node} {probe.place(clocks[0])} publishes there',
            why='Nodes that follow /clock would hear two times.',
            todo=f'End it, such as lab.remove({clocks[0].node!r}), or where it runs.',
        )


def place(robot: Any, start: tuple[float, float, float]) -> None:
    """Put the robot somewhere.

    Raises:
        Fail: There is no room, since another robot or thing is there.
    """
    try:
        robot.place(*start)
    except LabError as error:
        raise Fail(
            f'room for the robot at x = {start[0]:.2f} m, y = {start[1]:.2f} m',
            str(error.message),
            todo=RUN_AGAIN,
        ) from None


@contextlib.contextmanager
def short_sighted(robot: Any) -> Iterator[None]:
    """Let the scanner see less far, and say 0.0 where it sees nothing, as a real one does."""
    simulator = robot.simulator
    before = simulator.robot, simulator.scan_nothing
    simulator.robot = dataclasses.replace(simulator.robot, range_max=SHORT_SIGHT)
    simulator.scan_nothing = 0.0
    try:
        yield
    finally:
        simulator.robot, simulator.scan_nothing = before


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


class OtherDrivers:
    """Who publishes on /cmd_vel beside the node under test.

    A message does not say who has sent it. So what nodes of this notebook publish is counted, and
    the rest is told from it, and by the numbers that each publisher gives its messages.

    Args:
        probe: The probe of the check.
        source: The publisher of the node under test.
    """

    def __init__(self, probe: Probe, source: Endpoint) -> None:
        self._probe, self._source = probe, source
        self._counts: Counter[str] = Counter()

    def _ends(self) -> list[Endpoint]:
        from labkit.rosgraph.endpoints import publishers

        found = publishers(self._probe.node, '/cmd_vel')
        return [end for end in found if end.node != self._source.node]

    @contextlib.contextmanager
    def counted(self) -> Iterator[None]:
        """Count anew what nodes of this notebook publish, for a `with` block."""
        from labkit.background.runtime import runtime

        nodes = [entry.node for entry in runtime.nodes()] + runtime.unspun_nodes()
        found = [
            (node.get_fully_qualified_name(), publisher)
            for node in nodes
            for publisher in node.publishers
            if publisher.topic_name == '/cmd_vel'
        ]
        self._counts.clear()
        with contextlib.ExitStack() as stack:
            for name, publisher in found:
                self._count(name, publisher)
                stack.callback(vars(publisher).pop, 'publish', None)
            yield

    def _count(self, name: str, publisher: Any) -> None:
        publish = publisher.publish

        def counting(message: Any) -> None:
            publish(message)
            self._counts[name] += 1

        publisher.publish = counting

    def look(self) -> None:
        """Look for a moment whether one of them drives, in real time.

        As long as that is, the robot itself says: it is spun as they are, also on a busy machine.

        Raises:
            Fail: One drives.
        """
        if not self._ends():
            return
        probe = self._probe
        commands, odometry = probe.watch('/cmd_vel', TWIST), probe.watch('/odom', ODOMETRY)
        try:
            with self.counted():
                probe.wait(lambda: len(odometry) >= ROUNDS, OTHERS_SEC)
                self.refuse(commands.samples)
        finally:
            commands.close()
            odometry.close()
            probe.forget((commands, odometry))

    def refuse(self, commands: Sequence[Sample]) -> None:
        """Raise Fail if another node has published on /cmd_vel meanwhile, and name it.

        Args:
            commands: What has come there since it is counted.
        """
        ends = self._ends()
        here = {end.node for end in ends if self._probe.in_this_process(end)}
        driving = {name: self._counts[name] for name in here if self._counts[name]}
        elsewhere = [end for end in ends if end.node not in here]
        if not driving and elsewhere and self._is_mixed(commands):
            driving = {end.node: 0 for end in elsewhere}
        if not driving:
            return
        name = min(driving)
        end = next(end for end in ends if end.node == name)
        count = driving[name]
        often = f', {count} command{"s" * (count > 1)}' if count else ''
        teleop = name.endswith('teleop')
        raise Fail(
            f'commands of {self._source.node} alone on /cmd_vel',
            f'{name} {self._probe.place(end)} drives the robot as well{often}',
            why='A key of the teleop is held, or its knob.'
            if teleop
            else 'The robot obeys whoever spoke last. Commands that say stop count, too.',
            todo='Let go of it while the check runs.'
            if teleop
            else f'End it, such as lab.remove({name!r}), or where it runs. Then check again.',
        )

    def _is_mixed(self, commands: Sequence[Sample]) -> bool:
        """Tell whether commands come that the node under test has not sent."""
        if self._probe.in_this_process(self._source):
            return len(commands) > sum(self._counts.values())
        return any(b.number != a.number + 1 for a, b in pairwise(commands))
