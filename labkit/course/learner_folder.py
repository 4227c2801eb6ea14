"""The learner's folder `work`: copies of the lessons.

What a learner has written is never lost: a file is replaced only while its bytes are exactly the
ones that were put there. A small record in the folder says which those are.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
from pathlib import Path
from typing import Any

from labkit.errors import LabError, SetupError
from labkit.files import rename_to_free, write_atomically
from labkit.setup.environment import ROOT

__all__ = ['FIRST', 'WORK', 'copy_lessons', 'fresh_lesson', 'put', 'reset']

LESSONS = ROOT / 'notebooks'
# On a hub each learner has one in their home.
WORK = Path(os.environ.get('LABKIT_WORK') or ROOT / 'work')
RECORD = '.labkit.json'
# Where the old copies of lessons go, in the learner's folder.
BACKUPS = 'backups'
FIRST = '00_start_here.ipynb'
# Files next to the lessons that are for their tests, or made by running them.
_NOT_FOR_LEARNERS = re.compile(r'\.|__pycache__$|conftest\.py$')


def copy_lessons() -> list[str]:
    """Bring the learner's folder up to date, without touching what the learner has changed.

    Returns:
        Sentences about what is worth knowing: one for each lesson that has a newer version.

    Raises:
        SetupError: The folder can't be written to.
    """
    try:
        if WORK.exists() and not WORK.is_dir():
            raise SetupError(
                f'{str(WORK)!r} should be the folder for your lessons, but it is a file.',
                todo='Move it away, and repeat the command.',
            )
        WORK.mkdir(exist_ok=True)
        record = _read_record()
        news = []
        for name in _published():
            fresh = _fresh(name)
            if _place(name, fresh, record):
                record[name] = _digest(fresh)
            elif record.get(name) != _digest(fresh):
                news.append(
                    f'{name} has a newer version; yours has changes of its own and is left as it '
                    f'is. For the new one: python3 -m labkit reset {_number(name)}'
                )
        write_atomically(WORK / RECORD, json.dumps(record, indent=1).encode())
        _gather_backups()
    except OSError as error:
        raise SetupError(
            f'{str(error.filename or WORK)!r} can not be written ({error.strerror}).',
            todo='Make sure that there is space and that the folder is yours, and repeat.',
        ) from error
    return news


def reset(lesson: str) -> str:
    """Put a fresh copy of a lesson into the learner's folder; keep the old one in `backups`.

    Args:
        lesson: The lesson's number or name: `'02'`, `'2'`, `'talker'`, `'02_talker_listener'`.

    Returns:
        A sentence that says what was done.

    Raises:
        LabError: There is no such lesson, or more than one.
    """
    name, fresh = fresh_lesson(lesson)
    return put(name, fresh)


def fresh_lesson(lesson: str) -> tuple[str, bytes]:
    """Return the file name of a lesson, and what a learner's copy of it holds at first.

    Args:
        lesson: See `reset`.

    Raises:
        LabError: There is no such lesson, or more than one.
    """
    name = _find(lesson)
    return name, _fresh(name)


def put(name: str, fresh: bytes) -> str:
    """Put a file into the learner's folder; keep what is there in `backups`, unless it is equal.

    Args:
        name: File name.
        fresh: What it is to hold.

    Returns:
        A sentence that says what was done.
    """
    copy_lessons()
    path = WORK / name
    if path.is_file() and path.read_bytes() == fresh:
        return f'{path} is a fresh copy already.'
    backup = _back_up(path, name) if os.path.lexists(path) else None
    write_atomically(path, fresh)
    record = _read_record()
    record[name] = _digest(fresh)
    write_atomically(WORK / RECORD, json.dumps(record, indent=1).encode())
    return f'{path} is a fresh copy.' + (f' The old one is {backup}.' if backup else '')


# --- Lessons and copies --------------------------------------------------------------------------


def _published() -> list[str]:
    """Return the names of all files that a learner gets, relative to both folders."""
    found = []
    for folder, folders, files in os.walk(LESSONS):
        folders[:] = [name for name in folders if not _NOT_FOR_LEARNERS.match(name)]
        for name in files:
            if not _NOT_FOR_LEARNERS.match(name):
                found.append(os.path.relpath(os.path.join(folder, name), LESSONS))
    return sorted(found)


def _fresh(name: str) -> bytes:
    """Return the content of a learner's copy: that of the published file, outputs cleared."""
    content = (LESSONS / name).read_bytes()
    if not name.endswith('.ipynb'):
        return content
    notebook = json.loads(content)
    for cell in notebook['cells']:
        if cell['cell_type'] == 'code':
            cell['outputs'] = []
            cell['execution_count'] = None
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + '\n').encode()


