"""The table of kinds: how a check might be taken in, for each clause of each exercise.

A check has been taken in by answers of eight kinds, see `KINDS`. For each clause and each kind
`<lesson>.yaml` says which wrong answer of that kind is refused, or why there can be none:

- `not to a namesake`: a wrong answer to this exercise, in the proofs;
- `odds/ones: ends after ten`: one to another exercise that has a clause of the same class, where
  the class alone judges;
- `program: the first thirty only`: a program of `wrong_programs`, which is refused for whatever
  is drawn for this clause;
- a sentence, which ends with a full stop: why it can't occur there.

What holds for each clause of a class, and of those made of it, stands once, in `usual.yaml`. A
class of a lesson is named with it there: `bags/OnlyTopic`.
`python tests/lessons/kinds` prints the table, and what is missing in it.
"""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import wrong_programs
import yaml
from cases import answers_of

from labkit.exercises import Clause, Exercise, Outcome
from labkit.exercises.found_lessons import all_lessons, load

__all__ = ['KINDS', 'fields', 'main', 'stale', 'table_of', 'trouble']

HERE = Path(__file__).resolve().parent
KINDS = {
    'A': 'names and texts that are not drawn',
    'B': 'moments before or after the look',
    'C': 'values beyond the usual bounds',
    'D': 'order and overlap',
    'E': 'more rounds than the check has',
    'F': 'the ends, and what is not looked at',
    'G': 'real time that passes after the check',
    'H': 'another place',
}
FEWEST_WORDS = 5


@functools.cache
def table_of(lesson: str) -> dict[str, dict[str, dict[str, str]]]:
    """Return what the file of a lesson says, by exercise, clause and kind; empty without one."""
    path = HERE / f'{lesson}.yaml'
    return yaml.safe_load(path.read_text(encoding='utf-8')) if path.is_file() else {}


@functools.cache
def _usual() -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = yaml.safe_load((HERE / 'usual.yaml').read_text())
    return found


def fields(exercise: Exercise, clause: Clause[Any]) -> dict[str, str]:
    """Return the fields of a clause, by kind: its own ones, and the usual ones of its class."""
    own = table_of(exercise.lesson).get(exercise.name, {}).get(clause.text, {})
    usual = _usual()
    classes = map(_key, reversed(type(clause).__mro__))
    known = {kind: said for name in classes for kind, said in usual.get(name, {}).items()}
    return {**known, **own}


def _key(kind: type) -> str:
    """Return the key of a class in `usual.yaml`; one of a lesson has the lesson in front."""
    lesson = kind.__module__.partition('labkit.lessons.')[2].partition('.')[0]
    return kind.__name__ if lesson.startswith('_') or not lesson else f'{lesson}/{kind.__name__}'


def stale(exercise: Exercise) -> list[str]:
    """Return the clauses of a table that the exercise does not have."""
    known = {clause.text for clause in exercise.clauses}
    return [text for text in table_of(exercise.lesson).get(exercise.name, {}) if text not in known]


def trouble(exercise: Exercise, clause: Clause[Any], kind: str) -> str:
    """Return what is wrong with a field; `''` if nothing is."""
    said = fields(exercise, clause).get(kind, '')
    if not said:
        return 'no field'
    if said.endswith('.'):
        return '' if len(said.split()) >= FEWEST_WORDS else f'too short: {said}'
    place, colon, name = said.partition(': ')
    if place == 'program':
        known = wrong_programs.CLAUSES.get(exercise.name)
        return '' if known and name in wrong_programs.table(exercise.name, known) else said
    if not colon:
        return '' if said in _wrong(exercise) else said
    lesson, _, other = place.partition('/')
    found: Exercise = getattr(load(lesson), other)
    same = any(isinstance(clause, type(each)) for each in found.clauses)
    return '' if same and name in _wrong(found) else said


def _wrong(exercise: Exercise) -> set[str]:
    return {each.name for each in answers_of(exercise) if each.outcome is not Outcome.PASS}


def main(lessons: Sequence[str]) -> None:
    """Print the table of some lessons, or of all, and count its fields."""
    count = Counter[str]()
    for lesson in all_lessons():
        if lessons and lesson.name not in lessons:
            continue
        for exercise in lesson.exercises:
            for clause in exercise.clauses:
                print(f'\n{lesson.name}/{exercise.name}: {clause.text}')
                for kind in KINDS:
                    said = fields(exercise, clause).get(kind, '')
                    wrong = trouble(exercise, clause, kind)
                    what = 'missing' if wrong else 'sentence' if said.endswith('.') else 'answer'
                    count[what] += 1
                    print(f'  {kind} {"? " * bool(wrong)}{said}')
    print('\n' + ', '.join(f'{what}: {number}' for what, number in sorted(count.items())))
