"""The learner's folder `work`: copies of the lessons, and JupyterLab on them.

What a learner has written is never lost: a file is replaced only while its bytes are exactly the
ones that were put there. A small record in the folder says which those are.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import socket
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from labkit.errors import LabError, SetupError
from labkit.setup.environment import ROOT, environment_variables, make_environment

__all__ = ['copy_lessons', 'reset', 'start_lab']

LESSONS = ROOT / 'notebooks'
WORK = ROOT / 'work'
RECORD = '.labkit.json'
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
        _write(WORK / RECORD, json.dumps(record, indent=1).encode())
    except OSError as error:
        raise SetupError(
            f'{str(error.filename or WORK)!r} can not be written ({error.strerror}).',
            todo='Make sure that there is space and that the folder is yours, and repeat.',
        ) from error
    return news


def reset(lesson: str) -> str:
    """Put a fresh copy of a lesson into the learner's folder; keep the old one beside it.

    Args:
        lesson: The lesson's number or name: `'02'`, `'2'`, `'talker'`, `'02_talker_listener'`.

    Returns:
        A sentence that says what was done.

    Raises:
        LabError: There is no such lesson, or more than one.
    """
    name = _find(lesson)
    copy_lessons()
    fresh = _fresh(name)
    path = WORK / name
    if path.is_file() and path.read_bytes() == fresh:
        return f'{path} is a fresh copy already.'
    backup = _back_up(path)
    _write(path, fresh)
    record = _read_record()
    record[name] = _digest(fresh)
    _write(WORK / RECORD, json.dumps(record, indent=1).encode())
    return f'{path} is a fresh copy. The old one is {backup.name}, beside it.'


def start_lab(arguments: Sequence[str]) -> NoReturn:
    """Make the environment, bring the lessons up to date, and become JupyterLab.

    Args:
        arguments: Options for JupyterLab, besides those set here.

    Raises:
        SetupError: This machine, or a port that was asked for, does not allow it.
    """
    _check_port(arguments)
    python = make_environment()
    for sentence in copy_lessons():
        print(sentence)
    options = [
        f'--ServerApp.root_dir={WORK}',
        '--ServerApp.ip=127.0.0.1',
        f'--LabApp.default_url=/lab/tree/{FIRST}',
        # Without it a server whose output is no terminal gives login shells, and those may set
        # PATH anew: the command `ros2` would be gone.
        f'--ServerApp.terminado_settings=shell_command={os.environ.get("SHELL") or "/bin/sh"}',
    ]
    if _asked_port(arguments) is not None:
        options.append('--ServerApp.port_retries=0')
    if os.geteuid() == 0:
        options.append('--allow-root')  # containers, and WSL set up without a user
    if 'microsoft' in platform.release().lower() or os.path.exists('/snap/bin/firefox'):
        # A Windows browser, or Firefox as a snap, can't read the file through which JupyterLab
        # opens its page otherwise.
        options.append('--ServerApp.use_redirect_file=False')
    variables = environment_variables()
    # A kernel that was installed for the user would belong to another Python, without ROS.
    variables['JUPYTER_PREFER_ENV_PATH'] = '1'
    print('Starting JupyterLab. To stop it, press Ctrl+C here, twice.', flush=True)
    os.chdir(WORK)
    os.execve(python, [str(python), '-m', 'jupyterlab', *options, *arguments], variables)


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
        _write(path, fresh, replace=False)
    elif not path.is_file():
        return False
    elif path.read_bytes() != fresh:
        if _digest(path.read_bytes()) != record.get(name):
            return False
        _write(path, fresh)
    return True


def _write(path: Path, content: bytes, *, replace: bool = True) -> None:
    """Write a file whole or not at all.

    Raises:
        FileExistsError: It is there, and is not to be replaced.
    """
    handle, new = tempfile.mkstemp(dir=path.parent, prefix='.labkit-')
    try:
        with os.fdopen(handle, 'wb') as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(new, 0o644)
        if replace:
            os.replace(new, path)
        else:
            _rename_to_free(new, path)
    finally:
        if os.path.lexists(new):
            os.unlink(new)


def _rename_to_free(old: str | Path, new: Path) -> None:
    """Rename a file to a name that nothing has, even if another program takes it just now."""
    try:
        os.link(old, new)
    except FileExistsError:
        raise
    except OSError:
        # A file system without hard links, such as a Windows drive: this is as good as it gets.
        if os.path.lexists(new):
            raise FileExistsError(f'{new} is there') from None
        os.rename(old, new)
    else:
        os.unlink(old)


def _back_up(path: Path) -> Path:
    """Rename what is there to the first free name for a backup."""
    for number in range(1, 10_000):
        backup = path.with_name(f'{path.stem}.backup-{number}{path.suffix}')
        try:
            _rename_to_free(path, backup)
        except FileExistsError:
            continue
        return backup
    raise LabError(f'{path} has 9999 backups.', todo='Delete some, and repeat the command.')


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


# --- JupyterLab's port ---------------------------------------------------------------------------


def _asked_port(arguments: Sequence[str]) -> int | None:
    """Return the port that is asked for in the options, None if there is none."""
    text = ' '.join(arguments)
    found = re.search(r'--(?:port|ServerApp\.port)[= ](\d+)', text)
    return int(found[1]) if found else None


def _check_port(arguments: Sequence[str]) -> None:
    port = _asked_port(arguments)
    if port is None:
        return  # JupyterLab takes the first free one from 8888 on
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(('127.0.0.1', port))
        except (OSError, OverflowError) as error:
            raise SetupError(
                f'Port {port} can not be used: {error}.',
                todo='Give another one with --port, or none: then a free one is taken.',
            ) from error
