"""Python and its packages."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import platform
import sys
import sysconfig

from labkit.errors import LabError, first_few
from labkit.files import is_inside
from labkit.setup.environment import ROOT, VENV
from labkit.setup.machine import VERSIONS, check_platform
from labkit.setup.requirements import applicable

__all__ = ['jupyter', 'python', 'ros_packages']

_JUPYTER = ('jupyterlab', 'ipykernel', 'ipywidgets', 'anywidget')


def python() -> str:
    """Check the machine and the running Python."""
    check_platform()
    here = f'{platform.python_version()} ({sys.executable})'
    fits = sys.implementation.name == 'cpython' and sys.maxsize > 2**32
    if sys.version_info[:2] not in VERSIONS or not fits:
        raise LabError(
            f'ROS 2 Jazzy needs Python 3.10, 3.11, 3.12 or 3.13 (CPython, 64 bits), '
            f'but this is {platform.python_implementation()} {here}.',
            todo='Run python3 -m labkit lab: it looks for a Python that fits.',
        )
    return here


def ros_packages() -> str:
    """Check that the ROS 2 packages are installed, from one distribution and one place."""
    wanted = {name: version for name, version in pinned().items() if name.startswith('ros-')}
    _compare(wanted)
    spec = importlib.util.find_spec('rclpy')
    origin = (spec.origin if spec is not None else None) or ''
    # Not the path at startup: a kernel may have entered the environment since.
    own = sysconfig.get_path('platlib', vars={'platbase': sys.prefix})
    if not is_inside(origin, os.path.join(own, 'rclpy')):
        sourced = [entry for entry in _python_path() if is_inside(origin, entry)]
        raise LabError(
            f'Python takes rclpy from {origin!r}, not from its own environment {sys.prefix!r}.',
            todo=f'PYTHONPATH has {sourced[0]!r}: start from a terminal where no ROS 2 has been '
            'sourced.'
            if sourced
            else f'Start from another folder than {os.getcwd()!r}, or rename what is called rclpy '
            'there.'
            if is_inside(origin, os.getcwd())
            else 'Start from a terminal where no ROS 2 has been sourced.',
        )
    return f'Jazzy, rclpy {_version("ros-rclpy")}'


def jupyter() -> str:
    """Check that JupyterLab and its parts are the versions in environment.txt."""
    wanted = {name: version for name, version in pinned().items() if name in _JUPYTER}
    spec = importlib.util.find_spec('ipykernel')
    if spec is not None and not is_inside(spec.origin or '', sys.prefix, follow_links=False):
        found = [f'{name} {_version(name)}' for name in _JUPYTER if _version(name)]
        return f'not of this environment: {", ".join(found)}'
    _compare(wanted)
    return ', '.join(f'{name} {_version(name)}' for name in wanted or _JUPYTER if _version(name))


def _python_path() -> list[str]:
    return [entry for entry in os.environ.get('PYTHONPATH', '').split(os.pathsep) if entry]


def pinned() -> dict[str, str]:
    """Return the packages and versions that environment.txt pins for this Python.

    None where labkit was installed from a wheel: there is no course then, and the environment is
    somebody else's.
    """
    if is_inside(str(ROOT), sysconfig.get_path('purelib')):
        return {}
    try:
        lines = (ROOT / 'environment.txt').read_text(encoding='utf-8').splitlines()
    except OSError as error:
        raise LabError(
            f'environment.txt, which names the packages, can not be read: {error}.',
            todo='Use a complete copy (git clone) of the course.',
        ) from error
    pinned = {}
    for line in applicable(lines, tuple(sys.version_info[:3])):
        name, _, version = line.partition(';')[0].partition('==')
        pinned[name.partition('[')[0].strip().lower()] = version.strip()
    return pinned


def _compare(wanted: dict[str, str]) -> None:
    missing, other = [], []
    for name, version in wanted.items():
        found = _version(name)
        if not found:
            missing.append(name)
        elif found != version:
            other.append(f'{name} {found} instead of {version}')
    if not missing and not other:
        return
    texts = [f'Missing: {first_few(missing)}.'] if missing else []
    texts += [f'Installed: {first_few(other)}.'] if other else []
    raise LabError(' '.join(texts), todo=_renew_environment())


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return ''


def _renew_environment() -> str:
    if is_inside(sys.prefix, str(VENV)):
        return (
            f'End JupyterLab, delete the folder {VENV}, and run python3 -m labkit lab: that makes '
            'it anew.'
        )
    return (
        'Run python3 -m labkit lab, which makes an environment with all of them, or in an '
        f'environment of your own: pip install -r {ROOT / "environment.txt"}'
    )
