"""Texts with `$(...)` in them, as in XML and YAML: reading them as the real grammar does."""

from __future__ import annotations

import re

from labkit.launching.model import LaunchError, Substitution, Text, TextSubstitution
from labkit.launching.substitutions import substitution

__all__ = ['template', 'unescaped']


def unescaped(text: str) -> str:
    r"""Return a text without backslashes before characters: `\$` means `$`."""
    return re.sub(r'\\(.)', r'\1', text)


def template(text: str) -> Text:
    """Return a text as its pieces.

    Raises:
        LaunchError: A `$(` in it can't be understood.
    """
    return _Reader(text).fragments('') or [TextSubstitution(text='')]


class _Reader:
    """Reads a text from left to right.

    A quotation mark that has begun an argument (`quote`) ends it. Inside, the other one is a
    character like all others, and substitutions have arguments without quotation marks.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def fragments(self, quote: str) -> Text:
        """Read up to a quotation mark, or to the end."""
        found: Text = []
        start = self._at
        while self._at < len(self._text) and not (quote and self._text[self._at] == quote):
            if self._next('\\'):
                self._at += 2
            elif self._opens():
                self._keep(found, start)
                found.append(self._substitution(quote))
                start = self._at
            else:
                self._at += 1
        self._at = min(self._at, len(self._text))
        self._keep(found, start)
        return found

    def _keep(self, found: Text, start: int) -> None:
        if start < self._at:
            found.append(TextSubstitution(text=unescaped(self._text[start : self._at])))

    def _next(self, sign: str) -> bool:
        return self._text.startswith(sign, self._at)

    def _opens(self) -> bool:
        """Return whether a substitution begins here: not right after a backslash."""
        return self._next('$(') and self._text[self._at - 1 : self._at] != '\\'

    def _substitution(self, quote: str) -> Substitution:
        start = self._at
        word = re.compile(r'\$\(([A-Za-z][A-Za-z0-9_-]*)').match(self._text, start)
        if word is None:
            raise self._wrong(start, 'a word has to follow $(')
        self._at = word.end()
        arguments = []
        while self._next(' '):
            self._at += 1
            arguments.append(self._argument(start, quote))
        if not self._next(')'):
            raise self._wrong(start, 'its ) is missing')
        self._at += 1
        return substitution(word[1], arguments)

    def _argument(self, start: int, quote: str) -> Text:
        if not quote and (self._next('"') or self._next("'")):
            mark = self._text[self._at]
            self._at += 1
            value = self.fragments(mark)
            if not self._next(mark):
                raise self._wrong(start, f'a quotation mark {mark} is missing')
            self._at += 1
            return value or [TextSubstitution(text='')]
        marks = quote or '\'"'
        found: Text = []
        begin = self._at
        while self._at < len(self._text) and self._text[self._at] not in f' (){marks}':
            if self._next('\\') and not self._next('\\ '):
                self._at += 2
            elif self._opens():
                self._keep(found, begin)
                found.append(self._substitution(quote))
                begin = self._at
            else:
                self._at += 1
        self._at = min(self._at, len(self._text))
        self._keep(found, begin)
        if not found:
            raise self._wrong(start, 'between two words stands one space')
        return found

    def _wrong(self, start: int, why: str) -> LaunchError:
        return LaunchError(
            f'{self._text[start : start + 40]!r} can not be read: {why}.',
            todo='A $( that is meant as it stands is written \\$(',
        )
