"""Nodes with a life cycle: launches that ask them for transitions, and hear of their states."""

import signal
import sys
import textwrap
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from lifecycle_msgs.msg import State, Transition

from labkit.background.domains import claim_domain
from labkit.errors import LabError
from labkit.launching.lifecycle_nodes import ChangeState
from tests.launching.stage import visit, write

# A node that shows its transitions; the parameter `ends` makes one of them end otherwise.
NODE = f"""\
#!{sys.executable}
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn


class Talker(LifecycleNode):
    def __init__(self):
        super().__init__('someone')
        self.declare_parameter('ends', '')

    def _end(self, name):
        print(name, flush=True)
        word, _, how = self.get_parameter('ends').value.partition(' ')
        return getattr(TransitionCallbackReturn, how if word == name else 'SUCCESS')

    def on_configure(self, state):
        return self._end('configure')

    def on_activate(self, state):
        return self._end('activate')

    def on_deactivate(self, state):
        return self._end('deactivate')

    def on_cleanup(self, state):
        return self._end('cleanup')

    def on_error(self, state):
        return self._end('error')


rclpy.init()
try:
    rclpy.spin(Talker())
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""
HEAD = """\
from launch import LaunchDescription
from launch.actions import (
    EmitEvent, ExecuteProcess, LogInfo, RegisterEventHandler, Shutdown, TimerAction)
from launch.events import matches_action
from launch_ros.actions import LifecycleNode, LifecycleTransition, Node
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events import matches_node_name
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition


def managed(name='talker', **options):
    return LifecycleNode(
        executable='NODE', name=name, namespace='a', exec_name='managed', output='screen',
        **options)


def ask(number, matcher):
    return EmitEvent(event=ChangeState(lifecycle_node_matcher=matcher, transition_id=number))


def when(entities, **what):
    return RegisterEventHandler(OnStateTransition(entities=entities, **what))


def generate_launch_description():
    node = managed()
