"""`ros2 interface` and `ros2 pkg`: what is read from files, not from the graph."""

from __future__ import annotations

import sys

from ament_index_python import get_resource

from labkit.ros2.shell import run_line
from labkit.rosgraph import interfaces

TWIST_STAMPED = """\
# A twist with reference coordinate frame and timestamp

std_msgs/Header header
\tbuiltin_interfaces/Time stamp
\t\tint32 sec
\t\tuint32 nanosec
\tstring frame_id
Twist twist
\tVector3  linear
\t\tfloat64 x
\t\tfloat64 y
\t\tfloat64 z
\tVector3  angular
\t\tfloat64 x
\t\tfloat64 y
\t\tfloat64 z
"""
SET_BOOL = """\
bool data # e.g. for hardware enabling / disabling
---
bool success   # indicate successful run of triggered service
string message # informational, e.g. for error messages
"""


def said(capsys, line: str) -> tuple[int, str, str]:
    code = run_line(line)
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def test_interface_show(capsys):
    assert said(capsys, 'interface show geometry_msgs/msg/TwistStamped') == (0, TWIST_STAMPED, '')
    assert said(capsys, 'interface show std_srvs/srv/SetBool') == (0, SET_BOOL, '')
    _, out, _ = said(capsys, 'interface show std_srvs/srv/SetBool --no-comments')
    # The sign of a comment stays, as with the real one.
    assert out == 'bool data #\n---\nbool success   #\nstring message #\n'
    _, out, _ = said(capsys, 'interface show actionlib_msgs/msg/GoalStatus --no-comments')
    assert 'uint8 PENDING         = 0   #' in out.splitlines()
    _, out, _ = said(capsys, 'interface show sensor_msgs/msg/CameraInfo')
    assert '\tuint32 x_offset  #' in out.splitlines()
    _, out, _ = said(capsys, 'interface show sensor_msgs/msg/CameraInfo --all-comments')
    assert '\tuint32 x_offset  # Leftmost pixel of the ROI' in out.splitlines()
    _, out, _ = said(capsys, 'interface show geometry_msgs/msg/TwistStamped --all-comments')
    assert '\t# This expresses velocity in free space' in out


def test_every_interface_can_be_shown_and_filled(capsys):
    for name in interfaces.names():
        assert run_line(f'interface show {name}') == 0, name
        assert run_line(f'interface proto {name}') == 0, name
        assert capsys.readouterr().out


def test_interface_proto(capsys):
    assert said(capsys, 'interface proto std_msgs/msg/String') == (0, '"data: \'\'\n"\n', '')
    _, out, _ = said(capsys, 'interface proto std_srvs/srv/SetBool --no-quotes')
    assert out == 'data: false\n\n'


def test_interface_lists(capsys):
    _, out, _ = said(capsys, 'interface list')
    lines = out.splitlines()
    assert [line for line in lines if not line.startswith(' ')] == [
        *('Messages:', 'Services:', 'Actions:')
    ]
    assert lines.index('    std_msgs/msg/String') < lines.index('Services:')
    assert lines.index('    std_srvs/srv/Trigger') > lines.index('Services:')
    _, out, _ = said(capsys, 'interface package std_srvs')
    assert out.split() == ['std_srvs/srv/Empty', 'std_srvs/srv/SetBool', 'std_srvs/srv/Trigger']
    _, out, _ = said(capsys, 'interface package test_msgs')
    listed = get_resource('rosidl_interfaces', 'test_msgs')[0].split()
    files = [name for name in listed if '_' not in name]
    assert out.split() == list(
        dict.fromkeys(f'test_msgs/{name[: name.rindex(".")]}' for name in files)
    )
    _, out, _ = said(capsys, 'interface packages --only-srvs')
    assert 'std_srvs' in out.split() and 'std_msgs' not in out.split()


def test_interface_wrong_names(capsys):
    assert said(capsys, 'interface show std_msgs/String') == (
        1,
        '',
        "The passed interface is invalid: 'std_msgs/String' is not known.\n"
        "Did you mean 'std_msgs/msg/String'?\n",
    )
    assert said(capsys, 'interface package std_srv') == (
        *(1, '', "Unknown package 'std_srv'\nDid you mean 'std_srvs'?\n"),
    )
    for name in ('../../etc/passwd', 'os/msg/path', '', '/', 'std_msgs/msg/', 'std_msgs/msg/../x'):
        code, out, err = said(capsys, f'interface show "{name}"')
        assert (code, out) == (1, '') and 'invalid' in err, name


def test_packages(capsys):
    _, out, _ = said(capsys, 'pkg list')
    assert out.split() == sorted(out.split()) and 'rclpy' in out.split()
    assert said(capsys, 'pkg prefix rclpy') == (0, f'{sys.prefix}\n', '')
    assert said(capsys, 'pkg prefix --share rclpy') == (0, f'{sys.prefix}/share/rclpy\n', '')
    assert said(capsys, 'pkg xml std_msgs --tag name') == (0, 'std_msgs\n', '')
    assert said(capsys, 'pkg prefix rclp') == (
        *(1, '', "Package 'rclp' not found\nDid you mean 'rclpy'?\n"),
    )


def test_a_package_of_the_tutorials_that_is_not_here_names_what_is(capsys):
    for line in ('run turtlesim turtlesim_node', 'pkg prefix turtlesim'):
        code, out, err = said(capsys, line)
        assert (code, out) == (1, '')
        assert err.startswith("Package 'turtlesim' not found\n")
        assert 'ros2 run labkit turtlebot starts it, lab.arena() shows it' in err


def test_prefix_of_a_package_that_has_stand_ins(capsys):
    code, out, err = said(capsys, 'pkg prefix demo_nodes_py')
    assert (code, out) == (1, '')
    assert err.endswith('It has no files here. labkit runs its talker and listener.\n')


def test_executables(capsys):
    code, out, _ = said(capsys, 'pkg executables demo_nodes_py')
    assert code == 0
    assert {'demo_nodes_py listener', 'demo_nodes_py talker'} <= set(out.splitlines())
    _, out, _ = said(capsys, 'pkg executables rosidl_adapter --full-path')
    assert f'{sys.prefix}/lib/rosidl_adapter/msg2idl.py' in out.splitlines()
    code, out, err = said(capsys, 'run demo_nodes_py tolker')
    assert (code, out) == (1, '') and err.endswith("Did you mean 'talker'?\n")
    code, out, err = said(capsys, 'run demo_nodes_py')
    assert code == 2 and err.startswith(
        'ros2 run: the following arguments are required: executable_name\nusage: ros2 run'
    )
