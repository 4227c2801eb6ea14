"""Faults of launch files are told with file and line, and with what to do."""

import itertools
from pathlib import Path

import pytest

from labkit.errors import LabError
from labkit.launching.launch_files import arguments, find, load, tree
from tests.launching.stage import visit, write

XML = [
    ('<nod pkg="toys" exec="echo_args"/>', 2, 'Did you mean node?'),
    ('<node pkg="toys" exec="echo_arg"/>', 2, "Did you mean 'echo_args'?"),
    ('<node pkg="toy" exec="echo_args"/>', 2, "Did you mean 'toys'?"),
    ('<node pkg="toys" exce="echo_args"/>', 2, "'exec'"),
    ('<node pkg="toys"\n  exec="echo_args" nmae="a"/>', 2, "Did you mean 'name'?"),
    ('<node pkg="toys" type="echo_args"/>', 2, 'exec="..."'),
    ('\n<log message="$(var who)"/>', 3, "'who' does not exist"),
    ('\n\n<log/>', 4, "'message'"),
    ('<remap from="a" to="b"/>', 2, 'It belongs into node or lifecycle_node.'),
    ('<param name="a" value="1"/>', 2, 'It belongs into node or lifecycle_node or param.'),
    ('<rosparam command="load" file="a.yaml"/>', 2, 'ROS 2 writes <param from='),
    ('<machine name="a"/>', 2, 'that is ROS 1'),
    ('<node_container pkg="a" exec="b"/>', 2, 'take a <node> for each'),
    ('<lifecycle_node pkg="toys" exec="echo_args"/>', 2, "has no 'name'"),
    ('<lifecycle_node pkg="a" exec="b" name="c"/>', 2, "has no 'namespace'"),
    ('<node pkg="toys" exec="echo_args" output="sceen"/>', 2, "Did you mean 'screen'?"),
    ('<node pkg="toys" exec="echo_args"><param from="a.yaml"/></node>', 2, '$(dirname)/'),
    ('<node pkg="toys" exec="echo_args"><param name="a"/></node>', 2, "'value'"),
    (
        '<node pkg="toys" exec="echo_args">\n<param name="a" value="x" type="floats"/></node>',
        3,
        "Did you mean 'float'?",
    ),
    ('<include file="$(dirname)/nowhere.launch.xml"/>', 2, 'There is no launch file'),
    ('<include file="$(dirname)/main.launch.xm"/>', 2, "Did you mean 'main.launch.xml'?"),
    ('<include file="$(filename)"/>', 2, 'The file includes itself: main.launch.xml includes'),
    ('<arg name="need"/>', 2, 'need:=value on the command line'),
    ('<log message="a" if="maybe"/>', 2, 'A condition is true, false, 1 or 0'),
    ('<timer period="-1"><log message="a"/></timer>', 2, 'below 0'),
    ('<timer period="nan"><log message="a"/></timer>', 2, 'below 0'),
    ('<timer period="inf"><log message="a"/></timer>', 2, 'without end'),
    ('<timer period="soon"/>', 2, 'float'),
    ('<group scoped="perhaps"/>', 2, 'bool'),
    ('<let name="a"/>', 2, "'value'"),
    ('<log message="a"', 3, 'This is no XML'),
    ('<log message="a & b"/>', 2, '&amp;'),
    ('<push_ros_namespace namespace="a-b"/>', 2, 'can not be a namespace'),
    ('<set_env name="A"/>', 2, "'value'"),
]


@pytest.mark.parametrize(('body', 'line', 'words'), XML)
def test_xml(body: str, line: int, words: str, tmp_path: Path, toys: Path):
    path = write(tmp_path, {'main.launch.xml': f'<launch>\n{body}\n</launch>\n'})
    with pytest.raises(LabError) as caught:
        visit(path)
    assert str(caught.value).startswith(f'{path}, line {line}: '), caught.value
    assert words in str(caught.value)


