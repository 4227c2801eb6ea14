"""Write files whole or not at all, and tell what lies in a folder. Runs in Python from 3.8 on."""

from __future__ import annotations

import contextlib
import os
import threading
from pathlib import Path
from typing import Union

__all__ = ['is_inside', 'rename_to_free', 'write_atomically']

AnyPath = Union[str, 'os.PathLike[str]']


def write_atomically(path: Path, content: bytes, *, replace: bool = True) -> None:
    """Put a file in its place, all of it or nothing, even if the machine is switched off.

    A file that is there keeps its permissions; a new one gets those that the umask leaves.

    Args:
        path: The file. Its folder has to be there.
        content: What it is to hold.
        replace: Whether a file of that name may be replaced.

    Raises:
        FileExistsError: It is there, and is not to be replaced.
        OSError: It can't be written. Then all is as it was.
    """
    # What a killed process has left behind under this name is written over.
    new = path.with_name(f'.{path.name}.{os.getpid()}-{threading.get_ident()}.new')
    try:
        with open(new, 'wb') as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if replace:
            with contextlib.suppress(FileNotFoundError):
                os.chmod(new, path.stat().st_mode & 0o7777)
            os.replace(new, path)
        else:
            rename_to_free(new, path)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(new)
    _sync_folder(path.parent)


def rename_to_free(old: Path, new: Path) -> None:
    """Rename a file to a name that nothing has, even if another program takes it just now.

    Raises:
        FileExistsError: The name is taken.
    """
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


def is_inside(path: AnyPath, folder: AnyPath) -> bool:
    """Tell whether a path leads into a folder, or is that folder; links are followed."""
    real, real_folder = os.path.realpath(path), os.path.realpath(folder)
    return real == real_folder or real.startswith(real_folder.rstrip(os.sep) + os.sep)


def _sync_folder(folder: Path) -> None:
    """Make a new name last; some file systems can't be asked to."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
