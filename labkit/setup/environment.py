"""Make the environment `.venv` of the course, keep it up to date, repair it.

Runs in any Python from 3.8 on. An environment that is in order has a stamp: a small file, written
last, that says what was installed from. Anything without a good stamp is completed or made anew.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from labkit.errors import SetupError
from labkit.files import read_json, remove, write_atomically
from labkit.setup.installer import Progress, install
from labkit.setup.machine import (
    VERSIONS,
    check_platform,
    clean_environment,
    find_interpreter,
    run,
)
from labkit.setup.requirements import applicable

__all__ = [
    'ROOT',
    'VENV',
    'environment_variables',
    'existing_environment',
    'make_environment',
    'one_at_a_time',
]

ROOT = Path(__file__).resolve().parents[2]
VENV = ROOT / '.venv'
PYTHON = VENV / 'bin' / 'python'
STAMP = VENV / 'labkit.json'
# Where the environment of before waits until a new one stands in its place.
ASIDE = ROOT / '.venv.old'
LOCKED = ROOT / '.venv.lock'
LEARNER = ('environment.txt',)
# A new environment takes 0.9 GB with what the tests need, and pip keeps what it has fetched.
SPACE_BYTES = 1_200_000_000
_VERSION = re.compile(r'^__version__ = .*', re.MULTILINE)
# The tables of pyproject.toml that are about the package. The settings of tools change more often,
# and then nothing has to be installed. Python has a module for TOML only from 3.11 on.
_PACKAGE_TABLES = re.compile(
    r'^\[(?:build-system|project|tool\.flit)\b.*(?:\n(?!\[\w).*)*', re.MULTILINE
)


def make_environment(requirements: Sequence[str] = LEARNER) -> Path:
    """Make sure that the environment is there and in order.

    Args:
        requirements: Files with what has to be installed, relative to the course's folder.

    Returns:
        The environment's interpreter.

    Raises:
        SetupError: It can't be made on this machine, now. Nothing half made is left.
    """
    check_platform()
    missing = [name for name in requirements if not (ROOT / name).is_file()]
    if missing:
        raise SetupError(
            f'The environment is made from {missing[0]}, but {str(ROOT)!r} has no such file.',
            todo='Run this command in a complete copy (git clone) of the course.',
        )
    if _lacking(_read_stamp(), requirements):
        with one_at_a_time():
            # Another process may have made it while this one waited.
            stamp = _read_stamp()
            lacking = _lacking(stamp, requirements)
            if lacking:
                _refuse_others(stamp, lacking)
                _bring_up(stamp, lacking, requirements)
    return PYTHON


def existing_environment() -> Path:
    """Return the interpreter of the environment, which has to be there.

    Raises:
        SetupError: It isn't.
    """
    if _interpreter_mark() is None:
        check_platform()
        find_interpreter()
        raise SetupError('There is no environment yet.', todo='Make it: python3 -m labkit lab')
    return PYTHON


def environment_variables() -> dict[str, str]:
    """Return the variables for a program in the environment, as if it had been activated."""
    variables = clean_environment()
    variables['VIRTUAL_ENV'] = str(VENV)
    variables['PATH'] = os.pathsep.join([str(PYTHON.parent), variables.get('PATH', os.defpath)])
    return variables


# --- The stamp -----------------------------------------------------------------------------------


def _read_stamp() -> dict[str, Any] | None:
    """Return what the stamp says, None if there is none, {} if it says nothing to rely on."""
    try:
        stamp = read_json(STAMP)
    except FileNotFoundError:
        return None
    except (OSError, ValueError):
        return {}
    sound = isinstance(stamp, dict) and isinstance(stamp.get('installed'), dict)
    return stamp if sound else {}


def _write_stamp(stamp: dict[str, Any]) -> None:
    write_atomically(STAMP, json.dumps(stamp, indent=1).encode())


def _wanted(requirements: Sequence[str]) -> dict[str, str]:
    wanted = {
        name: hashlib.sha256((ROOT / name).read_bytes()).hexdigest() for name in requirements
    }
    return {**wanted, 'labkit': _own_mark()}


def _own_mark() -> str:
    """Return what changes when the package itself has to be installed anew.

    Its modules are used where they lie. What is copied into the environment is its version, its
    commands, and the files in labkit/data: JupyterLab's defaults and completion for bash.
    """
    mark = hashlib.sha256()
    data = ROOT / 'labkit' / 'data'
    for path in sorted(path for path in data.rglob('*') if path.is_file()):
        mark.update(f'{path.relative_to(ROOT)}\0'.encode() + path.read_bytes() + b'\0')
    for name, part in (('labkit/__init__.py', _VERSION), ('pyproject.toml', _PACKAGE_TABLES)):
        if (ROOT / name).is_file():
            text = (ROOT / name).read_text(encoding='utf-8')
            mark.update('\0'.join(part.findall(text)).encode())
    return mark.hexdigest()


def _lacking(stamp: dict[str, Any] | None, requirements: Sequence[str]) -> str:
    """Return in a few words why the environment isn't in order, '' if it is."""
    if stamp is None:
        return 'it is not there yet' if not VENV.exists() else 'it is incomplete'
    mark = _interpreter_mark()
    if mark is None:
        return 'its Python is gone'
    if 'installed' not in stamp:
        return 'making it was interrupted'
    if stamp.get('folder') != str(VENV):
        return 'its folder was moved'
    if stamp.get('interpreter') != mark:
        return 'its Python was replaced'
    installed = stamp['installed']
    for name, version in _wanted(requirements).items():
        if name not in installed:
            return f'{name} was not installed'
        if installed[name] != version:
            return f'{name} has changed'
    return ''


