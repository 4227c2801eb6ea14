"""Completion by the Tab key, as bash and IPython ask for it."""

from __future__ import annotations

import os
import subprocess
import sys
from argparse import Namespace
from pathlib import Path
from types import SimpleNamespace

import pytest

import labkit
from labkit.ros2 import graph_completion, terminal
from labkit.ros2.completion import complete_line


@pytest.mark.parametrize(
    ('line', 'words'),
    [
        ('to', ['topic']),
        ('topic ', ['bw', 'delay', 'echo', 'find', 'hz', 'info', 'list', 'pub', 'type']),
        ('topic e', ['echo']),
        ('topic --include-hidden-topics l', ['list']),
        ('topic echo --qos-r', ['--qos-reliability']),
        ('topic echo --qos-reliability best', ['best_available', 'best_effort']),
        (
            'topic pub /odds std_msgs/msg/Int1',
            ['std_msgs/msg/Int16', 'std_msgs/msg/Int16MultiArray'],
        ),
        ('topic pub /odds std_msgs/msg/Int16 ', ['"{data: 0}"']),
        ('topic pub -r 2 /odds std_msgs/msg/Int16 ', ['"{data: 0}"']),
        ('topic echo /o nav_msgs/msg/Odometry --field twist.twist.l', ['twist.twist.linear']),
        (
            'interface show std_srvs/',
            [f'std_srvs/srv/{n}' for n in ('Empty', 'SetBool', 'Trigger')],
        ),
        ('interface package nav', ['nav_msgs']),
        ('service call /switch std_srvs/srv/SetBool ', ['"{data: false}"']),
        ('pkg prefix rclp', ['rclpy']),
        ('run demo_nodes_py ', ['listener', 'talker']),
        ('nonsense ', []),
        ('topic nonsense ', []),
    ],
)
def test_words(line, words):
    _, found = complete_line(line)
    if line == 'topic echo /o nav_msgs/msg/Odometry --field twist.twist.l':
        found = found[:1]
    assert found == words


def test_the_word_that_is_begun_is_told():
    assert complete_line('interface show std_msgs/msg/Strin')[0] == 'std_msgs/msg/Strin'
    assert complete_line('topic echo ')[0] == ''
    assert complete_line('interface show "std_srvs/srv/Tr') == (
        *('"std_srvs/srv/Tr', ['"std_srvs/srv/Trigger']),
    )


@pytest.mark.slow('bash, many times')
@pytest.mark.usefixtures('robot')
def test_names_of_the_live_graph_in_bash(domain, lab_env):
    env = {**lab_env, **domain}

    def tab(line: str) -> list[str]:
        done = subprocess.run(
            [sys.executable, '-m', 'labkit.ros2', '--complete'],
            env={**env, 'COMP_LINE': line, 'COMP_POINT': str(len(line))},
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    assert tab('ros2 topic info /o') == ['/odds', '/odom']
    assert tab('ros2 node info ') == ['/fleet/robot', '/lamp']
    assert tab('ros2 topic echo /odom ') == ['nav_msgs/msg/Odometry']
    assert tab('ros2 param get /lamp sp') == ['speed']
    assert tab('ros2 service call /sw') == ['/switch']


def test_bash_line(lab_env, tmp_path):
    """The line that --completion prints makes bash complete `ros2`."""
    folder = tmp_path / 'bin'
    folder.mkdir()
    script = folder / 'ros2'
    script.write_text(f'#!/bin/sh\nexec {sys.executable} -m labkit.ros2 "$@"\n')
    script.chmod(0o755)
    test = (
        'eval "$(ros2 --completion)"; complete -p ros2; '
        "COMP_LINE='ros2 topic ec' COMP_POINT=13 ros2 --complete ros2 ec topic"
    )
    done = subprocess.run(
        ['bash', '-c', test],
        env={**lab_env, 'PATH': f'{folder}{os.pathsep}{lab_env["PATH"]}'},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stdout.splitlines() == [
        "complete -o default -C 'ros2 --complete' ros2",
        'echo',
    ], done.stderr


def test_the_file_for_bash_completion_says_the_same():
    folder = Path(labkit.__file__).parent / 'data/share/bash-completion/completions'
    assert (folder / 'ros2').read_text().splitlines()[-1] == terminal.BASH


def test_a_type_that_comes_a_moment_later_is_awaited(monkeypatch):
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    answers = iter([[], [], [('/odds', ['std_msgs/msg/Int16'])]])
    node = SimpleNamespace(get_topic_names_and_types=lambda: next(answers))
    monkeypatch.setattr(graph_completion, 'asking_node', lambda args: node)
    found = graph_completion.types_of_topic(Namespace(topic_name='/odds'))
    assert list(found) == ['std_msgs/msg/Int16']