def test_entities_that_stand_for_billions_are_refused(tmp_path: Path):
    # 10 ** 6 texts: more would be refused by expat itself, and by no other limit.
    names = 'abcdefg'
    declared = ''.join(
        f'<!ENTITY {name} "{f"&{before};" * 10}">\n' for before, name in itertools.pairwise(names)
    )
    text = (
        f'<!DOCTYPE launch [\n<!ENTITY a "x">\n{declared}]>\n<launch><log message="&g;"/></launch>'
    )
    path = write(tmp_path, {'main.launch.xml': text})
    with pytest.raises(LabError) as caught:
        visit(path)
    assert f"{path}, line 2: This is no XML: it declares the entity 'a'." in str(caught.value)


@pytest.mark.parametrize(
    ('program', 'words'),
    [
        ('<executable cmd="lab_no_such_program"/>', "There is no program 'lab_no_such_program'."),
        ('<executable cmd="echo a" cwd="/lab/none"/>', "cwd is no folder: '/lab/none'"),
        (
            '<node pkg="toys" exec="echo_args" launch-prefix="lab_none -x"/>',
            "There is no program 'lab_none'.",
        ),
    ],
)
def test_a_program_that_is_not_there_is_told_and_the_others_start(
    program: str, words: str, tmp_path: Path, toys: Path
):
    body = f'<launch>\n{program}<executable cmd="echo"/></launch>'
    path = write(tmp_path, {'main.launch.xml': body})
    found = visit(path)
    assert found.warned == [f'can not be started: {path}, line 2: {words}']
    assert [name for name, *_ in found.started] == ['echo-2']


MUCH = {
    'groups': ('<group>' * 5000 + '</group>' * 5000, 2, 'nested too deep'),
    'substitutions': (f'<log message="{"$(var " * 5000}a{")" * 5000}"/>', 1, 'nested too deep'),
    'text': (
        '<let name="a" value="x"/>' + '<let name="a" value="$(var a)$(var a)"/>' * 40,
        2,
        'and at most 1000000 are possible',
    ),
}


@pytest.mark.parametrize('name', MUCH)
def test_what_has_no_end_is_told(name: str, tmp_path: Path, toys: Path):
    test_xml(*MUCH[name], tmp_path, toys)


YAML = [
    ('- nod: {pkg: toys, exec: echo_args}', 2, 'Did you mean node?'),
    ('- node:\n    pkg: toys\n    exce: echo_args', 3, "'exec'"),
    ('- arg: {name: a, default: 1}', 2, "default: '1'"),
    ('- log: {message: a, if: true}', 2, "if: 'true'"),
    ('- log: {message: a}\n  let: {name: a, value: b}', 1, 'each item is one name'),
    ('- log: [a', 3, 'This is no YAML'),
    ('- timer:\n    period: 1\n    children: []', 3, 'period: 1.0'),
    ('- node:\n    pkg: toys\n    exec: echo_args\n    param:\n    - name: a', 6, "'value'"),
    ('- group:\n    scoped: "true"', 3, "'children'"),
    ('\t- log: {message: a}', 2, 'This is no YAML'),
]


@pytest.mark.parametrize(('body', 'line', 'words'), YAML)
def test_yaml(body: str, line: int, words: str, tmp_path: Path, toys: Path):
    path = write(tmp_path, {'main.launch.yaml': f'launch:\n{body}\n'})
    with pytest.raises(LabError) as caught:
        visit(path)
    assert str(caught.value).startswith(f'{path}, line {line}: '), caught.value
    assert words in str(caught.value)


