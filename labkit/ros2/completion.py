"""Completion with the Tab key: commands, verbs, options, and names from the live graph."""

from __future__ import annotations

import argparse
import shlex
from argparse import Namespace
from collections.abc import Iterable

from labkit.errors import LabError
from labkit.ros2.parser import Parser
from labkit.ros2.shell import COMMANDS, command

__all__ = ['complete', 'complete_line']


def complete_line(line: str) -> tuple[str, list[str]]:
    """Complete the end of a line.

    Args:
        line: The text after `ros2`, up to the cursor.

    Returns:
        The last word as typed, and its completions.
    """
    words, last, quote = _split(line)
    return f'{quote}{last}', [f'{quote}{text}' for text in complete(words, last)]


def complete(words: list[str], last: str) -> list[str]:
    """Complete the last word.

    Args:
        words: The complete words after `ros2`.
        last: The last, incomplete word.

    Returns:
        Its completions, sorted.
    """
    try:
        found = set(_candidates(words, last))
    except Exception:  # a Tab key that raises helps nobody
        return []
    return sorted(text for text in found if text.startswith(last))


def _candidates(words: list[str], last: str) -> Iterable[str]:
    if not words:
        return COMMANDS
    chosen = command(words[0])
    rest = words[1:]
    if chosen.has_verbs:
        while rest and rest[0] in chosen.options:
            rest = rest[1:]
        if not rest:
            verbs = [verb.name for verb in chosen.verbs]
            return [*verbs, *chosen.options] if last.startswith('-') else verbs
        verb, rest = chosen.verb(rest[0]), rest[1:]
    else:
        verb = chosen.verbs[0]
    return _arguments(verb.parser(chosen.name), rest, last)


def _arguments(parser: Parser, words: list[str], last: str) -> Iterable[str]:
    """Return candidates for the word after some words that follow the verb."""
    known, wanted = parser.guess(words)
    in_option = wanted is not None and bool(wanted.option_strings) and wanted.nargs != '+'
    if last.startswith('-') and not in_option:
        shown = [action for action in parser.actions if action.help != argparse.SUPPRESS]
        names = [name for action in shown for name in action.option_strings]
        return [name for name in names if name.startswith('--') or len(last) < 2]
    return _words_for(wanted, known) if wanted is not None else ()


def _words_for(action: argparse.Action, known: Namespace) -> Iterable[str]:
    try:
        words = getattr(action, 'complete', None)
        return words(known) if words is not None else ()
    except LabError:
        return ()


def _split(line: str) -> tuple[list[str], str, str]:
    """Split a line into complete words, the incomplete word, and its quotation mark if any."""
    for quote in ('', '"', "'"):
        try:
            words = shlex.split(line + quote)
        except ValueError:
            continue
        if quote:
            return words[:-1], words[-1] if words else '', quote
        if not line or line[-1].isspace():
            return words, '', ''
        return words[:-1], words[-1], ''
    return line.split()[:-1], '', ''
