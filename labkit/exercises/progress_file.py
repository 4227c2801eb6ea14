"""The file that remembers a learner's progress, and survives what happens to files.

It is replaced as a whole, so a process that is killed at any moment leaves the old file or the
new one. Two kernels that write at once wait for each other at a lock. A damaged file is kept
aside, and said so.
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
from labkit.files import locked, rename_to_free, write_atomically

__all__ = ['Store']

VERSION = 1
LOCK_TIMEOUT_SEC = 2.0

Data = dict[str, Any]


class Store:
    """Read and change the progress file.

    Where a program runs the notebook, nothing is read from the learner's file or written to it:
    what happens is remembered for as long as the kernel runs.

    Args:
        folder: Where the file is; labkit's state folder if None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        unkept = folder is None and settings.audience().same_each_time
        self._memory: Data | None = _empty() if unkept else None

    @property
    def path(self) -> Path:
        """The file."""
        return (self._folder or settings.state_dir()) / 'progress.json'

    def read(self) -> tuple[Data, str]:
        """Return what is known, and a note if something is wrong with the file."""
        if self._memory is not None:
            return copy.deepcopy(self._memory), ''
        try:
            return self._load(), ''
        except OSError as error:
            return _empty(), f'Your progress cannot be read: {error}'
        except ValueError:
            return self._update(lambda data: None)

    def update(self, change: Callable[[Data], None]) -> str:
        """Change what is known.

        Args:
            change: Changes the data it is called with.

        Returns:
            A note if something is wrong with the file, else `''`. It never raises.
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
        """Return what the file holds.

        Raises:
            ValueError: It is damaged.
            OSError: It can't be read.
        """
        try:
            text = self.path.read_text(encoding='utf-8')
        except FileNotFoundError:
            return _empty()
        data = json.loads(text)
        if not _is_sound(data):
            raise ValueError('not a progress file')
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


def _is_sound(data: object) -> bool:
    """Tell whether data has the form that the rest of labkit relies on."""
    if not isinstance(data, dict) or not isinstance(data.get('lessons'), dict):
        return False
    return all(
        isinstance(lesson, dict)
        and all(
            isinstance(entry, dict)
            for kind in ('exercises', 'questions')
            for entry in _values(lesson.get(kind, {}))
        )
        for lesson in data['lessons'].values()
    )


def _values(group: object) -> list[object]:
    return list(group.values()) if isinstance(group, dict) else [None]
