"""The progress file.

It is replaced atomically, so a process killed at any moment leaves the old file or the new one. A
lock serializes kernels that write at once. A damaged file is kept aside and reported.
"""

from __future__ import annotations

import contextlib
import copy
import itertools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from labkit import settings
from labkit.files import locked, read_json, rename_to_free, write_atomically

__all__ = ['Store']

VERSION = 1
LOCK_TIMEOUT_SEC = 2.0
# A valid file has five levels. Python can read many more levels than it can write.
MAX_LEVELS = 50
# Exercises that were in another lesson once: that lesson, their name, and where they are now.
MOVED = [('theory', 'ears', 'talker_listener'), ('theory', 'mouth', 'talker_listener')]

Data = dict[str, Any]


class Store:
    """Read and change the progress file.

    Where a program runs the notebook, the learner's file is not used, and progress is kept in
    memory.

    Args:
        folder: Folder of the file; labkit's state folder if None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        in_memory = folder is None and settings.audience().same_each_time
        self._memory: Data | None = _empty() if in_memory else None

    @property
    def path(self) -> Path:
        """The file."""
        return (self._folder or settings.state_dir()) / 'progress.json'

    def read(self) -> tuple[Data, str]:
        """Return the data, and a note if something is wrong with the file."""
        if self._memory is not None:
            return copy.deepcopy(self._memory), ''
        try:
            return self._load(), ''
        except OSError as error:
            return _empty(), f'Your progress cannot be read: {error}'
        except ValueError:
            return self._update(lambda data: None)

    def update(self, change: Callable[[Data], None]) -> str:
        """Change the data, and return a note if something is wrong with the file.

        Args:
            change: Changes its argument.
        """
        if self._memory is not None:
            change(self._memory)
            return ''
        return self._update(change)[1]

    def damaged_files(self) -> list[Path]:
        """Return the damaged files that were kept aside."""
        return sorted(self.path.parent.glob('progress-damaged-*.json'))

    def _update(self, change: Callable[[Data], None]) -> tuple[Data, str]:
        note = ''
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with locked(self.path.with_suffix('.lock'), LOCK_TIMEOUT_SEC):
                try:
                    data = self._load()
                except ValueError:
                    note = self._keep_aside()
                    data = _empty()
                change(data)
                content = json.dumps(data, indent=1, sort_keys=True)
                write_atomically(self.path, content.encode())
        except OSError as error:
            return _empty(), f'Your progress could not be saved: {error}'
        return data, note

    def _load(self) -> Data:
        """Return the data of the file.

        Raises:
            ValueError: It is damaged.
            OSError: It can't be read.
        """
        try:
            data = read_json(self.path)
        except FileNotFoundError:
            return _empty()
        if not _is_valid(data) or _levels(data) > MAX_LEVELS:
            raise ValueError('not a progress file')
        _follow_moves(data['lessons'])
        return data  # type: ignore[no-any-return]

    def _keep_aside(self) -> str:
        for number in itertools.count(1):
            aside = self.path.with_name(f'progress-damaged-{number}.json')
            with contextlib.suppress(FileExistsError):
                rename_to_free(self.path, aside)
                break
        return (
            f'The progress file was damaged. It is kept as {aside.name} in {aside.parent}, and '
            'counting starts anew.'
        )


def _empty() -> Data:
    return {'version': VERSION, 'lessons': {}}


def _follow_moves(lessons: Data) -> None:
    """Put what was done in the lesson where an exercise was to the one where it is now."""
    for before, name, now in MOVED:
        entry = lessons.get(before, {}).get('exercises', {}).pop(name, None)
        if entry is not None:
            lessons.setdefault(now, {}).setdefault('exercises', {}).setdefault(name, entry)


def _is_valid(data: object) -> bool:
    if not isinstance(data, dict) or not isinstance(data.get('lessons'), dict):
        return False
    return all(
        isinstance(lesson, dict)
        and all(
            isinstance(entry, dict)
            for kind in ('exercises', 'questions', 'guesses')
            for entry in _values(lesson.get(kind, {}))
        )
        for lesson in data['lessons'].values()
    )


def _levels(data: object) -> int:
    """Return the depth of nesting; not recursive, as it may be very deep."""
    count, level = 0, [data]
    while level:
        count += 1
        level = [
            inner
            for outer in level
            if isinstance(outer, (dict, list))
            for inner in (outer.values() if isinstance(outer, dict) else outer)
        ]
    return count


def _values(group: object) -> list[object]:
    return list(group.values()) if isinstance(group, dict) else [None]
