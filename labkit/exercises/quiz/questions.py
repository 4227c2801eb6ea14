"""Kinds of quiz questions, which judge and explain answers."""

from __future__ import annotations

import contextlib
import math
import re
import zlib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product, zip_longest
from typing import Any

from labkit.errors import LabError, nearest
from labkit.exercises.quiz import spelling

__all__ = [
    'LETTERS',
    'Choice',
    'Feedback',
    'Number',
    'Option',
    'Question',
    'Several',
    'Word',
    'question_of',
    'right',
    'wrong',
]

LETTERS = 'abcdefghijklmnopqrstuvwxyz'


@dataclass(frozen=True)
class Option:
    """An answer to choose, made by `right` or `wrong`, with an explanation `why`."""

    text: str
    why: str
    is_right: bool


def right(text: str, why: str) -> Option:
    """Return a right answer with its explanation."""
    return Option(text, why, True)


def wrong(text: str, why: str) -> Option:
    """Return a wrong answer with its explanation."""
    return Option(text, why, False)


@dataclass(frozen=True)
class Feedback:
    """The verdict on an answer.

    Attributes:
        is_right: Whether it is right.
        lines: Pairs of a label, such as `'b'`, and an explanation.
    """

    is_right: bool
    lines: Sequence[tuple[str, str]]


class Question:
    """A question; one of `Choice`, `Several`, `Number` and `Word`.

    Attributes:
        text: The question.
        kind: Type of the form's field: `'radio'`, `'checkbox'` or `'text'`.
        how: The expected kind of answer, in words.
    """

    text: str
    kind = 'text'
    how = ''

    def labels(self) -> list[str]:
        """Return the answers to choose from, in the order shown."""
        return []

    def example(self) -> str:
        """Return an example of an answer as code."""
        return "'b'"

    def judge(self, given: Any) -> Feedback:
        """Judge and explain an answer.

        Raises:
            LabError: The answer is invalid.
        """
        raise NotImplementedError


class _Options(Question):
    """A question with answers to choose from.

    Args:
        text: The question.
        options: The answers, made by `right` and `wrong`.
    """

    def __init__(self, text: str, *options: Option) -> None:
        self.text = text
        # Authors usually write the right one first, so another order is shown, always the same.
        self.options = sorted(options, key=lambda option: zlib.crc32(option.text.encode()))

    def labels(self) -> list[str]:
        """Return the answers to choose from, in the order shown."""
        return [option.text for option in self.options]

    def _chosen(self, given: Any) -> list[int]:
        if isinstance(given, (list, tuple, set)) and given:
            return sorted({number for one in given for number in self._chosen(one)})
        text = spelling.tidy(str(given)).casefold()
        labels = [spelling.tidy(label).casefold() for label in self.labels()]
        if text in labels:
            return [labels.index(text)]
        known = LETTERS[: len(labels)]
        # Also 'b)', 'a, c' and 'a and c'.
        letters = re.sub(r'\band\b|[\s,;.+&()]', '', text)
        if not letters or not set(letters) <= set(known):
            raise LabError(
                f'The answer must be a letter, {known[0]} to {known[-1]}, but it is {given!r}.',
                todo=f'For instance: {self.example()}',
            )
        return sorted({known.index(letter) for letter in letters})

    def _explain(self, numbers: Iterable[int]) -> list[tuple[str, str]]:
        return [(LETTERS[number], self.options[number].why) for number in numbers]


class Choice(_Options):
    """A question with one right answer."""

    kind = 'radio'
    how = 'one answer'

    def judge(self, given: Any) -> Feedback:
        """Judge and explain an answer."""
        chosen = self._chosen(given)
        if len(chosen) != 1:
            raise LabError(f'This question has one answer, but {given!r} names {len(chosen)}.')
        if not self.options[chosen[0]].is_right:
            return Feedback(False, self._explain(chosen))
        others = [number for number in range(len(self.options)) if number not in chosen]
        return Feedback(True, self._explain(chosen + others))


class Several(_Options):
    """A question with any number of right answers, all of which must be chosen, and no others."""

    kind = 'checkbox'
    how = 'all that are right'

    def example(self) -> str:
        """Return an example of an answer as code."""
        return "'ac'"

    def judge(self, given: Any) -> Feedback:
        """Judge and explain an answer."""
        chosen = self._chosen(given)
        wanted = [number for number, option in enumerate(self.options) if option.is_right]
        if chosen == wanted:
            return Feedback(True, self._explain(range(len(self.options))))
        lines = self._explain(number for number in chosen if number not in wanted)
        missing = len([number for number in wanted if number not in chosen])
        if missing:
            count = 'One right answer is' if missing == 1 else f'{missing} right answers are'
            lines.append(('missing', f'{count} not among those you chose.'))
        return Feedback(False, lines)


