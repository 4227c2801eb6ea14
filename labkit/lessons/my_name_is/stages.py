"""What the exercises of the chain have in common: how it begins, and what a name may look like."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from labkit.exercises import Mistake, words_of
from labkit.exercises.clauses import Says

__all__ = [
    'COMPLETES',
    'INNER',
    'NOTHING_ADDED',
    'NOT_IN_IT',
    'OPENING',
    'STRING',
    'says_opening',
]

WORDS = words_of(__file__)

INNER, STRING = '/incomplete', 'std_msgs/msg/String'
OPENING = 'My name is '

NOTHING_ADDED = WORDS.mistake('stages/nothing-added', str)
GROWS = WORDS.mistake('stages/grows')
SPACE_BESIDE = WORDS.mistake('stages/space-beside')
NO_SPACE = WORDS.mistake('stages/no-space')
IN_FRONT = WORDS.mistake('stages/in-front')
NOT_IN_IT = WORDS.mistake('stages/not-in-it')
CHANGED = WORDS.mistake('stages/changed')


def says_opening() -> Says:
    """Return what the messages of stage one have to say."""
    words = f'each message says `{OPENING}`, with the space at the end'
    return Says(INNER, OPENING, words=words)


def _name_trouble(text: str, answer: str) -> Mistake | None:
    """Return what is wrong with a name that was appended to a text; None if nothing is."""
    name = answer.removeprefix(text)
    if answer == text or not name.strip():
        return NOTHING_ADDED
    if answer.startswith(text):
        if text and text in name:
            return GROWS
        return SPACE_BESIDE if name != name.strip() else None
    if answer.startswith(text.rstrip()):
        return NO_SPACE
    return IN_FRONT if text.strip() in answer else NOT_IN_IT


def _complete(name: str | None) -> Generator[str, str, None]:
    """Append a name, or what stands for one, to each text."""
    text = yield ''
    while True:
        text = yield f'{text}{name or "Ada"}'


def _names(text: str, said: str) -> Sequence[str | None]:
    """Return the name that the first answer tells, None in its place if it holds none."""
    return [None if _name_trouble(text, said) else said.removeprefix(text)]


def _trouble(text: str, came: Sequence[str]) -> Mistake | None:
    return (_name_trouble(text, came[-1]) or CHANGED) if came else None


# For `Answers`: a stage appends a first name to each text. Which one, its first answer tells.
COMPLETES: dict[str, Any] = {
    'answer': _complete,
    'mistakes': [NOTHING_ADDED],
    'explain': _trouble,
    'resume': _names,
}
