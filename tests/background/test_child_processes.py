"""Processes that a notebook starts: their nodes are waited for, whatever the machine is doing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from labkit.background.domains import claim_domain


@pytest.fixture
def env() -> Iterator[dict[str, str]]:
    claim = claim_domain()
    yield {
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(claim.domain_id),
    }
    claim.close()


# A machine may be so busy that a program stops for a second between two lines.
SLOW = """
import sys, time
import labkit as lab
from labkit.background import child_processes, service_calls
from labkit.background.child_processes import environment, start_process
from labkit.background.runtime import runtime
from labkit.rosgraph.listings import ends_of_node
from labkit.rosgraph.snapshot import node_names

PROGRAM = '''
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from labkit.background.program import spin_until_interrupted

rclpy.init()
node = Node('slow')
time.sleep(2)
node.create_subscription(String, 'late', print, 10)
{spin}
'''

def start(spin, announces):
    before = node_names(runtime.helper)
    program = PROGRAM.format(spin=spin)
    process = start_process(
        'slow', [sys.executable, '-c', program], environment(), announces=announces
    )
    process.wait_for_nodes(runtime.helper, before, 60)
    print(process.nodes, ends_of_node(runtime.helper, '/slow').names()['subscribers'])
    return process

lab.start()
"""


def test_a_program_that_announces_its_nodes_is_waited_for(
    script: Any, env: dict[str, str]
) -> None:
    result = script(SLOW + 'process = start("spin_until_interrupted(node)", True)', **env)
    assert result.stdout == "['/slow'] ['/late']\n", result.stderr


def test_another_program_is_waited_for_until_it_answers(script: Any, env: dict[str, str]) -> None:
    result = script(
        SLOW
        + """
service_calls.wait_until_spun.__defaults__ = (60.0,)
process = start('rclpy.spin(node)', False)
print(process.announced)
""",
        **env,
    )
    assert result.stdout == "['/slow'] ['/late']\nNone\n", result.stderr


def test_a_program_that_ends_early_is_not_waited_for(script: Any, env: dict[str, str]) -> None:
    result = script(
        SLOW + 'process = start("raise SystemExit(5)", True)\nprint(process.exit_code)', **env
    )
    assert result.stdout == '[] []\n5\n', result.stderr


def test_a_program_without_parameter_services_is_not_asked(
    script: Any, env: dict[str, str]
) -> None:
    result = script(
        SLOW.replace("Node('slow')", "Node('slow', start_parameter_services=False)").replace(
            'time.sleep(2)', ''
        )
        + "process = start('rclpy.spin(node)', False)\n",
        **env,
    )
    # What else it has, only time can tell.
    assert result.stdout.startswith("['/slow'] "), result.stderr


STADIUM = """
import psutil
from labkit.background.runtime import runtime
from labkit.lessons.odds import stadium
from labkit.rosgraph.listings import ends_of_node
from labkit.rosgraph.snapshot import node_names, read_graph

def nodes():
    return [name for name in node_names(runtime.helper) if not name.startswith('/_')]

def gates():
    infos = runtime.helper.get_publishers_info_by_topic('/visitors')
    return sorted(f'/{info.node_name}' for info in infos)

def is_open():
    stadium.open_stadium()
    wrong = stadium.wrong_gates()
    assert nodes() == sorted(stadium.NODES), nodes()
    assert gates() == sorted(stadium.GATES), gates()
    assert len(wrong) == 1 and wrong[0] in stadium.GATES, wrong

is_open()
"""


def test_a_stadium_that_is_opened_again_says_goodbye(script: Any, env: dict[str, str]) -> None:
    code = """
is_open()
stadium._process.stop()
print(nodes(), gates(), stadium.wrong_gates(), stadium._process.exit_code)
"""
    result = script(STADIUM + code, **env)
    assert result.stdout == '[] [] [] 0\n', result.stderr


def test_of_a_stadium_that_was_killed_nothing_is_shown(script: Any, env: dict[str, str]) -> None:
    code = """
supervisor = psutil.Process(stadium._process._supervisor.pid)
for child in supervisor.children(recursive=True):
    child.kill()
runtime.wait(lambda: not nodes(), 5.0)
graph = read_graph(runtime.helper)
print(nodes(), graph.nodes, graph.topics, runtime.foreign_nodes(), stadium.wrong_gates())
print(len(gates()))  # ROS itself remembers them for 20 s
is_open()
stadium._process.stop()
"""
    result = script(STADIUM + code, **env)
    assert result.stdout == '[] () () set() []\n5\n', result.stderr
