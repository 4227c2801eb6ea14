"""Record the learner's checks, hints, solutions and answers."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime, timezone
from typing import Any

from labkit.exercises.record.progress_file import Store

__all__ = ['GROUPS', 'ProgressStore', 'number_of', 'progress_store', 'text_of']

# Where the file has each kind of entry.
GROUPS = {'exercise': 'exercises', 'question': 'questions', 'guess': 'guesses'}
# Most characters to keep of an answer, and of the reason of a verdict.
LONGEST_ANSWER = 200
LONGEST_WHY = 1000


class ProgressStore:
    """Records what the learner does. Each `note_...` returns a note on the file, usually `''`.

    Attributes:
        after_change: Called after each change.
    """

    def __init__(self, store: Store | None = None) -> None:
        self.store = store or Store()
        self.after_change: list[Callable[[], None]] = []

    def note_check(
        self,
        lesson: str,
        name: str,
        outcome: str,
        *,
        clause: str = '',
        why: str = '',
        mistake: str = '',
    ) -> str:
        """Record the outcome of a check; NOT ATTEMPTED does not count.

        Args:
            lesson: The lesson.
            name: The exercise.
            outcome: PASS, FAIL, ERROR or NOT ATTEMPTED.
            clause: The part of the task that is not fulfilled.
            why: The misconception behind it.
            mistake: Id of the misconception, if it has one.
        """
        if not lesson or outcome == 'NOT ATTEMPTED':
            return ''

        def change(entry: dict[str, Any]) -> None:
            _note_try(entry, outcome == 'PASS')
            entry['last'], entry['clause'], entry['why'] = outcome, clause, why[:LONGEST_WHY]
            entry['mistake'] = mistake

        return self._change(lesson, 'exercises', name, change)

    def note_hint(self, lesson: str, name: str, number: int) -> str:
        """Record that a hint was shown."""

        def change(entry: dict[str, Any]) -> None:
            entry['hints'] = max(number, number_of(entry.get('hints')))

        return self._change(lesson, 'exercises', name, change)

    def note_solution(self, lesson: str, name: str) -> str:
        """Record that the solution was shown."""
        return self._change(lesson, 'exercises', name, lambda entry: entry.update(solution=True))

    def note_answer(
        self, lesson: str, quiz: str, number: int, right: bool, given: str = ''
    ) -> str:
        """Record an answer to a question of a quiz."""

        def change(entry: dict[str, Any]) -> None:
            _note_try(entry, right)
            entry['given'], entry['last'] = given[:LONGEST_ANSWER], right

        return self._change(lesson, 'questions', f'{quiz}.{number}', change)

    def note_guess(self, lesson: str, name: str, index: int) -> str:
        """Record a guess: which option, from 0, and whether the answer was known by then."""

        def change(entry: dict[str, Any]) -> None:
            _note_try(entry, right=False)
            entry['after' if entry.get('told') is True else 'before'] = index

        return self._change(lesson, 'guesses', name, change)

    def note_told(self, lesson: str, name: str) -> str:
        """Record that the answer to a guess was shown: from now on it is known."""
        return self._change(lesson, 'guesses', name, lambda entry: entry.update(told=True))

    def guess(self, lesson: str, name: str) -> object:
        """Return what was guessed last before the answer was known, as the file has it."""
        data, _ = self.store.read()
        return data['lessons'].get(lesson, {}).get('guesses', {}).get(name, {}).get('before')

    def answers(self, lesson: str, quiz: str) -> dict[int, tuple[str, bool]]:
        """Return the last answer to each question of a quiz, and whether it was right."""
        data, _ = self.store.read()
        found = {}
        for name, entry in data['lessons'].get(lesson, {}).get('questions', {}).items():
            start, _, number = name.rpartition('.')
            given, right = entry.get('given'), entry.get('last')
            if (
                start == quiz
                and number.isdecimal()
                and isinstance(given, str)
                and isinstance(right, bool)
            ):
                found[int(number)] = (given, right)
        return found

    def _change(
        self, lesson: str, kind: str, name: str, change: Callable[[dict[str, Any]], None]
    ) -> str:
        if not lesson:
            return ''
        note = self.store.update(
            lambda data: change(
                data['lessons'].setdefault(lesson, {}).setdefault(kind, {}).setdefault(name, {})
            )
        )
        for action in self.after_change:
            action()
        return note


def number_of(value: object) -> int:
    """Return a count from the file, 0 if it is invalid."""
    return value if isinstance(value, int) else 0


def text_of(value: object) -> str:
    """Return a text from the file, '' if it is invalid."""
    return value if isinstance(value, str) else ''


def _note_try(entry: dict[str, Any], right: bool) -> None:
    now = datetime.now(timezone.utc).isoformat(timespec='seconds')
    entry['tries'] = number_of(entry.get('tries')) + 1
    entry.setdefault('first_try', now)
    entry['last_try'] = now
    if right:
        entry.setdefault('passed_at', now)


progress_store = ProgressStore()
