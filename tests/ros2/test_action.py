"""`ros2 action` against a server in another process, in a cell, and its completion."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import labkit
from labkit.ros2.completion import complete_line

COUNTER = Path(__file__).with_name('counter.py')
FIBONACCI = 'test_msgs/action/Fibonacci'


@pytest.fixture
def counter(domain, lab_env) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [sys.executable, str(COUNTER)],
        env={**lab_env, **domain},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdin is not None and process.stdout is not None
    assert process.stdout.readline() == 'ready\n'
    yield process
    process.stdin.close()
    process.wait(60)
    process.stdout.close()


@pytest.mark.usefixtures('counter')
def test_list_info_and_type(ros2):
    shown, types, count, info, both, kind, wrong = ros2(
        'action list',
        'action list -t',
        'action list -c',
        'action info /count',
        'action info count -t',
        'action type /count',
        'action info /cuont',
    )
    assert shown.lines == ['/count']
    assert types.lines == [f'/count [{FIBONACCI}]']
    assert count.out == '1\n'
    assert info.lines == [
        *('Action: /count', 'Action clients: 0', 'Action servers: 1', '    /counter')
    ]
    assert both.lines[-1] == f'    /counter [{FIBONACCI}]'
    assert kind.out == f'{FIBONACCI}\n'
    assert (wrong.code, wrong.err) == (1, "Unknown action '/cuont'\nDid you mean '/count'?\n")


@pytest.mark.usefixtures('counter')
def test_a_goal_with_feedback_and_one_that_is_refused(ros2):
    sent, silent, refused = ros2(
        f'action send_goal /count {FIBONACCI} "{{order: 2}}" --feedback',
        f'action send_goal /count {FIBONACCI} "{{order: 2}}"',
        f'action send_goal /count {FIBONACCI}',
    )
    assert sent.code == 0, sent.err
    text = re.sub(r'ID: [0-9a-f]{32}', 'ID: *', sent.out)
    assert text == (
        'Waiting for an action server to become available...\n'
        'Sending goal:\n     order: 2\n\n'
        'Goal accepted with ID: *\n\n'
        'Feedback:\n    sequence:\n- 1\n\n'
        'Feedback:\n    sequence:\n- 1\n- 2\n\n'
        'Result:\n    sequence:\n- 1\n- 2\n\n'
        'Goal finished with status: SUCCEEDED\n'
    )
    assert 'Feedback' not in silent.out and 'SUCCEEDED' in silent.out
    assert refused.lines[-1] == 'Goal was rejected.' and refused.code == 0


# The background is in a callback from the request for the result until that has come, and all of
# the feedback with it.
AT_ONCE = """
import os
import threading

import labkit as lab
lab.start()
from labkit.asking.action_goals import ActionGoals
from labkit.background.runtime import runtime
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from test_msgs.action import Fibonacci

asked, busy, sent = threading.Event(), threading.Event(), threading.Event()
ask, send = ActionClient._get_result_async, ActionServer._send_result_response


def ask_and_tell(client, handle):
    future = ask(client, handle)
    asked.set()
    return future


def send_and_tell(server, *response):
    send(server, *response)
    sent.set()


def be_busy():
    if asked.is_set() and not busy.is_set():
        busy.set()
        print('came while it was busy:', sent.wait(60))


def execute(handle):
    busy.wait(60)
    result = Fibonacci.Result()
    for number in (1, 2, 3):
        result.sequence.append(number)
        handle.publish_feedback(Fibonacci.Feedback(sequence=result.sequence))
    handle.succeed()
    return result


ActionClient._get_result_async = ask_and_tell
ActionServer._send_result_response = send_and_tell
lab.spin(Node('holder')).create_timer(0.01, be_busy)
counter = Node('counter')
ActionServer(counter, Fibonacci, '/count', execute, callback_group=ReentrantCallbackGroup())
executor = MultiThreadedExecutor(4)
executor.add_node(counter)
threading.Thread(target=executor.spin, daemon=True).start()
heard = []
with ActionGoals(runtime.helper, Fibonacci, '/count') as goals:
    goals.wait_until_ready(60)
    handle = goals.send(Fibonacci.Goal(order=3), 60, feedback=heard.append)
    result = goals.result(handle, 60)
    print([list(message.feedback.sequence) for message in heard])
    print(list(result.result.sequence), goals._client._feedback_callbacks, flush=True)
