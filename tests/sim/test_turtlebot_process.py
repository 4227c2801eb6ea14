"""The robot in a process of its own, driven from another, against the closed form."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import pytest

from labkit.sim.simulator import Simulator

ROBOT = """
import sys, threading
import rclpy
from labkit.sim.turtlebot import Turtlebot

rclpy.init()
robot = Turtlebot(lockstep=0.1, noise=0.01, seed=3)
ended = threading.Event()
threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
while not ended.is_set():
    rclpy.spin_once(robot, timeout_sec=0.1)
robot.destroy_node()
rclpy.shutdown()
"""

# A circle of radius 0.2 m, then stop, in a process that knows nothing of labkit.
CIRCLE = """
import json, os, subprocess, sys
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

rclpy.init()
node = rclpy.create_node('circle')
commands = node.create_publisher(Twist, '/cmd_vel', 10)
path, scans = [], []

def send(v, w):
    message = Twist()
    message.linear.x, message.angular.z = v, w
    commands.publish(message)

def on_odometry(message):
    stamp = message.header.stamp
    if path and path[-1][0] == stamp.sec + stamp.nanosec * 1e-9:
        return  # told again because somebody joined
    pose, twist = message.pose.pose, message.twist.twist
    turn = pose.orientation
    path.append([stamp.sec + stamp.nanosec * 1e-9, pose.position.x, pose.position.y,
                 turn.z, turn.w, twist.linear.x, twist.angular.z])
    if len(path) <= 60:
        send(*((0.1, 0.5) if len(path) <= 40 else (0.0, 0.0)))

node.create_subscription(Odometry, '/odom', on_odometry, 100)
node.create_subscription(LaserScan, '/scan', scans.append, qos_profile_sensor_data)
robot = subprocess.Popen([sys.executable, os.environ['ROBOT']], stdin=subprocess.PIPE)
while len(path) <= 60:
    rclpy.spin_once(node, timeout_sec=1)
robot.communicate(b'')
print(json.dumps({'path': path, 'last': list(scans[-1].ranges), 'exit_code': robot.returncode}))
node.destroy_node()
rclpy.shutdown()
"""


def test_from_another_process_it_drives_the_closed_form(
    script: Callable[..., Any], tmp_path: Any
) -> None:
    from labkit.background.domains import claim_domain

    robot_file = tmp_path / 'robot.py'
    robot_file.write_text(ROBOT, encoding='utf-8')
    claim = claim_domain()
    try:
        done = script(
            CIRCLE,
            ROBOT=str(robot_file),
            ROS_DOMAIN_ID=str(claim.domain_id),
            ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST',
        )
    finally:
        claim.close()
    assert done.exit_code == 0, done.stderr
    seen = json.loads(done.stdout)
    assert seen['exit_code'] == 0, done.stderr
    twin = Simulator(command_timeout=math.inf)
    for step, row in enumerate(seen['path']):
        if step:
            twin.command(*((0.1, 0.5) if step <= 40 else (0.0, 0.0)))
            twin.step(0.1)
        assert row[0] == pytest.approx(0.1 * step)
        assert row[1:3] == pytest.approx(twin.pose[:2], abs=1e-12)
        assert row[5:] == pytest.approx(twin.twist, abs=1e-12)
        # While both speeds are constant the robot stays on a circle of radius v / w.
        if step == 3:
            x, y, yaw = twin.pose
            middle = x - 0.2 * math.sin(yaw), y + 0.2 * math.cos(yaw)
        if 3 <= step <= 40:
            assert math.dist(row[1:3], middle) == pytest.approx(0.2)
    finite = [
        (a, b) for a, b in zip(seen['last'], twin.scan(), strict=True) if max(abs(a), abs(b)) < 9
    ]
    assert len(finite) > 200
    assert max(abs(a - b) for a, b in finite) < 0.06, 'six times the noise'


# A teleop that speaks the other type, in a process that knows nothing of labkit.
OTHER = """
import sys, threading
import rclpy
from geometry_msgs.msg import Twist, TwistStamped

rclpy.init()
node = rclpy.create_node('teleop_keyboard')
node.create_publisher(Twist if sys.argv[1] == 'True' else TwistStamped, '/cmd_vel', 10)
sys.stdin.read()
"""
HEARING = """
import os, subprocess, sys
import rclpy
from rclpy.node import Node
from rcl_interfaces.msg import Log
from labkit.sim.turtlebot import Turtlebot

rclpy.init()
node = Node('listener')
said = []
node.create_subscription(Log, '/rosout', lambda log: log.level >= 30 and said.append(log.msg), 100)
robot = Turtlebot(stamped={stamped})
teleop = subprocess.Popen([sys.executable, 'other.py', '{stamped}'], stdin=subprocess.PIPE)
while not said:
    rclpy.spin_once(robot, timeout_sec=0.1)
    rclpy.spin_once(node, timeout_sec=0)
print(said[0])
teleop.communicate(b'')
robot.destroy_node()
rclpy.shutdown()
"""


@pytest.mark.slow('starts other processes')
@pytest.mark.parametrize('stamped', [False, True])
def test_the_robot_says_which_commands_it_can_not_hear(
    script: Callable[..., Any], tmp_path: Any, stamped: bool
) -> None:
    from labkit.background.domains import claim_domain

    (tmp_path / 'other.py').write_text(OTHER)
    claim = claim_domain()
    try:
        result = script(
            HEARING.format(stamped=stamped),
            ROS_DOMAIN_ID=str(claim.domain_id),
            ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST',
        )
    finally:
        claim.close()
    mine, other = ('TwistStamped', 'Twist') if stamped else ('Twist', 'TwistStamped')
    assert result.stdout == (
        f"Can't hear /teleop_keyboard on /cmd_vel: it publishes geometry_msgs/msg/{other}, and "
        f'this robot takes geometry_msgs/msg/{mine}. Make the robot with stamped={not stamped}.\n'
    ), result.stderr
