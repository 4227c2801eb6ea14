"""Time that a check lets pass in another process: exact there, too, and undone afterwards."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from labkit.background.domains import claim_domain

NODE = Path(__file__).resolve().with_name('counter_node.py')
# What the other process runs: its nodes count on /odds.
COUNTS = f"""
import sys
sys.path.append({str(NODE.parent)!r})
import rclpy
from counter_node import Counter
rclpy.init()
"""
SPUN = COUNTS + "rclpy.spin(Counter('ones'))\n"
NOT_SPUN = COUNTS + "node = Counter('ones')\nimport time\ntime.sleep(600)\n"
# Spins until it has been told a time, and is busy then.
HANGS = (
    COUNTS
    + """
import time
node = Counter('ones')
while not node.get_clock().ros_time_is_active or not node.get_clock().now().nanoseconds:
    rclpy.spin_once(node)
time.sleep(600)
"""
)
# Does not answer in time, but takes what it was asked later.
SLOW = (
    COUNTS
    + """
import time
node = Counter('ones')
while '_check_ones' not in node.get_node_names():
    time.sleep(0.01)
time.sleep(8)
rclpy.spin(node)
"""
)
DRIVER = """
import json, subprocess, sys
import labkit as lab
from labkit.exercises.life import live
from labkit.exercises.probe import Probe
from labkit.exercises.remote_time import RemoteTime
from labkit.exercises.scope import Scope

TOPICS = {'/odds': 'std_msgs/msg/Int16'}
lab.start()
process = subprocess.Popen([sys.executable, '-c', PROGRAM])


def see():
    with Probe('ones', Scope(publishes=TOPICS)) as probe:
        assert probe.wait(lambda: probe.publishers('/odds'))
        return live(probe, TOPICS, nodes=['/ones'], tick=0.02, fine_sec=4.0, rest=0.02)


def say(**what):
    print(json.dumps(what))


try:
    ACTION
finally:
    process.kill()
    process.wait()
    lab.stop()
"""


@pytest.fixture
def drive(script: Callable[..., Any]) -> Callable[..., dict[str, Any]]:
    """Give a function that runs lines beside another process, and returns what they say."""

    def run(program: str, action: str) -> dict[str, Any]:
        lines = action.strip().replace('\n', '\n    ')
        code = DRIVER.replace('PROGRAM', repr(program)).replace('ACTION', lines)
        claim = claim_domain()
        done = script(
            code, ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST', ROS_DOMAIN_ID=str(claim.domain_id)
        )
        claim.close()
        assert done.exit_code == 0, done.stderr
        said: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return said

    return run


def test_each_message_of_another_process_has_its_exact_time(drive: Callable[..., Any]) -> None:
    said = drive(
        SPUN,
        """
for _ in range(2):
    life = see()
    samples = [s for s in life.on('/odds') if s.at <= 4.0]
    gaps = {round(b.at - a.at, 6) for a, b in zip(samples, samples[1:])}
    say(remote=list(life.remote), gaps=sorted(gaps), count=len(samples))
""",
    )
    assert said == {'remote': ['/ones'], 'gaps': [0.02], 'count': 200}


def test_afterwards_time_is_real_there(drive: Callable[..., Any]) -> None:
    said = drive(
        SPUN,
        """
see()
from std_msgs.msg import Int16
numbers = [m.data for m in lab.listen('/odds', Int16, count=5, timeout_sec=30)]
from labkit.background.runtime import runtime
say(clocks=runtime.helper.count_publishers('/clock'), step=numbers[-1] - numbers[0])
""",
    )
    assert said == {'clocks': 0, 'step': 4}


def test_node_that_is_not_spun_is_left_in_real_time(drive: Callable[..., Any]) -> None:
    said = drive(NOT_SPUN, 'life = see()\nsay(remote=list(life.remote), count=len(life.samples))')
    assert said['remote'] == []


def test_node_that_does_not_answer_any_more_is_not_asked_at_each_step(
    drive: Callable[..., Any],
) -> None:
    said = drive(
        HANGS,
        """
with Probe('ones', Scope(publishes=TOPICS)) as probe:
    assert probe.wait(lambda: probe.publishers('/odds'))
    with RemoteTime(probe.spun_node, ['/ones']) as remote:
        followed = list(remote.names)
        for second in range(1, 200):
            remote.set(second * 1_000_000_000)
        say(followed=followed, names=remote.names)
""",
    )
    assert said == {'followed': ['/ones'], 'names': []}


def test_node_that_answers_late_has_its_own_time_afterwards(drive: Callable[..., Any]) -> None:
    said = drive(
        SLOW,
        """
life = see()
from std_msgs.msg import Int16
lab.listen('/odds', Int16, count=5, timeout_sec=30)
say(remote=list(life.remote))
""",
    )
    assert said == {'remote': []}
