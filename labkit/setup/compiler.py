"""What this machine needs to build interfaces: a C++ compiler, make, and Python's headers."""

from __future__ import annotations

import os
import shutil
import sysconfig
from pathlib import Path

from labkit.errors import LabError

__all__ = ['check_compiler', 'compiler', 'fix_exported_paths']

# Where the wheels were built: folders that their cmake files name, and no other machine has.
_BUILT_WITH = '/opt/python/'
_EXPORTS = 'share/*/cmake/*__rosidl_generator_pyExport.cmake'
_INSTALL = (
    ('apt-get', 'sudo apt install build-essential python3-dev'),
    ('dnf', 'sudo dnf install gcc-c++ make python3-devel'),
    ('pacman', 'sudo pacman -S base-devel'),
    ('zypper', 'sudo zypper install gcc-c++ make python3-devel'),
)


def compiler() -> str:
    """Return the C++ compiler's path, '' if there is none."""
    named = os.environ.get('CXX', '').split()
    return next(filter(None, map(shutil.which, [*named[:1], 'c++', 'g++', 'clang++'])), '')


def check_compiler() -> str:
    """Return the C++ compiler's path, if all is there that builds interfaces.

    Raises:
        LabError: Something is missing; it says with which command it is installed.
    """
    missing = [] if compiler() else ['a C++ compiler']
    missing += [] if shutil.which('make') else ['make']
    headers = Path(sysconfig.get_path('include'), 'Python.h')
    missing += [] if headers.is_file() else [f"Python's headers ({headers})"]
    if not missing:
        return compiler()
    command = next(
        (command for tool, command in _INSTALL if shutil.which(tool)),
        'install a C++ compiler, make and the headers of Python',
    )
    raise LabError(
        f'To build interfaces, this machine lacks {" and ".join(missing)}.', todo=command
    )


def fix_exported_paths(prefix: Path, numpy_include: str) -> int:
    """Put this machine's folders into the cmake files that name those of another one.

    The wheels of interfaces were built on a machine whose Python lay in `/opt/python`, and their
    cmake files tell the compiler to look there. Doing it again changes nothing.

    Args:
        prefix: The environment.
        numpy_include: The folder with the headers of numpy.

    Returns:
        How many files were changed.

    Raises:
        LabError: A file can't be written.
    """
    from labkit.files import write_atomically

    count = 0
    for path in sorted(prefix.glob(_EXPORTS)):
        text = path.read_text(encoding='utf-8')
        fixed = ';'.join(_fixed(part, numpy_include) for part in text.split(';'))
        if fixed == text:
            continue
        try:
            write_atomically(path, fixed.encode())
        except OSError as error:
            raise LabError(
                f'{path} names folders of another machine, and can not be written: {error}.',
                todo='Let the owner of the environment build once, or give it to yourself.',
            ) from error
        count += 1
    return count


def _fixed(part: str, numpy_include: str) -> str:
    """Return a piece of a cmake file with this machine's folder in the place of a foreign one."""
    start = part.find(_BUILT_WITH)
    if start < 0:
        return part
    end = min(end for end in (part.find('"', start), len(part)) if end >= 0)
    known = numpy_include if 'numpy' in part[start:end] else sysconfig.get_path('include')
    return part[:start] + known + part[end:]
