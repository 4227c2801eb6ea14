"""Types of the tutorials that no wheel has: built when they are asked for, and kept.

What is built lies in the environment, so that all tests and all later runs share it.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from rosidl_adapter.parser import parse_message_string

from labkit.packages import built_types
from labkit.rosgraph import interfaces
from labkit.rosgraph.refusals import Refused

# A first build takes seconds of processor time a type.
pytestmark = pytest.mark.timeout(900)

TUTORIAL = """
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node


class Adder(Node):
    def __init__(self):
        super().__init__('adder')
        self.create_service(AddTwoInts, 'add_two_ints', self.add)

    def add(self, request, response):
        response.sum = request.a + request.b
        return response


adder = lab.spin(Adder())
"""
ADD = 'example_interfaces/srv/AddTwoInts'
NUMBER = 'example_interfaces/msg/Int64'


@pytest.mark.slow('it builds types with a compiler')
def test_a_tutorial_with_such_types_works(start_kernel):
    """One kernel for all that has to do with types: each that is new is built here."""
    kernel = start_kernel()
    assert kernel.run('import labkit as lab').error == ''
    # Shows its progress if it is the first.
    assert kernel.run(TUTORIAL, timeout=800).error == ''
    # All that the words of `ros2` know, and the other views.
    shown = kernel.run(f'%ros2 interface show {ADD}')
    assert shown.text == 'int64 a\nint64 b\n---\nint64 sum\n'
    called = kernel.run(f'%ros2 service call /add_two_ints {ADD} "{{a: 2, b: 3}}"')
    assert 'AddTwoInts_Response(sum=5)' in called.text
    line = f'topic pub --times 1 --wait-matching-subscriptions 0 /number {NUMBER} "{{data: 7}}"'
    published = kernel.run(f'%ros2 {line}', timeout=800)
    assert 'example_interfaces.msg.Int64(data=7)' in published.text
    kernel.run(
        'from example_interfaces.msg import Int64\n'
        'from rclpy.node import Node\n'
        'class Source(Node):\n'
        '    def __init__(self):\n'
        "        super().__init__('source')\n"
        "        self.publisher = self.create_publisher(Int64, 'number', 10)\n"
        '        self.create_timer(0.05, self.tick)\n'
        '    def tick(self):\n'
        '        self.publisher.publish(Int64(data=8))\n'
        'lab.spin(Source())'
    )
    seen = kernel.run("print(lab.monitor('/number', count=1))")
    assert f'/number [{NUMBER}]' in seen.text and 'data: 8' in seen.text
    assert kernel.run('%ros2 topic echo --once /number').text == 'data: 8\n---\n'
    kept = kernel.run(
        "with lab.record('bag', ['/number']) as recording:\n"
        "    recording.wait_for(1, '/number', timeout_sec=60)\n"
        "print(lab.bag('bag'))"
    )
    assert NUMBER in kept.text and kept.error == ''
    # A process that a cell starts finds them, too, without labkit.
    child = kernel.run(
        'import subprocess, sys\n'
        "code = 'from example_interfaces.srv import AddTwoInts as A; print(A.Request(a=4).a)'\n"
        "print(subprocess.run([sys.executable, '-c', code], capture_output=True, text=True))"
    )
    assert r"stdout='4\n', stderr=''" in child.text


def test_all_of_a_package_are_there_by_name(script):
    seen = script(
        'import labkit\n'
        'import example_interfaces.msg, example_interfaces.srv\n'
        'print(dir(example_interfaces.srv)[:3], "Int64" in example_interfaces.msg.__all__)\n'
        'print(hasattr(example_interfaces.srv, "AddThreeInts"))\n'
        'from example_interfaces.srv import AddThreeInts'
    )
    assert seen.stdout == "['AddTwoInts', 'SetBool', 'Trigger'] True\nFalse\n"
    assert "ImportError: cannot import name 'AddThreeInts'" in seen.stderr


@pytest.mark.parametrize('name', interfaces.buildable())
def test_each_type_is_defined_in_words_that_ros_reads(name):
    package, kind, word = name.split('/')
    assert interfaces.check_exists(name, kind) == name
    text = interfaces.path_of(name).read_text(encoding='utf-8')
    parts = text.split('---\n')
    assert len(parts) == {'msg': 1, 'srv': 2, 'action': 3}[kind]
    for part in parts:
        for field in parse_message_string(package, word, part).fields:
            if not field.type.is_primitive_type():
                interfaces.check_exists(f'{field.type.pkg_name}/msg/{field.type.type}', 'msg')


def test_near_names_are_suggested_and_installed_ones_first():
    for asked, near in [
        ('example_interfaces/srv/AddTwoInt', ADD),
        ('example_interface/srv/AddTwoInts', ADD),
        ('std_msg/msg/Int64', 'std_msgs/msg/Int64'),
    ]:
        with pytest.raises(Refused) as raised:
            interfaces.check_exists(asked)
        assert raised.value.todo == f'Did you mean {near!r}?'
    # What `ros2 interface list` shows is installed.
    assert not {'example_interfaces', 'turtlesim', 'tf2_msgs'} & set(interfaces.packages())


def test_one_that_is_installed_wins(script, tmp_path):
    for folder in ('early', 'late'):
        package = tmp_path / folder / 'example_interfaces' / 'srv'
        package.mkdir(parents=True)
        (package.parent / '__init__.py').write_text('')
        (package / '__init__.py').write_text(f"AddTwoInts = '{folder}'")
    code = 'from example_interfaces.srv import AddTwoInts; print(AddTwoInts)'
    ours = str(Path(built_types.__file__).parent / 'stand_ins')
    early = script(code, PYTHONPATH=f'{tmp_path / "early"}:{ours}')
    assert early.stdout == 'early\n'
    # As in the environment itself, which Python looks through after PYTHONPATH.
    late = script(f'import sys; sys.path.append({str(tmp_path / "late")!r})\n{code}')
    assert late.stdout == 'late\n', late.stderr


def test_import_of_all_says_how_far_it_is_and_how_to_need_less(monkeypatch):
    said = []

    def load(self, word, of_all):
        said.append(of_all)
        return word

    monkeypatch.setattr(built_types._Types, '_load', load)
    monkeypatch.setitem(sys.modules, 'some', ModuleType('some'))
    words = [
        ' (1 of 2: import * asks for all of them. Name those that you use instead: '
        'from some.msg import Bool)',
        ' (2 of 2: import * asks for all of them. Name those '
        'that you use instead: from some.msg import Int64)',
    ]
    for code, told in (
        ('from some.msg import *', words),
        ('from some.msg import Bool', ['']),
        ('import some.msg; some.msg.Int64; some.msg.Int64', ['']),
    ):
        module = built_types._Types('some.msg', ['Bool', 'Int64'])
        monkeypatch.setitem(sys.modules, 'some.msg', module)
        monkeypatch.setattr(sys.modules['some'], 'msg', module, raising=False)
        exec(code, {})
        assert said == told
        said.clear()


# -- keeping ------------------------------------------------------------------------------------


@pytest.fixture
def places(tmp_path, monkeypatch):
    """Keep what is built in two new folders, and only pretend to build."""
    found = [tmp_path / 'environment', tmp_path / 'home']
    monkeypatch.setattr(built_types, '_places', lambda: found)

    def build(work: Path, name: str, texts: dict[str, str], of_all: str) -> Path:
        with (tmp_path / 'builds').open('a') as log:
            log.write(f'{name}{of_all}\n')
        (work / 'result').mkdir()
        return work / 'result'

    monkeypatch.setattr(built_types, '_build', build)
    return found


def builds(tmp_path: Path) -> list[str]:
    path = tmp_path / 'builds'
    return path.read_text().splitlines() if path.exists() else []


def test_what_was_built_is_kept_until_its_text_changes(places, tmp_path, monkeypatch):
    first = built_types._built(ADD)
    assert first.parent == places[0] and first == built_types._built(ADD)
    assert builds(tmp_path) == [ADD]
    monkeypatch.setattr(built_types, '_texts', lambda name: {'srv/AddTwoInts.srv': 'int64 a'})
    assert built_types._built(ADD) != first
    assert builds(tmp_path) == [ADD, ADD]


def test_an_environment_that_can_not_be_written_is_left_alone(places, tmp_path):
    for place, kept in zip(places, [places[1], None], strict=True):
        place.parent.mkdir(exist_ok=True)
        shutil.rmtree(place, ignore_errors=True)
        place.write_text('no folder can be made here')
        if kept:
            assert built_types._built(ADD).parent == kept
    with pytest.raises(ImportError) as raised:
        built_types._built(NUMBER)
    assert str(raised.value) == (
        f'{NUMBER} comes with no wheel, and has to be built here. It would be kept in '
        f'{places[0]} or {places[1]}, and neither can be written.\n'
        'Set LABKIT_HOME to a folder that can be written.'
    )


def test_without_a_compiler_the_command_is_told_that_installs_it(places, tmp_path, monkeypatch):
    (tmp_path / 'apt-get').write_text('#!/bin/sh\n')
    (tmp_path / 'apt-get').chmod(0o755)
    monkeypatch.setenv('PATH', str(tmp_path))
    monkeypatch.delenv('CXX', raising=False)
    with pytest.raises(ImportError) as raised:
        built_types._built(ADD)
    assert str(raised.value) == (
        f'{ADD} comes with no wheel, and has to be built here. '
        'To build interfaces, this machine lacks a C++ compiler and make.\n'
        'sudo apt install build-essential python3-dev'
    )
    assert not places[0].exists()


BUILDER = f"""
import sys
from pathlib import Path
from labkit.packages import built_types


