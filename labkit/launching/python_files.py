"""Launch files in Python, and the modules that they import.

`launch` and `launch_ros` are not in the wheels of ROS 2. The modules of these names are made here,
of the classes of this package, and exist only in the process that launches.
"""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType
from typing import NoReturn

from labkit.errors import LabError, nearest
from labkit.launching import model
from labkit.launching.model import LaunchDescription, LaunchError, Place, placed, raised
from labkit.launching.modules import contents
from labkit.packages.imports import why_not_installed

__all__ = ['from_python']


class _Lent(ModuleType):
    """A module of the real name. What it does not have is named, with the line that asks."""

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith('__'):
            raise AttributeError(name)
        place, module = placed(), self.__name__
        known = [
            word
            for word, value in vars(self).items()
            if not (word.startswith('_') or isinstance(value, ModuleType))
        ]
        near = nearest(name, known)
        raise LaunchError(
            f'{module} has no {name} here.',
            todo=f'Did you mean {near}?' if near else f'It has: {", ".join(sorted(known))}.',
            place=place,
        )


def lend() -> None:
    """Let launch files import `launch`, `launch_ros` and what belongs to them.

    Raises:
        LaunchError: The real ones are installed: then they are the right ones.
    """
    if isinstance(sys.modules.get('launch'), _Lent):
        return
    if importlib.util.find_spec('launch_ros') is not None:
        raise LaunchError(
            'The real package launch_ros is installed in this Python.',
            todo='Start the file with the ros2 of that installation.',
        )
    for name, content in contents().items():
        module = _Lent(name)
        vars(module).update(content)
        module.__path__ = []
        sys.modules[name] = module
        parent, _, last = name.rpartition('.')
        if parent:  # a function there may have the name of its module
            vars(sys.modules[parent]).setdefault(last, module)


def from_python(text: str, path: str) -> LaunchDescription:
    """Return what `generate_launch_description()` of a text of Python returns.

    Raises:
        LaunchError: It can't be run, or uses what is not supported.
    """
    lend()
    model.python_files.add(path)
    module = ModuleType('python_launch_file')
    module.__file__ = path
    try:
        exec(compile(text, path, 'exec'), vars(module))
        function = vars(module).get('generate_launch_description')
        if function is None:
            raise LaunchError(
                f"launch file at '{path}' does not contain the required function "
                "'generate_launch_description()'",
                place=Place(path, 1),
            )
        found = function()
    except SyntaxError as error:
        raise LaunchError(f'{error.msg}.', place=Place(path, error.lineno or 1)) from error
    except LabError as error:
        raise model.at(error, raised(error).place) from error
    except ModuleNotFoundError as error:
        missing = why_not_installed(error.name or '')
        raise LaunchError(
            missing.message if missing else f'ModuleNotFoundError: {error}',
            todo=missing.todo if missing else '',
            place=raised(error).place,
        ) from error
    except (Exception, SystemExit) as error:
        raise raised(error) from error
    if not isinstance(found, LaunchDescription):
        raise LaunchError(
            f'generate_launch_description() returns {found!r}, and a LaunchDescription is '
            'expected.',
            place=Place(path, function.__code__.co_firstlineno),
        )
    return found
