"""A cause is told only if it was seen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

BEGIN = """
import labkit as lab
from labkit.ros2.shell import run_line
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int16
from std_srvs.srv import SetBool

lab.start()
node = Node('mouth')
lab.spin(node)
"""


@pytest.mark.slow('starts other processes')
def test_a_service_that_has_clients_only(script: Callable[..., Any]) -> None:
    code = """
node.create_client(SetBool, '/nobody')
run_line('service call /nobody std_srvs/srv/SetBool')
"""
    result = script(BEGIN + code, LABKIT_HEADLESS='1')
    assert '/nobody has clients, but no node offers it.' in result.stderr
    assert 'Did you mean' not in result.stderr


def test_a_best_effort_subscription_that_asks_for_earlier_messages(
    script: Callable[..., Any],
) -> None:
    code = """
kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_publisher(Int16, '/map', kept).publish(Int16(data=1))
run_line('topic echo /map --qos-durability transient_local --timeout 0.1')
run_line('topic echo /map --qos-durability transient_local --qos-reliability reliable --once')
"""
    result = script(BEGIN + code)
    assert 'a subscription that is BEST_EFFORT gets only new ones' in result.stderr
    assert 'timer' not in result.stderr
    assert 'data: 1' in result.stdout


def test_a_talker_that_nobody_spins(script: Callable[..., Any]) -> None:
    code = """
idle = Node('idle')
idle.create_publisher(Int16, '/count', 10)
idle.create_timer(0.1, print)
run_line('topic echo /count --timeout 0.1')
run_line('topic hz /count --timeout 0.1')
"""
    result = script(BEGIN + code, LABKIT_HEADLESS='1')
    assert result.stderr.count('/idle is not spun: lab.spin(...) does that.') == 2
    assert 'publish()' not in result.stderr
