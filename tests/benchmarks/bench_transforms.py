"""How fast transforms are looked up, and what hearing a thousand of them in a second costs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

from table import Row

__all__ = ['tables']

# A listener in a process of its own, on labkit's background thread as in a notebook. It tells what
# it cost when its standard input closes.
LISTENER = """
import json, sys, time
import labkit as lab
from rclpy.node import Node
from tf2_ros import Buffer, TransformListener

lab.start()
node, buffer = Node('listener'), Buffer()
heard = 0


class Counting(TransformListener):
    def callback(self, data):
        global heard
        heard += len(data.transforms)
        super().callback(data)


listener = Counting(buffer, node)
lab.spin(node)
lab.wait_until(lambda: heard, timeout_sec=60)
print('ready', flush=True)
sys.stdin.readline()
wall, cpu, before = time.perf_counter(), time.process_time(), heard
sys.stdin.readline()
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
print(json.dumps({'share': cpu / wall, 'rate': (heard - before) / wall}))
lab.stop()
"""
# Sends so many messages in a second, each with so many transforms of frames that move.
SENDER = """
import sys, time
import labkit as lab
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_ros import TransformBroadcaster

rate, size = map(int, sys.argv[1:])
lab.start()
node = Node('sender')
broadcaster = TransformBroadcaster(node)
frames = [TransformStamped(child_frame_id=f'frame{number}') for number in range(size)]


began, sent = time.monotonic(), 0


def catch_up():
    # As many as are due, since a busy machine calls a timer late.
    global sent
    while sent < (time.monotonic() - began) * rate:
        sent += 1
        send()


def send():
    now = node.get_clock().now().to_msg()
    for frame in frames:
        frame.header.frame_id, frame.header.stamp = 'odom', now
        frame.transform.rotation.w = 1.0
    broadcaster.sendTransform(frames)


node.create_timer(0.01, catch_up)
lab.spin(node)
sys.stdin.readline()
lab.stop()
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
            *(looked_up(frames, 20 if quick else 3000) for frames in (5, 50)),
            *heard(1000, 1, 1 if quick else 10),
            *heard(100, 10, 1 if quick else 10),
        ]
    finally:
        claim.close()
        os.environ.clear()
        os.environ.update(before)
    yield 'Transforms', rows


def looked_up(frames: int, count: int) -> Row:
    """Look through a chain of so many moving frames, between two samples."""
    from geometry_msgs.msg import TransformStamped
    from rclpy.time import Time

    from labkit.transforms.buffer_core import BufferCore

    buffer = BufferCore()
    for second in (1, 2):
        for number in range(frames):
            one = TransformStamped(child_frame_id=f'frame{number + 1}')
            one.header.frame_id, one.header.stamp.sec = f'frame{number}', second
            one.transform.translation.x, one.transform.rotation.w = 1.0, 0.9
            one.transform.rotation.z = 0.1 * second
            buffer.set_transform(one, 'the benchmark')
    asked = 'frame0', f'frame{frames}', Time(seconds=1, nanoseconds=500_000_000)
    began = time.process_time()
    for _ in range(count):
        buffer.lookup_transform_core(*asked)
    return Row(f'lookups through {frames} frames', count / (time.process_time() - began), '/s')


def heard(rate: int, size: int, seconds: float) -> Iterator[Row]:
    """Hear so many messages in a second, each with so many transforms."""
    listener, sender = _start(LISTENER), _start(SENDER, str(rate), str(size))
    assert listener.stdout.readline() == 'ready\n'
    listener.stdin.write('\n')
    listener.stdin.flush()
    time.sleep(seconds)
    told = json.loads(listener.communicate('\n')[0])
    sender.communicate('\n')
    what = f'{rate} messages of {size}'
    yield Row(f'{what}: transforms heard', told['rate'], '/s')
    yield Row(f'{what}: processor', 100 * told['share'], '% of a core', at_most=20)


def _start(code: str, *words: str) -> Any:
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [sys.executable, '-c', code, *words], stdin=pipe, stdout=pipe, text=True
    )
