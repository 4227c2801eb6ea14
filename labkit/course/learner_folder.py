"""The learner's folder `work`: copies of the lessons.

The learner's work is never lost: a file is replaced only while its bytes are exactly those that
were put there. A small record in the folder keeps their digests.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import platform
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from labkit.errors import LabError, SetupError
from labkit.files import read_json, rename_to_free, write_atomically
from labkit.setup.environment import ROOT

__all__ = [
    'FIRST',
    'WORK',
    'back_up',
    'choose',
    'copy_lessons',
    'fresh_lesson',
    'is_untouched',
    'put',
    'reset',
    'without_outputs',
]

LESSONS = ROOT / 'notebooks'
# On a hub each learner has one in their home.
WORK = Path(os.environ.get('LABKIT_WORK') or ROOT / 'work')
RECORD = '.labkit.json'
# Folder for old copies of lessons, inside the learner's.
BACKUPS = 'backups'
FIRST = '00_start_here.ipynb'
# As in the messaging protocol of Jupyter, `kernel_info`, from ipykernel for this Python.
_LANGUAGE = {
    'name': 'python',
    'version': platform.python_version(),
    'mimetype': 'text/x-python',
    'codemirror_mode': {'name': 'ipython', 'version': 3},
    'pygments_lexer': 'ipython3',
    'nbconvert_exporter': 'python',
    'file_extension': '.py',
}
# Files next to the lessons that belong to tests, or are made by running them.
_NOT_FOR_LEARNERS = re.compile(r'\.|(__pycache__|bags|legs_ws|nodes|ros2_ws)$')


def copy_lessons() -> list[str]:
    """Update the learner's folder, without touching what the learner has changed.

    Returns:
        One sentence for each lesson that has a newer version.

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
            if _update(name, fresh, record):
                record[name] = _digest(fresh)
            elif record.get(name) != _digest(fresh):
                news.append(
                    f'{name} has a newer version; yours has changes of its own and is left as it '
                    f'is. For the new one: python3 -m labkit reset {_number(name)}'
                )
        write_atomically(WORK / RECORD, json.dumps(record, indent=1).encode())
        _collect_backups()
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
        A sentence about the result.

    Raises:
        LabError: There is no such lesson, or more than one.
    """
    name, fresh = fresh_lesson(lesson)
    return put(name, fresh)


def fresh_lesson(lesson: str) -> tuple[str, bytes]:
    """Return the file name of a lesson, and the content of a learner's fresh copy.

    Args:
        lesson: See `reset`.

    Raises:
        LabError: There is no such lesson, or more than one.
    """
    names = [name for name in _published() if name.endswith('.ipynb') and os.sep not in name]
    name = choose(lesson, names)
    return name, _fresh(name)


def put(name: str, fresh: bytes) -> str:
    """Put a file into the learner's folder; keep a different one in `backups`.

    Args:
        name: File name.
        fresh: Its content.

    Returns:
        A sentence about the result.

    Raises:
        LabError: It can't be written, or what is there can't be kept.
    """
    copy_lessons()
    path = WORK / name
    if path.is_file() and path.read_bytes() == fresh:
        return f'{path} is a fresh copy already.'
    try:
        backup = back_up(path, name) if os.path.lexists(path) else None
        write_atomically(path, fresh)
        record = _read_record()
        record[name] = _digest(fresh)
        write_atomically(WORK / RECORD, json.dumps(record, indent=1).encode())
    except OSError as error:
        raise LabError(f'{str(path)!r} can not be written ({error.strerror}).') from error
    return f'{path} is a fresh copy.' + (f' The old one is {backup}.' if backup else '')


# --- Lessons and copies --------------------------------------------------------------------------


def _published() -> list[str]:
    """Return the names of all files for learners, relative to both folders."""
    found = []
    for folder, folders, files in os.walk(LESSONS):
        folders[:] = [name for name in folders if not _NOT_FOR_LEARNERS.match(name)]
        for name in files:
            if not _NOT_FOR_LEARNERS.match(name):
                found.append(os.path.relpath(os.path.join(folder, name), LESSONS))
    return sorted(found)


def _fresh(name: str) -> bytes:
    """Return the content of a learner's copy: the published file with outputs cleared.

    It names the language as the kernel does, in every detail. JupyterLab writes that into each
    notebook, and one that it has to change for it counts as changed by the learner.
    """
    content = (LESSONS / name).read_bytes()
    if not name.endswith('.ipynb'):
        return content
    notebook = json.loads(without_outputs(content))
    notebook.setdefault('metadata', {})['language_info'] = _LANGUAGE
    return _as_file(notebook)


def without_outputs(content: bytes) -> bytes:
    """Return a notebook with outputs cleared.

    Raises:
        ValueError, LookupError, TypeError: It is not a notebook.
    """
    notebook = json.loads(content)
    for cell in notebook['cells']:
        if cell['cell_type'] == 'code':
            cell.update(outputs=[], execution_count=None)
    return _as_file(notebook)


def _as_file(notebook: Any) -> bytes:
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + '\n').encode()


def is_untouched(name: str) -> bool:
    """Return whether a file is in the learner's folder as the course has put it there.

    The course has put no link there: what one leads to is never written to.
    """
    path = WORK / name
    try:
        return not path.is_symlink() and _digest(path.read_bytes()) == _read_record().get(name)
    except OSError:
        return False


def _update(name: str, fresh: bytes, record: dict[str, str]) -> bool:
    """Write a file into the learner's folder, unless the learner has changed it.

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
        if path.is_symlink() or _digest(path.read_bytes()) != record.get(name):
            return False
        write_atomically(path, fresh)
    return True


