"""Time that a check lets pass in another process: exact there, too, and undone afterwards."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from labkit.background.domains import claim_domain

NODE = Path(__file__).resolve().parents[1] / 'counter_node.py'
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
# The same, until the driver lets it go on. It answers.
BUSY = HANGS.replace(
    "node = Counter('ones')",
    "from std_msgs.msg import Int16\nnode = Counter('ones')\n"
    "node.create_subscription(Int16, 'asked', node.publisher.publish, 10)",
).replace(
    'time.sleep(600)',
    "import os\nwhile not os.path.exists('go_on'):\n    time.sleep(0.01)\nrclpy.spin(node)",
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
# Says how many seconds its ROS clock has gone since it was made, and never less than before.
CLOCKED = (
    COUNTS
    + """
from std_msgs.msg import Int16
class Clocked(Counter):
    first = last = 0
    def on_timer(self):
        now = self.get_clock().now().nanoseconds // 10**9
        self.first = self.first or now
        if now - self.first >= self.last:
            self.last = now - self.first
            self.publisher.publish(Int16(data=self.last))
rclpy.spin(Clocked('ones'))
"""
)
SLEEPS = """rclpy.init()
import time
class Sleeps(Counter):
    def __init__(self):
        super().__init__('ones')
    def on_timer(self):
        super().on_timer()
        time.sleep(0.5)
"""
DRIVER = """
import json, subprocess, sys
import labkit as lab
from labkit.exercises.observation import live
from labkit.exercises.probe import Probe
from labkit.exercises.time.remote_time import RemoteTime
from labkit.exercises.what_is_asked import Scope

TOPICS = {'/odds': 'std_msgs/msg/Int16'}
lab.start()
process = subprocess.Popen([sys.executable, '-c', PROGRAM])


def see():
    with Probe('ones', Scope(publishes=TOPICS)) as probe:
        assert probe.wait(lambda: probe.publishers('/odds'))
        return live(probe, TOPICS, nodes=['/ones'], step=0.02)


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


@pytest.mark.slow('hundreds of messages of another process')
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


@pytest.mark.slow('several checks of another process')
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


@pytest.mark.slow('another process, in real time')
def test_node_that_is_not_spun_is_left_in_real_time(drive: Callable[..., Any]) -> None:
    said = drive(NOT_SPUN, 'life = see()\nsay(remote=list(life.remote), count=len(life.samples))')
    assert said['remote'] == []


def test_node_whose_clock_nobody_tells_is_not_woken(drive: Callable[..., Any]) -> None:
    told = "rclpy.init(args=['--ros-args', '-p', 'use_sim_time:=true'])"
    dead = SPUN.replace('rclpy.init()', told)
    said = drive(
        dead,
        """
life = see()
say(remote=list(life.remote), count=len(life.on('/odds')))
""",
    )
    assert said == {'remote': [], 'count': 0}


@pytest.mark.slow('starts other processes')
def test_a_node_that_waits_for_a_clock_does_not_hear_that_of_a_check(
    drive: Callable[..., Any],
) -> None:
    """It is not the check's business, and dead in reality."""
    said = drive(
        SPUN,
        """
from rclpy.node import Node
from rclpy.parameter import Parameter
dead = lab.spin(Node('dead', parameter_overrides=[Parameter('use_sim_time', value=True)]))
ticks = []
dead.create_timer(0.1, lambda: ticks.append(1))
life = see()
say(remote=list(life.remote), ticks=len(ticks), clock=dead.get_clock().now().nanoseconds)
""",
    )
    assert said == {'remote': [], 'ticks': 0, 'clock': 0}


@pytest.mark.slow('another process, in real time')
def test_the_next_check_begins_where_the_last_one_has_ended(drive: Callable[..., Any]) -> None:
    said = drive(
        CLOCKED,
        """
last = [see().on('/odds')[-1].message.data for _ in range(2)]
say(gone=last[1] - last[0])
""",
    )
    assert 25 <= said['gone'] <= 60


@pytest.mark.slow('another process, in real time')
def test_a_node_that_needs_more_time_than_it_is_told_is_seen_in_real_time(
    drive: Callable[..., Any],
) -> None:
    said = drive(
        SPUN.replace("Counter('ones')", 'Sleeps()').replace('rclpy.init()', SLEEPS),
        """
from labkit.exercises.time.learner_time import _REAL
began = _REAL['monotonic']()
life = see()
long = _REAL['monotonic']() - began > 20
say(remote=list(life.remote), lost=list(life.lost), real=list(life.real), long=long)
""",
    )
    assert said == {'remote': [], 'lost': [], 'real': ['/ones'], 'long': False}


@pytest.mark.slow('another process, in real time')
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
        remote.settle()
        say(followed=followed, names=remote.names, slow=remote.slow)
""",
    )
    assert said == {'followed': ['/ones'], 'names': [], 'slow': True}


@pytest.mark.slow('another process, in real time')
def test_node_that_was_given_up_is_waited_for_until_it_has_caught_up(
    drive: Callable[..., Any],
) -> None:
    said = drive(
        BUSY,
        """
import pathlib
with Probe('ones', Scope(publishes=TOPICS)) as probe:
    assert probe.wait(lambda: probe.publishers('/odds'))
    watch, ask = probe.watch('/odds', TOPICS['/odds']), probe.sender('/asked', TOPICS['/odds'])
    with RemoteTime(probe.spun_node, ['/ones']) as remote:
        for second in range(1, 20):
            remote.set(second * 1_000_000_000)
        ask({'data': -7})
        pathlib.Path('go_on').touch()
        remote.catch_up()
        watch.pump()
        say(names=remote.names, answered=-7 in watch.values('data'))
""",
    )
    assert said == {'names': [], 'answered': True}


@pytest.mark.slow('another process, in real time')
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


@pytest.mark.slow('another process, in real time')
def test_stop_button_while_time_is_given_back_waits_for_that(drive: Callable[..., Any]) -> None:
    said = drive(
        SPUN,
        """
import signal
from labkit.background.runtime import runtime
stopped = False
try:
    with Probe('ones', Scope(publishes=TOPICS)) as probe:
        assert probe.wait(lambda: probe.publishers('/odds'))
        with RemoteTime(probe.spun_node, ['/ones']) as remote:
            remote.set(1_000_000_000)
            clients = len(list(runtime.helper.clients))
            signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    stopped = True
left = [clients - len(list(runtime.helper.clients)), runtime.helper.count_publishers('/clock')]
say(stopped=stopped, left=left, guard=remote._guard.returncode)
""",
    )
    assert said == {'stopped': True, 'left': [1, 0], 'guard': 0}
