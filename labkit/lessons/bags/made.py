"""Bags that exercises and the quiz are about. What is in them is drawn anew each time."""

from __future__ import annotations

import math
import os
import random
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from labkit.errors import LabError

__all__ = [
    'TRIP',
    'TRIP_TOPICS',
    'make_commands',
    'make_trip',
    'silent_topic',
    'stop_sec',
    'trip_is_missing',
]

TRIP = 'bags/trip'
TRIP_SEC = 20.0
# Topics of the trip, with how often they come, Hz.
TRIP_TOPICS = {'/battery': 1.0, '/imu': 20.0, '/odom': 10.0, '/scan': 5.0}
SPEED = 0.2
# Below this the robot stands, m/s.
STILL = 0.01


def make_commands(path: str | os.PathLike[str]) -> None:
    """Make a bag of thirty drawn commands on /cmd_vel, 20 a second, and of texts on /chatter."""
    from geometry_msgs.msg import Twist
    from std_msgs.msg import String

    rows: list[tuple[float, str, Any]] = []
    speeds = [
        (round(random.uniform(-0.22, 0.22), 3), round(random.uniform(-2.8, 2.8), 3))
        for _ in range(30)
    ]
    # One backwards, twice the same, a stop: a node that takes such for nothing is found out.
    speeds[6:10] = [(-0.15, 1.2), (-0.15, 1.2), (0.0, 0.0), (0.2, -2.4)]
    for number, (speed, turn) in enumerate(speeds):
        command = Twist()
        command.linear.x, command.angular.z = speed, turn
        rows.append((0.05 * number, '/cmd_vel', command))
        if number % 10 == 0:
            rows.append((0.05 * number + 0.01, '/chatter', String(data=f'part {number // 10}')))
    _write(Path(path), rows)


def make_trip(path: str | os.PathLike[str] = TRIP) -> None:
    """Make a bag of a trip: a robot drives against a wall, and later one of its topics stops.

    Args:
        path: The folder of the bag; one that is there is replaced.
    """
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import BatteryState, Imu, LaserScan

    classes: dict[str, Any] = {
        '/battery': BatteryState,
        '/imu': Imu,
        '/odom': Odometry,
        '/scan': LaserScan,
    }
    hit = round(random.uniform(5.0, 10.0), 1)
    silent = random.choice(['/imu', '/scan'])
    until = random.uniform(13.0, 16.0)
    rows: list[tuple[float, str, Any]] = []
    for topic, hz in TRIP_TOPICS.items():
        for number in range(round(TRIP_SEC * hz) + 1):
            moment = number / hz
            if topic == silent and moment > until:
                break
            message = classes[topic]()
            if topic == '/odom':
                message.pose.pose.position.x = SPEED * min(moment, hit)
                message.pose.pose.orientation.w = 1.0
                message.twist.twist.linear.x = SPEED if moment < hit else 0.0
            rows.append((moment, topic, message))
    _write(Path(path), rows)


def silent_topic() -> str:
    """Return the topic of the trip that stops before the others."""
    from labkit.bags.reader import open_bag

    with open_bag(TRIP) as bag:
        ends = {topic.name: bag.stamps(topic.name)[-1] for topic in bag.topics}
        return min(ends, key=lambda name: int(ends[name]))


def stop_sec() -> float:
    """Return when the robot of the trip has come to a stop, s since the bag begins."""
    from labkit.bags.reader import open_bag

    with open_bag(TRIP) as bag:
        for found in bag.messages('/odom'):
            if abs(found.message.twist.twist.linear.x) < STILL:
                return (found.stamp_ns - bag.start_ns) / 1e9
    return math.nan


def trip_is_missing(_: object = None) -> str:
    """Return what to do if the bag of the trip is not there, '' if it is."""
    from labkit.bags.reader import open_bag

    try:
        open_bag(TRIP).close()
    except LabError:
        return f'There is no bag {TRIP!r} at this moment. Run the cell that makes it.'
    return ''


def _write(path: Path, rows: Iterable[tuple[float, str, Any]]) -> None:
    """Write messages to a bag, in order of time; one that is there is replaced."""
    from rclpy.qos import QoSProfile
    from rclpy.serialization import serialize_message

    from labkit.bags.metadata import profiles_to_text
    from labkit.bags.schemas import ENCODING, full_definition
    from labkit.bags.writer import BagWriter
    from labkit.rosgraph.interfaces import type_name

    start = time.time_ns()
    writer = BagWriter(path, overwrite=True)
    numbers: dict[str, int] = {}
    for seconds, topic, message in sorted(rows, key=lambda row: row[:2]):
        if topic not in numbers:
            name = type_name(type(message))
            qos = profiles_to_text([QoSProfile(depth=50)])  # type: ignore[no-untyped-call]
            numbers[topic] = writer.add_topic(
                topic, name, qos=qos, definition=full_definition(name), encoding=ENCODING
            )
        stamp = start + round(seconds * 1e9)
        writer.write([(numbers[topic], stamp, stamp, serialize_message(message))])
    writer.close()
