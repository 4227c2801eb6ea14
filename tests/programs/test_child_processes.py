"""Processes that a notebook starts: their nodes are waited for, however busy the machine is."""

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


# On a busy machine a program may need longer to end than a learner waits for it.
PATIENT = """
from pathlib import Path
from labkit.lessons import _companion
from labkit.programs import child_processes, children

hasty = children.SUPERVISOR.read_text()
supervisor = Path('supervisor.py').resolve()
supervisor.write_text(hasty.replace('GRACE_SEC = 6.0', 'GRACE_SEC = 60.0'))
assert supervisor.read_text() != hasty
children.SUPERVISOR = child_processes.SUPERVISOR = supervisor
child_processes.STOP_SEC = 90.0
_companion.START_SEC = 60.0
"""
# A machine may be so busy that a program stops for a second between two lines.
SLOW = (
    PATIENT
    + """
import sys, time
import labkit as lab
from labkit.programs import child_processes
from labkit.programs.child_processes import environment, start_process
from labkit.background.runtime import runtime
from labkit.rosgraph.listings import ends_of_node
from labkit.rosgraph.snapshot import node_names

PROGRAM = '''
import time
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from labkit.programs.program import spin_until_interrupted

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
)


def test_a_program_that_announces_its_nodes_is_waited_for(
    script: Any, env: dict[str, str]
) -> None:
    result = script(SLOW + 'process = start("spin_until_interrupted(node)", True)', **env)
    assert result.stdout == "['/slow'] ['/late']\n", result.stderr


@pytest.mark.slow('starts several programs')
def test_another_program_is_waited_for_until_it_answers(script: Any, env: dict[str, str]) -> None:
    result = script(
        SLOW
        + """
child_processes.SPUN_SEC = 60.0
process = start('rclpy.spin(node)', False)
print(process.announced)
""",
        **env,
    )
    assert result.stdout == "['/slow'] ['/late']\nNone\n", result.stderr


@pytest.mark.slow('starts several programs')
def test_a_program_that_ends_early_is_not_waited_for(script: Any, env: dict[str, str]) -> None:
    result = script(
        SLOW + 'process = start("raise SystemExit(5)", True)\nprint(process.exit_code)', **env
    )
    assert result.stdout == '[] []\n5\n', result.stderr


def test_what_a_companion_said_before_it_ended_is_told(script: Any, env: dict[str, str]) -> None:
    result = script(
        """
from pathlib import Path
from labkit.errors import LabTimeout
from labkit.lessons._companion import start_companion

Path('wreck.py').write_text("def main():\\n    print('no port')\\n    raise SystemExit(3)\\n")
try:
    start_companion('harbour', 'wreck', None)
except LabTimeout as error:
    print(error.message)
""",
        **env,
    )
    assert result.stdout == 'The harbour ended with code 3 before its nodes came.\nno port\n', (
        result.stderr
    )


@pytest.mark.slow('starts several programs')
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
    # Only time can tell whether it has more.
    assert result.stdout.startswith("['/slow'] "), result.stderr


STADIUM = (
    PATIENT
    + """
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
)


@pytest.mark.slow('starts several programs')
def test_a_stadium_that_is_opened_again_says_goodbye(script: Any, env: dict[str, str]) -> None:
    code = """
is_open()
stadium._process.stop()
print(nodes(), gates(), stadium.wrong_gates(), stadium._process.exit_code)
"""
    result = script(STADIUM + code, **env)
    assert result.stdout == '[] [] [] 0\n', result.stderr


@pytest.mark.slow('processes that are killed')
def test_of_a_stadium_that_was_killed_nothing_is_shown(script: Any, env: dict[str, str]) -> None:
    code = """
supervisor = psutil.Process(stadium._process._supervisor.pid)
for child in supervisor.children(recursive=True):
    child.kill()
runtime.wait(lambda: not nodes(), 60.0)
graph = read_graph(runtime.helper)
print(nodes(), graph.nodes, graph.topics, runtime.foreign_nodes(), stadium.wrong_gates())
print(len(gates()))  # ROS itself remembers them for 20 s
is_open()
stadium._process.stop()
"""
    result = script(STADIUM + code, **env)
    assert result.stdout == '[] () () set() []\n5\n', result.stderr


def test_what_an_ended_process_has_printed_is_all_there(script: Any, env: dict[str, str]) -> None:
    """Its reader has had no turn yet, as on a busy machine."""
    code = """
import sys, threading
from labkit.background.runtime import runtime
from labkit.programs import child_processes

turn, read = threading.Event(), child_processes.Process._read
child_processes.Process._read = lambda process: (turn.wait(), read(process))
program = 'print("one"); print("two", end="")'
process = child_processes.start_process(
    'short', [sys.executable, '-c', program], child_processes.environment()
)
shown = []
process._shown, runtime.console.write_under = True, lambda cell, line: shown.append(line)
process._supervisor.wait()
print(process.running, process.output)
turn.set()
process._reader.join()
print(shown)
"""
    result = script(code, **env)
    assert result.stdout == "False ['one', 'two']\n['one\\n', 'two']\n", result.stderr
