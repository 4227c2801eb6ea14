"""Simulated robots and those who drive them, on one executor in the thread of the test."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Log
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, LaserScan

from labkit.sim.kinematics import yaw_from_quaternion
from labkit.sim.turtlebot import Turtlebot

# There to end a hang, not to judge: machines under test are busy.
TIMEOUT_SEC = 60.0


def twist(v: float = 0.0, w: float = 0.0) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = v, w
    return message


def yaw_of(odometry: Odometry) -> float:
    turn = odometry.pose.pose.orientation
    return yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)


class Driver(Node):
    """Sends commands to one robot and keeps all that it hears from it."""

    def __init__(self, space: str = '') -> None:
        super().__init__('driver', namespace=space or None)
        self.odometry: list[Odometry] = []
        self.scans: list[LaserScan] = []
        self.joints: list[JointState] = []
        self.clocks: list[Clock] = []
        self.warnings: list[str] = []
        self.on_odometry: Callable[[Odometry], None] = lambda message: None
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.hear, 1000)
        self.create_subscription(LaserScan, 'scan', self.scans.append, qos_profile_sensor_data)
        self.create_subscription(JointState, 'joint_states', self.joints.append, 1000)
        self.create_subscription(Clock, '/clock', self.clocks.append, 1000)
        self.create_subscription(Log, '/rosout', self.note, 1000)

    def hear(self, message: Odometry) -> None:
        self.odometry.append(message)
        self.on_odometry(message)

    def note(self, message: Log) -> None:
        if message.level >= 30:
            self.warnings.append(message.msg)


class Stage:
    """Robots and drivers on one executor, in the thread of the test."""

    def __init__(self) -> None:
        self.executor = SingleThreadedExecutor()
        self.nodes: list[Node] = []

    def add(self, node: Any) -> Any:
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def robot(self, **options: Any) -> Turtlebot:
        return self.add(Turtlebot(**options))

    def driver(self, space: str = '') -> Driver:
        driver = self.add(Driver(space))
        self.until(lambda: driver.commands.get_subscription_count() == 1)
        # In lock-step it is told where the robot is; else it hears it soon.
        self.until(lambda: driver.odometry)
        return driver

    def until(self, condition: Callable[[], object]) -> None:
        end = time.monotonic() + TIMEOUT_SEC
        while not condition():
            assert time.monotonic() < end, 'what was awaited did not happen'
            self.executor.spin_once(timeout_sec=0.1)

    def command(self, driver: Driver, v: float, w: float, count: int = 1) -> None:
        """Send commands in lock-step: the next one when the answer to the last has come."""
        for _ in range(count):
            heard = len(driver.odometry)
            driver.commands.publish(twist(v, w))
            self.until(lambda heard=heard: len(driver.odometry) > heard)

    def close(self) -> None:
        for node in self.nodes:
            self.executor.remove_node(node)
            node.destroy_node()
        self.executor.shutdown()
