"""A recording against a bare subscription that only counts: throughput, CPU time, memory.

Somebody publishes as fast as is heard, and never is more than a window ahead, so that nothing is
lost on the way: small messages another process, which knows from a file in memory how many have
come; large ones a thread of this process, since the middleware takes them apart on their way
between processes, and is slower than either. Of large ones it waits until they are written, too:
they come faster than a disk takes them, and a recorder then leaves some out, and says so. Both
hear raw messages, with the same QoS, and take turns, and a recording has ended when all is
written; what counts is the ratio.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from table import Row
from turns import Figures, take_turns

from labkit.background import domains

__all__ = ['tables']

FLOOD = """
import struct, time
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String, UInt8MultiArray

def flood(node, size, count, window, came):
    small = size < 10000
    kind = String if small else UInt8MultiArray
    data = serialize_message(kind(data='x' * size if small else bytes(size)))
    publisher = node.create_publisher(kind, '/flood', QoSProfile(depth=2 * window))
    while publisher.get_subscription_count() == 0:
        time.sleep(0.01)
    print('begin', flush=True)
    sent = 0
    while sent < count:
        if sent - came() < window:
            publisher.publish(data)
            sent += 1
        else:
            time.sleep(0.0002)
"""
PUBLISHER = """
import mmap, sys
import rclpy

with open(sys.argv[1], 'r+b') as file:
    shared = mmap.mmap(file.fileno(), 8)
rclpy.init()
node = rclpy.create_node('flood')
flood(node, *map(int, sys.argv[2:]), lambda: struct.unpack('<q', shared[:8])[0])
sys.stdin.read()
"""
HEARER = """
import json, mmap, os, subprocess, sys, threading
import psutil
import labkit as lab

way, folder, storage = sys.argv[1:4]
size, count, window = map(int, sys.argv[4:])
lab.start()
from rclpy.event_handler import SubscriptionEventCallbacks
from labkit.background.nodes import helper_node

path = os.path.join(folder, 'came')
with open(path, 'w+b') as file:
    file.write(bytes(8))
    file.flush()
    shared = mmap.mmap(file.fileno(), 8)
bag = os.path.join(folder, 'bag')
if way == 'record':
    recording = lab.record(bag, '/flood', storage=storage, timeout_sec=0)
    came = lambda: recording.count + recording.lost
    done = lambda: came() - recording.waiting
else:
    # With no more than the recorder has: what else a node has makes each message dearer.
    heard = [0]

    def hear(data):
        heard[0] += 1

    node = lab.spin(helper_node('bare'))
    kind = String if size < 10000 else UInt8MultiArray
    events = SubscriptionEventCallbacks(use_default_callbacks=False)
    node.create_subscription(
        kind, '/flood', hear, QoSProfile(depth=1000), event_callbacks=events, raw=True
    )
    came = done = lambda: heard[0]
if size < 10000:
    publisher = subprocess.Popen(
        [sys.executable, '-c', {publisher!r}, path, str(size), str(count), str(window)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )
    publisher.stdout.readline()
else:
    node = lab.spin(helper_node('flood'))
    threading.Thread(target=flood, args=(node, size, count, window, done), daemon=True).start()
process = psutil.Process()
cpu, begin = sum(process.cpu_times()[:2]), time.perf_counter()
rss, last, moved = [], 0, begin
while last < count:
    time.sleep(0.001)
    shared[:8] = struct.pack('<q', came())
    now = done()
    if now != last:
        last, moved = now, time.perf_counter()
        if now >= count * (len(rss) + 1) / 20:
            rss.append(process.memory_info().rss)
    elif time.perf_counter() > moved + 20:
        break
end = time.perf_counter()
lost = count - last
if way == 'record':
    recording.stop()
    lost += recording.lost  # these have come, and were not written
cpu = sum(process.cpu_times()[:2]) - cpu
if size < 10000:
    publisher.kill()
    publisher.communicate()
print(json.dumps({{
    'rate': last / (end - begin),
    'cpu': 1e6 * cpu / count,
    'lost': lost,
    'growth': (rss[-1] - rss[len(rss) // 2]) / 1e6 if rss else 0.0,
}}))
"""


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of each table."""
    claim = domains.claim_domain()
    try:
        yield from _tables(quick, claim.domain_id)
    finally:
        claim.close()


def _tables(quick: bool, domain_id: int) -> Iterator[tuple[str, list[Row]]]:
    for name, size, count, window in (
        ('100 B', 100, 200 if quick else 30000, 500),
        ('1 MB', 1_000_000, 20 if quick else 600, 20),
    ):
        ways = {
            way: partial(_heard, way, size, count, window, domain_id)
            for way in ('bare', 'mcap', 'sqlite3')
        }
        seen = take_turns(ways, ('rate',), 1 if quick else 3)
        yield f'Recording messages of {name}', list(_rows(seen, quick))


def _rows(seen: dict[str, list[Figures]], quick: bool) -> Iterator[Row]:
    typical = {
        way: {key: statistics.median(each[key] for each in found) for key in found[0]}
        for way, found in seen.items()
    }
    words = {'bare': 'a bare subscription', 'mcap': 'to mcap', 'sqlite3': 'to sqlite3'}
    for way, name in words.items():
        yield Row(f'throughput: {name}', typical[way]['rate'], 'messages/s')
    for way in ('mcap', 'sqlite3'):
        ratio = typical[way]['rate'] / typical['bare']['rate']
        yield Row(f'throughput: {words[way]} / bare', ratio, '', at_least=0.8)
    for way, name in words.items():
        yield Row(f'CPU time a message: {name}', typical[way]['cpu'], 'us')
    for way in ('mcap', 'sqlite3'):
        lost = max(each['lost'] for each in seen[way])
        yield Row(f'lost: {words[way]}', lost, 'messages', at_most=0)
        limit = None if quick else 20.0
        yield Row(f'memory, second half: {words[way]}', typical[way]['growth'], 'MB', limit)


def _heard(way: str, size: int, count: int, window: int, domain_id: int) -> Figures:
    code = FLOOD + HEARER.format(publisher=FLOOD + PUBLISHER)
    storage = 'mcap' if way == 'bare' else way
    variables = {
        **os.environ,
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(domain_id),
    }
    # In memory if there is such a place: the disk is not what is measured.
    place = '/dev/shm' if os.access('/dev/shm', os.W_OK) else None
    with tempfile.TemporaryDirectory(dir=place) as folder:
        words = ['bare' if way == 'bare' else 'record', folder, storage, size, count, window]
        done = subprocess.run(
            [sys.executable, '-c', code, *map(str, words)],
            capture_output=True,
            text=True,
            timeout=300,
            env=variables,
            cwd=Path(folder),
        )
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    result: Figures = json.loads(done.stdout.splitlines()[-1])
    return result
