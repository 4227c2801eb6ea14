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


def test_a_process_that_wants_a_processor_is_still_starting(script: Any) -> None:
    result = script(
        """
import subprocess, sys, time
import psutil
from labkit.background import child_processes

child_processes._YOUNG_SEC = 0.0  # as if it had been started long ago
idle = subprocess.Popen([sys.executable, '-S', '-c', 'input()'], stdin=subprocess.PIPE)
while psutil.Process(idle.pid).status() != psutil.STATUS_SLEEPING:
    time.sleep(0.01)
print(child_processes.starting_children([]))
busy = subprocess.Popen([sys.executable, '-S', '-c', 'while True: pass'])
while psutil.Process(busy.pid).status() != psutil.STATUS_RUNNING:
    time.sleep(0.01)
print(child_processes.starting_children([]))
busy.kill()
idle.kill()
"""
    )
    assert result.stdout == '(False, False)\n(True, False)\n', result.stderr


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
    assert script(STADIUM + code, **env).stdout == '[] [] [] 0\n'


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


CHILD = """
import rclpy
from rclpy.node import Node
rclpy.init()
try:
    rclpy.spin(Node('child'))
except KeyboardInterrupt:
    pass
"""
STARTED = {
    'Popen': 'subprocess.Popen([sys.executable, path])',
    'a shell': 'subprocess.Popen(f"{python} {path}; true", shell=True)',
    'asyncio': 'await asyncio.create_subprocess_exec(sys.executable, path)',
    'a shell of asyncio': 'await asyncio.create_subprocess_shell(f"{python} {path}; true")',
    'a session of its own': 'subprocess.Popen([sys.executable, path], start_new_session=True)',
}


@pytest.mark.parametrize('how', STARTED)
def test_a_child_is_seen_starting_and_can_be_interrupted(
    start_kernel: Any, env: dict[str, str], how: str
) -> None:
    kernel = start_kernel(**env)
    kernel.run(
        'import asyncio, subprocess, sys, time\n'
        'import labkit as lab\n'
        'from labkit.background.child_processes import *\n'
        'from labkit.background.child_processes import ended_children\n'
        'from labkit.background.runtime import runtime\n'
        'python, path = sys.executable, "child.py"\nlab.start()\n'
        f'open(path, "w").write({CHILD!r})\n'
        'def gids():\n'
        '    infos = runtime.helper.get_publishers_info_by_topic("/parameter_events")\n'
        '    return [bytes(i.endpoint_gid) for i in infos if i.node_name == "child"]\n'
    )
    starting = kernel.run(f'child = {STARTED[how]}\nprint(starting_children([]))')
    assert (starting.error, starting.text) == ('', '(True, False)\n')
    seen = kernel.run(
        'print(runtime.wait(gids, 50))\n'
        'print(runtime.wait(lambda: starting_children(gids())[0] is False, 50))\n'
        'print(interrupt_child(gids()[0]), interrupt_child(b"\\0" * 16))\n'
        'print(runtime.wait(lambda: not gids(), 50))\n'
    )
    assert (seen.error, seen.text) == ('', 'True\nTrue\nTrue False\nTrue\n')
    ended = kernel.run('print(runtime.wait(ended_children, 50))')
    assert (ended.error, ended.text) == ('', 'True\n')
    if 'asyncio' in how:  # its loop learns of the end between two cells
        kernel.run('while child.returncode is None:\n    await asyncio.sleep(0.01)')
    told = kernel.run(
        'print(ended_children() == ended_children())\n'
        '(end,) = ended_children()\nprint(end.pid == child.pid, end.exit_code)\nprint(end.command)'
    )
    assert told.error == ''
    assert told.text.startswith('True\nTrue 0\n')
    assert 'child.py' in told.text


def test_a_child_that_has_ended_is_told_and_can_still_be_waited_for(script: Any) -> None:
    code = """
import os, signal, subprocess, sys
from labkit.background.child_processes import environment, start_process
from labkit.background.child_processes import ended_children
from labkit.background.runtime import runtime

def start(code):
    return subprocess.Popen([sys.executable, '-S', '-c', code])

waited, zombie = start('raise SystemExit(3)'), start('raise SystemExit(4)')
running = start('import time; time.sleep(99)')
killed = start('import os; os.kill(os.getpid(), 9)')
pid = os.fork()
if pid == 0:
    os._exit(5)
own = start_process('own', ['true'], environment())
own._reader.join()
waited.wait()
while len(ended_children()) < 4:
    pass
told = {child.pid: (child.exit_code, child.command[-1:]) for child in ended_children()}
print(told[waited.pid], told[zombie.pid], told[pid], told[killed.pid][0], running.pid in told)
print(zombie.wait(), killed.wait(), os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))
running.kill()
"""
    result = script(code)
    told = "(3, ('raise SystemExit(3)',)) (4, ('raise SystemExit(4)',)) (5, ()) -9 False\n4 -9 5\n"
    assert result.stdout == told, result.stderr
