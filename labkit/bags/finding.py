"""Opening the files of a bag, or explaining why a path is not one."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from labkit.bags.mcap_file import McapFile
from labkit.bags.metadata import FILE_NAME, Metadata, read_metadata
from labkit.bags.sqlite_file import SqliteFile
from labkit.bags.stored import Damaged, StoredFile
from labkit.bags.unpacking import unpacked_size
from labkit.errors import LabError, nearest, quoted

__all__ = ['Found', 'find', 'find_without_metadata', 'is_bag']

_STORAGES: dict[str, tuple[str, Callable[[Path], StoredFile]]] = {
    '.mcap': ('mcap', McapFile),
    '.db3': ('sqlite3', SqliteFile),
}
_ROS_1 = b'#ROSBAG V'
NEWEST_VERSION = 9
# Files are unpacked up to this part of the room that is left.
MOST_OF_DISK = 0.9


@dataclass
class Found:
    """The open files of a bag.

    Attributes:
        path: Its folder, or its single file.
        storage: `'mcap'` or `'sqlite3'`.
        files: The files, in order.
        metadata: The content of `metadata.yaml`, None if there is no reliable one.
        note: Any fault, as a sentence; '' if there is none.
        stored_at: The files on disk.
        compressed_messages: Whether messages are compressed one by one.
    """

    path: Path
    storage: str
    files: list[StoredFile]
    metadata: Metadata | None
    note: str
    stored_at: Sequence[Path]
    compressed_messages: bool = False
    _at_end: list[Callable[[], None]] = field(default_factory=list)

    def close(self) -> None:
        """Close the files."""
        for file in self.files:
            file.close()
        for action in self._at_end:
            action()
        self._at_end.clear()


def is_bag(path: Path) -> bool:
    """Return whether a path looks like a bag: a folder with its files, or one of those."""
    if path.is_dir():
        return (path / FILE_NAME).is_file() or bool(_data_files(path))
    return path.suffix in _STORAGES and path.is_file()


def find(path: Path) -> Found:
    """Open the bag at a path.

    Raises:
        LabError: There is no readable bag.
    """
    try:
        if path.is_dir():
            return _find_folder(path)
        if path.is_file():
            return _find_file(path)
    except PermissionError as error:
        raise LabError(
            f'{quoted(str(path))} may not be read: {error.strerror}.',
            todo='Change its permissions.',
        ) from error
    except OSError as error:
        raise LabError(f'{quoted(str(path))} can not be read: {error}.') from error
    if path.exists():
        raise LabError(
            f'{quoted(str(path))} is no bag: it is neither a folder nor a regular file.',
            todo='Pass the name of the folder that the bag is in.',
        )
    raise _missing(path)


def find_without_metadata(path: Path) -> Found:
    """Open the data files in a folder, whatever its `metadata.yaml` says.

    Raises:
        LabError: There are none, or they can't be read.
    """
    files = _data_files(path) if path.is_dir() else []
    if not files:
        raise LabError(
            f'{quoted(str(path))} is no folder with files .mcap or .db3.',
            todo='Pass the folder of the bag.',
        )
    found, note = _open_all(path, files, '')
    return Found(path, _STORAGES[files[0].suffix][0], found, None, note, files)


# --- Folders and files ---------------------------------------------------------------------------


def _find_folder(path: Path) -> Found:
    metadata, note = None, ''
    if (path / FILE_NAME).is_file():
        try:
            metadata = read_metadata(path / FILE_NAME)
        except Damaged:
            note = f'Its {FILE_NAME} can not be understood; its files are read without it.'
        else:
            _check(path, metadata)
    files = _data_files(path)
    if metadata is not None:
        if metadata.compression:
            return _find_compressed(path, metadata)
        there, files = files, [path / Path(name).name for name in metadata.files]
        if len(there) == len(files) and not any(file.is_file() for file in files):
            files = there
            note = f'Its {FILE_NAME} names other files; those in the folder are read.'
    elif files and not note:
        note = f'It is not complete ({FILE_NAME} is missing); it is read as far as it goes.'
    if not files:
        raise _no_bag(path)
    found, notes = _open_all(path, files, note)
    if notes != note:
        metadata = None  # its counts include missing messages
    return Found(path, _STORAGES[files[0].suffix][0], found, metadata, notes, files)


def _find_file(path: Path) -> Found:
    with path.open('rb') as file:
        begin = file.read(16)
    if begin.startswith(_ROS_1) or path.suffix == '.bag':
        raise _ros_1(path)
    if path.name == FILE_NAME:
        return _find_folder(path.parent)
    if path.suffix not in _STORAGES:
        raise LabError(
            f'{quoted(str(path))} is no bag: expected a folder with {FILE_NAME}, or a file .mcap '
            'or .db3.',
            todo='Pass the name of the folder that the bag is in.',
        )
    files, note = _open_all(path, [path], '')
    return Found(path, _STORAGES[path.suffix][0], files, None, note, [path])


def _open_all(path: Path, files: Sequence[Path], note: str) -> tuple[list[StoredFile], str]:
    """Open files; return them, and a note about faults."""
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        raise LabError(
            f'{quoted(str(path))} lacks {", ".join(missing)}, which its {FILE_NAME} names.',
            todo='Maybe the folder was not copied whole: it needs all of its files.',
        )
    found: list[StoredFile] = []
    try:
        for file in files:
            if file.suffix not in _STORAGES:
                raise Damaged('is of a kind that is not known here')
            found.append(_STORAGES[file.suffix][1](file))
    except (Damaged, ValueError) as error:
        for opened in found:
            opened.close()
        why = error if isinstance(error, Damaged) else f'is damaged: {error}'
        if str(why) == 'is empty' and len(files) > 1 and note:
            return found, note
        what, todo = _something_else(file)
        raise LabError(
            f'{quoted(str(file))} {what or why}.',
            todo=todo or 'It holds nothing that can be read. Is there another copy of it?',
        ) from error
    except OSError:
        for opened in found:
            opened.close()
        raise
    unfinished = [file for file in found if file.note]
    if unfinished and not note:
        note = ' '.join(f'{file.path.name} {file.note}.' for file in unfinished)
    return found, note


def _something_else(file: Path) -> tuple[str, str]:
    """Return what lies in the place of a data file, and what to do; '' if that is not known."""
    with file.open('rb') as content:
        begin = content.read(200).lstrip().lower()
    if begin.startswith(b'version https://git-lfs'):
        return (
            'is a pointer of Git LFS: the data itself was not fetched',
            'Fetch it where the repository was cloned: git lfs pull',
        )
    if begin.startswith((b'<!doctype html', b'<html')):
        return 'is a web page', 'Download the file itself, not the page that shows it.'
    return '', ''


def _data_files(path: Path) -> list[Path]:
    """Return the data files in a folder, in the order in which they were written."""

    def order(file: Path) -> tuple[int, str]:
        number = file.stem.rpartition('_')[2]
        return (int(number) if number.isdecimal() else -1, file.name)

    files = [file for file in path.iterdir() if file.suffix in _STORAGES and file.is_file()]
    kinds = {file.suffix for file in files}
    if len(kinds) > 1:
        raise LabError(
            f'{quoted(str(path))} holds files of two kinds, {" and ".join(sorted(kinds))}, and no '
            f'{FILE_NAME} that says which of them are the bag.',
            todo='Pass the name of one file.',
        )
    return sorted(files, key=order)


def _check(path: Path, metadata: Metadata) -> None:
    storages = [name for name, _ in _STORAGES.values()]
    if metadata.storage not in storages:
        raise LabError(
            f'{quoted(str(path))} is stored as {quoted(metadata.storage)}; here '
            f'{" and ".join(storages)} can be read.',
            todo='Convert it where its storage plugin is installed: ros2 bag convert.',
        )
    if metadata.version > NEWEST_VERSION:
        raise LabError(
            f'{quoted(str(path))} is of version {metadata.version}; the newest that is known here '
            f'is {NEWEST_VERSION}, that of ROS 2 Jazzy.',
            todo='Convert it with the ROS 2 that has recorded it.',
        )


def _find_compressed(path: Path, metadata: Metadata) -> Found:
    """Open a compressed bag; `rosbags` unpacks compressed files to a temporary folder."""
    from rosbags.rosbag2 import Reader, ReaderError

    names = [path / Path(name).name for name in metadata.files]
    if metadata.compression == 'message':
        files, note = _open_all(path, names, '')
        return Found(path, metadata.storage, files, metadata, note, names, True)
    reader = Reader(path)
    try:
        free = shutil.disk_usage(tempfile.gettempdir()).free
        if sum(unpacked_size(name, free) for name in names) > free * MOST_OF_DISK:
            raise ValueError(f'there is no room for it in {tempfile.gettempdir()}')
        reader.open()
        unpacked = [Path(str(each.path)) for each in reader.storage.storages]  # type: ignore[attr-defined]
        files, note = _open_all(path, unpacked, '')
    except (ReaderError, OSError, ValueError, LabError) as error:
        with suppress(Exception):
            reader.close()
        raise LabError(
            f'{quoted(str(path))} is compressed, and can not be unpacked: {error}.',
            todo='Is there another copy of it?',
        ) from error
    return Found(path, metadata.storage, files, metadata, note, names, False, [reader.close])


# --- Errors --------------------------------------------------------------------------------------


def _missing(path: Path) -> LabError:
    beside: list[str] = []
    with suppress(OSError):
        beside = [each.name for each in path.parent.iterdir() if is_bag(each)]
    near = nearest(path.name, beside)
    if near:
        todo = f'Did you mean {str(path.parent / near)!r}?'
    elif beside:
        todo = f'There are these bags: {", ".join(sorted(beside)[:10])}.'
    else:
        todo = f'Record one: lab.record({quoted(str(path))}).'
    return LabError(f'There is no bag {quoted(str(path))}.', todo=todo)


def _no_bag(path: Path) -> LabError:
    if any(path.glob('*.bag')):
        return _ros_1(next(path.glob('*.bag')))
    inner = [each for each in path.iterdir() if each.is_dir() and is_bag(each)]
    if inner:
        return LabError(
            f'{quoted(str(path))} is no bag, but it holds some.',
            todo=f'Pass {quoted(str(inner[0]))}.',
        )
    what = 'is empty' if not any(path.iterdir()) else f'holds no {FILE_NAME}, no .mcap, no .db3'
    return LabError(
        f'{quoted(str(path))} is no bag: the folder {what}.',
        todo='Pass the name of the folder that the bag is in.',
    )


def _ros_1(path: Path) -> LabError:
    return LabError(
        f'{quoted(str(path))} is a bag of ROS 1, which has another format.',
        todo=f'Convert it in a terminal: rosbags-convert --src {path} --dst {path.stem}',
    )