@dataclass(frozen=True)
class Number(Question):
    """A question whose answer is a number.

    Attributes:
        text: The question.
        answer: The number, or a function that determines it from the live graph.
        why: Explanation of the right answer.
        otherwise: Advice for any other answer.
        wrong: Typical wrong numbers, with explanations.
        explain: Explains a wrong number from the live graph, '' if it can't.
        tolerance: Relative tolerance.
        unit: The unit, such as `'Hz'`.
    """

    text: str
    answer: float | Callable[[], float]
    why: str
    otherwise: str
    wrong: Mapping[float, str] = field(default_factory=dict)
    explain: Callable[[float], str] = lambda number: ''
    tolerance: float = 0.0
    unit: str = ''

    @property
    def how(self) -> str:  # type: ignore[override]
        """The expected kind of answer, in words."""
        return f'a number, in {self.unit}' if self.unit else 'a number'

    def example(self) -> str:
        """Return an example of an answer as code."""
        return '2.5'

    def judge(self, given: Any) -> Feedback:
        """Judge and explain an answer."""
        numbers = self._numbers(given)
        if not numbers:  # it has another unit
            return Feedback(False, [('why', self._mistake(spelling.numbers(str(given))))])
        answer = _value(self.answer)
        for number in numbers:
            if abs(number - answer) <= max(self.tolerance, 1e-9) * abs(answer):
                return Feedback(True, [('why', self.why)])
        why = self._mistake(numbers) or self.explain(numbers[0]) or self.otherwise
        return Feedback(False, [('why', why)])

    def _mistake(self, numbers: Sequence[float]) -> str:
        """Return the explanation of a typical wrong number, '' if it is none."""
        for number, (value, why) in product(numbers, self.wrong.items()):
            # Nobody types all decimals.
            off = 1e-9 if float(value).is_integer() else 0.005
            if math.isclose(number, value, rel_tol=max(off, self.tolerance / 2)):
                return why
        return ''

    def _numbers(self, given: Any) -> list[float]:
        """Return the possible values; none if it is a typical wrong number in another unit.

        Raises:
            LabError: It is no number, or has another unit.
        """
        try:
            return spelling.numbers(str(given), self.unit)
        except ValueError as error:
            if str(error) == 'no number':
                raise LabError(f'The answer must be a number, but it is {given!r}.') from None
            with contextlib.suppress(ValueError):
                if self._mistake(spelling.numbers(str(given))):
                    return []
            raise LabError(
                f'The answer must be a number in {self.unit}, but the unit of {given!r} is '
                f'{str(error)!r}.',
            ) from None


@dataclass(frozen=True)
class Word(Question):
    """A question whose answer is a word, such as the name of a node or a type.

    Attributes:
        text: The question.
        answer: The word, several right ones, or a function that determines them from the graph.
        why: Explanation of the right answer.
        otherwise: Advice for any other answer.
        wrong: Typical wrong words, with explanations.
        explain: Explains a wrong word from the live graph, '' if it can't.
        form: Normalizes the spelling, see `spelling`. `explain` gets the normalized word.
        how: The expected kind of answer, in words.
    """

    text: str
    answer: str | Collection[str] | Callable[[], str | Collection[str]]
    why: str
    otherwise: str
    wrong: Mapping[str, str] = field(default_factory=dict)
    explain: Callable[[str], str] = lambda word: ''
    form: Callable[[str], str] = spelling.name
    how: str = 'a word'

    def example(self) -> str:
        """Return an example of an answer as code."""
        return "'/talker'"

    def judge(self, given: Any) -> Feedback:
        """Judge and explain an answer."""
        word = self.form(given) if isinstance(given, str) else ''
        if not word:
            raise LabError(
                f'The answer must be {self.how} in quotation marks, but it is {given!r}.',
                todo=f'For instance: {self.example()}',
            )
        answer = _value(self.answer)
        rights = [self.form(one) for one in ([answer] if isinstance(answer, str) else answer)]
        if word in rights:
            return Feedback(True, [('why', self.why)])
        known = {self.form(one): why for one, why in self.wrong.items()}
        why = known.get(word) or self.explain(word) or _nearly(word, rights) or self.otherwise
        return Feedback(False, [('why', why)])


def question_of(told: Mapping[str, Any], **live: Any) -> Question:
    """Return a question as a file of words has it.

    Args:
        told: Its parts: the kind with the text, `options` of `right` or `wrong` and `why`, or what
            a `Number` or a `Word` has.
        live: What the graph tells, and other functions; it goes before the parts.

    Raises:
        ValueError: It is no question.
    """
    kinds: dict[str, Any] = {'choice': Choice, 'several': Several, 'number': Number, 'word': Word}
    kind = next((kind for kind in kinds if kind in told), '')
    if not kind:
        raise ValueError(f'a question is a {", ".join(kinds)}, and one has {", ".join(told)}')
    if kind in ('choice', 'several'):
        options = [
            Option(each.get('right', each.get('wrong', '')), each.get('why', ''), 'right' in each)
            for each in told.get('options', ())
        ]
        rights = sum(option.is_right for option in options)
        if rights < 1 or (kind == 'choice' and rights > 1):
            raise ValueError(f'{told[kind]!r} has {rights} right options')
        return kinds[kind](told[kind], *options)  # type: ignore[no-any-return]
    parts = {name: part for name, part in told.items() if name not in (kind, 'id')}
    if kind == 'number':
        for name in {'answer', 'tolerance'} & parts.keys():
            parts[name] = _read_number(parts[name])
        parts['wrong'] = {_read_number(n): why for n, why in parts.get('wrong', {}).items()}
    parts = {'text': told[kind], **parts, **live}
    for name in ('answer', 'why', 'otherwise'):
        if name not in parts:
            raise ValueError(f'{told[kind]!r} has no {name!r}')
    return kinds[kind](**parts)  # type: ignore[no-any-return]


def _read_number(text: str) -> float:
    return float(text) if set('.en') & set(text) else int(text)


def _nearly(word: str, rights: Collection[str]) -> str:
    """Explain a word that is nearly right, '' if it is not."""
    for one in rights:
        if word.casefold() == one.casefold():
            return 'Capital and small letters differ in names.'
        if re.sub(r'[\s_-]', '', word).casefold() == re.sub(r'[\s_-]', '', one).casefold():
            return 'An underscore is part of the name, and a name has no blanks.'
        parts = zip_longest(word.split('/'), one.split('/'), fillvalue='')
        if all(nearest(part, [other]) for part, other in parts):
            return 'It is nearly that. Compare the name letter by letter.'
    return ''


def _value(answer: Any) -> Any:
    return answer() if callable(answer) else answer
