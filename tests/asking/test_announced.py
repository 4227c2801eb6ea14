"""What other processes announce, and what of it is there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import pytest
from rclpy.node import Node
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

import labkit
from labkit.asking.announced import Announced
from labkit.background import domains
from labkit.background.runtime import runtime

# A process with many topics, whose list is asked for as soon as it has begun.
MANY = """
import subprocess, sys
import labkit
from labkit.ros2.shell import run_line

code = '''
import rclpy, sys
from std_msgs.msg import String
rclpy.init()
nodes = [rclpy.create_node(f'node{number}') for number in range(5)]
for number, node in enumerate(nodes):
    for topic in range(10):
        node.create_publisher(String, f'said{number}_{topic}', 10)
        node.create_subscription(String, f'heard{number}_{topic}', print, 10)
print('ready', flush=True)
sys.stdin.read()
'''
other = subprocess.Popen([sys.executable, '-c', code], stdin=-1, stdout=-1)
other.stdout.readline()
run_line('topic list -c')
run_line('node list -c')
other.kill()
"""


@pytest.fixture
def node() -> Iterator[Node]:
    labkit.start()
    assert runtime.helper is not None
    yield runtime.helper
    labkit.stop()


def test_a_participant_counts_when_all_that_it_announces_is_there(node: Node) -> None:
    gid = bytes(node.get_publishers_info_by_topic('/parameter_events')[0].endpoint_gid)

    def announcement(*ends: bytes) -> ParticipantEntitiesInfo:
        own = NodeEntitiesInfo(writer_gid_seq=[Gid(data=list(end)) for end in ends])
        return ParticipantEntitiesInfo(gid=Gid(data=list(gid)), node_entities_info_seq=[own])

    with Announced(node) as announced:
        labkit.wait_until(lambda: announced.participants() == 1, timeout_sec=60)
        announced.note(announcement(gid, gid[:12] + bytes(4)))
        assert announced.participants() == 0
        announced.note(announcement(gid))
        assert announced.participants() == 1


def test_the_announcement_of_a_process_that_is_gone_counts_no_more(node: Node) -> None:
    with Announced(node) as announced:
        labkit.wait_until(lambda: announced.participants() == 1, timeout_sec=60)
        announced.note(ParticipantEntitiesInfo())
        assert announced.participants() == 1


@pytest.mark.slow('starts four processes')
def test_a_list_has_all_that_was_announced(script: Callable[..., Any]) -> None:
    with closing(domains.claim_domain()) as claim:
        env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
        done = script(MANY, **env)
    # The topics, and the two that every node has.
    assert (done.exit_code, done.stdout, done.stderr) == (0, '102\n5\n', '')
