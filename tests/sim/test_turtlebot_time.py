"""The three ways for time to pass: real, fast, in lock-step."""

from __future__ import annotations

import itertools

import pytest
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.parameter import Parameter

from labkit.sim.world import open_field
from tests.stage import Driver, Stage, twist, yaw_of


def steer_home(driver: Driver, steps: int) -> None:
    """Drive by feedback: each odometry message is answered with the next command."""

    def answer(message: Odometry) -> None:
        if len(driver.odometry) <= steps:
            driver.commands.publish(twist(-message.pose.pose.position.x, 0.3 - yaw_of(message)))

    driver.on_odometry = answer


def test_lockstep_gives_the_same_numbers_each_time(stage: Stage) -> None:
    def run() -> list[str]:
        robot = stage.robot(lockstep=0.1, x=1.0, noise=0.01, seed=7, drift=0.01)
        driver = stage.add(Driver())
        steer_home(driver, 40)
        stage.until(lambda: len(driver.odometry) > 40)
        stage.until(lambda: len(driver.scans) > 20 and len(driver.joints) >= 40)
        messages = [*driver.odometry, *driver.joints, *driver.scans]
        for node in (robot, driver):
            stage.executor.remove_node(node)
            stage.nodes.remove(node)
            node.destroy_node()
        # Not the bytes on the wire: the padding between two fields is whatever was there.
        return [str(message) for message in messages]

    first = run()
    assert first == run()
    assert len(set(first)) > 90


def test_lockstep_tells_who_joins_where_the_robot_is(stage: Stage) -> None:
    robot = stage.robot(lockstep=0.1, x=0.7)
    driver = stage.driver()
    stage.until(lambda: driver.odometry)
    assert driver.odometry[0].pose.pose.position.x == 0.7
    assert driver.odometry[0].header.stamp.sec == 0
    assert robot.simulator.time == 0


def test_lockstep_tells_who_takes_the_place_of_another(stage: Stage) -> None:
    stage.robot(lockstep=0.1, x=0.7)
    driver = stage.driver()
    # As on a busy machine, the robot learns of both at once: there are no more than before.
    earlier = next(s for s in driver.subscriptions if s.topic_name == '/odom')
    driver.destroy_subscription(earlier)
    heard: list[Odometry] = []
    driver.create_subscription(Odometry, 'odom', heard.append, 10)
    stage.until(lambda: heard)
    assert heard[0].pose.pose.position.x == 0.7


def test_lockstep_passes_exactly_the_time_it_was_given(stage: Stage) -> None:
    stage.robot(world=open_field(), lockstep=0.1)
    driver = stage.driver()
    stage.command(driver, 0.2, 0.0, count=20)
    # A ramp of v/a seconds, then constant speed; the command never times out in between.
    expected = 0.2 * 2.0 - 0.2**2 / (2 * 2.5)
    assert driver.odometry[-1].pose.pose.position.x == pytest.approx(expected)
    stamp = driver.odometry[-1].header.stamp
    assert (stamp.sec, stamp.nanosec) == (2, 0)
    stage.until(lambda: driver.clocks and driver.clocks[-1].clock == stamp)


def test_fast_time_is_told_by_the_clock(stage: Stage) -> None:
    stage.robot(world=open_field(), speed=20.0)
    driver = stage.driver()
    ticks: list[int] = []
    follower = stage.add(
        Node('follower', parameter_overrides=[Parameter('use_sim_time', value=True)])
    )
    follower.create_timer(0.1, lambda: ticks.append(follower.get_clock().now().nanoseconds))
    stage.until(lambda: len(driver.scans) >= 10 and len(ticks) >= 10)
    stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in driver.odometry]
    told = [m.clock.sec * 10**9 + m.clock.nanosec for m in driver.clocks]
    for times in (stamps, told):
        assert times == sorted(set(times))
        # A robot that was held up makes up at once, and its queue of ten may overflow. But each
        # moment is one of a step.
        assert all(abs(time * 30 / 1e9 - round(time * 30 / 1e9)) < 1e-6 for time in times)
    scans = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in driver.scans[1:]]
    gaps = [later - earlier for earlier, later in itertools.pairwise(scans)]
    # Best effort: one may be lost, but each is a multiple of a turn after the last.
    assert all(abs(gap / 2e8 - round(gap / 2e8)) < 1e-6 for gap in gaps)
    assert ticks == sorted(ticks)


def test_a_second_robot_can_follow_the_clock_of_the_first(stage: Stage) -> None:
    stage.robot(namespace='one', speed=20.0)
    second = stage.robot(namespace='two', use_sim_time=True)
    driver = stage.driver('two')
    driver.create_timer(0.02, lambda: driver.commands.publish(twist(0.2)))
    stage.until(lambda: driver.odometry and driver.odometry[-1].pose.pose.position.x > 0.5)
    assert second.simulator.time > 0.5 / 0.2