def build(work, name, texts, of_all):
    print('builds', flush=True)
    sys.stdin.readline()
    (work / 'result').mkdir()
    return work / 'result'


built_types._places = lambda: [Path(sys.argv[1])]
built_types.check_compiler = lambda: print('asks', flush=True)
built_types._build = build
print(built_types._built({ADD!r}).name)
"""


@pytest.fixture
def start_builder(tmp_path, lab_env):
    """Give a function that starts a process that needs a type, and builds until it is told."""
    started: list[subprocess.Popen[str]] = []

    def start() -> subprocess.Popen[str]:
        command = [sys.executable, '-c', BUILDER, str(tmp_path / 'types')]
        pipe = subprocess.PIPE
        started.append(subprocess.Popen(command, env=lab_env, stdin=pipe, stdout=pipe, text=True))
        assert started[-1].stdout.readline() == 'asks\n'
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()


def test_of_two_that_ask_at_once_one_builds(start_builder):
    first = start_builder()
    assert first.stdout.readline() == 'builds\n'
    second = start_builder()
    name, _ = first.communicate('\n')
    assert second.communicate()[0] == name and name.startswith('example_interfaces.srv.AddTwoInts')


def test_after_a_killed_build_the_next_one_begins_anew(start_builder, tmp_path):
    first = start_builder()
    assert first.stdout.readline() == 'builds\n'
    first.kill()
    first.wait()
    second = start_builder()
    said, _ = second.communicate('\n')
    assert second.returncode == 0, said
    builds, name = said.splitlines()
    assert builds == 'builds'
    assert {path.name for path in (tmp_path / 'types').iterdir()} == {name, 'lock', 'lock-queue'}