def back_up(path: Path, name: str, first: int = 1) -> Path:
    """Rename a file to the first free name of a backup.

    Args:
        path: The file to rename.
        name: File name of the lesson.
        first: The first number to try.
    """
    folder = WORK / BACKUPS
    if folder.exists() and not folder.is_dir():
        raise LabError(
            f'{str(folder)!r} should be the folder for old copies, but it is a file.',
            todo='Move it away, and repeat the command.',
        )
    folder.mkdir(exist_ok=True)
    stem, ending = os.path.splitext(os.path.basename(name))
    for number in range(first, 10_000):
        backup = folder / f'{stem}.backup-{number}{ending}'
        try:
            if path.is_symlink():
                backup.symlink_to(os.path.realpath(path))  # a relative one would lead elsewhere
                path.unlink()
            else:
                rename_to_free(path, backup)
        except FileExistsError:
            continue
        return backup
    raise LabError(f'{name} has 9999 backups.', todo='Delete some, and repeat the command.')


def _collect_backups() -> None:
    """Move old backups, which used to be among the lessons, to the backup folder."""
    for path in sorted(WORK.glob('*.backup-*')):
        stem, _, number = path.stem.rpartition('.backup-')
        name = f'{stem}{path.suffix}'
        if number.isdecimal() and (LESSONS / name).is_file():
            with contextlib.suppress(LabError):  # then they stay where they are
                back_up(path, name, int(number))


def _read_record() -> dict[str, str]:
    """Return the digests by file name. Empty if damaged: then everything counts as changed."""
    try:
        record = read_json(WORK / RECORD)
    except (OSError, ValueError):
        return {}
    if not isinstance(record, dict):
        return {}
    return {name: digest for name, digest in record.items() if isinstance(digest, str)}


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _number(name: str) -> str:
    return name.split('_')[0] if name[:1].isdigit() else name


def choose(lesson: str, names: Sequence[str]) -> str:
    """Return the file name of a lesson given by number or name.

    Args:
        lesson: See `reset`.
        names: The lessons to choose from.

    Raises:
        LabError: There is no such lesson, or more than one.
    """
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
