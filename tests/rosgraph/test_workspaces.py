"""What is said of a package that is not found, or lacks something: what colcon has left of it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from labkit import settings
from labkit.errors import LabError
from labkit.launching.launch_files import find
from labkit.packages import workspace as built
from labkit.packages.skeleton import Skeleton
from labkit.ros2.shell import run_line

MARKER = 'share/ament_index/resource_index/packages'
LOG = 'log/build_2026-01-01_10-00-00'
COMPILER = 'main.cpp:3: error: expected a semicolon\n'
# The last line of what colcon writes where setup.py does not run, here shortened.
NO_SETUP = (
    'Traceback (most recent call last):\n'
    "subprocess.CalledProcessError: Command '['python', '-c', 'from distutils.core import "
    "run_setup;dist = run_setup(...)']' returned non-zero exit status 1.\n"
)
NOT_FOUND = "Package 'lamp_lab' not found\n"
SETUP_FAILS = (
    'The last build of lamp_lab has failed: its setup.py does not run. This says why: '
    'cd src/lamp_lab && python3 setup.py --name\n'
)


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv('COLCON_PREFIX_PATH', raising=False)
    return tmp_path


@pytest.fixture
def said(capsys) -> Callable[[str], str]:
    """Give a function that runs a command, and returns what it says of what is missing."""

    def run(line: str = 'run lamp_lab lamp') -> str:
        assert run_line(line) == 1
        shown = capsys.readouterr()
        assert shown.out == ''
        return shown.err

    return run


def write(path: Path, text: str = '') -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def leave(folder: Path, result: str, stderr: str = '', package: str = 'lamp_lab') -> None:
    """Leave behind what colcon does after a build of a package that ended so."""
    write(folder / 'build/.built_by', 'colcon\n')
    write(folder / f'build/{package}/colcon_build.rc', f'{result}\n')
    for name in ('stderr.log', 'stdout_stderr.log'):
        write(folder / LOG / package / name, stderr)
    if not (folder / 'log/latest_build').exists():
        (folder / 'log/latest_build').symlink_to(Path(LOG).name)
    if result == '0':
        write(folder / f'install/{package}/{MARKER}/{package}')


def make_source(folder: Path, package: str = 'lamp_lab', *, executable: str = 'lamp') -> Path:
    skeleton = Skeleton(
        name=package,
        maintainer='me',
        email='me@example.org',
        description='A lamp',
        license='Apache-2.0',
        dependencies=[],
        test_dependencies=[],
        scripts=[(executable, f'{package}.lamp:main'), ('other', f'{package}.lamp:main')],
    )
    for part in skeleton.parts():
        part.write(folder / 'src' / package)
    write(folder / f'src/{package}/{package}/lamp.py', 'def main():\n    pass\n')
    return folder / 'src' / package


def test_the_last_build_has_failed(workspace, said):
    """Also if an older one stays in install, as long as this process does not know that one."""
    make_source(workspace)
    leave(workspace, '0')
    leave(workspace, '1', COMPILER)
    told = (
        'The last build of lamp_lab has failed. What colcon said is in '
        'log/latest_build/lamp_lab/stderr.log. Mend that, and build it again: colcon build\n'
    )
    assert said() == NOT_FOUND + told
    assert said('pkg prefix lamp_lab') == NOT_FOUND + told
    assert said('launch lamp_lab lamp.launch.xml') == NOT_FOUND + told
    assert said('interface package lamp_lab') == "Unknown package 'lamp_lab'\n" + told
    assert said('interface show lamp_lab/msg/Lamp').endswith(f'is not known.\n{told}')
    # A later build was one of another package.
    other = workspace / 'log/build_2026-01-01_11-00-00'
    write(other / 'other_lab/stderr.log')
    (workspace / 'log/latest_build').unlink()
    (workspace / 'log/latest_build').symlink_to(other.name)
    assert f'What colcon said is in {LOG}/lamp_lab/stderr.log.' in said()


def test_where_setup_does_not_run_its_words_are_in_no_log(workspace, said):
    make_source(workspace)
    leave(workspace, '1', NO_SETUP)
    assert said() == NOT_FOUND + SETUP_FAILS


def test_other_ends_of_a_build(workspace, said):
    make_source(workspace)
    assert (
        said()
        == f'{NOT_FOUND}Its source is in src/lamp_lab, and it is not built. Build it: '
        + ('colcon build\n')
    )
    make_source(workspace, 'bulb_lab')
    leave(workspace, '1', COMPILER, 'bulb_lab')
    assert 'and it is not built. The last build of bulb_lab has failed. What' in said()
    leave(workspace, 'SIGINT')
    assert said().endswith('lamp_lab was interrupted. Build it again: colcon build\n')
    leave(workspace, '0')
    assert said() == (
        f'{NOT_FOUND}It is built in this folder, but this terminal does not know it yet: source '
        'install/setup.bash\n'
    )


def test_in_a_notebook_the_words_are_those_of_a_notebook(workspace, said, monkeypatch):
    """Its folder may be the one around the workspace."""
    make_source(workspace / 'ws')
    leave(workspace / 'ws', '0')
    monkeypatch.setattr(settings, 'in_kernel', lambda: True)
    with pytest.raises(LabError) as raised:
        find('lamp_lab', 'lamp.launch.xml')
    assert raised.value.todo == (
        f"It is built in {workspace}/ws, but this notebook does not know it yet: lab.source('ws')"
    )
    leave(workspace / 'ws', '1', COMPILER)
    with pytest.raises(LabError, match=r"build it again: lab.build\('ws'\)"):
        find('lamp_lab', 'lamp.launch.xml')


def test_a_package_that_is_known_may_be_an_old_one(workspace, said, monkeypatch):
    source = make_source(workspace)
    leave(workspace, '0')
    program = workspace / 'install/lamp_lab/lib/lamp_lab/lamp'
    write(program)
    program.chmod(0o755)
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'{workspace}/install/lamp_lab')
    monkeypatch.chdir('src')
    missing = "No executable found: lamp_lab has no 'dimmer'.\n"
    assert said('run lamp_lab dimmer') == f'{missing}lamp_lab has: lamp.\n'
    ended = (workspace / 'build/lamp_lab/colcon_build.rc').stat().st_mtime
    os.utime(source / 'setup.py', (ended + 1, ended + 1))
    changed = (
        f'lamp_lab/setup.py was changed after the last build: cd {workspace} && colcon build\n'
    )
    assert said('run lamp_lab dimmer') == f'{missing}{changed}lamp_lab has: lamp.\n'
    assert f'\n{changed}' in said('launch lamp_lab lamp.launch.xml')
    leave(workspace, '1', NO_SETUP)
    assert said('run lamp_lab dimmer').startswith(
        f'{missing}The last build of lamp_lab has failed: its setup.py does not run. '
    )


def test_a_name_is_no_path(workspace, said):
    leave(workspace / 'ws', '1', COMPILER)
    for name in ('../ws/lamp_lab', '*', '.', 'ws/lamp_lab'):
        assert 'has failed' not in said(f'run "{name}" lamp')


@pytest.mark.slow('the real colcon builds four times')
def test_what_colcon_leaves_is_that(workspace, said, lab_env):
    """And `lab.build` has the words that colcon leaves out."""
    env = {**lab_env, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF', 'ROS_DOMAIN_ID': '1'}
    env['PATH'] = f'{Path(sys.executable).parent}:{env["PATH"]}'

    def bash(line: str) -> str:
        return subprocess.run(
            ['bash', '-c', line], env=env, capture_output=True, text=True, timeout=200
        ).stderr

    make_source(workspace, 'bulb_lab')
    setup = make_source(workspace) / 'setup.py'
    text = setup.read_text()
    bash('colcon build')
    assert 'does not know it yet: source install/setup.bash' in said()
    shutil.rmtree(workspace / 'install/lamp_lab')

    setup.write_text(text.replace("['package.xml']", "['packages.xml']"))
    bash('colcon build')
    log = 'log/latest_build/lamp_lab/stderr.log'
    assert f'has failed. What colcon said is in {log}.' in said()
    assert "can't copy 'packages.xml'" in Path(log).read_text()

    setup.write_text(text.replace("lamp:main',", "lamp:main'"))
    bash('colcon build')
    assert bash('. install/setup.bash; ros2 run lamp_lab lamp') == NOT_FOUND + SETUP_FAILS
    said_by_setup = 'error in lamp_lab setup command: Problems to parse EntryPoint'
    assert said_by_setup in bash('cd src/lamp_lab && python3 setup.py --name')
    with pytest.raises(LabError) as raised:
        built.build(workspace)
    assert raised.value.message.startswith(
        f'colcon build of lamp_lab has failed:\n{setup}:\n{said_by_setup}'
    )
    assert 'run_setup' not in raised.value.message
