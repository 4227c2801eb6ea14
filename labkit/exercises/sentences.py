"""The sentences that the course itself says about a mistake, without anything of a learner's.

What a learner shares with a class is one of these, or the words of a clause, so that neither code
nor output leaves the notebook, and nobody can put words of their own on the teacher's screen. They
are read off the course's source: a sentence that is made with a value has a `…` in its place.
"""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterator
from pathlib import Path

__all__ = ['is_of_the_course', 'known_sentences', 'of_the_course']

# Where judges and lessons say what is wrong.
_ROOMS = ('exercises', 'lessons')
_HOLE = '\N{HORIZONTAL ELLIPSIS}'
# What a program puts in when a sentence is said: {name} of `str.format`.
_FORMAT = re.compile(r'\{\w*\}')
_END = re.compile(r'(?<=[.?]) +')
# Shorter ones are no sentences; with fewer letters of its own, one would fit to anything.
_FEWEST_WORDS, _FEWEST_LETTERS = 3, 12


def of_the_course(text: str) -> str:
    """Return what is said in words of the course alone, `''` if nothing is.

    Args:
        text: Sentences of a verdict, maybe with a learner's names and values in them.
    """
    found = (_template(sentence) for sentence in _END.split(text))
    return ' '.join(filter(None, found))


def is_of_the_course(text: str) -> bool:
    """Tell whether a text is made of the course's sentences alone."""
    return all(sentence in known_sentences() for sentence in _END.split(text))


@functools.lru_cache(maxsize=1)
def known_sentences() -> frozenset[str]:
    """Return all sentences of the course, with `…` for what differs."""
    course = Path(__file__).parents[1]
    return frozenset(
        sentence
        for room in _ROOMS
        for path in sorted((course / room).rglob('*.py'))
        for text in _texts(ast.parse(path.read_text(encoding='utf-8')))
        for sentence in _END.split(_FORMAT.sub(_HOLE, text))
        if _is_sentence(sentence)
    )


def _template(sentence: str) -> str:
    if sentence in known_sentences():
        return sentence
    # The one with most letters of its own says most.
    fitting = [known for known, pattern in _patterns().items() if pattern.fullmatch(sentence)]
    return max(fitting, key=len, default='')


@functools.lru_cache(maxsize=1)
def _patterns() -> dict[str, re.Pattern[str]]:
    """Return those sentences that are made with values, and what they look like then."""
    return {
        sentence: re.compile('.+?'.join(map(re.escape, sentence.split(_HOLE))), re.DOTALL)
        for sentence in known_sentences()
        if _HOLE in sentence
    }


def _is_sentence(text: str) -> bool:
    own = text.replace(_HOLE, '')
    letters = sum(map(str.isalpha, own))
    words = len(own.split())
    return (
        text.endswith(('.', '?'))
        and '\n' not in text
        and words >= _FEWEST_WORDS
        and letters >= _FEWEST_LETTERS
    )


def _texts(tree: ast.AST) -> Iterator[str]:
    """Return the texts in a piece of code, but for those that document it."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            continue
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, ast.JoinedStr):
            parts = (p.value if isinstance(p, ast.Constant) else _HOLE for p in node.values)
            yield ''.join(map(str, parts))
        else:
            yield from _texts(node)
