"""Write files whole or not at all, read those of others, and locate paths.

Runs in Python from 3.8 on.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import secrets
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, BinaryIO, Union

__all__ = [
    'is_inside',
    'locked',
    'read_json',
    'read_limited',
    'remove',
    'rename_to_free',
    'replaced',
    'write_atomically',
]

AnyPath = Union[str, 'os.PathLike[str]']

# Temporary files. Short names: a lesson's name may already have the maximum length.
_PREFIX, _SUFFIX = '.labkit-', '.new'
# Permissions of a new file, before the umask.
_NEW_MODE = 0o666
# Most of a file that somebody else may have made.
MOST_BYTES = 1_000_000


def write_atomically(
    path: Path,
    content: bytes,
    *,
    replace: bool = True,
    follow_links: bool = True,
    mode: int | None = None,
) -> None:
    """Write a file completely or not at all, even if the machine is switched off.

    An existing file keeps its permissions; a link stays, and its target is written; a new file
    gets the permissions of the umask. Any number of processes and threads may write the same file:
    each reader finds the content of one of them.

    Args:
        path: The file. Its folder has to exist.
        content: Its new content.
        replace: Whether an existing file may be replaced.
        follow_links: Whether to follow a link. In a folder of other people, it may lead anywhere:
            then the link itself is replaced.
        mode: Permissions, regardless of an existing file and the umask.

    Raises:
        FileExistsError: The file exists, and must not be replaced.
        OSError: It can't be written. Then nothing has changed.
    """
    target = Path(os.path.realpath(path)) if replace and follow_links else path
    _remove_leftovers(target.parent)
    if mode is None and replace and follow_links:
        mode = _mode(target)
    try:
        with _new_file(target.parent, mode) as (new, file):
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
            if replace:
                os.replace(new, target)
            else:
                rename_to_free(new, target)
    except OSError as error:
        # The name known to the caller and the learner.
        error.filename, error.filename2 = str(path), None
        raise
    _sync_folder(target.parent)


@contextmanager
def locked(path: Path, timeout_sec: float) -> Iterator[None]:
    """Hold a lock between processes that use this function.

    A process that has just had the lock queues up behind those that wait: otherwise one that takes
    it again and again would starve the others.

    Args:
        path: An empty file for the lock. It stays, as does one beside it for the queue.
        timeout_sec: Seconds to wait for others.

    Raises:
        OSError: Another process holds it.
    """
    end = time.monotonic() + timeout_sec
    with path.open('a') as file:
        with path.with_name(f'{path.name}-queue').open('a') as queue:
            _lock_until(end, queue)
            _lock_until(end, file)
        yield


def rename_to_free(old: Path, new: Path) -> None:
    """Rename a file to an unused name, safe against other programs taking it at the same time.

    Args:
        old: A file, a link or a folder.
        new: Its new name, in the same file system.

    Raises:
        FileExistsError: The name is taken.
        OSError: It can't be renamed. Then nothing has changed.
    """
    try:
        os.link(old, new)
    except FileExistsError:
        raise
    except OSError:
        # A folder, or a file system without hard links, such as a Windows drive: reserve the name
        # with something empty, and replace that.
        _reserve(new, folder=old.is_dir() and not old.is_symlink())
        try:
            os.replace(old, new)
        except BaseException:
            _release(new)
            raise
    else:
        os.unlink(old)


def remove(path: Path) -> None:
    """Remove a file, a folder with all that is in it, or a link, and not what that leads to.

    Raises:
        OSError: It is not there, or can't be removed.
    """
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()


@contextmanager
def replaced(path: Path) -> Iterator[None]:
    """Free the name of a folder for a new one; what had it is removed when that stands.

    If something is raised meanwhile, what was there before stands there again, as it was. Of a
    link only the link is replaced: nothing is written to, or removed, where it leads.

    Args:
        path: The name. Its folder has to exist.

    Raises:
        OSError: The name can't be freed. Then nothing has changed.
    """
    with tempfile.TemporaryDirectory(prefix=_PREFIX, dir=path.parent) as place:
        old = Path(place, path.name)
        if os.path.lexists(path):
            path.rename(old)
        try:
            yield
        except BaseException:
            if os.path.lexists(path):
                remove(path)
            if os.path.lexists(old):
                old.rename(path)
            raise


def read_limited(path: AnyPath, most_bytes: int = MOST_BYTES) -> bytes:
    """Return the content of a file that somebody else may have made.

    Args:
        path: The file.
        most_bytes: Its greatest size.

    Raises:
        OSError: It can't be read, is larger, or is not a regular file: a pipe would block.
    """
    flags = getattr(os, 'O_CLOEXEC', 0) | getattr(os, 'O_NONBLOCK', 0)
    handle = os.open(path, os.O_RDONLY | flags)
    try:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, 'Not a regular file', os.fspath(path))
        with open(handle, 'rb', closefd=False) as file:
            content = file.read(most_bytes + 1)
    finally:
        os.close(handle)
    if len(content) > most_bytes:
        raise OSError(errno.EFBIG, f'Larger than {most_bytes} bytes', os.fspath(path))
    return content


def read_json(path: AnyPath) -> Any:
    """Return the data of a JSON file that somebody else may have made.

    Raises:
        OSError: As for `read_limited`.
        ValueError: It is not JSON, or nested too deep.
    """
    try:
        return json.loads(read_limited(path))
    except RecursionError as error:
        raise ValueError('nested too deep') from error


def is_inside(path: AnyPath, folder: AnyPath, *, follow_links: bool = True) -> bool:
    """Return whether a path is in a folder, or is that folder.

    Args:
        path: A file or a folder, which need not exist.
        folder: The folder.
        follow_links: Whether to resolve links. An environment's `bin/python` is in it, but links
            out of it.
    """
    form = os.path.realpath if follow_links else os.path.normpath
    inner, outer = form(os.fspath(path)), form(os.fspath(folder))
    return inner == outer or inner.startswith(outer.rstrip(os.sep) + os.sep)


# --- Files on their way --------------------------------------------------------------------------


def _mode(path: Path) -> int | None:
    """Return the permissions of a file, None if it does not exist."""
    try:
        return stat.S_IMODE(os.stat(path).st_mode)
    except FileNotFoundError:
        return None


@contextmanager
def _new_file(folder: Path, mode: int | None) -> Iterator[tuple[Path, BinaryIO]]:
    """Create a file that is locked while open, and removed afterwards unless it was renamed."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, 'O_CLOEXEC', 0)
    while True:
        new = folder / f'{_PREFIX}{secrets.token_hex(8)}{_SUFFIX}'
        # With its final permissions: nobody else may open it in between.
        handle = os.open(new, flags, _NEW_MODE if mode is None else mode)
        with open(handle, 'wb') as file:
            try:
                _lock(handle, wait=True)
                if not os.path.lexists(new):
                    continue  # another process took it for a leftover before it was locked
                if mode is not None:
                    with contextlib.suppress(PermissionError):  # a drive without permissions
                        os.fchmod(handle, mode)  # undo the umask
                yield new, file
                return
            finally:
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(new)


