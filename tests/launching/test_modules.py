"""The modules that launch files import: those of the real packages, with all their names.

`real_modules.txt` has what the real ones let other modules have: a line a module.
"""

from pathlib import Path

import pytest

from labkit.errors import LabError
from labkit.launching.modules import ACTIONS_LEFT_OUT, LEFT_OUT, PARTS_LEFT_OUT, contents
from tests.launching.stage import visit, write

REAL = Path(__file__).with_name('real_modules.txt').read_text(encoding='utf-8')
BY_MODULE = dict(line.split(':') for line in REAL.splitlines())


@pytest.mark.parametrize('module', BY_MODULE)
def test_all_names_of_the_real_modules_are_there(module: str):
    assert module in contents()
    assert [name for name in BY_MODULE[module].split() if name not in contents()[module]] == []


def test_what_is_left_out_can_be_imported_and_says_so_when_it_is_used(tmp_path: Path):
    for module, names in LEFT_OUT.items():
        for name, why in names.items():
            text = f'from {module} import {name}\n\n{name}()\n'
            path = write(tmp_path, {'main.launch.py': text})
            with pytest.raises(LabError) as caught:
                visit(path)
            assert str(caught.value) == f'{path}, line 3: {name} is not supported here: {why}.'


def test_the_page_lists_what_is_left_out():
    page = (Path(__file__).parents[2] / 'docs' / 'launch.md').read_text(encoding='utf-8')
    left_out = page.partition('\nLeft out:')[2].partition('\n## ')[0]
    for names in (LEFT_OUT, ACTIONS_LEFT_OUT, PARTS_LEFT_OUT):
        assert [
            name for part in names.values() for name in part if f'`{name}`' not in left_out
        ] == []


CONDITIONAL = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, GroupAction, RegisterEventHandler
from launch.conditions import IfCondition
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode, LoadComposableNodes
from launch_ros.descriptions import ComposableNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition


def generate_launch_description():
    node = LifecycleNode(executable='true', name='c', namespace='')
    return LaunchDescription([
        DeclareLaunchArgument('composed', default_value='false'),
        DeclareLaunchArgument('managed', default_value='false'),
        GroupAction(condition=IfCondition(LaunchConfiguration('composed')), actions=[
            LoadComposableNodes(target_container='c', composable_node_descriptions=[
                ComposableNode(package='a', plugin='b::C', name='c')])]),
        GroupAction(condition=IfCondition(LaunchConfiguration('managed')), actions=[node]),
        RegisterEventHandler(OnStateTransition(
            target_lifecycle_node=node, goal_state='active', entities=[])),
        EmitEvent(event=ChangeState(
            lifecycle_node_matcher=matches_action(node),
            transition_id=Transition.TRANSITION_CONFIGURE)),
    ])
"""


def test_an_action_that_is_left_out_may_stand_below_a_condition(tmp_path: Path):
    path = write(tmp_path, {'main.launch.py': CONDITIONAL})
    assert visit(path).started == []
    with pytest.raises(LabError, match=r'line 19: LoadComposableNodes is not supported here: '):
        visit(path, 'composed:=true')
    assert [name for name, *_ in visit(path, 'managed:=true').started] == ['true-1']


def test_a_left_out_class_may_be_named_for_the_types(tmp_path: Path):
    text = (
        'from launch import LaunchDescription\n'
        'from launch.actions import LogInfo\n'
        'from launch_ros.actions import LoadComposableNodes\n\n\n'
        'class Mine(LoadComposableNodes):\n    pass\n\n\n'
        'def generate_launch_description() -> LaunchDescription:\n'
        '    log = LogInfo(msg="here")\n'
        '    assert not isinstance(log, LoadComposableNodes)\n'
        '    return LaunchDescription([log])\n'
    )
    assert visit(write(tmp_path, {'main.launch.py': text})).said == ['here']


def test_a_name_that_is_nowhere_is_told_with_the_nearest(tmp_path: Path):
    text = 'import launch\nimport launch.logging\nlaunch.actions.LogInf(msg="a")\n'
    path = write(tmp_path, {'main.launch.py': text})
    with pytest.raises(LabError, match=r'line 3: .*\nDid you mean LogInfo\?'):
        visit(path)
