"""The words of `python3 -m labkit`, on machines where nothing is installed yet."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from courses import ROOT, Course
from test_layers import BARE

from labkit import __version__
from labkit.__main__ import main
from labkit.course import run_tests
from labkit.errors import LabError

MEASURED = """
import subprocess, sys
CODE = 'from labkit.files import is_inside; is_inside("a", "b")'
def test_it():
    done = subprocess.run([sys.executable, '-c', CODE], capture_output=True)
    assert (done.returncode, done.stderr) == (0, b'')
"""
COMMANDS = ('lab', 'test', 'doctor', 'record', 'reset', 'lesson')


@pytest.fixture
def course(tmp_path: Path) -> Course:
    return Course(tmp_path / 'course')


@pytest.mark.parametrize('module', BARE)
def test_old_python_can_read_what_tells_it_that_it_is_old(module: str) -> None:
    path = ROOT.joinpath(*module.split('.'))
    path = path / '__init__.py' if path.is_dir() else path.with_suffix('.py')
    ast.parse(path.read_text(encoding='utf-8'), feature_version=(3, 8))


def test_help_of_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(['--help'])
    assert ended.value.code == 0
    text = capsys.readouterr().out
    for command in COMMANDS:
        assert f'\n    {command} ' in text
        with pytest.raises(SystemExit) as ended:
            main([command, '--help'])
        assert ended.value.code == 0
        assert f'usage: labkit {command}' in capsys.readouterr().out


@pytest.mark.parametrize(
    'words',
    [
        [],
        ['lb'],
        ['doctor', '--colour'],
        ['reset'],
        ['--lab'],
        ['lesson', '04'],
        ['lesson', '--blank'],
    ],
)
def test_what_it_does_not_know(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    assert 'usage: labkit' in capsys.readouterr().err


def test_version(course: Course) -> None:
    assert course.run('--version').stdout.strip() == f'labkit {__version__}'


def test_commands_that_need_the_environment_say_so(course: Course) -> None:
    done = course.run('record', '00')
    assert done.returncode == 2
    assert done.stderr == (
        'labkit: There is no environment yet.\nMake it: python3 -m labkit lab\n'
    )
    assert not course.venv.exists()


def test_commands_go_on_in_the_environment(course: Course) -> None:
    course.require(course.wheel('rclpy'))
    assert course.make().returncode == 0
    # A stand-in that tells which Python runs it.
    (course.folder / 'labkit' / 'checkup' / 'report.py').write_text(
        'import sys\n'
        'class Report(str):\n'
        '    ok = False\n'
        'def doctor():\n'
        '    return Report(sys.prefix)\n'
    )
    done = course.run('doctor', _ROS_WHEELS_BOOTSTRAP_COMPLETE='1')
    assert (done.returncode, done.stdout.strip()) == (1, str(course.venv))


def test_environment_without_ros_is_said_to_be(course: Course) -> None:
    assert course.make().returncode == 0
    done = course.run('record', '00')
    assert done.returncode == 2
    assert 'is without ROS 2' in done.stderr


def test_later_parts_are_offered_when_they_are_there(course: Course) -> None:
    assert course.run('ros2', 'topic', 'list').returncode == 2
    course.require(course.wheel('rclpy'))
    assert course.make().returncode == 0
    code = 'import sys\ndef main(argv):\n    print(argv)\n    return 7\n'
    (course.folder / 'labkit' / 'ros2').mkdir()
    (course.folder / 'labkit' / 'ros2' / '__init__.py').write_text(code)
    done = course.run('ros2', 'topic', 'pub', '--help', '--once')
    assert (done.returncode, done.stdout) == (7, "['topic', 'pub', '--help', '--once']\n")
    assert '    ros2 ' in course.run('--help').stdout


def test_reset_needs_no_environment(course: Course) -> None:
    lesson = course.folder / 'notebooks' / '00_start_here.ipynb'
    lesson.write_text('{"cells": []}')
    done = course.run('reset', '0')
    assert done.returncode == 0, done.stderr
    assert (course.work / lesson.name).is_file()
    assert course.run('reset', '5').returncode == 2


def test_outside_of_a_clone(course: Course) -> None:
    (course.folder / 'environment.txt').unlink()
    done = course.run('test')
    assert done.returncode == 2
    assert 'Run this command in a complete copy (git clone) of the course.' in done.stderr


def test_order_of_the_test_command() -> None:
    steps = run_tests._steps([])
    assert [name for name, _ in steps] == [
        'style',
        'format',
        'types',
        'layers and format',
        'notebooks and tests',
    ]
    assert run_tests._steps(fast=True) == steps[:-1]
    everything = run_tests._steps(['--junitxml=report.xml'], everything=True)
    assert everything[:-1] == steps[:-1]
    gate, whole = set(steps[-1][1]), set(everything[-1][1])
    assert gate - whole == set(run_tests._GATE) and whole - gate == {'--junitxml=report.xml'}
    fast = [path for path in steps[-2][1] if path.startswith('tests/')]
    assert fast and all((ROOT / path).is_file() for path in fast)
    assert all(f'--ignore={path}' in steps[-1][1] for path in fast)


def test_arguments_for_pytest() -> None:
    ((_, command),) = run_tests._steps(['-k', 'odds'])
    assert command[-4:] == ['notebooks', 'tests', '-k', 'odds']
    ((_, command),) = run_tests._steps(['tests/test_layers.py::test_x', '-x'])
    assert 'notebooks' not in command
    ((_, command),) = run_tests._steps(['notebooks', '-x'])
    assert {'notebooks', '-x'} < set(command) and 'tests' not in command
    assert 'not slow' not in ' '.join(command)


def test_what_is_run_for_a_lesson() -> None:
    first, second = run_tests._steps(['04', '5', '-n', '1'])
    assert [first[0], second[0]] == ['lesson 04', 'lesson 5']
    assert 'notebooks/04_odds.ipynb' in first[1]
    assert first[1][-4:] == ['-k', '04_odds or odds-', '-n', '1']
    assert 'notebooks/05_my_name_is.ipynb' in second[1]
    ((_, command),) = run_tests._steps(['-n', '1'])
    assert command[-4:] == ['notebooks', 'tests', '-n', '1']
    with pytest.raises(LabError, match='There is no lesson 44'):
        run_tests._steps(['44'])


def test_what_is_measured() -> None:
    steps = run_tests._measured(run_tests._steps(['tests/sim']))
    assert [command[:2] for _, command in steps] == [
        ['coverage', 'erase'],
        ['coverage', 'run'],
        ['coverage', 'combine'],
        ['coverage', 'html'],
        ['coverage', 'report'],
    ]
    assert steps[1][1][2:5] == ['-m', 'pytest', '--nbval']
    everything = run_tests._measured(run_tests._steps())
    assert [name for name, command in everything if 'run' in command] == ['notebooks and tests']


@pytest.mark.parametrize(
    'words', [['--fast', '-k', 'odds'], ['--fast', '--all'], ['--fast', '--coverage']]
)
def test_options_that_do_not_go_together(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(['test', *words]) == 2
    assert '--fast' in capsys.readouterr().err


@pytest.mark.slow('an environment, measured')
def test_coverage_of_processes_too(course: Course) -> None:
    course.make_complete()
    shutil.copy(ROOT / 'pyproject.toml', course.folder)
    for room in ('background', 'checkup', 'lessons', 'rosgraph', 'sim', 'views'):
        shutil.rmtree(course.folder / 'labkit' / room)  # a page about each module takes its time
    (course.folder / 'tests' / 'test_it.py').write_text(MEASURED)
    done = course.run('test', '--coverage', 'tests/test_it.py', '-n', '1')
    assert done.returncode == 0, done.stdout + done.stderr
    # Nobody but the test's own process has imported this module.
    assert re.search(r'labkit/files\.py .* [1-9]\d%', done.stdout)
    assert (course.venv / 'cache' / 'coverage' / 'index.html').is_file()


@pytest.mark.slow('runs a small suite')
def test_run_without_a_test_is_a_failure(course: Course) -> None:
    course.make_complete()
    done = course.run('test', '-k', 'nothing_has_this_name', '-n', '1')
    assert done.returncode == 5, done.stdout + done.stderr
    assert 'tests failed (exit code 5)' in done.stderr


# Fails at its first run, and where a file says so at each.
FLAKY = """
from pathlib import Path
import pytest
TRIED = Path('tried')
def test_flaky():
    if not TRIED.exists():
        TRIED.touch()
        raise OSError('the port is taken')
