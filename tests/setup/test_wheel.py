"""labkit as a wheel: what a program of somebody else's gets, without the course."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

PROGRAM = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, '/chatter', 10)
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='hello'))

lab.spin(Talker())
print('heard', lab.wait_for_message('/chatter', String).data)
%ros2 topic echo /chatter --once
lab.doctor()
print('of', lab.__file__)
"""


def _link(source: str, target: str) -> None:
    """Copy half a gigabyte quickly: pip removes a link, and writes another file in its place."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


@pytest.fixture(scope='module')
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give an environment with this one's packages, and with labkit from a wheel of the tree."""
    folder = tmp_path_factory.mktemp('wheel')
    prefix = folder / 'env'
    shutil.copytree(sys.prefix, prefix, symlinks=True, copy_function=_link)
    tree = folder / 'tree'
    files = subprocess.run(
        ['git', 'ls-files', '-z', 'labkit', 'pyproject.toml', 'LICENSE'],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    for name in filter(None, files.split('\0')):
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tree / name)
    install = [
        'install',
        '-q',
        '--no-deps',
        '--force-reinstall',
        '--no-build-isolation',
        str(tree),
    ]
    subprocess.run([prefix / 'bin' / 'python', '-m', 'pip', *install], check=True)
    return prefix


def test_a_program_in_an_empty_folder(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / 'program.ipy').write_text(PROGRAM)
    run = subprocess.run(
        [prefix / 'bin' / 'python', '-m', 'IPython', '--no-banner', 'program.ipy'],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert run.returncode == 0, run.stderr
    assert 'heard hello' in run.stdout
    assert 'data: hello' in run.stdout
    assert f'of {prefix}' in run.stdout
    assert 'wrong' not in run.stdout, 'the doctor misses nothing of a course that is not there'
    assert sorted(path.name for path in tmp_path.iterdir()) == ['program.ipy']


def test_its_lessons_and_commands_are_there(prefix: Path, tmp_path: Path) -> None:
    code = (
        'import labkit as lab; lesson = lab.lesson("odds"); print(type(lesson.evens).__name__);'
        'lesson.evens.hint()'
    )
    for command, expected in (
        (['python', '-c', code], 'Exercise'),
        (['labkit', '--version'], '0.1.0'),
        (['ros2', 'interface', 'show', 'std_msgs/msg/String'], 'string data'),
    ):
        run = subprocess.run(
            [prefix / 'bin' / command[0], *command[1:]],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert run.returncode == 0, run.stderr
        assert expected in run.stdout
