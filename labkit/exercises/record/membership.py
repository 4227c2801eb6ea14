"""Share a learner's progress with a class, until the learner ends it.

A class has a folder, and in it a folder for each learner with one file: the learner's sheet (see
`class_sheet`). On a hub the hub makes these folders, each for one account; elsewhere any folder
that all computers reach will do, such as one on a network drive. After each change of the progress
file a thread rewrites the sheet, so a drive that does not answer delays no check.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import threading
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from labkit import settings
from labkit.errors import LabError
from labkit.exercises.record.class_sheet import FILE_NAME, sheet_text
from labkit.exercises.record.progress_store import progress_store
from labkit.files import locked, read_json, write_atomically
from labkit.views.card import Card

__all__ = ['follow_class', 'join_class', 'leave_class', 'wait_until_sent']

FOLDER_VARIABLE = 'LABKIT_CLASS_FOLDER'
# Set by JupyterHub.
_HUB_USER = 'JUPYTERHUB_USER'
LONGEST_NAME = 40
# Readable for teachers; on a hub, the folder around it keeps everybody else out.
_FILE_MODE, _FOLDER_MODE = 0o644, 0o755
# How long a notebook waits for another one to write, and at its end for its last sheet, s.
_LOCK_SEC, _LAST_SEC = 5.0, 2.0
_WHAT = (
    'Shared are the lesson that is open, and of each exercise and question: how often you tried, '
    'hints, whether the solution was shown, when you tried and passed; and of the last check what '
    'the course says about it; and what you guessed. Never your code, what it prints, or your '
    'answers to a quiz. All of it, as it is now, stands below.'
)


@dataclass(frozen=True)
class _Membership:
    """The location of a learner's sheet.

    Attributes:
        folder: The class's folder.
        name: Name of the learner's folder in it.
    """

    folder: Path
    name: str

    @property
    def sheet(self) -> Path:
        """Path of the sheet."""
        return self.folder / self.name / FILE_NAME


def join_class(name: str | None = None, *, folder: str | os.PathLike[str] | None = None) -> Card:
    """Share your progress with your class from now on, in all notebooks, until `leave_class()`.

    Without arguments it shows what is shared, if you have joined already.

    Args:
        name: Your name in the class; on a hub, by default your login name.
        folder: The folder of the class; by default `LABKIT_CLASS_FOLDER`, which a hub or your
            teacher sets.

    Returns:
        A card that shows what is shared, where, and how to end it.

    Raises:
        LabError: There is no such folder, it can't be written to, or the name is taken or invalid.
            Then nothing is shared.
    """
    if settings.audience().same_each_time:
        text = 'Nothing is shared while a program runs the notebook.'
        return Card('quiet', 'NOT SHARED', '', text=text)
    old = _read()
    wanted = old if old and name is None and folder is None else _wanted(name, folder)
    try:
        settings.state_dir().mkdir(parents=True, exist_ok=True)
        with _lock():
            if wanted != old:
                _make_folder(wanted)
            text = _send(wanted)
            if wanted != old:
                _save_or_undo(wanted)
                _remove_sheet(old)
    except OSError as error:
        raise LabError(
            f'Your progress can not be written into the folder of the class: {error}.',
            todo='Is the folder there, and may you write in it? Ask your teacher.',
        ) from error
    return _card(wanted, text)


def leave_class() -> Card:
    """Stop sharing your progress, and delete what was shared.

    Returns:
        A card that confirms it.

    Raises:
        LabError: The shared file can't be deleted. Sharing stops all the same.
    """
    old = _read()
    if old is None:
        return Card('quiet', 'NOT SHARED', '', text='You share nothing with a class.')
    try:
        _path().unlink(missing_ok=True)
        with _lock():
            _remove_sheet(old)
    except OSError as error:
        raise LabError(f'{str(old.sheet)!r} can not be deleted: {error}.') from error
    return Card('info', 'LEFT', 'your class', text=f'{str(old.sheet)!r} is deleted.')


# --- While notebooks are open --------------------------------------------------------------------


class _Sender:
    """Writes the sheet on request, in its own thread.

    Attributes:
        at: The lesson of this notebook, and when it was opened.
    """

    def __init__(self) -> None:
        self.at: tuple[str, datetime | None] = ('', None)
        self._changed = threading.Condition()
        # Number of requests, in all and done.
        self._requested = self._done = 0
        self._thread: threading.Thread | None = None

    def ask(self) -> None:
        """Write the sheet soon, if the learner has joined a class."""
        if not _path().exists():
            return
        with self._changed:
            self._requested += 1
            self._changed.notify_all()
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(
                    target=self._work, name='labkit class', daemon=True
                )
                self._thread.start()

    def wait(self, timeout_sec: float) -> bool:
        """Wait until all requests are done; return whether they are."""
        with self._changed:
            return self._changed.wait_for(lambda: self._done == self._requested, timeout_sec)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._done != self._requested)
                requested = self._requested
            with contextlib.suppress(OSError), _lock():  # the next sheet has it all
                membership = _read()
                if membership is not None:
                    _send(membership)
            with self._changed:
                self._done = requested
                self._changed.notify_all()


_sender = _Sender()


def follow_class(lesson: str) -> None:
    """Share progress from the notebook of a lesson, if the learner has joined a class."""
    if settings.audience().same_each_time:
        return
    if _sender.at[0] != lesson:
        _sender.at = (lesson, datetime.now(timezone.utc))
    if _sender.ask not in progress_store.after_change:
        progress_store.after_change.append(_sender.ask)
        atexit.register(_sender.wait, _LAST_SEC)
    _sender.ask()


def wait_until_sent(timeout_sec: float) -> bool:
    """Wait until the sheet is up to date; return whether it is."""
    return _sender.wait(timeout_sec)


# --- The class's folder --------------------------------------------------------------------------


def _send(membership: _Membership) -> str:
    """Write the sheet, and return its text."""
    text = sheet_text(progress_store.store.read()[0], *_sender.at)
    # Not through a link that another user of the shared folder may have made.
    write_atomically(membership.sheet, text.encode(), follow_links=False, mode=_FILE_MODE)
    return text


def _make_folder(wanted: _Membership) -> None:
    """Make the learner's folder, unless the hub has made it."""
    own = wanted.sheet.parent
    if not wanted.folder.is_dir():
        raise LabError(
            f'The folder of the class, {str(wanted.folder)!r}, is not there.',
            todo='Ask your teacher for the right one.',
        )
    if _made_by_hub(wanted) and own.is_dir():
        return
    try:
        own.mkdir()
    except FileExistsError:
        raise LabError(
            f'There is a {wanted.name!r} in {str(wanted.folder)!r} already.',
            todo='Choose another name. If it is yours, from another computer, delete it first.',
        ) from None
    own.chmod(_FOLDER_MODE)


