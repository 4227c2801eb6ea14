"""A player that was held up: it goes on with the pauses of the bag, and overruns nobody."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.views.bags import make_drive

PLAY = """
import time
import labkit as lab
from labkit.bags.player import Playing

moments = []
publish = Playing._publish

def held_up(self, message):
    if len(moments) == 5:
        time.sleep(1.0)
    moments.append(time.monotonic())
    publish(self, message)

Playing._publish = held_up
lab.play({path!r}, '/odom', rate=5.0, wait=True)
print(len(moments), moments[-1] - moments[5])
"""


@pytest.mark.slow('plays in real time')
def test_what_is_late_is_not_rushed_through(kernel: Any, tmp_path: Path) -> None:
    path = make_drive(tmp_path / 'drive', seconds=4.0)
    result = kernel.run(PLAY.format(path=str(path)))
    assert not result.error, result.traceback
    count, took = result.text.split()
    # 35 pauses of 20 ms each follow the message that was held up for a second: one that makes up
    # for it would take nothing for them.
    assert int(count) == 41 and float(took) > 0.5


CLOCK = """
import time
import labkit as lab
from labkit.bags.player import Playing
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

node = lab.spin(Node('hearer'))
clocks = []
node.create_subscription(
    Clock, '/clock', lambda msg: clocks.append(msg.clock.sec * 10**9 + msg.clock.nanosec), 5000
)
tick = Playing._publish_clock
ticks = 0

def held_up(self, sec):
    global ticks
    ticks += 1
    if ticks % 50 == 0:
        time.sleep(0.3)
    tick(self, sec)

Playing._publish_clock = held_up
lab.play({path!r}, '/odom', rate=5.0, clock=1000.0, wait=True)
print(len(clocks) > 50, clocks == sorted(clocks))
"""


@pytest.mark.slow('it is held up for seconds')
def test_time_does_not_go_back_when_the_player_was_held_up(kernel: Any, tmp_path: Path) -> None:
    path = make_drive(tmp_path / 'drive', seconds=4.0)
    result = kernel.run(CLOCK.format(path=str(path)))
    assert not result.error, result.traceback
    assert result.text == 'True True\n'