PYTHON = [
    ('from launch.actions import LogInf', 1, 'Did you mean LogInfo?'),
    ('from launch import LaunchService\nLaunchService()', 2, 'this launch runs already'),
    ('from launch.utilities import is_an', 1, 'Did you mean is_a?'),
    (
        'from launch import LaunchDescription\n'
        'from launch_ros.actions import RosTimer, SetUseSimTime\n'
        'def generate_launch_description():\n'
        '    return LaunchDescription([SetUseSimTime(True),\n'
        '        RosTimer(period=1.0, actions=[])])',
        5,
        'leave SetUseSimTime out',
    ),
    (
        'from launch_ros.actions import Node\n'
        "Node(package='toys', executable='echo_args').node_name",
        2,
        "cannot access 'node_name' before executing action",
    ),
    ('from launch.actions import TimerAction\nTimerAction(period=1, actions=[])', 2, 'period=1.0'),
    (
        'from launch.actions import IncludeLaunchDescription\n'
        "IncludeLaunchDescription('a.launch.py', launch_arguments={'a': '1'})",
        2,
        'launch_arguments={...}.items()',
    ),
    (
        'from launch_ros.actions import Node\n'
        "Node(package='toys', executable='echo_args', remappings=[['a', 'b']])",
        2,
        "remappings=[('old', 'new'), ...]",
    ),
    (
        'from launch.actions import LogInfo, RegisterEventHandler\n'
        'from launch.event_handlers import OnProcessExit\n'
        "log = LogInfo(msg='a')\n"
        'RegisterEventHandler(OnProcessExit(target_action=log, on_exit=[log]))',
        4,
        'target_action of OnProcessExit is an action of the class ExecuteLocal',
    ),
    ('import launch_testing', 1, 'what launch files are tested with'),
    ('from nav2_common.launch import RewrittenYaml', 1, 'apt install ros-jazzy-nav2-common'),
    ('\nimport lab_not_there', 2, 'ModuleNotFoundError'),
    ('x = (', 1, 'was never closed'),
    ('\nraise SystemExit(3)', 2, 'SystemExit: 3'),
    (
        'from launch import LaunchDescription\nfrom launch.actions import OpaqueFunction\n'
        'def again(context):\n    return [OpaqueFunction(function=again)]\n'
        'def generate_launch_description():\n    return LaunchDescription(again(None))',
        4,
        'leads to itself',
    ),
    ('def generate_launch_description():\n    return 5', 1, 'a LaunchDescription is expected'),
    (
        'from launch import LaunchDescription\nfrom launch_ros.actions import Node\n'
        'def generate_launch_description():\n    return LaunchDescription([\n'
        "        Node(package='toys', executable='echo_arg')])",
        5,
        "Did you mean 'echo_args'?",
    ),
    (
        'from launch import LaunchDescription\nfrom launch_ros.actions import Node\n'
        'def generate_launch_description():\n    return LaunchDescription([\n'
        "        Node(package='toys', executable='echo_args', outptu='screen')])",
        5,
        "Did you mean 'output'?",
    ),
    (
        'from launch import LaunchDescription\nfrom launch.actions import LogInfo\n'
        'def generate_launch_description():\n    return LaunchDescription([LogInfo(msg=5)])',
        4,
        "Write it as a text: '5'",
    ),
    (
        'from launch import LaunchDescription\nfrom launch.actions import ExecuteProcess\n'
        'def generate_launch_description():\n    return LaunchDescription([\n'
        "        ExecuteProcess(cmd='echo a')])",
        5,
        "cmd=['echo', 'a']",
    ),
]


@pytest.mark.parametrize(('text', 'line', 'words'), PYTHON)
def test_python(text: str, line: int, words: str, tmp_path: Path, toys: Path):
    path = write(tmp_path, {'main.launch.py': text + '\n'})
    with pytest.raises(LabError) as caught:
        visit(path)
    assert str(caught.value).startswith(f'{path}, line {line}: '), caught.value
    assert words in str(caught.value)


def test_the_line_is_that_of_the_included_file(tmp_path: Path):
    main = '<launch>\n<include file="$(dirname)/inner.launch.yaml"/>\n</launch>'
    inner = 'launch:\n- log:\n    message: $(var x)\n'
    path = write(tmp_path, {'main.launch.xml': main, 'inner.launch.yaml': inner})
    with pytest.raises(LabError, match=r"inner\.launch\.yaml, line 3: launch configuration 'x'"):
        visit(path)


