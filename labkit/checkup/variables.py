"""Environment variables left over from another installation, or from old habits."""

from __future__ import annotations

import os
import sys
import sysconfig
from pathlib import Path

from labkit import settings
from labkit.checkup.found import Found
from labkit.errors import first_few
from labkit.files import is_inside
from labkit.setup.machine import OWN_RELEASE, clean_environment

__all__ = ['variables']

_NOT_SOURCED = (
    'Start from a terminal where no other ROS has been sourced (look for a line with /opt/ros in '
    '~/.bashrc).'
)


def variables() -> str:
    """Check for environment variables left over from another installation, or from old habits."""
    found = [*_foreign_entries(), *_lost_libraries(), *_wrong_values()]
    if found:
        raise Found(found)
    peers, server = map(os.environ.get, ('ROS_STATIC_PEERS', 'ROS_DISCOVERY_SERVER'))
    said = [f'ROS_STATIC_PEERS lets {peers!r} take part'] * bool(peers)
    said += [f'ROS_DISCOVERY_SERVER: nodes find each other through {server!r}'] * bool(server)
    return '; '.join(said) or 'none from elsewhere'


def _foreign_entries() -> list[tuple[str, str]]:
    """Find folders of another ROS in the search paths of Python and the system."""
    clean = clean_environment()
    # The learner's own workspace, built on this environment, is fine.
    workspaces = [
        entry
        for entry in _entries('AMENT_PREFIX_PATH')
        if not is_inside(entry, '/opt/ros') and not os.path.isdir(f'{entry}/share/rclpy')
    ]
    welcome = [sys.prefix, *_libraries(), *workspaces]
    found = []
    for name in ('AMENT_PREFIX_PATH', 'PYTHONPATH', 'LD_LIBRARY_PATH'):
        kept = clean.get(name, '').split(os.pathsep)
        foreign = [
            entry
            for entry in _entries(name)
            if entry not in kept and not any(is_inside(entry, folder) for folder in welcome)
        ]
        if foreign:
            found.append(
                (
                    f'{name} leads to another ROS: {first_few(foreign)}.',
                    _NOT_SOURCED,
                )
            )
    return found


def _lost_libraries() -> list[tuple[str, str]]:
    """Find out whether the mark of another environment keeps this one from its libraries."""
    if not os.environ.get('_ROS_WHEELS_BOOTSTRAP_COMPLETE'):
        return []
    searched = {os.path.realpath(entry) for entry in _entries('LD_LIBRARY_PATH')}
    if searched.issuperset(_libraries()):
        return []
    return [
        (
            '_ROS_WHEELS_BOOTSTRAP_COMPLETE is set, and LD_LIBRARY_PATH lacks the libraries of '
            'this environment: they are not found. Maybe another environment has set it.',
            'Start with: env -u _ROS_WHEELS_BOOTSTRAP_COMPLETE -u LD_LIBRARY_PATH jupyter lab',
        )
    ]


def _wrong_values() -> list[tuple[str, str]]:
    """Find variables that set ROS to something the course can't use."""
    found = []
    asked = {**settings.dropped_variables, **os.environ}.get('RMW_IMPLEMENTATION', '')
    if asked not in ('', 'rmw_fastrtps_cpp'):
        text = f'RMW_IMPLEMENTATION asks for {asked!r}; the course is made for rmw_fastrtps_cpp.'
        if settings.dropped_variables:
            text += ' That is used instead, but a program without labkit would not start.'
        found.append((text, _unset('RMW_IMPLEMENTATION')))
    others = [
        f'{name} is {value!r}'
        for name, own in OWN_RELEASE.items()
        if (value := os.environ.get(name, '')) not in ('', own)
    ]
    if others:
        text = (
            f'{" and ".join(others)}, but what runs here is ROS 2 Jazzy: programs and launch '
            'files that ask for it take the wrong way.'
        )
        found.append((text, _NOT_SOURCED))
    local = os.environ.get('ROS_LOCALHOST_ONLY', '')
    if local:
        text = (
            f'ROS_LOCALHOST_ONLY ({local!r}) is of older versions of ROS, and overrides '
            'ROS_AUTOMATIC_DISCOVERY_RANGE.'
        )
        found.append((text, _unset('ROS_LOCALHOST_ONLY')))
    peers = os.environ.get('ROS_STATIC_PEERS', '')
    if peers and os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') == 'OFF':
        text = f'ROS_STATIC_PEERS ({peers!r}) has no effect: ROS_AUTOMATIC_DISCOVERY_RANGE is OFF.'
        found.append((text, _unset('ROS_AUTOMATIC_DISCOVERY_RANGE')))
    checked = os.environ.get('ROS_PYTHON_CHECK_FIELDS', '')
    if checked != '1':
        text = (
            f'ROS_PYTHON_CHECK_FIELDS is {checked!r} instead of 1: a wrong value in a message, '
            'such as Int16(data=40000), is not refused.'
        )
        found.append((text, _unset('ROS_PYTHON_CHECK_FIELDS')))
    return found


def _unset(name: str) -> str:
    if settings.in_kernel():
        return f'Close JupyterLab, run unset {name} in its terminal, and start it again.'
    return f'unset {name}'


def _libraries() -> list[str]:
    """Return the library folders of this environment's ROS packages."""
    folder = Path(sysconfig.get_path('platlib'))
    return [os.path.realpath(path) for path in folder.glob('ros_*.libs')]


def _entries(name: str) -> list[str]:
    return [entry for entry in os.environ.get(name, '').split(os.pathsep) if entry]
