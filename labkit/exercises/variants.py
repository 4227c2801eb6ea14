"""Exercises with different numbers and names for each learner of a class.

A function makes variants of the notebook's exercise, with other numbers and names in task, check,
hints and solution. A seed, such as the learner's name, chooses them. Without a seed there is only
the notebook's exercise.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail, NotAttempted, Outcome, Verdict
from labkit.views.card import Card

if TYPE_CHECKING:
    from labkit.exercises.exercise import Exercise

__all__ = ['Variants', 'variants_card', 'varied']

Values = Mapping[str, Any]
ANOTHER = 'This answers a variant other than yours'


@dataclass(frozen=True, eq=False)
class Variants:
    """The variants of an exercise.

    Attributes:
        usual: The notebook's exercise.
        make: Makes a variant from numbers and names.
        guess: Looks at the learner's nodes, and returns likely arguments of `make`, or None. The
            check of that variant then decides.
        choices: Possible arguments of `make`, so far apart that no usual slip leads from one to
            another.
    """

    usual: Exercise
    make: Callable[..., Exercise]
    guess: Callable[[Probe], Values | None]
    choices: Mapping[str, Sequence[Any]]
    _made: dict[str, Exercise] = field(default_factory=dict)

    def values(self, seed: str) -> dict[str, Any]:
        """Return the arguments of `make` for a seed: the same on each machine."""
        name = self.usual.name
        return {
            key: among[_number(f'{name} {key} {seed}') % len(among)]
            for key, among in self.choices.items()
        }

    def of(self, seed: str) -> Exercise:
        """Return the exercise for a seed; for `''` the notebook's."""
        exercise = self.make(**self.values(seed)) if seed else self.usual
        exercise.variants, exercise.seed = self, seed
        return exercise

    def recognise(self, mine: Exercise, verdict: Verdict) -> Verdict:
        """Return a FAIL that says so if the answer passes another variant, else `verdict`.

        Args:
            mine: The learner's variant.
            verdict: The verdict of its own check.
        """
        if verdict.outcome not in (Outcome.FAIL, Outcome.NOT_ATTEMPTED):
            return verdict
        other = self._other(mine)
        if other is None or not other.examine().passed:
            return verdict
        told = Verdict(
            Outcome.FAIL,
            mine.name,
            expected=mine.task,
            seen=other.task,
            why=f'{ANOTHER}: it would be right for somebody else in your class, or in the '
            'published course.',
            todo=f'Do it with your own numbers and names: `lesson.{mine.name}` tells them.',
        )
        if mine.once:
            # The check of the other variant has used up the evidence.
            mine.keep(told)
        return told

    def _other(self, mine: Exercise) -> Exercise | None:
        """Return the other variant that the answer seems to be for, if any."""
        try:
            with Probe(mine.name, mine.scope) as probe:
                values = self.guess(probe)
        except (Fail, NotAttempted):
            return None
        if values is None or not self._is_possible(values):
            return None
        # Kept, because a check may use up the evidence.
        other = self._made.setdefault(repr(sorted(values.items())), self.make(**values))
        if other.task == mine.task:
            return None
        scope = mine.scope
        other.scope = replace(
            other.scope,
            known=scope.known | set(other.scope.topics),
            given=scope.given,
            earlier=scope.earlier,
            of_lesson=scope.of_lesson | other.scope.roles.keys(),
        )
        return other

    def _is_possible(self, values: Values) -> bool:
        chosen = all(value in self.choices[key] for key, value in values.items())
        return chosen or self.make(**values).task == self.usual.task


def varied(
    usual: Exercise,
    make: Callable[..., Exercise],
    guess: Callable[[Probe], Values | None],
    **choices: Sequence[Any],
) -> Exercise:
    """Return this learner's variant of an exercise; arguments as those of `Variants`."""
    return Variants(usual, make, guess, choices).of(settings.variant_seed())


def variants_card(exercises: Sequence[Exercise]) -> Card | None:
    """Return a card with this learner's variants of a lesson's tasks, None if there are none."""
    rows = [
        (exercise.name, '\n'.join(clause.text for clause in exercise.clauses))
        for exercise in exercises
        if exercise.seed
    ]
    if not rows:
        return None
    text = (
        'In this class everybody has numbers and names of their own. What stands here goes '
        'before what the notebook says. The name of an exercise in a cell, such as '
        f'`lesson.{rows[0][0]}`, shows it again.'
    )
    seed = next(exercise.seed for exercise in exercises if exercise.seed)
    return Card('info', 'YOUR VARIANT', seed, text=text, rows=rows)


def _number(text: str) -> int:
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], 'big')