def test_whole():
    assert not Path('broken').exists()
@pytest.mark.parametrize('number', range(13))
def test_many(number):
    assert not Path('many').exists()
@pytest.mark.slow('it waits for an hour')
def test_slow():
    assert 'slow' == 'run'
"""


@pytest.mark.slow('runs a small suite, twice')
def test_what_passes_only_at_the_second_try_is_told(course: Course) -> None:
    course.make_complete()
    shutil.copy(ROOT / 'pyproject.toml', course.folder)
    (course.folder / 'tests' / 'test_it.py').write_text(FLAKY)
    gate = ['tests', '-n', '2', *run_tests._GATE]
    done = course.run('test', *gate)
    assert done.returncode == 0, done.stdout + done.stderr
    assert '== a second try, alone: 1 of what failed' in done.stdout
    assert done.stdout.endswith(
        'labkit test: all passed, 1 of them only at the second try:\n'
        '  tests/test_it.py::test_flaky\n'
        '      OSError: the port is taken\n'
    )
    assert course.run('test', *gate).stdout.endswith('\nlabkit test: all passed.\n')
    # What fails twice has failed, and so has what somebody names.
    (course.folder / 'broken').touch()
    done = course.run('test', *gate)
    assert (done.returncode, done.stdout.count('a second try')) == (1, 1)
    (course.folder / 'tried').unlink()
    assert course.run('test', 'tests/test_it.py::test_flaky', '-n', '2').returncode == 1
    # Many failures are no flakes.
    (course.folder / 'many').touch()
    done = course.run('test', *gate)
    assert (done.returncode, done.stdout.count('a second try')) == (1, 0)
    # Without the gate's choice what is slow runs, too.
    assert "'slow' == 'run'" in course.run('test', 'tests', '-n', '2', '-k', 'slow').stdout


def test_quarantine_decides_nothing(course: Course) -> None:
    course.make_complete()
    shutil.copy(ROOT / 'pyproject.toml', course.folder)
    (course.folder / 'tests' / 'test_it.py').write_text(FLAKY)
    (course.folder / 'broken').touch()
    (course.folder / 'tests' / 'quarantine.txt').write_text(
        'tests/test_it.py::test_whole | 2026-11-27 | it fails | a file\n'
    )
    done = course.run('test', 'tests', '-n', '2', '-k', 'whole or many')
    assert done.returncode == 0, done.stdout + done.stderr
    told = 'in quarantine, decides nothing: tests/test_it.py::test_whole: '
    assert f'{told}failed (since 2026-11-27)' in done.stdout
    done = course.run('test', 'tests', '-n', '2', *run_tests._GATE, '-k', 'whole or many')
    assert f'{told}not run (since 2026-11-27)' in done.stdout


def test_marker_without_a_word_on_why_is_refused(course: Course) -> None:
    course.make_complete()
    shutil.copy(ROOT / 'pyproject.toml', course.folder)
    text = 'import pytest\n@pytest.mark.slow\ndef test_it():\n    pass\n'
    (course.folder / 'tests' / 'test_it.py').write_text(text)
    done = course.run('test', 'tests', '-n', '0')
    assert done.returncode != 0
    assert 'say why' in done.stdout + done.stderr


@pytest.mark.slow('copies the course')
def test_first_failure_ends_the_test_command_and_leaves_no_junk(course: Course) -> None:
    course.make_complete()
    (course.folder / 'labkit' / 'bad.py').write_text('import this is not Python\n')
    before = {path.name for path in course.folder.iterdir()}
    done = course.run('test', PYTHONDONTWRITEBYTECODE='1')
    assert done.returncode == 1, done.stdout + done.stderr
    assert '\nlabkit test: style failed (exit code 1).\n' in done.stderr
    assert '== format' not in done.stdout
    (course.folder / 'tests' / 'test_it.py').write_text('def test_it():\n    assert 1 == 2\n')
    done = course.run('test', 'tests/test_it.py', '-n', '1', PYTHONDONTWRITEBYTECODE='1')
    assert done.returncode == 1
    assert 'assert 1 == 2' in done.stdout
    assert {path.name for path in course.folder.iterdir()} == before


def test_import_from_any_folder(tmp_path: Path) -> None:
    code = 'import labkit, sys; print(labkit.__version__, "rclpy" in sys.modules)'
    done = subprocess.run(
        [sys.executable, '-c', code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == f'{__version__} False\n'
