"""What a task asks of a bag, clause by clause, and how a bag is judged by it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError, nearest
from labkit.exercises import Clause, Fail, NotAttempted, Probe, Stage, words_of
from labkit.exercises.figures import many
from labkit.exercises.learner_errors import last_cell

if TYPE_CHECKING:
    from labkit.background.session import Session
    from labkit.bags.reader import Bag, BagMessage

__all__ = ['Found', 'InABag', 'IsThere', 'OnlyTopic']

WORDS = words_of(__file__)

# Topics that every node has, and that are recorded where all are.
_OF_EVERY_NODE = ('/parameter_events', '/rosout')

# Path of a bag -> when the bag was written that was judged last.
_judged: dict[str, float] = {}

NOTHING = WORDS.mistake('bag/nothing')
OTHER_TOPIC = WORDS.mistake('bag/other-topic')
ALL_TOPICS = WORDS.mistake('bag/all-topics')
MORE_TOPICS = WORDS.mistake('bag/more-topics')
OTHER_TYPE = WORDS.mistake('bag/other-type')
NO_MESSAGE = WORDS.mistake('bag/no-message')
ELSEWHERE = WORDS.mistake('bag/elsewhere')
UNREADABLE = WORDS.mistake('bag/unreadable')
CUT_OFF = WORDS.mistake('bag/cut-off')
GOES_ON = WORDS.mistake('bag/goes-on')


@dataclass
class Found:
    """A bag, as the clauses look at it.

    Attributes:
        opened: The bag, once `IsThere` has opened it.
        messages: Its messages on the topic that it should have, once `OnlyTopic` has read them.
    """

    opened: Bag | None = None
    messages: Sequence[BagMessage] = ()

    @property
    def bag(self) -> Bag:
        """The bag."""
        assert self.opened is not None
        return self.opened


@dataclass(frozen=True)
class IsThere(Clause[Found]):
    """A bag is in its folder, and finished.

    Attributes:
        path: The folder.
        source: The folder of a bag that the lesson makes, which is needed for it.
    """

    path: str
    source: str = ''

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(path=self.path).clause('is-there')

    def judge(self, found: Found) -> str:
        """Open it."""
        if self.source and not Path(self.source).is_dir():
            raise NotAttempted(f'There is no bag {self.source} yet. Run the cell that makes it.')
        _refuse_old(self.path)
        found.opened = _opened(self.path)
        return ''


@dataclass(frozen=True)
class OnlyTopic(Clause[Found]):
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
        return WORDS.of(topic=self.topic, msg_type=self.msg_type).clause('only-topic')

    def judge(self, found: Found) -> str:
        """Look at its topics, and read the messages."""
        names = [topic.name for topic in found.bag.topics]
        others = {*names} - {self.topic}
        if self.topic not in names or others:
            mistake = ALL_TOPICS if others >= {*_OF_EVERY_NODE} else MORE_TOPICS
            if self.topic not in names:
                mistake = OTHER_TOPIC if names else NOTHING
            raise Fail(
                f'the topic {self.topic} alone',
                f'topics: {", ".join(names)}' if names else 'no topic at all',
                mistake.of(topic=self.topic),
            )
        topic = found.bag.topic(self.topic)
        if topic.msg_type != self.msg_type:
            raise Fail(
                f'messages of type {self.msg_type} on {self.topic}',
                f'messages of type {topic.msg_type}',
                OTHER_TYPE,
            )
        if not topic.count:
            raise Fail(
                f'messages of {self.topic}', 'the topic is there, without a message', NO_MESSAGE
            )
        found.messages = list(found.bag.messages(self.topic))
        return ''


@dataclass(frozen=True)
class InABag(Stage[Found]):
    """A bag that the learner has recorded.

    Attributes:
        path: Its folder.
        topic: Full name of the topic that it should have.
    """

    path: str
    topic: str

    @contextmanager
    def scenes(self, probe: Probe, clauses: Sequence[Clause[Found]]) -> Iterator[Sequence[Found]]:
        """Give the bag, which `IsThere` opens."""
        found = Found()
        try:
            yield [found]
        finally:
            if found.opened is not None:
                found.opened.close()

    def tell(self, seen: Sequence[Found]) -> str:
        """Say what is in it."""
        count = len(seen[0].messages)
        return f'{self.path} has {many(count, "message")} of {self.topic}, and no others.'


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
            ELSEWHERE.of(path=path),
        )
    if not Path(path).exists():
        raise NotAttempted
    try:
        bag = open_bag(path)
    except LabError as error:
        raise Fail(f'the bag {path}', error.message, UNREADABLE.then(error.todo)) from error
    if bag.note:
        note = bag.note
        bag.close()
        raise Fail(f'the bag {path}, finished', note, CUT_OFF)
    return bag


def _refuse_going_on(path: str) -> None:
    from labkit.background.session import going_on
    from labkit.bags.recorder import Recording

    for session in going_on(Recording):
        if _path_of(session).resolve() == Path(path).resolve():
            raise Fail(
                f'the bag {path}, finished',
                f'the recording of {path} goes on',
                GOES_ON,
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
