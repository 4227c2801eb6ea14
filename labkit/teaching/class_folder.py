"""Reading the files that the learners of a class have sent, within limits.

Each learner has a folder with one file of a fixed name. A learner may put anything into their own
folder, and into a shared folder anything beside it. So the number of names and bytes is limited,
links are not followed, opening never blocks on special files, and a file counts only if all of it
has the form that the course writes.
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
from labkit.exercises.record.class_sheet import FILE_NAME, MOST_BYTES, Sheet, catalogue, read_sheet

__all__ = ['ClassFolder', 'Learner', 'Reading', 'chosen_folder']

# More learners than this are not a class.
MAX_LEARNERS = 300
# Most names looked at in the folder, which takes a hundredth of a second.
MAX_NAMES = 20_000
MAX_NAME_LENGTH = 40
_VARIABLE = 'LABKIT_CLASS_FOLDER'
_UNKNOWN_SIGN = '\N{REPLACEMENT CHARACTER}'
_TROUBLES = {errno.ELOOP: 'a link', errno.ENXIO: 'no ordinary file', errno.ENOTDIR: 'a link'}

# Identifies an unchanged file.
_Stamp = tuple[int, ...]


@dataclass(frozen=True)
class Learner:
    """A learner who shares progress, or tries to.

    Attributes:
        name: The name of their folder, made printable.
        sheet: What they have sent; None if it is unusable.
        trouble: Why it is unusable, in words of this module.
        certain: Whether the name is reliable: the folder belongs to one account, and only that one
            can write in it.
    """

    name: str
    sheet: Sheet | None = None
    trouble: str = ''
    certain: bool = False


@dataclass(frozen=True)
class Reading:
    """The content of a class's folder.

    Attributes:
        learners: The learners who share, by name; also those with unusable files.
        silent: Number of learners with empty folders: they share nothing.
        certain: Whether only the owner of the folder can create names in it.
        note: Any general problem, `''` if there is none.
    """

    learners: tuple[Learner, ...] = ()
    silent: int = 0
    certain: bool = False
    note: str = ''


class ClassFolder:
    """The folder of a class, to be read repeatedly."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._known = catalogue()
        # By folder name: the learner, and the file it was read from.
        self._cache: dict[str, tuple[_Stamp, Learner]] = {}

    def read(self) -> Reading:
        """Read the folder. It never raises."""
        try:
            with _opened(self.path, os.O_DIRECTORY) as folder:
                return self._read(folder)
        except OSError as error:
            who = ' On a hub its teachers alone can.' if error.errno == errno.EACCES else ''
            return Reading(note=f'{str(self.path)!r} can not be read: {error.strerror}.{who}')

    def _read(self, folder: int) -> Reading:
        around = os.fstat(folder)
        vouching = _is_protected(around)
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
        self._cache = kept
        note = _note(others, too_many)
        return Reading(tuple(learners), silent, vouching, note)

    def _names(self, folder: int) -> tuple[list[str], int, bool]:
        """Return the names of learners' folders, the number of other entries, and if too many."""
        found, others, count = [], 0, 0
        with os.scandir(folder) as entries:
            for entry in entries:
                count += 1
                if count > MAX_NAMES:
                    break
                if entry.is_dir(follow_symlinks=False):
                    found.append(entry.name)
                else:
                    others += 1
        # Known learners stay, even if somebody fills the folder with names.
        found.sort(key=lambda name: (name not in self._cache, name))
        too_many = count > MAX_NAMES or len(found) > MAX_LEARNERS
        missing = self._cache.keys() - set(found) if too_many else ()
        chosen = [*missing, *found][:MAX_LEARNERS]
        return sorted(chosen), others, too_many

    def _learner(
        self, folder: int, name: str, keeper: int | None
    ) -> tuple[_Stamp, Learner | None]:
        shown, certain = _printable(name), False
        try:
            around = os.stat(name, dir_fd=folder, follow_symlinks=False)
            certain = keeper is not None and _is_private(around, keeper)
            with (
                _opened(name, os.O_DIRECTORY, folder) as place,
                # Never block on a pipe.
                _opened(FILE_NAME, os.O_NONBLOCK | os.O_NOCTTY, place) as file,
            ):
                status = os.fstat(file)
                stamp = (
                    *(status.st_dev, status.st_ino, status.st_size),
                    *(status.st_mtime_ns, status.st_ctime_ns, around.st_uid, certain),
                )
                if name in self._cache and self._cache[name][0] == stamp:
                    return self._cache[name]
                trouble = _trouble(around, status)
                if trouble:
                    return stamp, Learner(shown, trouble=trouble, certain=certain)
                return stamp, self._evaluated(shown, _content(file), certain)
        except FileNotFoundError:
            return (), None
        except OSError as error:
            why = _TROUBLES.get(error.errno or 0, error.strerror or 'not readable')
            return (), Learner(shown, trouble=why, certain=certain)

    def _evaluated(self, name: str, content: bytes, certain: bool) -> Learner:
        if len(content) > MOST_BYTES:
            return Learner(name, trouble='too large', certain=certain)
        try:
            return Learner(name, read_sheet(content, self._known), certain=certain)
        except ValueError as error:
            return Learner(name, trouble=str(error), certain=certain)


def chosen_folder(folder: str | os.PathLike[str] | None) -> Path:
    """Return the folder of the class.

    Args:
        folder: The given folder; if None, the one set by the hub or the teacher.

    Raises:
        LabError: There is none, or it is not a folder.
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


def _is_protected(folder: os.stat_result) -> bool:
    """Return whether only root, or this user, can create folders in it."""
    return folder.st_uid in (0, os.geteuid()) and not folder.st_mode & 0o022


def _is_private(place: os.stat_result, keeper: int) -> bool:
    """Return whether a learner's folder belongs to one account other than the keeper's."""
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
    """Return the content of a file, up to one byte more than allowed."""
    parts, missing = [], MOST_BYTES + 1
    while missing > 0:
        part = os.read(file, missing)
        if not part:
            break
        parts.append(part)
        missing -= len(part)
    return b''.join(parts)


def _printable(name: str) -> str:
    """Return a name without invisible characters, or those that change the text direction."""
    shown = ''.join(sign if sign.isprintable() else _UNKNOWN_SIGN for sign in name)
    return shown if len(shown) <= MAX_NAME_LENGTH else f'{shown[: MAX_NAME_LENGTH - 1]}…'


def _note(others: int, too_many: bool) -> str:
    parts = []
    if too_many:
        parts.append(
            'There are more names in the folder than a class has; of at most '
            f'{MAX_LEARNERS} learners something is read.'
        )
    if others:
        what = '1 thing' if others == 1 else f'{others} things'
        parts.append(f'{what} in the folder that no learner of the course has put there.')
    return ' '.join(parts)
