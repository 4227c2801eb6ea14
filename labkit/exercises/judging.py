"""The one loop of a check: a stage makes what there is to see, and each clause judges it.

A stage is where an exercise takes place: the graph with the learner's nodes, a robot that they
drive, the commands that were sent, a bag, a package. It knows how to look at the learner's answer,
and nothing of the task. The clauses are the task, and know nothing of how it was looked at.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from labkit.exercises.verdict import Fail
from labkit.exercises.what_is_asked import Role

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Clause', 'Stage', 'find', 'judge', 'naming']

Seen = TypeVar('Seen')


class Clause(Generic[Seen]):
    """One thing that a task asks for. `Seen` is what the stage of the exercise shows.

    Attributes:
        words: What is asked for, where the task itself says it.
    """

    words: str

    @property
    def text(self) -> str:
        """What is asked for, in words of the task. The notebook says it in the same words."""
        return self.words

    @property
    def roles(self) -> dict[Role, str]:
        """What nodes of the learner's do in the graph to fulfil it, with the types.

        What an exercise looks for is read off its clauses.
        """
        return {}

    @property
    def listens(self) -> Collection[str]:
        """The topics of which it judges what was said before the check, too.

        Where the learner names them, it is their type, see `history`.
        """
        return ()

    def find(self, seen: Seen) -> None:
        """Look for what has to be there before anything is tried.

        Raises:
            NotAttempted: Nothing of the learner's shows an attempt.
            Fail: It is missing, or otherwise.
        """
        return

    def explain_nothing(self, probe: Probe) -> None:
        """Say why nothing of the learner's was found, though it was there.

        Raises:
            Fail: It has ended meanwhile.
        """
        return

    def judge(self, seen: Seen) -> str:
        """Judge what was seen.

        Returns:
            What was seen, in a sentence; `''` if there is nothing to say.

        Raises:
            Fail: It is not what the clause asks for.
        """
        return ''


class Stage(ABC, Generic[Seen]):
    """Where an exercise takes place. It makes what its clauses judge."""

    @abstractmethod
    def scenes(
        self, probe: Probe, clauses: Sequence[Clause[Seen]]
    ) -> AbstractContextManager[Iterable[Seen]]:
        """Give what there is to see, one scene after the other, for a `with` block.

        What it has started, opened or changed is as before when the block ends.

        Args:
            probe: The probe of the check.
            clauses: What the task asks for. It lets them look for what has to be there (`find`).

        Raises:
            NotAttempted: Nothing of the learner's shows an attempt.
            Fail: There is nothing to see.
        """

    def tell(self, seen: Sequence[Seen]) -> str:
        """Return what was seen, in a sentence, where that is not a matter of one clause."""
        return ''


def judge(probe: Probe, stage: Stage[Any], clauses: Sequence[Clause[Any]]) -> str:
    """Let each clause judge each scene.

    Returns:
        What was seen, in a sentence for each clause that has something to say.

    Raises:
        NotAttempted: Nothing of the learner's shows an attempt.
        Fail: A clause is not fulfilled; the exception names it.
    """
    seen: list[Any] = []
    said: list[str] = []
    with stage.scenes(probe, clauses) as scenes:
        for scene in scenes:
            said = []
            for clause in clauses:
                with naming(clause):
                    said.append(clause.judge(scene))
            seen.append(scene)
        said.append(stage.tell(seen))
    return '\n'.join(filter(None, said))


def find(clauses: Sequence[Clause[Seen]], seen: Seen) -> None:
    """Let each clause look for what has to be there."""
    for clause in clauses:
        with naming(clause):
            clause.find(seen)


@contextmanager
def naming(clause: Clause[Any], *, came_first: bool = False) -> Iterator[None]:
    """Let a Fail say which clause is not fulfilled."""
    try:
        yield
    except Fail as fail:
        fail.clause = fail.clause or clause.text
        fail.came_first = came_first
        raise