os._exit(0)
"""


def test_feedback_that_arrives_together_with_the_result_is_heard(script):
    result = script(AT_ONCE)
    assert result.stdout == (
        'came while it was busy: True\n[[1], [1, 2], [1, 2, 3]]\n[1, 2, 3] {}\n'
    ), result.stderr


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('counter')
def test_what_is_wrong_with_a_goal_is_said_before_it_is_sent(ros2):
    field, other, service, missing = ros2(
        f'action send_goal /count {FIBONACCI} "{{orde: 2}}"',
        'action send_goal /count test_msgs/action/NestedMessage',
        'action send_goal /count std_srvs/srv/Trigger',
        f'action send_goal /count {FIBONACCI} "{{order:2}}"',
    )
    assert "has no field 'orde'.\nDid you mean 'order'?" in field.err
    assert other.err == f'/count is of type {FIBONACCI}, not test_msgs/action/NestedMessage.\n'
    assert service.err.startswith('The passed action type is invalid')
    assert 'space is missing after the colon' in missing.err
    for answer in (field, other, service, missing):
        assert (answer.code, answer.out) == (1, '')


@pytest.mark.slow('starts other processes')
def test_the_stop_button_cancels_a_goal(start_kernel, counter, domain):
    kernel = start_kernel(**domain)
    kernel.run('import labkit as lab\n%load_ext labkit.ros2')
    cell = kernel.start(f'%ros2 action send_goal /count {FIBONACCI} "{{order: 13}}" -f')
    kernel.wait_for_output(cell, '- 3')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert result.text.endswith('Canceling goal...\nGoal canceled.\n')
    assert counter.stdout.readline() == 'canceled 13\n'


@pytest.mark.slow('starts other processes')
def test_an_action_without_a_server_in_a_lesson_that_a_program_runs(start_kernel, domain):
    kernel = start_kernel(**domain, LABKIT_HEADLESS='1')
    kernel.run('import labkit as lab\n%load_ext labkit.ros2')
    result = kernel.run(f'%ros2 action send_goal /count {FIBONACCI}')
    assert '/count has no server.\nThere is no action at all.\n' in result.text


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('counter')
def test_the_hidden_topics_of_an_action_can_be_looked_at(ros2):
    listed, kind = ros2(
        'topic list --include-hidden-topics -t',
        'topic type /count/_action/feedback --include-hidden-topics',
    )
    assert f'/count/_action/feedback [{FIBONACCI}_FeedbackMessage]' in listed.lines
    assert kind.out == f'{FIBONACCI}_FeedbackMessage\n'


@pytest.mark.parametrize(
    ('line', 'words'),
    [
        ('ac', ['action']),
        ('action ', ['info', 'list', 'send_goal', 'type']),
        ('action send_goal /count test_msgs/action/F', [FIBONACCI]),
        (f'action send_goal /count {FIBONACCI} ', ['"{order: 0}"']),
        (f'action send_goal /count {FIBONACCI} "{{order: 1}}" --f', ['--feedback']),
    ],
)
def test_completion(line, words):
    assert complete_line(line)[1] == words
    labkit.stop()


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('counter')
def test_completion_of_names_on_the_live_graph(domain, lab_env):
    def tab(line: str) -> list[str]:
        done = subprocess.run(
            [sys.executable, '-m', 'labkit.ros2', '--complete'],
            env={**lab_env, **domain, 'COMP_LINE': line, 'COMP_POINT': str(len(line))},
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    assert tab('ros2 action info /c') == ['/count']
    assert tab('ros2 action send_goal /count ') == [FIBONACCI]


def test_types_of_actions(ros2):
    proto, show, part, listed = ros2(
        f'interface proto {FIBONACCI}',
        f'interface show {FIBONACCI}',
        f'interface show {FIBONACCI}_Goal',
        'interface list -a',
    )
    assert proto.out == '"order: 0\n"\n'
    assert show.lines.count('---') == 2 and 'int32 order' in show.lines
    assert part.code == 1 and 'Did you mean' in part.err
    assert f'    {FIBONACCI}' in listed.lines


GRAPH = """
import json
import labkit as lab
lab.start()
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from labkit.views.graph_picture import Picture
from test_msgs.action import Fibonacci

def arrows():
    return [(line.kind, line.node, line.other) for line in Picture(lab.graph().data).lines]

server, client = Node('counter'), Node('asker')
ActionServer(server, Fibonacci, '/count', lambda handle: Fibonacci.Result())
print(json.dumps(arrows()))
ActionClient(client, Fibonacci, '/count')
print(json.dumps(arrows()))
print(json.dumps([str(lab.graph()), str(lab.graph(actions=False))]))
"""


def test_an_action_is_one_thing_in_the_graph(script):
    result = script(GRAPH)
    assert result.exit_code == 0, result.stderr
    alone, both, (words, without) = (json.loads(line) for line in result.stdout.splitlines())
    assert alone == [['action', '/counter', '/count']]
    assert both == [['action', '/asker', '/count'], ['action', '/counter', '/count']]
    assert 'Actions' not in without
    assert words.endswith(
        f'Actions:\n  /count [{FIBONACCI}]\n    served by /counter\n    goals from /asker'
    )
    assert '_action' not in words
