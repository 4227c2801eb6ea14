"""Packages, their executables, and what to start to run one."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path

from ament_index_python import get_packages_with_prefixes

from labkit.errors import LabError, nearest
from labkit.rosgraph import interfaces

__all__ = ['DEMO', 'Executable', 'executable', 'executables', 'package_names', 'prefix_of']

# The package that labkit has stand-ins for.
DEMO = 'demo_nodes_py'
_STAND_INS = ('listener', 'talker')
assert interfaces  # has told the ament index where to look


@dataclass(frozen=True)
class Executable:
    """Something that `ros2 run` can start.

    Attributes:
        package: Name of its package.
        path: The file; of labkit's own, one that does not exist as such.
        command: What to start.
        stand_in: Whether it is labkit's own, because the package is not installed.
    """

    package: str
    path: Path
    command: tuple[str, ...]
    stand_in: bool = False


def package_names() -> list[str]:
    """Return the names of all packages that are installed."""
    return sorted(get_packages_with_prefixes())


def prefix_of(package: str) -> Path:
    """Return the folder that a package is installed in.

    Raises:
        LabError: There is no such package.
    """
    packages = get_packages_with_prefixes()
    if package in packages:
        return Path(packages[package])
    if package == DEMO:
        raise LabError(
            f"Package '{package}' not found",
            todo='It is not installed here; labkit has its talker and listener.',
        )
    if Path('install', package, 'share', package).is_dir():
        raise LabError(
            f"Package '{package}' not found",
            todo='It is built in this folder, but this terminal does not know it yet: '
            'source install/setup.bash',
        )
    near = nearest(package, [*packages, DEMO])
    raise LabError(
        f"Package '{package}' not found",
        todo=f'Did you mean {near!r}?' if near else 'ros2 pkg list shows all that are installed.',
    )


def executables(package: str) -> list[Executable]:
    """Return what a package has to run, sorted by name.

    Raises:
        LabError: There is no such package.
    """
    if package == DEMO and package not in package_names():
        module = ('-m', 'labkit.background.demo_nodes')
        return [
            Executable(DEMO, Path(name), (sys.executable, *module, name), stand_in=True)
            for name in _STAND_INS
        ]
    found = []
    for folder, folders, files in os.walk(prefix_of(package) / 'lib' / package):
        folders[:] = sorted(name for name in folders if not name.startswith('.'))
        for name in files:
            path = Path(folder, name)
            if os.access(path, os.X_OK):
                found.append(Executable(package, path, (str(path),)))
    return sorted(found, key=lambda one: one.path)


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
    raise LabError(f'No executable found: {package} has no {name!r}.', todo=todo)
