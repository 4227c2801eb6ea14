"""`ros2` with its output in a pipe says what the real one says; to people it explains."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

NOBODY = 'Action clients: 0\nAction servers: 0\n'
WAITING = 'Waiting for at least 1 matching subscription(s)...\n'
PREFIX = os.path.join(sys.prefix, 'share')

# A line, and exit code, standard output and standard error of the real one (0.32.2, of Jazzy).
ABSENT = {
    'topic type /nobody': (1, '', ''),
    'topic info /chater': (1, '', "Unknown topic '/chater'\n"),
    'topic find std_msgs/msg/Strin': (0, '', ''),
    'topic find -c std_msgs/msg/Strin': (0, '0\n', ''),
    'service type /swich': (1, '', ''),
    'service info /swich': (1, '', "Unknown service '/swich'\n"),
    'service find std_srvs/srv/SetBol': (0, '', ''),
    'service find -c std_srvs/srv/SetBol': (0, '0\n', ''),
    'action type /count': (1, '', ''),
    'action info /count': (0, f'Action: /count\n{NOBODY}', ''),
    'node info lamp': (1, '', "Unable to find node 'lamp'\n"),
    'param get /lump speed': (1, '', 'Node not found\n'),
    'param get /lamp sped': (1, '', 'Parameter not set\n'),
    'param describe /lamp pid.p spee': (
        0,
        'Parameter name: pid.p\n  Type: double\n  Constraints:\n',
        '',
    ),
    'param set /lamp speed fast': (
        0,
        '',
        "Setting parameter failed: Wrong parameter type, expected 'Type.INTEGER' got "
        "'Type.STRING'\n",
    ),
    'topic echo /cmd_vel --timeout 0.2': (0, '', ''),
    'topic echo /odom --field pose.x': (
        1,
        '',
        "Invalid field 'pose.x': 'PoseWithCovariance' object has no attribute 'x'\n",
    ),
    'topic echo /chater': (
        1,
        'WARNING: topic [/chater] does not appear to be published yet\n',
        'Could not determine the type for the passed topic\n',
    ),
    'topic pub --once --max-wait-time-secs 1 /Odds std_msgs/msg/Int16': (
        1,
        2 * WAITING,
        'Timed out waiting for subscribers: Expected 1 subcribers but only got 0 subscribers\n',
    ),
}
# The same, of what no graph is asked for.
NOT_INSTALLED = {
    'pkg prefix nowhere': (1, '', 'Package not found\n'),
    'pkg xml nowhere': (1, '', 'Package not found\n'),
    'pkg xml std_msgs -t nothing': (1, '', 'XML tag not found\n'),
    'interface package std_msg': (1, '', "Unknown package 'std_msg'\n"),
    'interface show nowhere/msg/String': (1, '', "Unknown package 'nowhere'\n"),
    'interface show std_msgs/msg/Strin': (
        1,
        '',
        f"Could not find the interface '{PREFIX}/std_msgs/msg/Strin.idl'\n",
    ),
    'interface show std_msgs/String': (
        1,
        '',
        "Invalid name 'std_msgs/String'. Expected three parts separated by '/'\n",
    ),
}


@pytest.mark.usefixtures('robot')
def test_a_script_gets_what_the_real_one_says(ros2):
    lines = {**ABSENT, **NOT_INSTALLED}
    answers = ros2(*lines, for_a_script=True)
    got = {line: (one.code, one.out, one.err) for line, one in zip(lines, answers, strict=True)}
    assert got == lines


def test_people_get_an_explanation(ros2):
    for line, answer in zip(NOT_INSTALLED, ros2(*NOT_INSTALLED), strict=True):
        assert (answer.code, answer.out) == (1, ''), line
        assert len(answer.err.splitlines()) > 1, line


def test_missing_words_are_told_in_the_words_of_the_real_one(ros2):
    (answer,) = ros2('param load', for_a_script=True)
    assert (answer.code, answer.out) == (2, '')
    assert answer.err.endswith(
        'ros2 param load: error: the following arguments are required: node_name, parameter_file\n'
    )


COMMAND = [sys.executable, '-m', 'labkit.ros2', 'pkg', 'prefix', 'nowhere']
HOW = 'ros2 pkg list shows all that are installed.'


def test_a_pipe_is_for_a_script_and_a_terminal_for_a_person(domain, lab_env):
    env = {**lab_env, **domain}
    done = subprocess.run(COMMAND, env=env, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (1, '', 'Package not found\n')
    ours, theirs = os.openpty()
    done = subprocess.run(COMMAND, env=env, stdout=theirs, stderr=subprocess.PIPE, text=True)
    os.close(ours)
    os.close(theirs)
    assert done.returncode == 1 and HOW in done.stderr


def test_a_cell_explains_whatever_runs_the_command(start_kernel):
    kernel = start_kernel()
    kernel.run('import labkit')
    line = 'ros2 pkg prefix nowhere'
    cells = f'%{line}', f'%{line} &', f'!{line}', f'%%bash --no-raise-error\n{line} | cat'
    for cell in cells:
        assert HOW in kernel.run(cell).text, cell


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('robot')
def test_it_is_on_the_graph_as_the_real_one(domain, lab_env):
    def run(*words: str) -> str:
        command = [sys.executable, '-m', 'labkit.ros2', *words]
        done = subprocess.run(command, env={**lab_env, **domain}, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    # Scripts leave out the node that asks by its name.
    own = re.compile(r'/_ros2cli_\d+')
    nodes = run('node', 'list', '-a').splitlines()
    assert [name for name in nodes if not own.fullmatch(name)] == [
        *('/_hidden', '/fleet/robot', '/lamp')
    ]
    # Three nodes, and the one that asks.
    counts = re.findall(r'^ \* (/[pr]\S+) \S+ (\d) publishers$', run('topic', 'list', '-v'), re.M)
    assert counts == [('/parameter_events', '4'), ('/rosout', '4')]
