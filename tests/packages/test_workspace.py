"""Interface packages: built by the real colcon, used in this process and in another one."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy
import pytest

from labkit.errors import LabError
from labkit.packages import workspace
from labkit.setup.compiler import check_compiler, fix_exported_paths

PACKAGE_XML = """<?xml version="1.0"?>
<package format="3">
  <name>box_interfaces</name>
  <version>0.1.0</version>
  <description>Types for a test.</description>
  <maintainer email="nobody@example.com">nobody</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>geometry_msgs</depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """cmake_minimum_required(VERSION 3.8)
project(box_interfaces)
find_package(ament_cmake REQUIRED)
find_package(geometry_msgs REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME}
  "msg/Box.msg" "srv/Weigh.srv" "action/Carry.action"
  DEPENDENCIES geometry_msgs)
ament_package()
"""
TYPES = {
    'msg/Box.msg': 'string name\ngeometry_msgs/Point place\n',
    'srv/Weigh.srv': 'Box box\n---\nfloat64 weight\n',
    'action/Carry.action': 'Box box\n---\nbool done\n---\nfloat64 remaining\n',
}

# Everything that has to do with types, with types of one's own, in one process: a build is long.
USED = """
import re, subprocess, sys
import labkit as lab

folder = {folder!r}
print(lab.build(folder))
from box_interfaces.action import Carry
from box_interfaces.msg import Box
from box_interfaces.srv import Weigh
from labkit.programs.child_processes import environment
from labkit.ros2.shell import run_line
from rclpy.action import ActionServer
from rclpy.node import Node


class Carrier(Node):
    def __init__(self):
        super().__init__('carrier')
        self.heard = []
        self.publisher = self.create_publisher(Box, 'boxes', 10)
        self.create_subscription(Box, 'boxes', self.heard.append, 10)
        self.create_service(Weigh, 'weigh', self.weigh)
        ActionServer(self, Carry, 'carry', self.carry)

    def weigh(self, request, response):
        response.weight = float(len(request.box.name))
        return response

    def carry(self, handle):
        handle.publish_feedback(Carry.Feedback(remaining=0.5))
        handle.succeed()
        return Carry.Result(done=True)


carrier = lab.spin(Carrier())
for line in (
    'interface show box_interfaces/action/Carry',
    'interface package box_interfaces',
    'topic pub --once /boxes box_interfaces/msg/Box "{{name: red, place: {{x: 1.5}}}}"',
    'service call /weigh box_interfaces/srv/Weigh "{{box: {{name: red}}}}"',
    'action send_goal /carry box_interfaces/action/Carry "{{box: {{name: red}}}}" --feedback',
):
    assert run_line(line) == 0, line
lab.wait_until(lambda: carrier.heard, timeout_sec=60)
print(carrier.heard[0].place.x)
with lab.record(folder + '/bag', ['/boxes', '/carry/_action/feedback']) as recording:
    carrier.publisher.publish(Box(name='blue'))
    run_line('action send_goal /carry box_interfaces/action/Carry')
    recording.wait_for(1, '/boxes', timeout_sec=60)
    recording.wait_for(1, '/carry/_action/feedback', timeout_sec=60)
carrier.heard.clear()
lab.play(folder + '/bag', ['/boxes']).wait()
lab.wait_until(lambda: carrier.heard, timeout_sec=60)
print('played', carrier.heard[0].name)
print(lab.graph())


class Filler(Node):
    def __init__(self):
        super().__init__('filler')
        self.publisher = self.create_publisher(Box, 'filled', 10)
        self.create_timer(0.05, self.fill)

    def fill(self):
        box = Box(name='green')
        box.place.x = 2.25
        self.publisher.publish(box)


filler = lab.spin(Filler())
print('monitor', lab.monitor('/filled', count=2))
print('plot', lab.plot('/filled.place.x', count=3))
assert run_line('topic echo --once /filled') == 0
assert run_line('topic echo --once /filled --field place.x') == 0
print('doctor', lab.doctor())
lab.remove(filler)
child = 'from box_interfaces.action import Carry; print(Carry.Goal().box.place.x)'
print(subprocess.run([sys.executable, '-c', child], env=environment(), capture_output=True))
from rosbags.highlevel import AnyReader
from pathlib import Path
with AnyReader([Path(folder + '/bag')]) as bag:
    print(sorted(type(bag.deserialize(data, link.msgtype)).__name__
                 for link, _, data in bag.messages()))

# Built anew with nothing changed: all is well. Changed: the kernel has the old ones.
print(lab.build(folder))
types = Path(folder, 'src/box_interfaces/msg/Box.msg')
types.write_text(types.read_text() + 'float64 mass\\n')
try:
    lab.build(folder)
except lab.LabError as error:
    print(error)
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    package = tmp_path / 'ws' / 'src' / 'box_interfaces'
    for name, text in {'package.xml': PACKAGE_XML, 'CMakeLists.txt': CMAKE, **TYPES}.items():
        path = package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / 'ws'


@pytest.mark.slow('it builds types with a compiler')
@pytest.mark.timeout(1800)
def test_types_of_ones_own_are_types_like_all_others(folder, tmp_path, lab_env):
    import subprocess

    check_compiler()
    program = tmp_path / 'used.py'
    program.write_text(USED.format(folder=str(folder)))
    done = subprocess.run(
        [sys.executable, str(program)],
        env={**lab_env, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF'},
        capture_output=True,
        text=True,
        timeout=1700,
    )
    out = done.stdout
    assert done.returncode == 0, out + done.stderr
    assert out.startswith("['box_interfaces']\n")
    assert 'Box box\n\tstring name\n\tgeometry_msgs/Point place\n\t\tfloat64 x' in out
    assert 'box_interfaces/action/Carry\nbox_interfaces/msg/Box\nbox_interfaces/srv/Weigh' in out
    assert 'response:\nbox_interfaces.srv.Weigh_Response(weight=3.0)' in out
    assert 'Feedback:\n    remaining: 0.5' in out and 'status: SUCCEEDED' in out
    assert '\n1.5\n' in out and '\nplayed blue\n' in out
    assert '  /carry [box_interfaces/action/Carry]\n    served by /carrier' in out
    assert 'monitor /filled [box_interfaces/msg/Box]\npublished by /filler' in out
    assert "name: 'green'\nplace:\n  x: 2.25\n" in out
    assert 'plot /filled.place.x: 3 messages, first 2.25 m' in out
    # The two echos.
    assert 'name: green\nplace:\n  x: 2.25\n' in out and '---\n2.25\n---\ndoctor' in out
    assert 'Topics          /boxes, /filled, /carry (action)' in out and 'All is well.' in out
    assert r"stdout=b'0.0\n', stderr=b''" in out
    assert "['box_interfaces__action__Carry_FeedbackMessage', 'box_interfaces__msg__Box']" in out
    assert 'box_interfaces was built anew, but this kernel has imported it' in out
    assert 'Restart the kernel' in out


def test_what_is_not_there_is_said(tmp_path, monkeypatch):
    with pytest.raises(LabError, match='There is no package in'):
        workspace.build(tmp_path)
    with pytest.raises(LabError, match='Nothing was built in'):
        workspace.source(tmp_path)


def test_without_a_compiler_the_command_is_told_that_installs_it(tmp_path, monkeypatch, folder):
    tools = tmp_path / 'bin'
    tools.mkdir()
    (tools / 'apt-get').write_text('#!/bin/sh\n')
    (tools / 'apt-get').chmod(0o755)
    monkeypatch.setenv('PATH', str(tools))
    monkeypatch.delenv('CXX', raising=False)
    with pytest.raises(LabError) as raised:
        workspace.build(folder)
    assert str(raised.value) == (
        'To build interfaces, this machine lacks a C++ compiler and make.\n'
        'sudo apt install build-essential python3-dev'
    )


def test_foreign_folders_are_replaced_once(tmp_path):
    path = tmp_path / 'share' / 'a_msgs' / 'cmake' / 'export_a__rosidl_generator_pyExport.cmake'
    path.parent.mkdir(parents=True)
    path.write_text(
        'INCLUDE "/opt/python/cp313-cp313/include/python3.13;'
        '/opt/python/cp313-cp313/lib/python3.13/site-packages/numpy/_core/include"\n'
        'OTHER "${_IMPORT_PREFIX}/include/a"\n'
    )
    assert fix_exported_paths(tmp_path, numpy.get_include()) == 1
    assert path.read_text() == (
        f'INCLUDE "{sysconfig.get_path("include")};{numpy.get_include()}"\n'
        'OTHER "${_IMPORT_PREFIX}/include/a"\n'
    )
    assert fix_exported_paths(tmp_path, numpy.get_include()) == 0


def test_of_a_failed_build_the_reason_is_shown():
    said = [
        '-- Found ament_cmake: 2.5.4',
        'Traceback (most recent call last):',
        '  File "generator.py", line 5, in <module>',
        "rosidl_adapter.parser.InvalidFieldDefinition: Could not parse the line 'int32'",
        'CMake Error at rosidl_adapt.cmake:60 (message):',
        '  execute_process(...) returned error code 1',
        'Failed   <<< box_interfaces [1.0s, exited with code 1]',
    ]
    shown = list(workspace._reasons(said))
    assert "InvalidFieldDefinition: Could not parse the line 'int32'" in shown[0]
    assert not any('File "' in line or '-- Found' in line for line in shown)


OTHER = """
import labkit as lab
print(lab.source({folder!r}), flush=True)
from labkit.ros2.shell import run_line
run_line('run lamps lamp')
"""


def other_tree(folder: Path) -> Path:
    """Make what colcon leaves of a package of Python, with a Python that is not here."""
    prefix = folder / 'install/lamps'
    modules = prefix / 'lib/python3.99/site-packages'
    marks = prefix / 'share/ament_index/resource_index/packages'
    for place in (marks, modules, prefix / 'lib/lamps'):
        place.mkdir(parents=True)
    (marks / 'lamps').touch()
    (modules / 'lamps.py').write_text(
        'import rclpy, sys\nprint("lit", sys.version_info < (3, 99))\n'
    )
    script = prefix / 'lib/lamps/lamp'
    script.write_text('#!/opt/other/bin/python3.99\nimport lamps\n')
    script.chmod(0o755)
    return modules


def run(folder: Path, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    code = OTHER.format(folder=str(folder))
    command = [sys.executable, '-c', code]
    return subprocess.run(command, env=env, capture_output=True, text=True, timeout=240)


@pytest.mark.slow('starts processes of its own')
def test_a_tree_of_another_python_is_told_and_run_by_this_one(
    tmp_path: Path, lab_env: dict[str, str]
) -> None:
    modules = other_tree(tmp_path)
    done = run(tmp_path, lab_env)
    own = f'{sys.version_info[0]}.{sys.version_info[1]}'
    assert f'lamps: built for Python 3.99, and this notebook runs Python {own}.' in done.stdout
    assert "['lamps']\nlit True\n" in done.stdout and done.returncode == 0, done.stderr
    (modules / 'lamps.cpython-399.so').touch()
    done = run(tmp_path, lab_env)
    assert 'What is compiled for that one can not be loaded.' in done.stderr
    assert f'Build it here: lab.build({str(tmp_path)!r})' in done.stderr
