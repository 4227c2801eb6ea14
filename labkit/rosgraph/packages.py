"""Packages, their executables, and the commands that start them."""

from __future__ import annotations

import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from ament_index_python import get_packages_with_prefixes

from labkit.errors import LabError, did_you_mean, nearest, quoted
from labkit.rosgraph import interfaces
from labkit.rosgraph.workspaces import other_python, why_missing, why_not_in

__all__ = [
    'Executable',
    'executable',
    'executables',
    'own_programs',
    'package_names',
    'prefix_of',
    'with_executables',
]

# Modules and their programs, by the package in which `ros2 run` finds them.
_OWN: dict[str, dict[str, tuple[str, ...]]] = {
    'demo_nodes_py': {
        name: ('labkit.programs.demo_nodes', name) for name in ('talker', 'listener')
    },
    'joint_state_publisher': {'joint_state_publisher': ('labkit.programs.joint_state_publisher',)},
    'robot_state_publisher': {'robot_state_publisher': ('labkit.programs.robot_state_publisher',)},
    'labkit': {'turtlebot': ('labkit.sim.turtlebot_program',)},
    'tf2_ros': {
        name: (f'labkit.programs.{name}',)
        for name in ('static_transform_publisher', 'tf2_echo', 'tf2_monitor')
    },
    'xacro': {'xacro': ('labkit.programs.xacro_program',)},
    'tf2_tools': {'view_frames': ('labkit.programs.view_frames',)},
}
# Packages of the tutorials that no wheel has, and what to use here.
_INSTEAD = {
    'turtlesim': 'It comes with an installed ROS 2, not with wheels. Here is a robot: '
    'ros2 run labkit turtlebot starts it, lab.arena() shows it, lab.teleop() drives it.',
}
assert interfaces  # imported for its side effect on the ament index


@dataclass(frozen=True)
class Executable:
    """A program that `ros2 run` can start.

    Attributes:
        path: The file; of one of labkit's own, only its name.
        command: The command line.
        own: Whether it is labkit's own, which announces its nodes.
    """

    package: str
    path: Path
    command: tuple[str, ...]
    own: bool = False

    @property
    def stand_in(self) -> bool:
        """Whether it stands in for that of a package that is not installed."""
        return self.own and self.package != 'labkit'


def package_names() -> list[str]:
    """Return the names of all installed packages."""
    return sorted(get_packages_with_prefixes())


def with_executables() -> list[str]:
    """Return the names of all packages in which `ros2 run` finds something."""
    return sorted({*package_names(), *_OWN})


def prefix_of(package: str) -> Path:
    """Return the folder in which a package is installed.

    Raises:
        LabError: There is no such package.
    """
    packages = get_packages_with_prefixes()
    if package in packages:
        return Path(packages[package])
    if package in _OWN:
        raise LabError(
            f"Package '{package}' not found",
            todo=f'It has no files here. labkit runs its {own_programs(package)}.',
        )
    if todo := why_missing(package):
        raise LabError(f"Package '{package}' not found", todo=todo)
    if package in _INSTEAD:
        raise LabError(f"Package '{package}' not found", todo=_INSTEAD[package])
    raise LabError(
        f"Package '{package}' not found",
        todo=did_you_mean(
            package, [*packages, *_OWN], 'ros2 pkg list shows all that are installed.'
        ),
    )


def own_programs(package: str) -> str:
    """Return the names of the programs that labkit has of a package."""
    *names, last = _OWN[package]
    return f'{", ".join(names)} and {last}' if names else last


def executables(package: str) -> list[Executable]:
    """Return the executables of a package, sorted by name.

    Raises:
        LabError: There is no such package.
    """
    if package in _OWN and package not in package_names():
        return [
            Executable(package, Path(name), (sys.executable, '-m', *words), own=True)
            for name, words in sorted(_OWN[package].items())
        ]
    found, prefix = [], prefix_of(package)
    # The Python that is named in a script of another tree has none of ROS: this one does it.
    interpreter = (sys.executable,) if other_python(prefix) else ()
    for folder, folders, files in os.walk(prefix / 'lib' / package):
        folders[:] = sorted(name for name in folders if not name.startswith('.'))
        for name in files:
            path = Path(folder, name)
            if os.access(path, os.X_OK):
                command = (*interpreter, str(path)) if _is_python(path) else (str(path),)
                found.append(Executable(package, path, command))
    return sorted(found, key=lambda one: one.path)


def _is_python(path: Path) -> bool:
    """Return whether a file is a script that names a Python in its first line."""
    with path.open('rb') as file:
        return re.match(rb'#!.*python', file.read(256)) is not None


def executable(package: str, name: str) -> Executable:
    """Return one executable of a package.

    Raises:
        LabError: There is no such package, or it has none or several of that name.
    """
    known = executables(package)
    found = [one for one in known if one.path.name == name]
    if len(found) > 1:
        paths = ''.join(f'\n- {one.path}' for one in found)
        raise LabError(f'Multiple executables found:{paths}')
    if found:
        return found[0]
    names = [one.path.name for one in known]
    near = nearest(name, names)
    if near:
        todo = f'Did you mean {near!r}?'
    elif names:
        todo = f'{package} has: {", ".join(names)}.'
    else:
        todo = f'{package} has none.'
    state = why_not_in(package, prefix_of(package)) if package in package_names() else ''
    todo = f'{state}\n{todo}' if state else todo
    raise LabError(f'No executable found: {package} has no {quoted(name)}.', todo=todo)