def _remove_sheet(membership: _Membership | None) -> None:
    if membership is not None:
        membership.sheet.unlink(missing_ok=True)
        if not _made_by_hub(membership):
            with contextlib.suppress(OSError):  # not empty
                membership.sheet.parent.rmdir()


def _made_by_hub(membership: _Membership) -> bool:
    return membership.name == os.environ.get(_HUB_USER) and str(
        membership.folder
    ) == os.environ.get(FOLDER_VARIABLE)


def _wanted(name: str | None, folder: str | os.PathLike[str] | None) -> _Membership:
    place = folder if folder is not None else os.environ.get(FOLDER_VARIABLE)
    if not place:
        raise LabError(
            'Which class?', todo="Give its folder: lab.join_class('anna', folder='/mnt/class')"
        )
    called = name if name is not None else os.environ.get(_HUB_USER)
    if not called:
        raise LabError('What are you called there?', todo="Say it: lab.join_class('anna')")
    good = isinstance(called, str) and called.isprintable() and called == called.strip()
    if not good or '/' in called or called[:1] == '.' or len(called) > LONGEST_NAME:
        raise LabError(
            f'{called!r} can not be a name in a class.',
            todo=f'Choose one of up to {LONGEST_NAME} letters, without a / and a dot in front.',
        )
    return _Membership(Path(place).expanduser().absolute(), called)


# --- The learner's own file ----------------------------------------------------------------------


def _path() -> Path:
    return settings.state_dir() / 'class.json'


def _lock() -> contextlib.AbstractContextManager[None]:
    return locked(_path().with_suffix('.lock'), _LOCK_SEC)


def _save(membership: _Membership) -> None:
    data = {'folder': str(membership.folder), 'name': membership.name}
    write_atomically(_path(), json.dumps(data).encode())


def _save_or_undo(membership: _Membership) -> None:
    """Save a membership; where the home has no room, take back what was sent."""
    try:
        _save(membership)
    except OSError as error:
        _remove_sheet(membership)
        raise LabError(
            f'Nothing is shared, because {str(_path())!r} can not be written: {error}.',
            todo='Is the disk full? Delete what you do not need, and join again.',
        ) from error


def _read() -> _Membership | None:
    """Return the saved membership, None if there is none."""
    try:
        data = read_json(_path())
        return _Membership(Path(data['folder']), str(data['name']))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _card(membership: _Membership, text: str) -> Card:
    place = str(membership.sheet)
    if _made_by_hub(membership):
        readers = 'your teachers, and who runs the hub'
    else:
        readers = 'everybody who can open the folder of the class'
    return Card(
        'info',
        'SHARED',
        f'your progress, as {membership.name}',
        text=_WHAT,
        rows=(
            ('Where', place),
            ('Who can read it', readers),
            ('Until', '`lab.leave_class()`, which deletes it'),
        ),
        code=text,
    )