def _interpreter_mark() -> list[Any] | None:
    """Return what tells the environment's interpreter from another, None if it can't run."""
    real = os.path.realpath(PYTHON)
    try:
        status = os.stat(real)
    except OSError:
        return None
    return [real, status.st_size, status.st_mtime_ns] if os.access(real, os.X_OK) else None


# --- Making it -----------------------------------------------------------------------------------


@contextmanager
def one_at_a_time() -> Iterator[None]:
    """Let one process at a time change the environment.

    The lock is on a file that only its owner can open: whoever can open one can lock it for ever.
    The installer inherits it: should this process be killed, the lock lasts until the installer
    has ended too.
    """
    import fcntl  # only there on Unix

    try:
        file = os.open(LOCKED, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    except OSError:
        yield  # where nothing can be written, there is nothing to keep apart
        return
    try:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print('Another labkit is setting up the environment. Waiting for it ...', flush=True)
            fcntl.flock(file, fcntl.LOCK_EX)
        except OSError:
            pass  # a network file system without locks
        os.set_inheritable(file, True)
        yield
    finally:
        os.close(file)


def _refuse_others(stamp: dict[str, Any] | None, lacking: str) -> None:
    """Refuse to change what is not an environment, or one that a link leads to.

    Behind a link an empty folder may be filled, and the course's own environment be updated.
    All else there may be somebody's: nothing is written to it, and nothing is deleted.
    """
    filled = VENV.exists() and (not VENV.is_dir() or any(VENV.iterdir()))
    if filled and stamp is None and not (VENV / 'pyvenv.cfg').exists():
        raise SetupError(
            f'{str(VENV)!r} is there, but it is not a Python environment.',
            todo='Move it away, and repeat the command.',
        )
    if not VENV.is_symlink():
        return
    target = os.path.realpath(VENV)
    owner = (stamp or {}).get('folder', str(VENV))
    if not VENV.exists():
        why = 'is not there'
    elif owner != str(VENV):
        why = f'is the environment of {owner!r}'
    elif filled and (not stamp or _version() is None):
        why = f'is no environment that this course has made, or not in order ({lacking})'
    else:
        return
    raise SetupError(
        f'{str(VENV)!r} is a link to {target!r}, which {why}. Nothing was changed.',
        todo=f'For an environment of its own, remove the link (`rm {VENV}`), or let it lead to an '
        'empty folder. Then repeat the command.',
    )


def _bring_up(stamp: dict[str, Any] | None, lacking: str, requirements: Sequence[str]) -> None:
    """Complete the environment if it is sound, else make it anew."""
    # Without a stamp: made by hand, with the conventional commands. Those stay and are completed.
    sound = stamp is None or stamp.get('folder') == str(VENV)
    version = _version() if sound else None
    with _readable_system_errors():
        # The system may have got a new patch release of the same Python: then all is well.
        renewed = {**(stamp or {}), 'interpreter': _interpreter_mark()}
        if version is not None and not _lacking(renewed, requirements):
            _write_stamp(renewed)
        elif version is None or version[:2] not in VERSIONS:
            _make_anew(lacking, requirements)
        else:
            print(f'Updating the environment {VENV} ({lacking}).', flush=True)
            _update(stamp, version, requirements)


def _make_anew(lacking: str, requirements: Sequence[str]) -> None:
    interpreter = find_interpreter()
    if not (shutil.which('uv') or interpreter.has_pip):
        raise SetupError(
            f'{interpreter.path} comes without the module `ensurepip`, which makes environments.',
            todo='Install it, on Debian and Ubuntu with `sudo apt install '
            'python{}.{}-venv`, and repeat the command.'.format(*interpreter.version),
        )
    print(
        f'Making the environment {VENV} ({lacking}) with {interpreter.path}, Python '
        '{}.{}.'.format(*interpreter.version),
        flush=True,
    )
    _check_space()
    try:
        _set_aside()
        VENV.mkdir(exist_ok=True)
        _write_stamp({})  # from here on it is known to be unfinished, and to be ours
        _create(interpreter.path)
        version = _version()
        if version is None:
            raise SetupError(
                f'{interpreter.path} made an environment that does not run.',
                todo='Install Python anew, or another one, and repeat the command.',
            )
        _install(version, requirements)
    except BaseException:
        _put_back()
        raise
    if os.path.lexists(ASIDE):
        remove(ASIDE)


def _set_aside() -> None:
    """Let the environment of before wait: one can't be made elsewhere and moved here later."""
    if not VENV.exists() or not any(VENV.iterdir()):
        return
    if ASIDE.exists() and _read_stamp() == {}:
        _clear()  # a run that was killed has set one aside, and has not finished this one
    else:
        if os.path.lexists(ASIDE):
            remove(ASIDE)
        VENV.rename(ASIDE)


def _put_back() -> None:
    """Remove what was made, and let the environment of before stand where it stood."""
    if VENV.exists() and _read_stamp() == {}:
        _clear()
        if not VENV.is_symlink():
            VENV.rmdir()
    if ASIDE.exists() and not VENV.exists():
        ASIDE.rename(VENV)


def _check_space() -> None:
    place = os.path.realpath(VENV) if VENV.exists() else str(ROOT)
    free = shutil.disk_usage(place).free
    if free < SPACE_BYTES:
        is_old = VENV.exists() and any(VENV.iterdir())
        old = f', delete the old environment ({VENV})' if is_old else ''
        raise SetupError(
            f'The environment needs {SPACE_BYTES / 1e9:.1f} GB of disk space, but only '
            f'{free / 1e9:.1f} GB are free in {place!r}.',
            todo=f'Free some space{old}, or move the course to another disk, and repeat the '
            'command.',
        )


def _clear() -> None:
    """Remove what this course has begun to make, the stamp that says so last."""
    for path in sorted(VENV.iterdir(), key=lambda path: path == STAMP):
        remove(path)


def _create(python: str) -> None:
    # `venv` takes no link. What it writes has the real path then, which is as good.
    place = os.path.realpath(VENV)
    command = [python, '-I', '-m', 'venv', '--without-pip', place]
    done = run(command, stderr=subprocess.STDOUT)
    if done.returncode != 0:
        lines = done.stdout.strip().splitlines() or ['']
        no_module = 'No module named' in done.stdout
        raise SetupError(
            f'{python} could not make an environment: {lines[-1]!r}',
            todo='On Debian and Ubuntu, install python3-venv. Then repeat the command.'
            if no_module
            else 'Put that right, and repeat the command.',
        )


def _update(
    stamp: dict[str, Any] | None, version: tuple[int, ...], requirements: Sequence[str]
) -> None:
    before = _packages(version)
    # The files of before stay installed, so they stay in the stamp.
    known = [name for name in (stamp or {}).get('installed', {}) if name.endswith('.txt')]
    names = [*requirements, *(name for name in known if (ROOT / name).is_file())]
    try:
        if stamp is not None:
            _write_stamp({})
        _install(version, list(dict.fromkeys(names)))
    except BaseException:
        # Most often the network is missing. If nothing has changed, what was there is still good.
        if stamp is not None and _packages(version) == before:
            _write_stamp(stamp)
        raise


def _install(version: tuple[int, ...], requirements: Sequence[str]) -> None:
    wanted = _wanted(requirements)
    lines = [line for name in requirements for line in (ROOT / name).read_text().splitlines()]
    progress = Progress(len(applicable(lines, version)))
    install(PYTHON, ROOT, requirements, progress, lambda: len(_packages(version)))
    _write_stamp(
        {'installed': wanted, 'folder': str(VENV), 'interpreter': _interpreter_mark()},
    )
    print('The environment is ready.', flush=True)


def _packages(version: tuple[int, ...]) -> set[str]:
    """Return the names and versions of the packages that are installed."""
    folder = VENV / 'lib' / 'python{}.{}'.format(*version) / 'site-packages'
    return {path.name for path in folder.glob('*.dist-info')}


def _version() -> tuple[int, ...] | None:
    """Return the version of the environment's Python, None if it doesn't run or is another one."""
    code = 'import sys; print(*sys.version_info[:3], int(sys.prefix != sys.base_prefix))'
    try:
        answer = run([str(PYTHON), '-I', '-c', code], timeout=60, check=True)
        major, minor, micro, inside = map(int, answer.stdout.split())
    except (OSError, ValueError, subprocess.SubprocessError):
        return None
    made_for_it = (VENV / 'lib' / f'python{major}.{minor}' / 'site-packages').is_dir()
    return (major, minor, micro) if inside and made_for_it else None


@contextmanager
def _readable_system_errors() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            message, todo = 'There is no disk space left', 'Free some space'
        elif error.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
            message, todo = (
                'The folder can not be written to',
                'Copy the course to your own folder',
            )
        else:
            message, todo = f'The environment can not be made ({error.strerror})', 'Put that right'
        raise SetupError(
            f'{message}: {str(error.filename or VENV)!r}.', todo=f'{todo}, and repeat the command.'
        ) from error
