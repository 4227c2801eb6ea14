"""Write files whole or not at all, and tell what lies in a folder. Runs in Python from 3.8 on."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, BinaryIO, Union

__all__ = ['is_inside', 'locked', 'rename_to_free', 'write_atomically']

AnyPath = Union[str, 'os.PathLike[str]']

# Files on their way. The same short form for all: a lesson's name may be as long as a name can be.
_PREFIX, _SUFFIX = '.labkit-', '.new'
# What a new file may be used for, before the umask takes its part away.
_NEW_MODE = 0o666


def write_atomically(
    path: Path,
    content: bytes,
    *,
    replace: bool = True,
    follow_links: bool = True,
    mode: int | None = None,
) -> None:
    """Put a file in its place, all of it or nothing, even if the machine is switched off.

    A file that is there keeps its permissions, a link stays a link and the file that it leads to
    is written; a new file gets the permissions that the umask leaves. Any number of processes
    and threads may write the same file: each reader finds what one of them has written.

    Args:
        path: The file. Its folder has to be there.
        content: What it is to hold.
        replace: Whether a file of that name may be replaced.
        follow_links: Whether a link stays. In a folder of others', one may lead anywhere: then
            the link itself is replaced.
        mode: Its permissions, whatever was there and whatever the umask says.

    Raises:
        FileExistsError: It is there, and is not to be replaced.
        OSError: It can't be written. Then all is as it was.
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
        # The name that the caller, and a learner, knows.
        error.filename, error.filename2 = str(path), None
        raise
    _sync_folder(target.parent)


@contextmanager
def locked(path: Path, timeout_sec: float) -> Iterator[None]:
    """Keep other processes out, as long as all of them ask here.

    Who has just had the lock queues up behind who waits: one that wants it again and again would
    else keep the others out for as long as it likes.

    Args:
        path: An empty file for the lock. It stays, and so does one beside it, for the queue.
        timeout_sec: Seconds to wait for others.

    Raises:
        OSError: Another process keeps it.
    """
    end = time.monotonic() + timeout_sec
    with path.open('w') as file:
        with path.with_name(f'{path.name}-queue').open('w') as queue:
            _lock_until(end, queue)
            _lock_until(end, file)
        yield


def rename_to_free(old: Path, new: Path) -> None:
    """Rename a file to a name that nothing has, even if another program takes it just now.

    Args:
        old: A file, a link or a folder.
        new: Its new name, in the same file system.

    Raises:
        FileExistsError: The name is taken.
        OSError: It can't be renamed. Then all is as it was.
    """
    try:
        os.link(old, new)
    except FileExistsError:
        raise
    except OSError:
        # A folder, or a file system without hard links, such as a Windows drive: take the name
        # with something empty, which is then replaced.
        _take(new, folder=old.is_dir() and not old.is_symlink())
        try:
            os.replace(old, new)
        except BaseException:
            _give_back(new)
            raise
    else:
        os.unlink(old)


def is_inside(path: AnyPath, folder: AnyPath, *, follow_links: bool = True) -> bool:
    """Tell whether a path leads into a folder, or is that folder.

    Args:
        path: A file or a folder; it need not be there.
        folder: The folder.
        follow_links: Whether it counts where links lead to, not where they lie. An environment's
            `bin/python` lies in it, and leads out of it.
    """
    form = os.path.realpath if follow_links else os.path.normpath
    inner, outer = form(os.fspath(path)), form(os.fspath(folder))
    return inner == outer or inner.startswith(outer.rstrip(os.sep) + os.sep)


# --- Files on their way --------------------------------------------------------------------------


def _mode(path: Path) -> int | None:
    """Return the permissions of a file, None if it is not there."""
    try:
        return stat.S_IMODE(os.stat(path).st_mode)
    except FileNotFoundError:
        return None


@contextmanager
def _new_file(folder: Path, mode: int | None) -> Iterator[tuple[Path, BinaryIO]]:
    """Make a file that is locked while it is open, and gone then unless it was renamed."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, 'O_CLOEXEC', 0)
    while True:
        new = folder / f'{_PREFIX}{secrets.token_hex(8)}{_SUFFIX}'
        # With its permissions from the start: nobody else may open it in between.
        handle = os.open(new, flags, _NEW_MODE if mode is None else mode)
        with open(handle, 'wb') as file:
            try:
                _lock(handle, wait=True)
                if not os.path.lexists(new):
                    continue  # before it was locked, somebody took it for left behind
                if mode is not None:
                    with contextlib.suppress(PermissionError):  # a drive without permissions
                        os.fchmod(handle, mode)  # what the umask has taken away
                yield new, file
                return
            finally:
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(new)


def _remove_leftovers(folder: Path) -> None:
    """Remove what killed processes have left in a folder: nobody has a lock on that.

    A process id would not do: the folder may be shared with other machines and containers.
    """
    with contextlib.suppress(OSError):
        for entry in list(os.scandir(folder)):
            if entry.name.startswith(_PREFIX) and entry.name.endswith(_SUFFIX):
                with contextlib.suppress(OSError):
                    _remove_if_left(entry.path)


def _remove_if_left(path: str) -> None:
    handle = os.open(path, os.O_WRONLY | getattr(os, 'O_NOFOLLOW', 0))
    try:
        if _lock(handle, wait=False):
            os.unlink(path)
    finally:
        os.close(handle)


def _lock(handle: int, *, wait: bool) -> bool:
    """Lock an open file; return False if another has locked it, or if files can't be locked."""
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


def _take(path: Path, *, folder: bool) -> None:
    if folder:
        os.mkdir(path)
    else:
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL))


def _give_back(path: Path) -> None:
    with contextlib.suppress(OSError):
        if path.is_dir():
            os.rmdir(path)
        elif path.stat().st_size == 0:
            os.unlink(path)


def _sync_folder(folder: Path) -> None:
    """Make a new name last; some file systems can't be asked to."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
