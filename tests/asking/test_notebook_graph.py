"""A terminal asks the running notebook of its user what is on the graph, and nobody else."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import suppress

import pytest

from labkit.asking import notebook_graph
from labkit.asking.notebook_graph import ask_notebook
from labkit.background.domains import claim_domain

NODES = """
import labkit as lab
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci

node = lab.spin(Node('walle'))
node.create_publisher(String, 'chatter', 10)
node.create_publisher(String, '_hidden', 10)
node.create_service(Trigger, 'dance', print)
ActionServer(node, Fibonacci, 'count', print)
"""
# Tells whether ROS was started by a command, which then has discovered the nodes anew.
TERMINAL = """
from labkit.background.runtime import runtime
from labkit.ros2.shell import run_line
run_line({line!r})
print(runtime.started)
"""


@pytest.fixture
def variables(monkeypatch: pytest.MonkeyPatch):
    """A domain of its own, for this process and those that it starts."""
    claim = claim_domain()
    variables = {
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        'ROS_DOMAIN_ID': str(claim.domain_id),
    }
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    yield variables
    claim.close()


@pytest.mark.slow('each command in a terminal')
def test_a_terminal_is_told_what_it_would_find(start_kernel, lab_env, variables):
    kernel = start_kernel(**variables)
    kernel.run(NODES)

    def ask(line: str) -> tuple[list[str], str]:
        done = subprocess.run(
            [sys.executable, '-c', TERMINAL.format(line=line)],
            env={**lab_env, **variables},
            capture_output=True,
            text=True,
            check=True,
        )
        *lines, started = done.stdout.splitlines()
        return lines, started

    for line in (
        *('topic list -t', 'topic list --include-hidden-topics', 'topic list -c'),
        *('service list -t', 'node list -a', 'action list -t'),
        *('topic find std_msgs/msg/String', 'service find std_srvs/srv/Trigger'),
    ):
        told, started = ask(line)
        found, has_started = ask(f'{line} --no-daemon' if 'find' not in line else line)
        # A terminal that has looked by itself finds its own node, too.
        assert told and told == [each for each in found if 'node' not in line or each in told]
        assert (started, has_started) == ('False', 'False' if 'find' in line else 'True')
    kernel.run('lab.stop()')
    assert ask_notebook('topics') is None  # and the terminal looks by itself
    kernel.run(NODES)
    assert ('/chatter', ['std_msgs/msg/String']) in (ask_notebook('topics') or [])
    assert ask_notebook('secrets') is None


def test_a_forked_process_does_not_keep_terminals_waiting(start_kernel, variables):
    kernel = start_kernel(**variables)
    kernel.run(NODES)
    forked = kernel.run(
        'import os, signal\nchild = os.fork()\nif not child: signal.pause()\n'
        'print(os.getpid(), child)'
    )
    parent, child = map(int, forked.text.split())
    assert ask_notebook('nodes')
    os.kill(parent, signal.SIGKILL)
    try:
        with pytest.raises(ConnectionRefusedError):
            while True:  # until it has ended
                socket.socket(socket.AF_UNIX).connect(
                    f'\0labkit-graph-{os.getuid()}-{variables["ROS_DOMAIN_ID"]}'
                )
    finally:
        os.kill(child, signal.SIGKILL)


def test_another_user_who_takes_the_name_is_not_believed(monkeypatch, variables):
    monkeypatch.setattr(os, 'getuid', lambda: 4321)  # so the forger is another user than oneself
    with socket.socket(socket.AF_UNIX) as forger:
        forger.bind(f'\0labkit-graph-4321-{variables["ROS_DOMAIN_ID"]}')
        forger.listen()

        def answer() -> None:
            connection, _ = forger.accept()
            with connection, suppress(BrokenPipeError):  # the asker has gone
                connection.sendall(json.dumps([['/forged', []]]).encode())

        thread = threading.Thread(target=answer)
        thread.start()
        assert ask_notebook('nodes') is None
        thread.join()


def test_another_user_is_told_nothing(monkeypatch):
    server, asker = socket.socketpair()
    with server, asker:
        assert notebook_graph._is_own_user(server)
        monkeypatch.setattr(os, 'getuid', lambda: 4321)
        assert not notebook_graph._is_own_user(server)
