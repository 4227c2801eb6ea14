"""The programs of tf2: `ros2 run tf2_ros ...` and `ros2 run tf2_tools view_frames`."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from geometry_msgs.msg import TransformStamped

from labkit.background.domains import claim_domain
from labkit.errors import LabError
from labkit.programs import static_transform_publisher, tf2_echo
from labkit.programs.view_frames import as_dot
from labkit.transforms.rotations import from_rpy, matrix, to_rpy
from labkit.transforms.tree import Edge

# A first build of the type of /tf takes seconds of processor time.
pytestmark = pytest.mark.timeout(900)

ECHOED = """\
At time 12.000000005
- Translation: [1.000, -2.500, 0.000]
- Rotation: in Quaternion [0.000, 0.000, 0.707, 0.707]
- Rotation: in RPY (radian) [0.000, -0.000, 1.571]
- Rotation: in RPY (degree) [0.000, -0.000, 90.000]
- Matrix:
  0.000 -1.000  0.000  1.000
  1.000  0.000  0.000 -2.500
  0.000  0.000  1.000  0.000
  0.000  0.000  0.000  1.000"""


def test_a_transform_is_told_in_all_forms():
    found = TransformStamped()
    found.header.stamp.sec, found.header.stamp.nanosec = 12, 5
    found.transform.translation.x, found.transform.translation.y = 1.0, -2.5
    turn = found.transform.rotation
    turn.x, turn.y, turn.z, turn.w = from_rpy(0.0, 0.0, math.pi / 2)
    assert tf2_echo.described(found) == ECHOED


ANGLES = [(0.1, -0.2, 3.0), (-3.0, 1.5, -1.0), (0.4, -1.5, 0.0), (3.1, 0.0, -3.1)]


@pytest.mark.parametrize('angles', ANGLES)
def test_angles_come_back(angles):
    assert to_rpy(matrix(from_rpy(*angles))) == pytest.approx(angles)


@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_straight_up_and_down_the_first_angle_is_all(sign):
    straight = ((0.0, 0.0, sign), (0.0, 1.0, 0.0), (-sign, 0.0, 0.0))
    assert to_rpy(straight) == (0.0, sign * math.pi / 2, 0.0)


FRAMES = ['--frame-id', 'base', '--child-frame-id', 'scan']


@pytest.mark.parametrize(
    ('words', 'shift', 'turn'),
    [
        (FRAMES, (0, 0, 0), (0, 0, 0, 1)),
        ([*FRAMES, '--x', '-1', '--z', '1e-1'], (-1, 0, 0.1), (0, 0, 0, 1)),
        (['--yaw', '1', *FRAMES], (0, 0, 0), from_rpy(0, 0, 1)),
        ([*FRAMES, '--qz', '1', '--qw', '0'], (0, 0, 0), (0, 0, 1, 0)),
        (['1', '2', '3', '0.3', '0.2', '0.1', 'base', 'scan'], (1, 2, 3), from_rpy(0.1, 0.2, 0.3)),
        (['1', '2', '3', '0', '0', '1', '0', 'base', 'scan'], (1, 2, 3), (0, 0, 1, 0)),
    ],
)
def test_a_static_transform_is_read_from_the_command_line(words, shift, turn):
    found = static_transform_publisher.read(words)
    assert found.frames == {'frame-id': 'base', 'child-frame-id': 'scan'}
    assert found.shift == pytest.approx(shift)
    assert found.turn == pytest.approx(turn)


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        ([], 'Frame id must not be empty'),
        (['--frame-id', 'a'], 'Child frame id must not be empty'),
        ([*FRAMES, '--x'], 'Not enough arguments for --x'),
        ([*FRAMES, '--x', 'one'], 'Failed to parse --x argument as float'),
        ([*FRAMES, '--q', '1'], 'Extra unparsed arguments on command-line'),
        ([*FRAMES, '--qx', '1', '--roll', '1'], 'Cannot specify both quaternion and Euler'),
        (
            [*['1', '2', '3', '0', '0', '0', 'a', 'b'], '--x', '1'],
            'Cannot specify both new-style (flags)',
        ),
        (['1', '2', '3', '0', '0', 'zero', 'a', 'b'], 'Failed to parse roll argument as float'),
    ],
)
def test_what_makes_no_sense_is_said_in_the_words_of_the_real_one(words, said):
    with pytest.raises(LabError) as raised:
        static_transform_publisher.read(words)
    assert str(raised.value).startswith(said)


def test_a_program_that_is_called_wrongly_says_how(script):
    run = 'import runpy, sys; sys.argv = {!r}; runpy.run_module({!r}, run_name="__main__")'
    for words, code, said in (
        (['tf2_echo', 'a'], 1, 'Usage: tf2_echo source_frame target_frame [echo_rate]'),
        (['tf2_echo', 'a', 'b', 'often'], 2, "Failed to convert rate argument 'often'"),
        (['tf2_echo', 'a', 'b', '1.0often'], 3, "Failed to convert rate argument '1.0often'"),
        (['tf2_echo', 'a', 'b', '0'], 1, 'echo_rate is how often it prints in a second'),
        (['static_transform_publisher', '--help'], 0, 'usage: static_transform_publisher [--x X]'),
        (['static_transform_publisher', '--x', '1'], 1, 'error parsing command line arguments'),
        (['tf2_monitor', 'a'], 255, 'TF_Monitor: usage: tf2_monitor framea frameb'),
        (['view_frames', '--help'], 0, 'usage: view_frames'),
    ):
        done = script(run.format(words, f'labkit.programs.{words[0]}'))
        assert said in done.stdout + done.stderr and done.exit_code == code, words


def test_the_tree_is_drawn_for_graphviz():
    edges = [
        Edge('base', 'odom', 'me', 10.0, 2_000_000_000, 1_000_000_000),
        Edge('s"can', 'base', 'me', 10_000.0, 0, 0),
    ]
    drawn = as_dot(edges, 3.5)
    assert drawn.splitlines()[1:3] == [
        r'"odom" -> "base"[label=" Broadcaster: me\nAverage rate: 10.0\nBuffer length: 1.0\nMost '
        r'recent transform: 2.0\nOldest transform: 1.0\n"];',
        r'"base" -> "s\"can"[label=" Broadcaster: me\nAverage rate: 10000.0\nBuffer length: 0.0\n'
        r'Most recent transform: 0.0\nOldest transform: 0.0\n"];',
    ]
    assert drawn.splitlines()[-2:] == ['}->"odom";', '}']
    loop = as_dot([Edge('a', 'b', 'me', 1.0, 0, 0), Edge('b', 'a', 'me', 1.0, 0, 0)], 1.0)
    assert '}->"b";' in loop
    assert as_dot([], 1.0) == 'digraph G { "No tf data received" }'


@pytest.fixture
def kernel(start_kernel) -> Iterator:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    kernel = start_kernel(**env)
    kernel.run('import labkit as lab')
    yield kernel
    claim.close()


LAUNCH = """
<launch>
  <node pkg="tf2_ros" exec="static_transform_publisher" name="fixed"
        args="--x 1 --yaw 1.5707963267948966 --frame-id map --child-frame-id odom"/>
