"""How fast the simulated robot is, and how evenly it speaks."""

from __future__ import annotations

import itertools
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

from kernel import Kernel
from table import Row

__all__ = ['tables']

# Three times what the slowest machine that the course was made on simulated at first.
GOALS = {'open_field': 2265, 'playground': 696, 'pillars': 591}

# A robot in a process of its own, on labkit's background thread as in a notebook. It tells what
# it cost when its standard input closes.
ROBOT = """
import json, sys, time
import labkit as lab
from labkit.sim.turtlebot import Turtlebot

robot = lab.spin(Turtlebot(**json.loads(sys.argv[1])))
print('ready', flush=True)
sys.stdin.readline()
wall, cpu, simulated = time.perf_counter(), time.process_time(), robot.simulator.time
sys.stdin.readline()
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
print(json.dumps({'wall': wall, 'cpu': cpu, 'time': robot.simulator.time - simulated}))
lab.stop()
"""


# A robot that drives circles in a notebook, with its arena open.
CIRCLES = """
import labkit as lab
from geometry_msgs.msg import Twist
from rclpy.node import Node

robot = lab.spin(lab.Turtlebot())
view = lab.arena()
display(view)
assert view._widget is not None
view._widget._handle_custom_msg({'view': 'seen'}, [])
driver = lab.spin(Node('driver'))
commands = driver.create_publisher(Twist, 'cmd_vel', 10)
curve = Twist()
curve.linear.x, curve.angular.z = 0.1, 0.5
driver.create_timer(0.1, lambda: commands.publish(curve))
lab.wait_until(lambda: view.scenes[''].pose.x > 0.05)
"""


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of the table."""
    from labkit.background.domains import claim_domain

    before = dict(os.environ)
    claim = claim_domain()
    os.environ['ROS_DOMAIN_ID'] = str(claim.domain_id)
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    try:
        rows = [
            *headless(2 if quick else 300),
            *real_time(1 if quick else 8),
            *arena(1 if quick else 8),
            *fast_time(0.2 if quick else 3),
            *lockstep(30 if quick else 1000),
        ]
    finally:
        claim.close()
        os.environ.clear()
        os.environ.update(before)
    yield 'The simulated robot', rows


class RobotProcess:
    """A robot in another process, from `begin` to `end`."""

    def __init__(self, **options: Any) -> None:
        self._process = subprocess.Popen(
            [sys.executable, '-c', ROBOT, json.dumps(options)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self._process.stdout is not None
        self._process.stdout.readline()

    def begin(self) -> None:
        """Start to count."""
        assert self._process.stdin is not None
        self._process.stdin.write('\n')
        self._process.stdin.flush()

    def end(self) -> dict[str, float]:
        """Return seconds that passed, of CPU time, and of simulated time."""
        out, _ = self._process.communicate('\n')
        cost: dict[str, float] = json.loads(out)
        return cost


def headless(seconds: float) -> list[Row]:
    """Measure the simulation alone: 30 steps, 10 commands and 5 scans in a simulated second."""
    from labkit.sim.kinematics import Pose
    from labkit.sim.simulator import Simulator
    from labkit.sim.world import open_field, pillars, playground

    rows: list[Row] = []
    for make, start in (
        (open_field, Pose()),
        (playground, Pose()),
        (pillars, Pose(-1.65, -0.55)),
    ):
        robot = Simulator(make(), start=start)
        begin = time.perf_counter()
        for step in range(round(seconds * 30)):
            if step % 3 == 0:
                robot.command(0.2 if step % 900 < 600 else -0.2, 0.6 if step % 450 < 300 else -0.5)
            robot.step(1 / 30)
            if step % 6 == 0:
                robot.scan()
        rate = seconds / (time.perf_counter() - begin)
        goal = GOALS[make.__name__]
        rows.append(Row(f'headless with scan, {make.__name__}', rate, 's per s', at_least=goal))
    return rows


def real_time(seconds: float) -> list[Row]:
    """Measure a robot in real time, heard from another process."""
    import rclpy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    robot = RobotProcess()
    rclpy.init()
    node = rclpy.create_node('listener')
    arrivals: list[float] = []
    stamps: list[float] = []
    scans: list[float] = []

    def hear(message: Odometry) -> None:
        arrivals.append(time.perf_counter())
        stamps.append(message.header.stamp.sec + message.header.stamp.nanosec * 1e-9)

    node.create_subscription(Odometry, '/odom', hear, 100)
    node.create_subscription(
        LaserScan, '/scan', lambda _: scans.append(time.perf_counter()), qos_profile_sensor_data
    )
    commands = node.create_publisher(Twist, '/cmd_vel', 10)
    drive = Twist()
    drive.linear.x, drive.angular.z = 0.1, 0.5
    node.create_timer(0.1, lambda: commands.publish(drive))
    while not (arrivals and scans):
        rclpy.spin_once(node, timeout_sec=1)
    for heard in (arrivals, stamps, scans):
        heard.clear()
    robot.begin()
    while len(arrivals) < 30 * seconds:
        rclpy.spin_once(node, timeout_sec=1)
    cost = robot.end()
    node.destroy_node()
    rclpy.shutdown()
    return [
        Row('real time, CPU of the robot', 100 * cost['cpu'] / cost['wall'], '% of a core'),
        *_gaps('/odom stamps, 33.3 ms', stamps),
        *_gaps('/odom arrivals, 33.3 ms', arrivals),
        *_gaps('/scan arrivals, 200 ms', scans),
    ]


def arena(seconds: float) -> list[Row]:
    """Measure what a kernel costs in which a robot drives, with its arena open."""
    with Kernel() as kernel:
        kernel.run(CIRCLES)
        share = kernel.cpu_share(seconds)
    return [Row('real time, CPU of robot and open arena', share, '% of a core', at_most=12)]


def _gaps(what: str, times: list[float]) -> list[Row]:
    gaps = sorted(1e3 * (later - earlier) for earlier, later in itertools.pairwise(times))
    if not gaps:
        return []
    return [
        Row(f'{what}: median', statistics.median(gaps), 'ms'),
        Row(f'{what}: standard deviation', statistics.pstdev(gaps), 'ms'),
        Row(f'{what}: 99 of 100 below', gaps[int(0.99 * (len(gaps) - 1))], 'ms'),
        Row(f'{what}: longest', gaps[-1], 'ms'),
    ]


def fast_time(seconds: float) -> list[Row]:
    """Measure how much faster than real time a robot on topics really runs."""
    rows: list[Row] = []
    for speed in (5.0, 20.0, 100.0):
        robot = RobotProcess(speed=speed)
        robot.begin()
        time.sleep(seconds)
        cost = robot.end()
        rate = cost['time'] / cost['wall']
        # What is begun last may not have ended when it is looked at.
        goal = 0.99 * speed
        share = 100 * cost['cpu'] / cost['wall']
        rows.append(Row(f'on topics, speed={speed:g}', rate, 's per s', at_least=goal))
        rows.append(Row(f'on topics, speed={speed:g}, CPU', share, '% of a core', at_most=100))
    return rows


def lockstep(count: int) -> list[Row]:
    """Measure the round trip in lock-step: command there, odometry back, another process."""
    import rclpy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    robot = RobotProcess(lockstep=0.1)
    rclpy.init()
    node = rclpy.create_node('controller')
    commands = node.create_publisher(Twist, '/cmd_vel', 10)
    trips: list[float] = []

    def answer(_: Odometry) -> None:
        trips.append(time.perf_counter())
        commands.publish(Twist())

    node.create_subscription(Odometry, '/odom', answer, 10)
    while len(trips) <= count:
        rclpy.spin_once(node, timeout_sec=1)
        if len(trips) <= 1:
            # The first answer may go out before the robot has found this publisher.
            commands.publish(Twist())
    robot.begin()
    robot.end()
    node.destroy_node()
    rclpy.shutdown()
    gaps = sorted(1e3 * (later - earlier) for earlier, later in itertools.pairwise(trips[10:]))
    return [Row('lock-step, round trip: median', statistics.median(gaps), 'ms')]
