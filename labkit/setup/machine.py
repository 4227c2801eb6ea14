"""What a machine must have for the course, and what on it is in the way.

Runs in any Python from 3.8 on, so that a wrong one is told in a sentence what is wrong.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from labkit.errors import SetupError
from labkit.files import is_inside

__all__ = [
    'OWN_RELEASE',
    'Interpreter',
    'check_platform',
    'clean_environment',
    'find_interpreter',
    'interpreters',
    'run',
]

# The Python versions that the wheels of ROS 2 Jazzy are built for, the most common one first.
VERSIONS = ((3, 12), (3, 13), (3, 11), (3, 10))
# The wheels are of the kind manylinux_2_28: they need this version of glibc.
GLIBC = (2, 28)
# What a sourced ROS sets, and programs ask for.
OWN_RELEASE = {'ROS_DISTRO': 'jazzy', 'ROS_VERSION': '2'}

_ELSEWHERE = (
    'On Windows, use WSL2 (`wsl --install`), which is Linux. On macOS, ARM and older systems, '
    "RoboStack's conda channel `robostack-jazzy` has the same rclpy: install it with JupyterLab "
    'there and open the folder `notebooks`.'
)
_PROBE = (
    'import sys, importlib.util as u; '
    'print(sys.version_info[0], sys.version_info[1], '
    "int(sys.implementation.name == 'cpython' and sys.maxsize > 2**32), "
    "int(u.find_spec('ensurepip') is not None))"
)


class Interpreter(NamedTuple):
    """A Python that an environment can be made with."""

    path: str
    version: tuple[int, int]
    has_pip: bool
    usable: bool = True


def check_platform(system: str = '', machine: str = '', libc: str | None = None) -> None:
    """Make sure that there are ROS 2 wheels for this kind of machine.

    Args:
        system: Name of the operating system as `platform.system()` has it. This one's if empty.
        machine: Kind of processor as `platform.machine()` has it. This one's if empty.
        libc: C library and its version, such as `'glibc 2.36'`. This one's if None.

    Raises:
        SetupError: There are none.
    """
    system = system or platform.system()
    machine = machine or platform.machine()
    if (system, machine) not in (('Linux', 'x86_64'), ('Linux', 'AMD64')):
        raise SetupError(
            f'The ROS 2 packages of this course are made for Linux on x86-64, but this is '
            f'{system} on {machine}.',
            todo=_ELSEWHERE,
        )
    libc = _libc() if libc is None else libc
    found = re.match(r'glibc (\d+)\.(\d+)', libc)
    if not found or (int(found[1]), int(found[2])) < GLIBC:
        raise SetupError(
            f'The ROS 2 packages of this course need glibc {GLIBC[0]}.{GLIBC[1]} or newer '
            f'(Debian 10, Ubuntu 20.04, Fedora 29), but this system has {libc!r}.',
            todo=_ELSEWHERE,
        )


def _libc() -> str:
    try:
        return os.confstr('CS_GNU_LIBC_VERSION') or 'no glibc'
    except (AttributeError, OSError, ValueError):
        return 'no glibc'


def find_interpreter() -> Interpreter:
    """Return a Python that the course can use: the running one, or else one on PATH.

    Raises:
        SetupError: There is none.
    """
    running = Interpreter(
        path=_base_executable(),
        version=(sys.version_info[0], sys.version_info[1]),
        has_pip=importlib.util.find_spec('ensurepip') is not None,
        usable=sys.implementation.name == 'cpython' and sys.maxsize > 2**32,
    )
    if running.version in VERSIONS and running.usable:
        return running
    for version in VERSIONS:
        found = _probe(shutil.which('python{}.{}'.format(*version)))
        if found is not None and found.version == version and found.usable:
            return found
    name = 'Python' if running.version not in VERSIONS else 'another kind of Python'
    raise SetupError(
        f'The course needs Python 3.10, 3.11, 3.12 or 3.13 (CPython, 64 bits), but this is {name} '
        f'{platform.python_version()} ({sys.executable}), and no other one is on PATH.',
        todo='Install one, for example with `sudo apt install python3.12 python3.12-venv`, '
        '`sudo dnf install python3.12`, or `uv python install 3.12`, and repeat the command.',
    )


def interpreters() -> list[Interpreter]:
    """Return a Python of each version of the course that is on PATH, or is one of pyenv's."""
    found = []
    pyenv = Path(os.environ.get('PYENV_ROOT', Path.home() / '.pyenv')) / 'versions'
    for version in VERSIONS:
        name = 'python{}.{}'.format(*version)
        # What pyenv has on PATH for a version that is not selected refuses to run.
        paths = [shutil.which(name), *sorted(pyenv.glob(f'*/bin/{name}'))]
        probed = (_probe(str(path)) for path in paths if path)
        usable = (one for one in probed if one and one.usable and one.version == version)
        found += [one for one in [next(usable, None)] if one]
    return found