def _remove_leftovers(folder: Path) -> None:
    """Remove the unlocked files of killed processes from a folder.

    A process id would not do: the folder may be shared with other machines and containers.
    """
    with contextlib.suppress(OSError):
        for entry in list(os.scandir(folder)):
            if entry.name.startswith(_PREFIX) and entry.name.endswith(_SUFFIX):
                with contextlib.suppress(OSError):
                    _remove_if_unlocked(entry.path)


def _remove_if_unlocked(path: str) -> None:
    handle = os.open(path, os.O_WRONLY | getattr(os, 'O_NOFOLLOW', 0))
    try:
        if _lock(handle, wait=False):
            os.unlink(path)
    finally:
        os.close(handle)


def _lock(handle: int, *, wait: bool) -> bool:
    """Lock an open file; return False if another process holds it, or locking is unsupported."""
    try:
        import fcntl  # only there on Unix

        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except (ImportError, OSError):
        return False
    return True


def _lock_until(end: float, file: IO[str]) -> None:
    import fcntl

    while True:
        try:
            return fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > end:
                raise OSError('another notebook keeps the file locked') from None
            time.sleep(0.005)


def _reserve(path: Path, *, folder: bool) -> None:
    if folder:
        os.mkdir(path)
    else:
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL))


def _release(path: Path) -> None:
    with contextlib.suppress(OSError):
        if path.is_dir():
            os.rmdir(path)
        elif path.stat().st_size == 0:
            os.unlink(path)


def _sync_folder(folder: Path) -> None:
    """Make a new name durable; some file systems do not support it."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
