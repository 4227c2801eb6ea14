"""Child processes, however they were started: starting, interrupted, ended."""

from __future__ import annotations

import time
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import psutil
import pytest

from labkit.background.domains import claim_domain
from labkit.programs.children import starting_children


@pytest.fixture
def env() -> Iterator[dict[str, str]]:
    claim = claim_domain()
    yield {
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(claim.domain_id),
    }
    claim.close()


# It has its publisher when it has all else: Ctrl-C while a node is made ends it in disorder.
CHILD = """
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init()
try:
    node = Node('child')
    node.create_publisher(String, 'ready', 1)
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""
STARTED = {
    'Popen': 'subprocess.Popen([sys.executable, path])',
    'a shell': 'subprocess.Popen(f"{python} {path}; true", shell=True)',
    'asyncio': 'await asyncio.create_subprocess_exec(sys.executable, path)',
    'a shell of asyncio': 'await asyncio.create_subprocess_shell(f"{python} {path}; true")',
    'a session of its own': 'subprocess.Popen([sys.executable, path], start_new_session=True)',
}


@pytest.mark.slow('starts other processes')
@pytest.mark.parametrize('how', STARTED)
def test_a_child_is_seen_starting_and_can_be_interrupted(
    start_kernel: Any, env: dict[str, str], how: str
) -> None:
    kernel = start_kernel(**env)
    kernel.run(
        'import asyncio, subprocess, sys, time\n'
        'import labkit as lab\n'
        'from labkit.programs.children import *\n'
        'from labkit.background.runtime import runtime\n'
        'python, path = sys.executable, "child.py"\nlab.start()\n'
        f'open(path, "w").write({CHILD!r})\n'
        'def gids():\n'
        '    infos = runtime.helper.get_publishers_info_by_topic("/ready")\n'
        '    return [bytes(info.endpoint_gid) for info in infos]\n'
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
from labkit.programs.child_processes import environment, start_process
from labkit.programs.children import ended_children
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


def test_a_child_has_ended_when_it_can_be_waited_for(script: Any) -> None:
    """A child whose main thread alone has ended is a zombie already, and still at work."""
    code = """
import subprocess, sys, psutil
from labkit.programs.children import ended_children

code = (
    'import ctypes, threading\\n'
    'threading.Thread(target=input).start()\\n'
    'ctypes.CDLL(None).pthread_exit(None)\\n'
)
child = subprocess.Popen([sys.executable, '-S', '-c', code], stdin=subprocess.PIPE)
while psutil.Process(child.pid).status() != psutil.STATUS_ZOMBIE:
    pass
print(ended_children())
child.kill()
while not ended_children():
    pass
print([each.exit_code for each in ended_children()])
"""
    result = script(code)
    assert result.stdout == '[]\n[-9]\n', result.stderr


def test_a_process_that_wants_a_processor_is_still_starting(script: Any) -> None:
    result = script(
        """
import subprocess, sys, time
import psutil
from labkit.programs import children

children._YOUNG_SEC = 0.0  # as if it had been started long ago
children._STARTING_CPU_SEC = float('inf')  # the busy one has its time, however long this takes
pipes = {'stdin': subprocess.PIPE, 'stdout': subprocess.PIPE}
idle = subprocess.Popen([sys.executable, '-S', '-c', 'print(flush=True); input()'], **pipes)
idle.stdout.readline()
while psutil.Process(idle.pid).status() != psutil.STATUS_SLEEPING:
    time.sleep(0.01)
used = {}
print(children.starting_children([], used=used), children.starting_children([], used=used))
used[idle.pid] -= 0.01
print(children.starting_children([], used=used), children.starting_children([], used=used))
code = (
    'import threading\\ndef work():\\n    while True: pass\\n'
    'threading.Thread(target=work).start(); print(flush=True); input()'
)
busy = subprocess.Popen([sys.executable, '-S', '-c', code], **pipes)
busy.stdout.readline()
while psutil.Process(busy.pid).status() != psutil.STATUS_SLEEPING:  # its main thread
    time.sleep(0.01)
print(*{children.starting_children([], used=used) for _ in range(100)})
busy.kill()
idle.kill()
"""
    )
    told = 2 * '(True, False) (False, False)\n' + '(True, False)\n'
    assert result.stdout == told, result.stderr


def test_a_process_that_has_a_port_of_the_domain_is_on_its_way(script: Any) -> None:
    result = script(
        """
import subprocess, sys, time
import psutil
from labkit.programs import children

children._YOUNG_SEC = 0.0  # as if it had been started long ago
code = (
    'import socket; end = socket.socket(type=socket.SOCK_DGRAM); end.bind(("127.0.0.1", 0)); '
    'print(end.getsockname()[1], flush=True); input()'
)
pipes = {'stdin': subprocess.PIPE, 'stdout': subprocess.PIPE}
idle = subprocess.Popen([sys.executable, '-S', '-c', code], **pipes)
port = int(idle.stdout.readline())
while psutil.Process(idle.pid).status() != psutil.STATUS_SLEEPING:
    time.sleep(0.01)
used = {}
children.starting_children([], used=used)
print(children.starting_children([], ports=[port + 1], used=used))
print(children.starting_children([], ports=[port], used=used))
gid = bytes(4) + (idle.pid & 0xFFFF).to_bytes(2, 'little') + bytes(10)
print(children.starting_children([gid], ports=[port]))
idle.kill()
"""
    )
    told = '(False, False)\n(True, False)\n(False, False)\n'
    assert result.stdout == told, result.stderr


def test_a_command_that_its_shell_starts_just_now_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    command = SimpleNamespace(
        pid=3, children=list, status=lambda: psutil.STATUS_RUNNING, create_time=time.time
    )
    # It is there when the shell is asked, and was not when all were listed.
    shell = SimpleNamespace(
        pid=2, children=lambda: [command], status=lambda: psutil.STATUS_SLEEPING
    )
    here = SimpleNamespace(children=lambda recursive=False: [shell])
    monkeypatch.setattr(psutil, 'Process', lambda: here)
    assert starting_children([]) == (True, False)
