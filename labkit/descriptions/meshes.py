"""Where the file of a mesh is."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote, urlsplit

from labkit.errors import LabError, quoted
from labkit.files import is_inside

__all__ = ['find_mesh']


def find_mesh(filename: str, folder: Path | None = None) -> Path:
    """Return the file of a mesh. It is there; whether it is a mesh is not looked at.

    Args:
        filename: As a description has it: `package://NAME/path`, as seen from the share folder of
            the package, `file:///path`, or a path.
        folder: Where a path that is relative begins.

    Raises:
        LabError: There is no such file, or it lies on another computer.
    """
    # Not all names are addresses: that of a bare path may have any character.
    scheme, _, rest = filename.partition('://')
    if not rest:
        path = Path(filename)
        if not path.is_absolute() and folder is None:
            raise LabError(
                f'The mesh {quoted(filename)} is a path, and relative to what is not known.',
                todo='Write package://NAME/path, as seen from the share folder of a package.',
            )
        path = (folder or Path()) / path
    elif scheme == 'package':
        path = _in_package(filename, rest)
    elif scheme == 'file':
        path = Path(unquote(urlsplit(filename).path))
    else:
        raise LabError(
            f'The mesh {quoted(filename)} is not a file of this computer, and is not loaded.',
            todo='Write package://NAME/path, or file:///path.',
        )
    try:
        found = path.is_file()
    except (OSError, ValueError):  # too long, or with a character that no file name has
        found = False
    if not found:
        raise LabError(
            f'There is no file for the mesh {quoted(filename)}: it would be {quoted(str(path))}.',
            todo='A package installs its meshes by data_files in setup.py, or by install() in '
            'CMakeLists.txt.' * (scheme == 'package'),
        )
    return path


def _in_package(filename: str, rest: str) -> Path:
    # Late: it needs the packages of ROS.
    from labkit.rosgraph.packages import prefix_of

    name, _, inner = rest.partition('/')
    try:
        share = prefix_of(name) / 'share' / name
    except LabError as error:
        raise LabError(
            f'The mesh {quoted(filename)} is in the package {quoted(name)}, which is not there.',
            todo=error.todo,
        ) from error
    path = share / unquote(inner)
    if not is_inside(path, share, follow_links=False):
        raise LabError(f'The mesh {quoted(filename)} is outside of its package.')
    return path
