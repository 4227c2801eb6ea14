"""What the learners of a class have sent: read with limits, whatever lies there.

A folder for each learner, with one file of a fixed name. A learner may put anything into their own
folder, and in a folder that is everybody's anything beside it. So at most so many names are looked
at and so many bytes read, links are not followed, what is no ordinary file is not opened for
waiting, and a file counts only if all of it has the form that the course writes.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from labkit.errors import LabError
from labkit.exercises.class_sheet import FILE_NAME, MOST_BYTES, Sheet, catalogue, read_sheet

__all__ = ['ClassFolder', 'Learner', 'Reading', 'chosen_folder']

# Of more learners than that it is no class.
MOST_LEARNERS = 300
# So many names in the folder are looked at, a hundredth of a second of work.
MOST_NAMES = 20_000
LONGEST_NAME = 40
_VARIABLE = 'LABKIT_CLASS_FOLDER'
_UNKNOWN_SIGN = '\N{REPLACEMENT CHARACTER}'
_TROUBLES = {errno.ELOOP: 'a link', errno.ENXIO: 'no ordinary file', errno.ENOTDIR: 'a link'}

# By it a file is known to be the same as before.
_Stamp = tuple[int, ...]


@dataclass(frozen=True)
class Learner:
    """Somebody who shares, or tries to.

    Attributes:
        name: The name of their folder, as it may be shown.
        sheet: What they have sent; None if it can't be used.
        trouble: Why it can't be used, in words of this module.
        certain: Whether the machine vouches for the name: their folder was given to one account,
            and only that one can write in it.
    """

    name: str
    sheet: Sheet | None = None
    trouble: str = ''
    certain: bool = False


@dataclass(frozen=True)
class Reading:
    """What lies in the folder of a class.

    Attributes:
        learners: Who shares, by name; those whose file can't be used included.
        silent: How many learners' folders are empty: they share nothing.
        certain: Whether nobody but who keeps the folder gives names in it.
        note: What is wrong with the whole, `''` if nothing is.
    """

    learners: tuple[Learner, ...] = ()
    silent: int = 0
    certain: bool = False
    note: str = ''


class ClassFolder:
    """The folder of a class, to be read again and again.

    Args:
        path: The folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._known = catalogue()
        # By name of a folder: what was read there, and of which file.
        self._kept: dict[str, tuple[_Stamp, Learner]] = {}

    def read(self) -> Reading:
        """Return what lies there now. It never raises."""
        try:
            with _opened(self.path, os.O_DIRECTORY) as folder:
                return self._read(folder)
        except OSError as error:
            return Reading(note=f'{str(self.path)!r} can not be read: {error.strerror}.')

    def _read(self, folder: int) -> Reading:
        around = os.fstat(folder)
        vouching = _is_well_kept(around)
        keeper = around.st_uid
        names, others, too_many = self._names(folder)
        learners, silent, kept = [], 0, {}
        for name in names:
            stamp, learner = self._learner(folder, name, keeper if vouching else None)
            if learner is None:
                silent += 1
                continue
            kept[name] = (stamp, learner)
            learners.append(learner)
        self._kept = kept
        note = _note(others, too_many)
        return Reading(tuple(learners), silent, vouching, note)

    def _names(self, folder: int) -> tuple[list[str], int, bool]:
        """Return the names of learners' folders, how many other things lie there, if too many."""
        found, others, count = [], 0, 0
        with os.scandir(folder) as entries:
            for entry in entries:
                count += 1
                if count > MOST_NAMES:
                    break
                if entry.is_dir(follow_symlinks=False):
                    found.append(entry.name)
                else:
                    others += 1
        # Who was there before stays, whoever fills the folder with names meanwhile.
        found.sort(key=lambda name: (name not in self._kept, name))
        too_many = count > MOST_NAMES or len(found) > MOST_LEARNERS
        missing = self._kept.keys() - set(found) if too_many else ()
        chosen = [*missing, *found][:MOST_LEARNERS]
        return sorted(chosen), others, too_many

    def _learner(
        self, folder: int, name: str, keeper: int | None
    ) -> tuple[_Stamp, Learner | None]:
        shown, certain = _as_shown(name), False
        try:
            around = os.stat(name, dir_fd=folder, follow_symlinks=False)
            certain = keeper is not None and _is_ones_own(around, keeper)
            with (
                _opened(name, os.O_DIRECTORY, folder) as place,
                # What is a pipe is not waited for.
                _opened(FILE_NAME, os.O_NONBLOCK | os.O_NOCTTY, place) as file,
            ):
                status = os.fstat(file)
                stamp = (
                    *(status.st_dev, status.st_ino, status.st_size),
                    *(status.st_mtime_ns, status.st_ctime_ns, around.st_uid, certain),
                )
                if name in self._kept and self._kept[name][0] == stamp:
                    return self._kept[name]
                trouble = _trouble(around, status)
                if trouble:
                    return stamp, Learner(shown, trouble=trouble, certain=certain)
                return stamp, self._judged(shown, _content(file), certain)
        except FileNotFoundError:
            return (), None
        except OSError as error:
            why = _TROUBLES.get(error.errno or 0, error.strerror or 'not readable')
            return (), Learner(shown, trouble=why, certain=certain)

    def _judged(self, name: str, content: bytes, certain: bool) -> Learner:
        if len(content) > MOST_BYTES:
            return Learner(name, trouble='too large', certain=certain)
        try:
            return Learner(name, read_sheet(content, self._known), certain=certain)
        except ValueError as error:
            return Learner(name, trouble=str(error), certain=certain)