def _place(name: str, fresh: bytes, record: dict[str, str]) -> bool:
    """Write a file into the learner's folder, unless the learner has changed what is there.

    Returns:
        Whether the fresh content is there now.
    """
    path = WORK / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if not os.path.lexists(path):
        write_atomically(path, fresh, replace=False)
    elif not path.is_file():
        return False
    elif path.read_bytes() != fresh:
        if _digest(path.read_bytes()) != record.get(name):
            return False
        write_atomically(path, fresh)
    return True


def _back_up(path: Path, name: str, first: int = 1) -> Path:
    """Rename what is there to the first free name for a backup of a lesson.

    Args:
        path: What is there.
        name: File name of the lesson.
        first: The number to begin with.
    """
    folder = WORK / BACKUPS
    if folder.exists() and not folder.is_dir():
        raise LabError(
            f'{str(folder)!r} should be the folder for old copies, but it is a file.',
            todo='Move it away, and repeat the command.',
        )
    folder.mkdir(exist_ok=True)
    stem, ending = os.path.splitext(name)
    for number in range(first, 10_000):
        backup = folder / f'{stem}.backup-{number}{ending}'
        try:
            rename_to_free(path, backup)
        except FileExistsError:
            continue
        return backup
    raise LabError(f'{name} has 9999 backups.', todo='Delete some, and repeat the command.')


def _gather_backups() -> None:
    """Put the backups that lie among the lessons, as they once did, to the others."""
    for path in sorted(WORK.glob('*.backup-*')):
        stem, _, number = path.stem.rpartition('.backup-')
        name = f'{stem}{path.suffix}'
        if number.isdecimal() and (LESSONS / name).is_file():
            with contextlib.suppress(LabError):  # then they stay where they are
                _back_up(path, name, int(number))


def _read_record() -> dict[str, str]:
    """Return what was put where. Nothing, if the record is damaged: then all is the learner's."""
    try:
        record: Any = json.loads((WORK / RECORD).read_bytes())
    except (OSError, ValueError):
        return {}
    if not isinstance(record, dict):
        return {}
    return {name: digest for name, digest in record.items() if isinstance(digest, str)}


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _number(name: str) -> str:
    return name.split('_')[0] if name[:1].isdigit() else name


def _find(lesson: str) -> str:
    """Return the file name of the lesson that a number or a name stands for."""
    names = [name for name in _published() if name.endswith('.ipynb') and os.sep not in name]
    wanted = lesson[: -len('.ipynb')] if lesson.endswith('.ipynb') else lesson
    if wanted.isdigit():
        found = [name for name in names if _number(name).isdigit()]
        found = [name for name in found if int(_number(name)) == int(wanted)]
    else:
        found = [name for name in names if name == f'{wanted}.ipynb']
        found = found or [name for name in names if wanted and wanted in name]
    if len(found) != 1:
        what = 'is more than one lesson' if found else 'is not a lesson'
        raise LabError(
            f'{lesson!r} {what}.', todo='One of: ' + ', '.join(n[: -len('.ipynb')] for n in names)
        )
    return found[0]
