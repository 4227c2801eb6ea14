"""What a task asks of a bag, clause by clause, and how a bag is judged by it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError, nearest
from labkit.exercises import Fail, NotAttempted, Probe
from labkit.exercises.clauses import Clause
from labkit.exercises.clauses.base import naming
from labkit.exercises.learner_errors import last_cell

if TYPE_CHECKING:
    from labkit.background.session import Session
    from labkit.bags.reader import Bag, BagMessage

__all__ = ['Found', 'Is', 'IsThere', 'OnlyTopic', 'judge_bag']

# Topics that every node has, and that are recorded where all are.
_OF_EVERY_NODE = ('/parameter_events', '/rosout')

# Path of a bag -> when the bag was written that was judged last.
_judged: dict[str, float] = {}


@dataclass(frozen=True)
class Found:
    """A bag, as the clauses look at it.

    Attributes:
        bag: The bag.
        messages: Its messages on the topic that it should have.
    """

    bag: Bag
    messages: Sequence[BagMessage]


@dataclass(frozen=True)
class IsThere(Clause):
    """A bag is in its folder, and finished.

    Attributes:
        path: The folder.
    """

    path: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'the bag `{self.path}` is there, and its recording has ended'


@dataclass(frozen=True)
class OnlyTopic(Clause):
    """A bag has one topic.

    Attributes:
        topic: Full name of the topic.
        msg_type: Name of its type.
    """

    topic: str
    msg_type: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'it has the topic `{self.topic}` (`{self.msg_type}`), and no other one'

    def look(self, bag: Bag) -> None:
        """Raise Fail if it has others, or not this one."""
        names = [topic.name for topic in bag.topics]
        seen = f'topics: {", ".join(names)}' if names else 'no topic at all'
        if self.topic not in names:
            near = nearest(self.topic, names)
            why = 'What nobody publishes while it is recorded is not in a bag.'
            if names:
                why = 'What was recorded is another topic.'
            raise Fail(
                f'the topic {self.topic}',
                seen,
                why=why,
                todo=f'{near} is close, and is not {self.topic}. Record {self.topic!r}.'
                if near
                else f'Record {self.topic!r}, while a node publishes on it.',
            )
        others = [name for name in names if name != self.topic]
        if others:
            each = set(others) & set(_OF_EVERY_NODE)
            raise Fail(
                f'the topic {self.topic} alone',
                seen,
                why='All that is published was recorded: every node publishes on some topics '
                'besides its own.'
                if each
                else 'More was chosen than the one topic.',
                todo=f'Name the topic: lab.record(..., {self.topic!r}, ...)',
            )
        found = bag.topic(self.topic)
        if found.msg_type != self.msg_type:
            raise Fail(
                f'messages of type {self.msg_type} on {self.topic}',
                f'messages of type {found.msg_type}',
                why='The node that publishes there takes another type.',
                todo='Compare the type with that of the task, letter by letter.',
            )
        if not found.count:
            raise Fail(
                f'messages of {self.topic}',
                'the topic is there, without a message',
                why='The recording had ended before the first message came.',
                todo='Wait for messages before you stop it: recording.wait_for(count)',
            )


@dataclass(frozen=True)
class Is(Clause):
    """What else a task asks of the bag.

    Attributes:
        words: What is asked for, in words of the task.
        look: Raises Fail if the bag is otherwise.
    """

    words: str
    look: Callable[[Found], None]

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words


def judge_bag(probe: Probe, clauses: Sequence[Clause]) -> str:
    """Open the bag that clauses are about, and judge each of them.

    Returns:
        What is in it, in a sentence.

    Raises:
        NotAttempted: There is no bag that may be meant.
        Fail: A clause is not fulfilled; the exception names it.
    """
    where, only, *others = clauses
    assert isinstance(where, IsThere) and isinstance(only, OnlyTopic)
    with naming(where):
        _refuse_old(where.path)
        bag = _opened(where.path)
    with bag:
        with naming(only):
            only.look(bag)
        found = Found(bag, list(bag.messages(only.topic)))
        for clause in others:
            assert isinstance(clause, Is)
            with naming(clause):
                clause.look(found)
        return f'{where.path} has {len(found.messages)} messages of {only.topic}, and no others.'


def _refuse_old(path: str) -> None:
    """Raise what the last cell has raised, if the bag is still the one that was judged before."""
    written = _written(Path(path))
    error = last_cell.learner_error()
    if error is not None and written and _judged.get(path) == written:
        raise error
    _judged[path] = written


def _opened(path: str) -> Bag:
    """Return the bag at a path, finished.

    Raises:
        NotAttempted: There is none, and none that may be meant.
        Fail: It is not finished, or is somewhere else.
    """
    from labkit.bags.reader import open_bag

    _refuse_going_on(path)
    other = _misplaced(Path(path))
    if other:
        raise Fail(
            f'the bag {path}',
            f'the bag {other}, which is newer' if Path(path).exists() else f'the bag {other}',
            why='A bag is in the folder that the recording is given, from the folder of this '
            'notebook on.',
            todo=f'Write {path!r}, letter by letter.',
        )
    if not Path(path).exists():
        raise NotAttempted
    try:
        bag = open_bag(path)
    except LabError as error:
        why = 'It can not be read.'
        raise Fail(f'the bag {path}', error.message, why=why, todo=error.todo) from error
    if bag.note:
        note = bag.note
        bag.close()
        raise Fail(
            f'the bag {path}, finished',
            note,
            why='The recording was cut off, before it could write metadata.yaml.',
            todo='Record it once more, and end the recording with stop().',
        )
    return bag


def _refuse_going_on(path: str) -> None:
    from labkit.background.session import going_on
    from labkit.bags.recorder import Recording

    for session in going_on(Recording):
        if _path_of(session).resolve() == Path(path).resolve():
            raise Fail(
                f'the bag {path}, finished',
                f'the recording of {path} goes on',
                why='A recording goes on until it is ended: what comes now is recorded, too.',
                todo='Call its stop() when enough was recorded, or record in a with block.',
            )


def _path_of(session: Session) -> Path:
    path: Any = getattr(session, 'path', '')
    return Path(path)


def _misplaced(wanted: Path) -> str:
    """Return a bag that may be meant for the wanted one, and is newer; '' if there is none."""
    from labkit.bags.finding import is_bag

    since = _written(wanted)
    folders = [wanted.parent, Path()]
    beside = [each for folder in folders if folder.is_dir() for each in folder.iterdir()]
    for each in beside:
        same = each.name == wanted.name and each.parent != wanted.parent
        near = nearest(wanted.name, [each.name]) and each.name != wanted.name
        if (same or near) and is_bag(each) and _written(each) > since:
            return str(each)
    return ''


def _written(path: Path) -> float:
    """Return when a bag was begun, as far as its folder tells; 0 if it is not there."""
    try:
        return max((each.stat().st_mtime for each in path.iterdir()), default=0.0)
    except OSError:
        return 0.0