def _base_executable() -> str:
    """Return the running Python; not an environment's, which may be about to be made anew."""
    path = str(getattr(sys, '_base_executable', sys.executable))
    if sys.prefix != sys.base_prefix and is_inside(path, sys.prefix, follow_links=False):
        return os.path.realpath(path)  # before Python 3.11
    return path


def _probe(path: str | None) -> Interpreter | None:
    if path is None:
        return None
    try:
        # A program of that name may be a stand-in for a Python that isn't there.
        answer = run([path, '-I', '-c', _PROBE], timeout=20, check=True)
        major, minor, usable, has_pip = map(int, answer.stdout.split())
    except (OSError, ValueError, subprocess.SubprocessError):
        return None
    return Interpreter(path, (major, minor), bool(has_pip), bool(usable))


def run(command: Sequence[str], **options: Any) -> subprocess.CompletedProcess[str]:
    """Run a program in the clean environment, and keep what it says but for its errors.

    Args:
        command: Its words.
        options: As for `subprocess.run`. They come first.
    """
    usual = {'env': clean_environment(), 'stderr': subprocess.DEVNULL}
    return subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        **{**usual, **options},
    )


def clean_environment() -> dict[str, str]:
    """Return the environment variables without what other ROS installations left in them.

    A sourced `/opt/ros/...` puts packages for another Python, or for another ROS, in front of
    ours. The ROS wheels restart Python once to set `LD_LIBRARY_PATH`, and mark that with a
    variable: if the mark of one environment gets into another, that one misses its libraries.
    """
    environment = dict(os.environ)
    marked = environment.pop('_ROS_WHEELS_BOOTSTRAP_COMPLETE', None) is not None
    prefixes = ['/opt/ros', *_entries(environment.pop('AMENT_PREFIX_PATH', ''))]
    for name in ('PYTHONPATH', 'LD_LIBRARY_PATH'):
        entries = _entries(environment.pop(name, ''))
        foreign = _wheel_folders(entries) if marked else []
        kept = [
            entry
            for entry in entries
            if entry not in foreign
            and not any(is_inside(entry, folder, follow_links=False) for folder in prefixes)
        ]
        if kept:
            environment[name] = os.pathsep.join(kept)
    environment.pop('PYTHONHOME', None)
    for name, own in OWN_RELEASE.items():
        if environment.get(name) != own:
            environment.pop(name, None)
    # The only middleware among the wheels; another choice is for another ROS installation.
    if environment.get('RMW_IMPLEMENTATION') != 'rmw_fastrtps_cpp':
        environment.pop('RMW_IMPLEMENTATION', None)
    return environment


def _entries(text: str) -> list[str]:
    return [entry for entry in text.split(os.pathsep) if entry]


def _wheel_folders(entries: list[str]) -> list[str]:
    """Return the entries of LD_LIBRARY_PATH that come from ROS wheels of an environment."""
    found = []
    for entry in entries:
        match = re.match(r'(.*/lib)/python[\d.]+/site-packages/ros_\w+\.libs$', entry)
        if match:
            found += [entry, match[1]]
    return found
