"""What the machine has done, and no learner: packages that are missing, no room, a kill.

Such a thing is an ERROR with its true reason. It is told by what Python or the system says of it,
never guessed: a program that has only ended is the learner's matter.
"""

from __future__ import annotations

import errno
import os
import re
import signal
import sys
from collections.abc import Sequence

from labkit import settings
from labkit.errors import LabError
from labkit.exercises.mistakes import Mistake
from labkit.exercises.words import words_of

__all__ = ['machine_fault', 'refuse_machine_fault']

WORDS = words_of(__file__)

_MISSING = re.compile(r"ModuleNotFoundError: No module named '(?P<name>\w+)")
_FILE = re.compile(r'^\s*File "(?P<path>[^"]+)", line \d+')
_NO_SPACE = (errno.ENOSPC, errno.EDQUOT)
_KILLED = (-signal.SIGKILL, 128 + signal.SIGKILL)

NO_PACKAGE = WORDS.mistake('machine/no-package')
NO_SPACE = WORDS.mistake('machine/no-space')
NO_MEMORY = WORDS.mistake('machine/no-memory')
KILLED = WORDS.mistake('machine/killed')


def machine_fault(error: BaseException) -> Mistake | None:
    """Return what the machine has done, if an error says so."""
    seen: BaseException | None = error
    while seen is not None:
        code = seen.errno if isinstance(seen, OSError) else None
        if code in _NO_SPACE:
            return NO_SPACE
        if isinstance(seen, MemoryError) or code == errno.ENOMEM:
            return NO_MEMORY
        if type(seen) is ModuleNotFoundError and _is_ours(seen.name or '', _importer(seen)):
            return NO_PACKAGE.of(name=(seen.name or '').partition('.')[0])
        seen = seen.__cause__
    return None


def refuse_machine_fault(output: Sequence[str], exit_code: int | None) -> None:
    """Raise LabError if a program has ended because of the machine.

    Args:
        output: What it has said, line by line.
        exit_code: Its exit code, that of `subprocess` or of a shell; None if it is not known.
    """
    found = _fault_of(output, exit_code)
    if found is not None:
        raise LabError(found.reason, todo=found.step)


def _fault_of(output: Sequence[str], exit_code: int | None) -> Mistake | None:
    if exit_code in _KILLED:
        return KILLED
    last = output[-1] if output else ''
    missing = _MISSING.search(last)
    if missing:
        places = [match['path'] for line in output if (match := _FILE.match(line))]
        # Python's own machinery of imports is `<frozen ...>`.
        importer = next((path for path in reversed(places) if path[0] != '<'), '')
        ours = _is_ours(missing['name'], importer)
        return NO_PACKAGE.of(name=missing['name']) if ours else None
    if os.strerror(errno.ENOSPC) in last or os.strerror(errno.EDQUOT) in last:
        return NO_SPACE
    if 'MemoryError' in last or os.strerror(errno.ENOMEM) in last or 'std::bad_alloc' in last:
        return NO_MEMORY
    return None


def _is_ours(module: str, importer: str) -> bool:
    """Tell whether a module that is missing is one that the environment has to have.

    That is so if environment.txt names it, or if what imports it is itself of the environment.
    """
    from labkit.checkup.packages import pinned

    if module.partition('.')[0] in {_import_name(name) for name in pinned()}:
        return True
    folders = (os.path.dirname(settings.__file__), sys.prefix)
    return importer.startswith(tuple(folder + os.sep for folder in folders))


def _import_name(package: str) -> str:
    name = package.removeprefix('ros-jazzy-').replace('-', '_')
    return {'pyyaml': 'yaml'}.get(name, name)


def _importer(error: BaseException) -> str:
    """Return the file of the line that has raised, without Python's own machinery of imports."""
    path, traceback = '', error.__traceback__
    while traceback is not None:
        name = traceback.tb_frame.f_code.co_filename
        path = path if name.startswith('<frozen') else name
        traceback = traceback.tb_next
    return path
