"""The robot with physics as a node: the same topics, and what is more."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import Imu
from std_srvs.srv import Empty

import labkit as lab
from labkit.errors import LabError
from labkit.exercises.time.virtual_time import VirtualTime
from labkit.sim.physics.mujoco_world import PhysicsWorld
from labkit.sim.physics.things import Crate, Ramp
from labkit.sim.turtlebot import TRUTH_TOPIC, Turtlebot
from labkit.sim.world import open_field
from tests.stage import Stage, twist


@pytest.fixture
def stage() -> Iterator[Stage]:
    rclpy.init()
    stage = Stage()
    yield stage
    stage.close()
    rclpy.shutdown()


def test_it_has_the_topics_of_the_light_robot(stage: Stage) -> None:
    light = stage.robot(name='light', namespace='light')
    heavy = stage.robot(name='heavy', namespace='heavy', physics=True)

    def topics(node: Turtlebot) -> set[str]:
        return {end.topic_name.replace(node.get_name(), 'robot') for end in node.publishers}

    assert topics(heavy) - topics(light) == {'/robot/base_pose_ground_truth'}
    assert topics(light) <= topics(heavy)
    driver = stage.driver('heavy')
    truth: list[Odometry] = []
    imu: list[Imu] = []
    driver.create_subscription(Odometry, TRUTH_TOPIC, truth.append, 10)
    driver.create_subscription(Imu, 'imu', imu.append, 10)
    driver.commands.publish(twist(0.1))
    stage.until(lambda: driver.scans and driver.joints and truth and imu)
    stage.until(lambda: driver.odometry[-1].pose.pose.position.x > 0.02)
    assert truth[-1].header.frame_id == 'map'
    assert imu[-1].linear_acceleration.z == pytest.approx(9.8, abs=1.0)


def test_truth_has_height_and_tilt_and_reset_puts_all_back(stage: Stage) -> None:
    world = PhysicsWorld(open_field(), crates=[Crate(0.0, 2.0)], ramps=[Ramp(0.3, 0.0)])
    robot = stage.robot(physics=True, world=world, lockstep=0.1)
    driver = stage.driver()
    truth: list[Odometry] = []
    driver.create_subscription(Odometry, TRUTH_TOPIC, truth.append, 10)
    stage.until(lambda: truth)
    stage.command(driver, 0.2, 0.0, 35)
    stage.until(lambda: truth[-1].pose.pose.position.z > 0.02)
    assert truth[-1].pose.pose.orientation.y < -0.05  # it climbs
    assert driver.odometry[-1].pose.pose.position.z == 0.0
    stage.command(driver, 0.2, 0.0, 40)
    assert robot.simulator.tipped_over
    stage.until(lambda: any('Tipped over' in line for line in driver.warnings))
    client = driver.create_client(Empty, 'reset_world')
    assert client.wait_for_service(timeout_sec=60)
    future = client.call_async(Empty.Request())
    stage.until(future.done)
    assert robot.pose == (0.0, 0.0, 0.0) and not robot.simulator.tipped_over
    # The clock goes on.
    assert len(driver.clocks) == 75 and robot.simulator.time == pytest.approx(7.5)


def test_two_nodes_share_a_world(stage: Stage) -> None:
    world = PhysicsWorld(open_field())
    one = stage.robot(physics=True, world=world, name='one', namespace='one')
    two = stage.robot(physics=True, world=world, name='two', namespace='two', x=1.0)
    stage.until(lambda: world.time > 1.0)
    assert abs(one.simulator.time - two.simulator.time) < 0.2
    assert one.simulator.scan()[0] == pytest.approx(0.965, abs=0.02)


def test_a_world_with_physics_is_for_a_robot_with_physics(stage: Stage) -> None:
    with pytest.raises(LabError, match='is one with physics, and this robot has none'):
        stage.robot(world=PhysicsWorld(open_field()))


def test_it_goes_from_one_world_into_another(stage: Stage) -> None:
    home, rink = PhysicsWorld(open_field()), PhysicsWorld(open_field(), crates=[Crate(1.0, 0.0)])
    robot = stage.robot(physics=True, world=home)
    robot.enter(rink, 0.5, -1.0, 1.0)
    assert robot.pose == pytest.approx((0.5, -1.0, 1.0), abs=1e-3)
    simulator: Any = robot.simulator
    assert simulator.physics is rink
    stage.until(lambda: rink.time > 0.2)
    with pytest.raises(LabError, match='but a crate is at'):
        robot.enter(rink, 1.0, 0.0)
    light = stage.robot(name='light', namespace='light')
    with pytest.raises(LabError, match='this robot has none'):
        light.enter(rink)


def test_its_heading_is_within_half_a_turn(stage: Stage) -> None:
    robot = stage.robot(physics=True, world=PhysicsWorld(open_field()), yaw=3.0, lockstep=0.1)
    driver = stage.driver()
    stage.command(driver, 0.0, 1.0, 10)
    assert robot.pose.yaw < 0
    _, _, z, w = robot.simulator.orientation
    assert 2 * math.atan2(z, w) == pytest.approx(robot.pose.yaw, abs=1e-6)


def test_in_virtual_time_it_goes_the_same_way_each_time() -> None:
    class Curve(Node):
        def __init__(self) -> None:
            super().__init__('curve')
            self.commands = self.create_publisher(lab_twist, 'cmd_vel', 10)
            self.count = 0
            self.create_timer(0.1, self.send)

        def send(self) -> None:
            self.count += 1
            self.commands.publish(twist(0.2, math.sin(self.count / 5)))

    lab_twist = type(twist())
    places = []
    try:
        for _ in range(2):
            robot: Any = lab.spin(lab.Turtlebot(physics=True))
            curve: Any = lab.spin(Curve())
            with VirtualTime([robot, curve]) as passing:
                robot.place()
                curve.count = 0
                passing.restart_timers()
                passing.advance(5.0, lambda: True)
                places.append((robot.pose, curve.count))
            lab.remove(robot)
            lab.remove(curve)
    finally:
        lab.stop()
    assert places[0] == places[1] and places[0][1] == 50
    assert places[0][0].x > 0.4


def test_without_mujoco_the_error_says_what_installs_it(script: Callable[..., Any]) -> None:
    code = (
        'import sys\nsys.modules["mujoco"] = None\n'
        'import labkit as lab\n'
        'try:\n    lab.Turtlebot(physics=True)\n'
        'except lab.LabError as error:\n    print(error)\n'
        'from labkit.sim.physics.mujoco_world import has_mujoco\n'
        'print(has_mujoco())'
    )
    done = script(code)
    assert done.stdout.count('python3 -m labkit physics') == 2, done
    assert done.stdout.endswith('False\n'), done