def test_a_circle_of_two_files_is_named(tmp_path: Path):
    other = '<launch><include file="$(dirname)/{}"/></launch>'
    files = {
        'a.launch.xml': other.format('b.launch.xml'),
        'b.launch.xml': other.format('a.launch.xml'),
    }
    path = write(tmp_path, files)
    with pytest.raises(LabError, match=r'a\.launch\.xml includes b\.launch\.xml includes a\.'):
        visit(path)


@pytest.mark.parametrize(
    ('keys', 'attributes', 'warned'),
    [
        ('/other', 'name="bob"', True),
        ('bob', 'name="bob"', False),
        ('/bob', 'name="bob"', False),
        ('/**', 'name="bob"', False),
        ('/*', 'name="bob"', False),
        ('/*', 'name="bob" namespace="n"', True),
        ('/**/bob', 'name="bob" namespace="n"', False),
        ('/n/bob', 'name="bob" namespace="n"', False),
        ('bob', 'name="bob" namespace="n"', True),
        ('/*/bob', 'name="bob" namespace="n"', False),
        ('/other', '', False),
    ],
)
def test_a_file_of_parameters_for_another_node_is_told(
    keys: str, attributes: str, warned: bool, tmp_path: Path, toys: Path
):
    body = (
        f'<node pkg="toys" exec="echo_args" {attributes}><param from="$(dirname)/p.yaml"/></node>'
    )
    parameters = f'{keys}:\n  ros__parameters:\n    a: 1\n'
    files = {'main.launch.xml': f'<launch>{body}</launch>', 'p.yaml': parameters}
    found = visit(write(tmp_path, files))
    assert [f'has parameters for /{keys.strip("/")}' in line for line in found.warned] == (
        [True] if warned else []
    )


@pytest.mark.parametrize('text', ['a: 1\n', '', '- a\n', '/**:\n  a: 1\n', 'a: [\n'])
def test_what_is_no_file_of_parameters_is_refused(text: str, tmp_path: Path, toys: Path):
    body = '<node pkg="toys" exec="echo_args"><param from="$(dirname)/p.yaml"/></node>'
    path = write(tmp_path, {'main.launch.xml': f'<launch>{body}</launch>', 'p.yaml': text})
    with pytest.raises(LabError, match='is no file of parameters'):
        visit(path)


def test_two_nodes_of_one_name_are_told(tmp_path: Path, toys: Path):
    node = '<node pkg="toys" exec="echo_args" name="a" namespace="n"/>'
    found = visit(write(tmp_path, {'main.launch.xml': f'<launch>{node}{node}</launch>'}))
    assert found.warned == [
        'there are now at least 2 nodes with the name /n/a created within this launch context'
    ]


def test_a_launch_file_of_a_package_is_found(toys: Path):
    assert find('toys', 'toys.launch.xml').endswith('share/toys/launch/toys.launch.xml')
    with pytest.raises(LabError, match=r"Did you mean 'toys\.launch\.xml'"):
        find('toys', 'toy.launch.xml')
    with pytest.raises(LabError, match=r'It has: toys\.launch\.xml'):
        find('toys', 'something_else')


def test_arguments_are_found_in_groups_and_includes(tmp_path: Path):
    main = """
        <launch>
          <arg name="a" default="1" description="The first."/>
          <group if="true"><arg name="b"/></group>
          <include file="$(dirname)/inner.launch.xml"/>
          <timer period="1"><arg name="c"/></timer>
        </launch>
        """
    path = write(tmp_path, {'main.launch.xml': main})
    found = [(one.name, conditional) for one, conditional in arguments([load(str(path))])]
    assert found == [('a', False), ('b', True), ('c', True)]


def test_the_tree_of_a_description(tmp_path: Path):
    main = '<launch><group><log message="a $(var b)"/></group><node pkg="p" exec="e"/></launch>'
    path = write(tmp_path, {'main.launch.xml': main})
    assert list(tree(load(str(path)).entities)) == [
        '├── GroupAction',
        "│   └── LogInfo('a ' + LaunchConfiguration('b'))",
        "└── Node(package='p', executable='e')",
    ]
