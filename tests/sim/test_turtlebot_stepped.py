"""The robot while somebody steps the clock of all nodes: its path depends on nothing else."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import pytest
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.clock import ROSClock
from rclpy.executors import TimeoutException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

from labkit.sim.kinematics import Pose, Twist2
from labkit.sim.simulator import Simulator
from labkit.sim.turtlebot import ODOM_RATE, Turtlebot
from labkit.sim.world import World, open_field, playground
from tests.stage import Driver, Stage, twist, yaw_of

PATH_ACCURACY = 1e-6
STEPS = 60
START = Pose(-0.4, 0.3, 2.0)


class Curve(Node):
    """Sends another command every 0.1 s of its clock: a curve that changes all the time."""

    def __init__(self) -> None:
        super().__init__('curve')
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.count = 0
        self.last = Twist2()

    def begin(self) -> None:
        self.end()
        self.count = 0
        self.last = Twist2()
        self.create_timer(0.1, self.send)

    def end(self) -> None:
        for timer in list(self.timers):
            self.destroy_timer(timer)

    def send(self) -> None:
        self.count += 1
        self.last = command(self.count)
        self.commands.publish(twist(*self.last))


class SteppedClock:
    """The clock of all nodes of a stage, set by hand. What becomes ready runs in between."""

    def __init__(self, stage: Stage, ahead: float = 0.0) -> None:
        self.stage = stage
        self.now = stage.nodes[0].get_clock().now().nanoseconds + round(ahead * 1e9)

    @contextmanager
    def active(self) -> Iterator[None]:
        self._set()
        self._follow(True)
        try:
            yield
        finally:
            self._follow(False)

    def jump(self, nanoseconds: int) -> None:
        self.now += nanoseconds
        self._set()
        self.settle()

    def next_due(self) -> None:
        """Go to where the next timer is due."""
        timers = [timer for node in self.stage.nodes for timer in node.timers]
        self.jump(max(1, min(timer.time_until_next_call() for timer in timers)))

    def settle(self) -> None:
        """Run what is ready until nothing is."""
        try:
            while True:
                task, _, _ = self.stage.executor.wait_for_ready_callbacks(timeout_sec=0)
                task()
        except TimeoutException:
            return

    def _follow(self, ros_time: bool) -> None:
        for node in self.stage.nodes:
            (result,) = node.set_parameters([Parameter('use_sim_time', value=ros_time)])
            assert result.successful

    def _set(self) -> None:
        for node in self.stage.nodes:
            clock = node.get_clock()
            assert isinstance(clock, ROSClock)
            clock.set_ros_time_override(Time(nanoseconds=self.now, clock_type=clock.clock_type))


class Drive(NamedTuple):
    """One drive along the curve, its times counted from the moment in which it was placed, ns."""

    # Where the robot was at each command, in truth.
    path: list[Pose]
    odometry: list[tuple[int, Pose]]
    scans: list[tuple[int, list[float]]]

    def assert_same(self, other: Drive) -> None:
        assert_same(self.path, other.path)
        assert [time for time, _ in self.odometry] == [time for time, _ in other.odometry]
        assert_same([pose for _, pose in self.odometry], [pose for _, pose in other.odometry])
        assert self.scans == other.scans


class Scene:
    """A robot, who listens, and who drives it along the curve."""

    def __init__(self, stage: Stage, world: World | None = None) -> None:
        self.stage = stage
        self.robot: Turtlebot = stage.robot(world=world or playground(), noise=0.01)
        self.driver: Driver = stage.driver()
        self.curve: Curve = stage.add(Curve())
        stage.until(lambda: self.curve.commands.get_subscription_count() == 1)

    def run_wild(self) -> None:
        """Give it a past: speed, a wall that it pushes against, rounds at any time."""
        self.robot.place(1.0, -2.2, -1.0)
        robot, sent = self.robot, Twist2(0.22, 0.05)
        robot.place(1.0, -2.2, -1.0)
        while not robot.collisions:
            sent = Twist2(0.22, -sent.w)
            self.driver.commands.publish(twist(*sent))
            self.stage.until(lambda sent=sent: robot.simulator.target == sent)

    def drive(self) -> Drive:
        """Drive the curve in stepped time."""
        robot, driver, curve = self.robot, self.driver, self.curve
        clock = SteppedClock(self.stage)
        path: list[Pose] = []
        with clock.active():
            clock.settle()
            robot.place(*START)
            curve.begin()
            begin = clock.now
            driver.odometry.clear()
            driver.scans.clear()
            while curve.count < STEPS:
                before = curve.count
                clock.next_due()
                self.stage.until(lambda: robot.simulator.target == curve.last)
                if curve.count > before:
                    path.append(robot.pose)
            curve.end()
            rounds = int(STEPS * 0.1 * ODOM_RATE)
            # What was told before may have come only now.
            self.stage.until(lambda: len(since(begin, driver.odometry)) >= rounds)
        odometry, scans = since(begin, driver.odometry), since(begin, driver.scans)
        return Drive(
            path,
            [(nanoseconds(message) - begin, place(message)) for message in odometry],
            [(nanoseconds(message) - begin, list(message.ranges)) for message in scans],
        )


def command(count: int) -> Twist2:
    """Return the command at a step of the curve."""
    return Twist2(0.12 + 0.08 * math.sin(count / 5), 1.5 * math.cos(count / 7))


def since(begin: int, messages: list[Any]) -> list[Any]:
    return [message for message in messages if nanoseconds(message) > begin]


def nanoseconds(message: Odometry | LaserScan) -> int:
    stamp = message.header.stamp
    return stamp.sec * 10**9 + stamp.nanosec


def place(message: Odometry) -> Pose:
    position = message.pose.pose.position
    return Pose(position.x, position.y, yaw_of(message))


def assert_same(ones: list[Pose], others: list[Pose]) -> None:
    assert len(ones) == len(others)
    for one, other in zip(ones, others, strict=True):
        assert one == pytest.approx(other, abs=PATH_ACCURACY)


@pytest.fixture
def busy() -> Iterator[None]:
    """Keep the machine busy."""
    loops = [subprocess.Popen([sys.executable, '-c', 'while True: pass']) for _ in range(8)]
    yield
    for loop in loops:
        loop.kill()
        loop.wait()


def test_the_path_is_that_of_the_commands_and_their_times(stage: Stage) -> None:
    twin = Simulator(start=START)
    expected: list[Pose] = []
    for count in range(1, STEPS + 1):
        twin.step(0.1)
        twin.command(*command(count))
        expected.append(twin.pose)
    assert math.dist(expected[0][:2], expected[-1][:2]) > 0.1
    drive = Scene(stage).drive()
    assert_same(drive.path, expected)
    assert len(drive.odometry) == STEPS * 0.1 * ODOM_RATE
    period = int(1e9 / ODOM_RATE)
    assert [time for time, _ in drive.odometry[:3]] == [period, 2 * period, 3 * period]
    assert [time for time, _ in drive.scans[:3]] == [period, 6 * period, 12 * period]


def test_what_went_before_changes_nothing(stage: Stage) -> None:
    scene = Scene(stage)
    first = scene.drive()
    # The clock of this one begins before the end of that one: real time is slower.
    scene.drive().assert_same(first)
    scene.run_wild()
    assert scene.robot.simulator.target != Twist2()
    assert scene.robot.collisions
    scene.drive().assert_same(first)
    assert not scene.robot.collisions


@pytest.mark.slow('makes the machine busy')
def test_a_busy_machine_changes_nothing(stage: Stage, busy: None) -> None:
    scene = Scene(stage)
    first = scene.drive()
    scene.run_wild()
    scene.drive().assert_same(first)


@pytest.mark.parametrize('ahead', [1000.0, -1000.0])
def test_it_does_not_drive_for_the_time_between_two_sources(stage: Stage, ahead: float) -> None:
    robot = stage.robot(world=open_field(), command_timeout=1e6)
    driver = stage.driver()
    driver.commands.publish(twist(0.2))
    stage.until(lambda: robot.twist == (0.2, 0.0))
    clock = SteppedClock(stage, ahead=ahead)
    start = robot.pose
    with clock.active():
        heard = len(driver.odometry)
        while len(driver.odometry) == heard:
            clock.next_due()
        assert robot.pose == start
        clock.jump(10**9)
        assert robot.pose.x - start.x == pytest.approx(0.2)
    start, back = robot.pose, driver.get_clock().now().nanoseconds

    def first() -> Odometry | None:
        # What was told by the other clock, or before it, may still be on its way.
        ages = ((nanoseconds(told) - back, told) for told in driver.odometry)
        return next((told for age, told in ages if 0 <= age < abs(ahead) / 2 * 1e9), None)

    stage.until(lambda: first() is not None)
    told = first()
    assert told is not None and told.pose.pose.position.x == start.x
    stage.until(lambda: robot.pose.x > start.x)
    assert robot.pose.x - start.x < 0.2 * abs(ahead) / 2


def test_time_begins_when_ros_time_is_told_first(stage: Stage) -> None:
    robot = stage.robot(use_sim_time=True)
    teller = stage.add(Node('teller'))
    clocks = teller.create_publisher(Clock, '/clock', 10)
    heard: list[Odometry] = []
    teller.create_subscription(Odometry, 'odom', heard.append, 10)
    stage.until(clocks.get_subscription_count)
    stage.until(lambda: robot.count_subscribers('/odom') == 1)
    told = Clock()
    told.clock.sec = 1_700_000_000
    for count, nanosec in enumerate((0, 100_000_000), start=1):
        told.clock.nanosec = nanosec
        clocks.publish(told)
        stage.until(lambda count=count: len(heard) == count)
    assert robot.simulator.time == pytest.approx(0.1)
