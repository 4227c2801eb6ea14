"""What lies at a path: the files of a bag, or a sentence why it is none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from labkit.bags.mcap_file import McapFile
from labkit.bags.metadata import FILE_NAME, Metadata, read_metadata
from labkit.bags.sqlite_file import SqliteFile
from labkit.bags.stored import Damaged, StoredFile
from labkit.errors import LabError, nearest

__all__ = ['Found', 'decompressed', 'find', 'is_bag']

_STORAGES: dict[str, tuple[str, Callable[[Path], StoredFile]]] = {
    '.mcap': ('mcap', McapFile),
    '.db3': ('sqlite3', SqliteFile),
}
_ROS_1 = b'#ROSBAG V'
NEWEST_VERSION = 9


@dataclass
class Found:
    """The files of a bag, open.

    Attributes:
        path: The folder, or the one file.
        storage: `'mcap'` or `'sqlite3'`.
        files: The files, in order.
        metadata: What `metadata.yaml` says, None if there is none to rely on.
        note: What is wrong, as a sentence; '' if nothing is.
        stored_at: Where the bag takes space.
        compressed_messages: Whether each message is compressed for itself.
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
    """Tell whether a path looks like a bag: a folder with its files, or one of those."""
    if path.is_dir():
        return (path / FILE_NAME).is_file() or bool(_data_files(path))
    return path.suffix in _STORAGES and path.is_file()


def find(path: Path) -> Found:
    """Open what lies at a path.

    Raises:
        LabError: It is no bag that can be read.
    """
    try:
        if path.is_dir():
            return _find_folder(path)
        if path.is_file():
            return _find_file(path)
    except PermissionError as error:
        raise LabError(
            f'{str(path)!r} may not be read: {error.strerror}.', todo='Change its permissions.'
        ) from error
    except OSError as error:
        raise LabError(f'{str(path)!r} can not be read: {error}.') from error
    raise _nothing_at(path)


def decompressed(data: bytes) -> bytes:
    """Return the bytes of a message that was compressed for itself.

    Raises:
        ValueError: They are damaged.
    """
    from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

    try:
        return DECOMPRESSORS['zstd'](data, 0)
    except Exception as error:  # of a library, about bytes that anybody may have written
        raise ValueError(str(error)) from error


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
        files = [path / Path(name).name for name in metadata.files]
    elif files and not note:
        note = f'It was not finished ({FILE_NAME} is missing); it is read as far as it goes.'
    if not files:
        raise _no_bag(path)
    found, notes = _open_all(path, files, note)
    if notes != note:
        metadata = None  # it would count what is not there
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
            f'{str(path)!r} is no bag: expected a folder with {FILE_NAME}, or a file .mcap or '
            '.db3.',
            todo='Pass the name of the folder that the bag is in.',
        )
    files, note = _open_all(path, [path], '')
    return Found(path, _STORAGES[path.suffix][0], files, None, note, [path])


def _open_all(path: Path, files: Sequence[Path], note: str) -> tuple[list[StoredFile], str]:
    """Open files; return them, and what is wrong as a sentence."""
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        raise LabError(
            f'{str(path)!r} lacks {", ".join(missing)}, which its {FILE_NAME} names.',
            todo='Copy the whole folder of the bag, with all of its files.',
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
        raise LabError(
            f'{str(file)!r} {why}.',
            todo='It holds nothing that can be read. Record it anew, or get another copy.',
        ) from error
    except OSError:
        for opened in found:
            opened.close()
        raise
    unfinished = [file for file in found if file.note]
    if unfinished and not note:
        note = ' '.join(f'{file.path.name} {file.note}.' for file in unfinished)
    return found, note


def _data_files(path: Path) -> list[Path]:
    """Return the files of messages in a folder, in the order in which they were written."""

    def place(file: Path) -> tuple[int, str]:
        number = file.stem.rpartition('_')[2]
        return (int(number) if number.isdecimal() else -1, file.name)

    files = [file for file in path.iterdir() if file.suffix in _STORAGES and file.is_file()]
    kinds = {file.suffix for file in files}
    if len(kinds) > 1:
        raise LabError(
            f'{str(path)!r} holds files of two kinds, {" and ".join(sorted(kinds))}, and no '
            f'{FILE_NAME} that says which of them are the bag.',
            todo='Pass the name of one file.',
        )
    return sorted(files, key=place)


def _check(path: Path, metadata: Metadata) -> None:
    storages = [name for name, _ in _STORAGES.values()]
    if metadata.storage not in storages:
        raise LabError(
            f'{str(path)!r} is stored as {metadata.storage!r}; here {" and ".join(storages)} can '
            'be read.',
            todo='Convert it where its storage plugin is installed: ros2 bag convert.',
        )
    if metadata.version > NEWEST_VERSION:
        raise LabError(
            f'{str(path)!r} is of version {metadata.version}; the newest that is known here is '
            f'{NEWEST_VERSION}, that of ROS 2 Jazzy.',
            todo='Convert it with the ROS 2 that has recorded it.',
        )


def _find_compressed(path: Path, metadata: Metadata) -> Found:
    """Open a bag that was compressed: `rosbags` unpacks files to a folder for the time being."""
    from rosbags.rosbag2 import Reader, ReaderError

    names = [path / Path(name).name for name in metadata.files]
    if metadata.compression == 'message':
        files, note = _open_all(path, names, '')
        return Found(path, metadata.storage, files, metadata, note, names, True)
    reader = Reader(path)
    try:
        reader.open()
        unpacked = [Path(str(each.path)) for each in reader.storage.storages]  # type: ignore[attr-defined]
        files, note = _open_all(path, unpacked, '')
    except (ReaderError, OSError, ValueError, LabError) as error:
        with suppress(Exception):
            reader.close()
        raise LabError(
            f'{str(path)!r} is compressed, and can not be unpacked: {error}.',
            todo='Is there another copy of it?',
        ) from error
    return Found(path, metadata.storage, files, metadata, note, names, False, [reader.close])


# --- What to say ---------------------------------------------------------------------------------


def _nothing_at(path: Path) -> LabError:
    beside: list[str] = []
    with suppress(OSError):
        beside = [each.name for each in path.parent.iterdir() if is_bag(each)]
    near = nearest(path.name, beside)
    if near:
        todo = f'Did you mean {str(path.parent / near)!r}?'
    elif beside:
        todo = f'There are these bags: {", ".join(sorted(beside)[:10])}.'
    else:
        todo = f'Record one: lab.record({str(path)!r}).'
    return LabError(f'There is no bag {str(path)!r}.', todo=todo)


def _no_bag(path: Path) -> LabError:
    if any(path.glob('*.bag')):
        return _ros_1(next(path.glob('*.bag')))
    inner = [each for each in path.iterdir() if each.is_dir() and is_bag(each)]
    if inner:
        return LabError(
            f'{str(path)!r} is no bag, but it holds some.', todo=f'Pass {str(inner[0])!r}.'
        )
    what = 'is empty' if not any(path.iterdir()) else f'holds no {FILE_NAME}, no .mcap, no .db3'
    return LabError(
        f'{str(path)!r} is no bag: the folder {what}.',
        todo='Pass the name of the folder that the bag is in.',
    )


def _ros_1(path: Path) -> LabError:
    return LabError(
        f'{str(path)!r} is a bag of ROS 1, which has another format.',
        todo=f'Convert it in a terminal: rosbags-convert --src {path} --dst {path.stem}',
    )
