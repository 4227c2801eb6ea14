"""The doctor and the machine: variables, packages, network and memory, broken on purpose."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from visits import visit

TIMEOUT_SEC = 120
ROOT = Path(__file__).resolve().parents[2]


# --- Variables -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('variable', 'value', 'line', 'words'),
    [
        ('RMW_IMPLEMENTATION', 'rmw_cyclonedds_cpp', 'Variables', "asks for 'rmw_cyclonedds_cpp'"),
        ('ROS_LOCALHOST_ONLY', '1', 'Variables', 'overrides ROS_AUTOMATIC_DISCOVERY_RANGE'),
        ('ROS_PYTHON_CHECK_FIELDS', '0', 'Variables', 'Int16(data=40000), is not refused'),
        ('ROS_STATIC_PEERS', '192.168.1.7', 'Variables', 'has no effect'),
        ('AMENT_PREFIX_PATH', '/opt/ros/humble', 'Variables', 'another ROS: /opt/ros/humble'),
        ('LD_LIBRARY_PATH', '/opt/ros/humble/lib', 'Variables', 'another ROS: /opt/ros/humble'),
        ('PYTHONPATH', '/opt/ros/noetic/lib', 'Variables', 'another ROS: /opt/ros/noetic/lib.'),
        ('ROS_DISTRO', 'humble', 'Variables', "is 'humble', but what runs here is ROS 2 Jazzy"),
        ('ROS_VERSION', '1', 'Variables', "is '1', but what runs here is ROS 2 Jazzy"),
        ('ROS_DOMAIN_ID', 'seven', 'Domain', "must be a number from 0 to 101, but it is 'seven'"),
        ('ROS_DOMAIN_ID', '150', 'Domain', 'Choose a number from 0 to 101'),
        ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCAL', 'Domain', "but it is 'LOCAL'"),
        ('LABKIT_HOME', '/proc/nowhere', 'Disk', "'/proc' can not be written to"),
    ],
)
def test_variable_that_is_wrong(
    lab_env: dict[str, str], variable: str, value: str, line: str, words: str
) -> None:
    if variable.endswith('PATH') and variable != 'AMENT_PREFIX_PATH':
        value += f':{lab_env.get(variable, "")}'
    seen = visit({**lab_env, variable: value})
    assert seen.exit_code == 1
    assert words in seen.red[line]
    assert '→' in seen.red[line]
    if line == 'Variables':
        assert variable in seen.red[line]
        assert set(seen.red) == {'Variables'}


def test_packages_of_another_ros_on_the_path(lab_env: dict[str, str], tmp_path: Path) -> None:
    other = tmp_path / 'rclpy'
    other.mkdir()
    (other / '__init__.py').write_text('raise ImportError("of another Python")')
    path = f'{tmp_path}:{lab_env["PYTHONPATH"]}'
    seen = visit({**lab_env, 'PYTHONPATH': f'/opt/ros/humble/python:{path}'})
    assert seen.exit_code == 1
    assert set(seen.red) == {'ROS 2 packages', 'Middleware', 'Variables'}
    assert f'Python takes rclpy from {str(other / "__init__.py")!r}' in seen.red['ROS 2 packages']
    assert f'PYTHONPATH has {str(tmp_path)!r}' in seen.red['ROS 2 packages']
    assert 'ROS does not start: ImportError: of another Python' in seen.red['Middleware']
    assert 'PYTHONPATH leads to another ROS' in seen.red['Variables']


def test_workspace_of_the_learner_is_welcome(lab_env: dict[str, str], tmp_path: Path) -> None:
    mine = tmp_path / 'install' / 'my_package'
    folder = mine / 'lib' / 'python'
    folder.mkdir(parents=True)
    path = f'{folder}:{lab_env["PYTHONPATH"]}'
    assert visit({**lab_env, 'AMENT_PREFIX_PATH': str(mine), 'PYTHONPATH': path}).exit_code == 0


def test_mark_of_another_environment(lab_env: dict[str, str]) -> None:
    env = {**lab_env, '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1', 'LD_LIBRARY_PATH': '/usr/lib'}
    seen = visit(env)
    assert seen.exit_code == 1
    assert set(seen.red) == {'Middleware', 'Variables'}
    assert 'Maybe another environment has set it.' in seen.red['Variables']
    assert re.search(r'ROS does not start: ImportError: \S+\.so', seen.red['Middleware'])


# --- Packages ------------------------------------------------------------------------------------


class Environment:
    """An environment of its own, whose packages are those of this one: by links, so quickly.

    Args:
        folder: Where to make it.
    """

    def __init__(self, folder: Path) -> None:
        command = [sys.executable, '-m', 'venv', '--without-pip', str(folder)]
        subprocess.run(command, check=True, timeout=TIMEOUT_SEC)
        self.python = str(folder / 'bin' / 'python')
        here = Path(sysconfig.get_path('purelib'))
        self.packages = folder / here.relative_to(sys.prefix)
        for path in here.iterdir():
            (self.packages / path.name).symlink_to(path)
        for path in Path(sys.prefix, 'lib').glob('*.so*'):
            (folder / 'lib' / path.name).symlink_to(path)

    def remove(self, pattern: str) -> None:
        """Take packages away."""
        found = list(self.packages.glob(pattern))
        assert found
        for path in found:
            path.unlink()

    def change_version(self, package: str, version: str) -> None:
        """Pretend that another version of a package is installed."""
        (folder,) = self.packages.glob(f'{package}-*.dist-info')
        metadata = (folder / 'METADATA').read_text(encoding='utf-8')
        folder.unlink()
        folder.mkdir()
        metadata = re.sub(r'(?m)^Version: .*', f'Version: {version}', metadata, count=1)
        (folder / 'METADATA').write_text(metadata, encoding='utf-8')


@pytest.fixture
def environment(tmp_path: Path) -> Environment:
    return Environment(tmp_path / 'environment')


@pytest.fixture
def bare_env(lab_env: dict[str, str]) -> dict[str, str]:
    """Variables without the traces of the environment that runs the tests."""
    lost = ('_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'LD_LIBRARY_PATH', 'VIRTUAL_ENV')
    return {name: value for name, value in lab_env.items() if name not in lost}


@pytest.mark.slow('makes an environment')
def test_other_environment_with_all_packages_is_healthy(
    environment: Environment, bare_env: dict[str, str]
) -> None:
    seen = visit(bare_env, python=environment.python)
    assert (seen.red, seen.exit_code) == ({}, 0)


def test_missing_package(environment: Environment, bare_env: dict[str, str]) -> None:
    environment.remove('ros_std_msgs*')
    environment.remove('std_msgs')
    environment.remove('anywidget*')
    seen = visit(bare_env, python=environment.python)
    assert seen.exit_code == 1
    assert set(seen.red) == {'ROS 2 packages', 'Middleware', 'JupyterLab'}
    assert 'Missing: ros-std-msgs.' in seen.red['ROS 2 packages']
    assert "No module named 'std_msgs'" in seen.red['Middleware']
    assert 'Missing: anywidget.' in seen.red['JupyterLab']


def test_other_versions(environment: Environment, bare_env: dict[str, str]) -> None:
    environment.change_version('ros_rclpy', '9.1.0')
    environment.change_version('ipywidgets', '7.8.5')
    seen = visit(bare_env, python=environment.python)
    assert seen.exit_code == 1
    assert set(seen.red) == {'ROS 2 packages', 'JupyterLab'}
    assert 'Installed: ros-rclpy 9.1.0 instead of 7.1.' in seen.red['ROS 2 packages']
    assert 'Installed: ipywidgets 7.8.5 instead of 8.' in seen.red['JupyterLab']


def test_library_that_is_gone(environment: Environment, bare_env: dict[str, str]) -> None:
    environment.remove('../../librmw_fastrtps_cpp.so*')
    seen = visit(bare_env, python=environment.python)
    assert seen.exit_code == 1
    assert set(seen.red) == {'Middleware'}


def test_nothing_installed_at_all(
    environment: Environment, bare_env: dict[str, str], tmp_path: Path
) -> None:
    shutil.rmtree(environment.packages)
    # A copy of the package alone: no environment beside it that could be entered.
    shutil.copytree(ROOT / 'labkit', tmp_path / 'course' / 'labkit')
    env = {**bare_env, 'PYTHONPATH': str(tmp_path / 'course')}
    seen = visit(env, python=environment.python)
    assert 'Use a complete copy (git clone)' in seen.red['ROS 2 packages']
    shutil.copy(ROOT / 'environment.txt', tmp_path / 'course')
    seen = visit(env, python=environment.python)
    assert (seen.exit_code, seen.noise) == (1, '')
    assert set(seen.red) == {'ROS 2 packages', 'Middleware', 'JupyterLab'}
    assert 'Missing: ros-jazzy-rclpy' in seen.red['ROS 2 packages']
    assert "No module named 'rclpy'" in seen.red['Middleware']


# --- The machine ---------------------------------------------------------------------------------


def unshared(kind: str, change: str) -> tuple[str, ...]:
    """Return a command that changes the machine for one program alone."""
    unshare = ['unshare', f'--{kind}', *([] if os.geteuid() == 0 else ['--map-root-user'])]
    if subprocess.run([*unshare, 'true'], capture_output=True).returncode != 0:
        pytest.skip(f'this system does not allow namespaces ({kind})')
    return (*unshare, 'sh', '-ec', f'{change}; exec "$@"', 'sh')


def test_no_loopback(lab_env: dict[str, str]) -> None:
    seen = visit(lab_env, before=unshared('net', 'true'))
    assert seen.exit_code == 1
    assert '(127.0.0.1) does not arrive' in seen.red['Network']


def test_no_multicast(lab_env: dict[str, str]) -> None:
    lonely = unshared('net', 'ip link set lo up')
    assert visit(lab_env, before=lonely).exit_code == 0
    seen = visit({**lab_env, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}, before=lonely)
    assert seen.exit_code == 1
    assert 'a multicast packet does not come back on any network' in seen.red['Network']


@pytest.mark.parametrize(
    ('options', 'words'),
    [
        ('size=1m', 'ROS needs 8 MB'),
        ('ro', 'can not be written to'),
    ],
)
def test_shared_memory(lab_env: dict[str, str], options: str, words: str) -> None:
    mounted = unshared('mount', f'mount -t tmpfs -o {options} tmpfs /dev/shm')
    seen = visit(lab_env, before=mounted)
    assert seen.exit_code == 1
    assert words in seen.red['Shared memory']


KILLED = """
import os, signal, rclpy
rclpy.init()
node = rclpy.create_node('killed')
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.slow('starts and kills a process')
def test_files_of_a_killed_process(lab_env: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / 'killed.py').write_text(KILLED)
    kill = f'{sys.executable} {tmp_path / "killed.py"} || true'
    roomy = unshared('mount', f'mount -t tmpfs -o size=16m tmpfs /dev/shm; {kill}')
    seen = visit(lab_env, before=roomy)
    assert seen.exit_code == 0
    assert 'of killed processes are left, which does no harm' in ' '.join(seen.text.split())
    tight = unshared('mount', f'mount -t tmpfs -o size=2m tmpfs /dev/shm; {kill}')
    seen = visit(lab_env, before=tight)
    assert seen.exit_code == 1
    assert 'fastdds shm clean' in seen.red['Shared memory']