</launch>
"""


@pytest.mark.slow('six processes')
def test_they_run_in_cells_and_launch_files(kernel):
    assert kernel.run('from tf2_msgs.msg import TFMessage', timeout=800).error == ''
    (kernel.folder / 'fixed.launch.xml').write_text(LAUNCH)
    assert kernel.run("fixed = lab.launch('fixed.launch.xml')").error == ''
    shown = kernel.run('%ros2 param get /fixed translation.x')
    assert shown.text == 'Double value is: 1.0\n'
    kernel.run('robot = lab.spin(lab.Turtlebot(x=0.5))')
    started = kernel.run('%ros2 run tf2_ros tf2_echo map base_scan 20')
    assert 'tf2_ros tf2_echo runs in a process of its own, as node /tf2_echo.' in started.text
    assert '(tf2_ros is not installed here. This tf2_echo comes with labkit' in started.text
    waits = (
        'def said(words, of):\n'
        '    lab.wait_until(lambda: any(words in line for process in lab.processes()'
        ' if of in str(process) for line in process.output), timeout_sec=120)'
    )
    kernel.run(waits)
    # The scanner is 32 mm behind the axle, at x = 0.5 of odom, which is y = 0.5 of map.
    assert kernel.run("said('- Translation: [1.000, 0.468, 0.182]', 'tf2_echo')").error == ''
    kernel.run('%ros2 run tf2_ros tf2_monitor map base_scan')
    assert kernel.run("said('Chain is: map', 'tf2_monitor')", timeout=200).error == ''
    heard = kernel.run('print(lab.processes())')
    assert 'tf2_monitor' in heard.text
    kernel.run('%ros2 run tf2_tools view_frames -t 2 -o seen')
    assert kernel.run("said('Exporting graph in seen.pdf', 'view_frames')").error == ''
    assert (
        kernel.run(
            'from pathlib import Path\n'
            "lab.wait_until(lambda: Path('seen.gv').exists(), timeout_sec=60)"
        ).error
        == ''
    )
    # What it has heard in that time depends on the machine.
    assert (kernel.folder / 'seen.gv').read_text().startswith('digraph G {')


def test_packages_that_are_not_installed_have_their_programs(capsys):
    from labkit.ros2.shell import run_line

    assert run_line('pkg executables tf2_ros') == 0
    shown = capsys.readouterr()
    assert shown.out.splitlines() == [
        'tf2_ros static_transform_publisher',
        'tf2_ros tf2_echo',
        'tf2_ros tf2_monitor',
    ]
    known = 'static_transform_publisher, tf2_echo and tf2_monitor'
    assert shown.err == f'(tf2_ros is not installed; labkit has its {known}.)\n'