"""


@pytest.fixture
def launch(launch: type) -> Iterator[Callable[..., Any]]:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    yield partial(launch, **env)
    claim.close()


@pytest.fixture
def node(tmp_path: Path) -> Path:
    path = write(tmp_path, {'node.py': NODE})
    path.chmod(0o755)
    return path


def text(node: Path, *lines: str) -> str:
    """Return a launch file of these actions."""
    body = textwrap.indent('\n'.join(lines), ' ' * 8)
    return f'{HEAD}    return LaunchDescription([\n{body}\n    ])\n'.replace('NODE', str(node))


def said(one) -> list[str]:
    """Return what each node has shown, and then the launch, but not of starts and ends.

    A node's lines come by a pipe, and its states by ROS: between the two is no order.
    """
    shown = [
        line
        for line in one.lines
        if line.startswith(('[managed-', '[INFO] [launch.user]', '[WARNING]', '[ERROR]'))
        or 'launch_ros' in line
    ]
    nodes = [line for line in shown if line.startswith('[managed-')]
    return sorted(nodes, key=lambda line: line.partition(' ')[0]) + [
        line for line in shown if line not in nodes
    ]


def test_numbers_and_names_are_those_of_the_messages():
    for kind, known in (
        (Transition, ChangeState.valid_transitions),
        (State, ChangeState.valid_states),
    ):
        names = {name for name in dir(kind) if name.startswith(('TRANSITION', 'PRIMARY'))}
        mine = {name: number for number, name in known.items()}
        assert mine.items() <= {name: getattr(kind, name) for name in names}.items()


def test_it_starts_by_itself(launch, node):
    one = launch(
        f'<launch><lifecycle_node exec="{node}" exec_name="managed" name="talker" '
        'namespace="" autostart="$(eval \'1 == 1\')" output="screen"/></launch>'
    )
    one.wait_for('activate')
    one.send(signal.SIGINT)
    assert one.end() == 0
    assert said(one)[:2] == ['[managed-1] configure', '[managed-1] activate']


def test_each_transition_is_asked_for_when_the_state_is_there(launch, node):
    one = launch(
        text(
            node,
            'when(start_state="configuring", goal_state="inactive", target_lifecycle_node=node,',
            '     entities=[LogInfo(msg="it is configured"),',
            '               ask(3, matches_node_name("a/talker"))]),',
            'when(goal_state="active", entities=[LogInfo(msg="it is active"), Shutdown()]),',
            'ask(Transition.TRANSITION_CONFIGURE, matches_action(node)),',
            'node,',
        )
    )
    assert one.end() == 0
    assert said(one) == [
        '[managed-1] configure',
        '[managed-1] activate',
        '[INFO] [launch.user]: it is configured',
        '[INFO] [launch.user]: it is active',
    ]


def test_transitions_in_a_row_and_of_several_nodes(launch, node):
    one = launch(
        text(
            node,
            'node,',
            'managed("other"),',
            'LifecycleTransition(',
            '    lifecycle_node_names=["a/talker"], transition_ids=["1", 3, 4, 2]),',
            'when(start_state="cleaningup",',
            '     entities=[ask(1, lambda action: action is not node)]),',
            'when(goal_state="inactive", matcher=None, target_lifecycle_node=node, entities=[]),',
            'when(matcher=lambda event: getattr(event, "goal_state", "") == "inactive"',
            '     and event.action.node_name == "/a/other", entities=[Shutdown()]),',
        )
    )
    assert one.end() == 0
    words = ['configure', 'activate', 'deactivate', 'cleanup']
    assert said(one) == [f'[managed-1] {word}' for word in words] + ['[managed-2] configure']


def test_a_transition_that_fails(launch, node):
    one = launch(
        text(
            node,
            'managed(autostart=True, parameters=[{"ends": "configure FAILURE"}]),',
        )
    )
    one.wait_for('Failed')
    one.send(signal.SIGINT)
    assert one.end() == 0
    assert said(one)[:2] == [
        '[managed-1] configure',
        '[ERROR] [launch_ros.utilities.lifecycle_event_manager]: Failed to make transition '
        "'TRANSITION_CONFIGURE' for LifecycleNode '/a/talker', which was unconfigured",
    ]


def test_an_error_ends_the_row(launch, node):
    one = launch(
        text(
            node,
            'managed(autostart=True, parameters=[{"ends": "activate ERROR"}]),',
            'when(start_state="errorprocessing", entities=[Shutdown()]),',
        )
    )
    assert one.end() == 0
    assert (
        '[INFO] [launch_ros.actions.lifecycle_transition]: Stopping transitions for /a/talker '
        "because 'error occurred during transitions'" in said(one)
    )
    shown = [line for line in said(one) if line.startswith('[managed')]
    assert shown == [f'[managed-1] {word}' for word in ('configure', 'activate', 'error')]


def test_nobody_is_waited_for_who_is_gone(launch):
    one = launch(
        text(
            Path(),
            'LifecycleNode(executable="false", name="short", namespace="", autostart=True),',
            'ask(3, matches_node_name("nobody")),',
        )
    )
    assert one.end() == 0
    manager = '[WARNING] [launch_ros.utilities.lifecycle_event_manager]: '
    assert (
        '[WARNING] [launch]: TRANSITION_ACTIVATE is asked of no LifecycleNode that was started'
        in said(one)
    )
    assert (
        f"{manager}Abandoning wait for the '/short/change_state' service, due to the end of its "
        'program.' in said(one)
    )


def test_a_wait_ends_with_the_launch(launch):
    one = launch(
        text(
            Path(),
            'LifecycleNode(',
            '    executable="sh", arguments=["-c", "sleep 60"], name="sleeper", namespace="",',
            '    autostart=True),',
        )
    )
    one.wait_for('process started')
    one.send(signal.SIGINT)
    assert one.end() == 0
    assert any(
        "Abandoning wait for the '/sleeper/change_state' service, due to shutdown" in line
        for line in one.lines
    )


@pytest.mark.parametrize(
    ('line', 'words'),
    [
        ('ask(9, matches_action(node))', '9 is no number of a transition'),
        (
            'LifecycleTransition(lifecycle_node_names=["a"], transition_ids=["configure"])',
            "'configure' is no number of a transition.\nThere are: 1 (TRANSITION_CONFIGURE), ",
        ),
        (
            'LifecycleTransition(lifecycle_node_names="a", transition_ids=[1])',
            "lifecycle_node_names is a list of one or more, and this is 'a'.",
        ),
        (
            'LifecycleTransition(lifecycle_node_names=["a"], transition_ids=[])',
            'transition_ids is a list of one or more, and this is [].',
        ),
        (
            'when([], target_lifecycle_node=Node(executable="true"))',
            'target_lifecycle_node of OnStateTransition is a LifecycleNode',
        ),
        ('managed(autostart="perhaps")', 'perhaps'),
        ('managed(name=None)', 'A LifecycleNode needs a name.'),
    ],
)
def test_faults(line: str, words: str, tmp_path: Path, node: Path):
    path = write(tmp_path, {'main.launch.py': text(node, f'{line},')})
    with pytest.raises(LabError) as caught:
        visit(path)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f'{path}, line ')


def test_it_is_started_as_any_other_node(tmp_path: Path, node: Path):
    path = write(tmp_path, {'main.launch.py': text(node, 'managed(parameters=[{"b": 1}]),')})
    found = visit(path)
    assert [one.node_name for one in found.context.managed] == ['/a/talker']
    values = {'/a/talker': {'ros__parameters': {'b': 1}}}
    words = ['--ros-args', '-r', '__node:=talker', '-r', '__ns:=/a', '--params-file', values]
    assert found.started == [['managed-1', [str(node), *words], {}]]