def chosen_folder(folder: str | os.PathLike[str] | None) -> Path:
    """Return the folder of the class that is meant.

    Args:
        folder: What was given. If None, what the hub or the teacher has set.

    Raises:
        LabError: Nothing was given or set, or it is no folder.
    """
    given = folder if folder is not None else os.environ.get(_VARIABLE)
    if not given:
        raise LabError(
            'Which class?',
            todo=f'Give its folder, lab.classroom("/mnt/class"), or set {_VARIABLE}.',
        )
    path = Path(given).expanduser().absolute()
    if not path.is_dir():
        raise LabError(
            f'{str(path)!r} is not a folder.',
            todo='Make it, where all learners can write, and let them join: docs/classroom.md.',
        )
    return path


# --- Whose it is ---------------------------------------------------------------------------------


def _is_well_kept(folder: os.stat_result) -> bool:
    """Tell whether nobody but root, or the one who reads, can make folders in it."""
    return folder.st_uid in (0, os.geteuid()) and not folder.st_mode & 0o022


def _is_ones_own(place: os.stat_result, keeper: int) -> bool:
    """Tell whether a learner's folder was given to one account that keeps no folders itself."""
    return place.st_uid not in (0, keeper) and not place.st_mode & 0o022


def _trouble(place: os.stat_result, file: os.stat_result) -> str:
    if not stat.S_ISREG(file.st_mode):
        return 'no ordinary file'
    if file.st_uid != place.st_uid or file.st_nlink > 1:
        return 'a file of somebody else'
    return 'too large' if file.st_size > MOST_BYTES else ''


# --- Reading -------------------------------------------------------------------------------------


@contextmanager
def _opened(path: str | Path, flags: int, folder: int | None = None) -> Iterator[int]:
    nofollow = os.O_NOFOLLOW if folder is not None else 0
    handle = os.open(path, os.O_RDONLY | os.O_CLOEXEC | nofollow | flags, dir_fd=folder)
    try:
        yield handle
    finally:
        os.close(handle)


def _content(file: int) -> bytes:
    """Return what is in a file, one byte more than it may have at most."""
    parts, missing = [], MOST_BYTES + 1
    while missing > 0:
        part = os.read(file, missing)
        if not part:
            break
        parts.append(part)
        missing -= len(part)
    return b''.join(parts)


def _as_shown(name: str) -> str:
    """Return a name without signs that can't be seen, or that turn the direction of a line."""
    shown = ''.join(sign if sign.isprintable() else _UNKNOWN_SIGN for sign in name)
    return shown if len(shown) <= LONGEST_NAME else f'{shown[: LONGEST_NAME - 1]}…'


def _note(others: int, too_many: bool) -> str:
    parts = []
    if too_many:
        parts.append(
            'There are more names in the folder than a class has; of at most '
            f'{MOST_LEARNERS} learners something is read.'
        )
    if others:
        what = '1 thing' if others == 1 else f'{others} things'
        parts.append(f'{what} in the folder that no learner of the course has put there.')
    return ' '.join(parts)
