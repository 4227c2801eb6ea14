"""Finding and loading launch files, in whichever form they are."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from labkit.errors import LabError, did_you_mean
from labkit.files import read_limited
from labkit.launching.actions import DeclareLaunchArgument
from labkit.launching.markup import from_xml, from_yaml
from labkit.launching.model import (
    Action,
    Context,
    LaunchDescription,
    LaunchError,
    Place,
    at,
    too_deep,
)
from labkit.rosgraph.packages import prefix_of
from labkit.rosgraph.workspaces import why_not_in

__all__ = ['arguments', 'find', 'launch_files', 'load', 'tree']

ENDINGS = {'.xml': 'xml', '.yaml': 'yaml', '.yml': 'yaml', '.py': 'python'}


def load(path: str, form: str = '') -> LaunchDescription:
    """Return the description in a launch file.

    Args:
        path: The file.
        form: `'xml'`, `'yaml'` or `'python'`; by default as its name or its beginning says.

    Raises:
        LaunchError: It can't be read or understood.
    """
    if not os.path.exists(path):
        folder = Path(path).parent
        raise LaunchError(
            f'There is no launch file {path}.',
            todo=did_you_mean(
                Path(path).name,
                _names(folder),
                'A file beside the one that includes it is found by $(dirname)/',
            ),
        )
    try:
        text = read_limited(path).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise LaunchError(f'{path} can not be read: {reason}.') from error
    form = form or ENDINGS.get(os.path.splitext(path)[1], '')
    if not form:
        form = 'xml' if text.lstrip().startswith('<') else 'yaml'
    if form == 'python':
        from labkit.launching.python_files import from_python

        return from_python(text, path)
    try:
        return (from_xml if form == 'xml' else from_yaml)(text, path)
    except RecursionError:
        raise at(too_deep(), Place(path, 1)) from None


def find(package: str, name: str) -> str:
    """Return the path of a launch file of a package.

    Raises:
        LabError: There is no such package, or it has none or several of that name.
    """
    share = prefix_of(package) / 'share' / package
    found = [path for path in launch_files(package) if path.name == name]
    if len(found) > 1:
        paths = ', '.join(f"'{path}'" for path in found)
        raise LabError(
            f"file '{name}' was found more than once in the share directory of package "
            f"'{package}': [{paths}]"
        )
    if found:
        return str(found[0])
    known = ', '.join(path.name for path in launch_files(package) if _is_launch_file(path))
    todo = f'It has: {known}.' if known else 'A line of data_files in its setup.py installs them.'
    todo = did_you_mean(name, [path.name for path in launch_files(package)], todo)
    state = why_not_in(package, prefix_of(package))
    raise LabError(
        f"file '{name}' was not found in the share directory of package '{package}' which is at "
        f"'{share}'",
        todo=f'{state}\n{todo}' if state else todo,
    )


def launch_files(package: str) -> list[Path]:
    """Return all shared files of a package."""
    share = prefix_of(package) / 'share' / package
    return sorted(path for path in share.rglob('*') if path.is_file())


def _is_launch_file(path: Path) -> bool:
    return 'launch' in path.name and path.suffix in ENDINGS


def _names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()] if folder.is_dir() else []


def arguments(
    actions: Iterable[Action], *, conditional: bool = False
) -> Iterator[tuple[DeclareLaunchArgument, bool]]:
    """Yield the arguments of a launch file, and whether they depend on a condition."""
    for action in actions:
        if isinstance(action, DeclareLaunchArgument):
            yield action, conditional or action.condition is not None
        for inner, open_one in action.inside(Context(load=load)):
            yield from arguments(inner, conditional=conditional or open_one)


def tree(actions: Sequence[Action], start: str = '') -> Iterator[str]:
    """Yield the lines of `--print-description`."""
    for number, action in enumerate(actions, 1):
        last = number == len(actions)
        yield f'{start}{"└── " if last else "├── "}{action.describe()}'
        for inner, _ in action.inside(Context(load=load)):
            yield from tree(list(inner), start + ('    ' if last else '│   '))
