"""What goes wrong in a beginner's first hour, by what Python says: indents, brackets, quotes."""

from __future__ import annotations

import linecache
import re
import traceback

from labkit.background.tracebacks import is_learners
from labkit.exercises.mistakes import Mistake

__all__ = ['SLIPS', 'unquoted']

# Names of the exception, what its text looks like, the misconception; see `learner_errors`.
SLIPS: tuple[tuple[tuple[str, ...], str, Mistake], ...] = (
    (
        ('TabError',),
        r'.',
        Mistake(
            'error/tabs',
            'Tabs and spaces are mixed at the beginnings of lines. They look alike, and Python '
            'counts them otherwise.',
            'Write spaces alone: four for each step to the right.',
        ),
    ),
    (
        ('IndentationError',),
        r'unexpected indent',
        Mistake(
            'error/too-far-right',
            'This line begins further to the right than the one before it, and that one does not '
            'end with a colon.',
            'Let the lines of one block begin exactly below each other.',
        ),
    ),
    (
        ('IndentationError',),
        r'expected an indented block',
        Mistake(
            'error/no-block',
            'After a line that ends with a colon, what belongs to it begins further to the right.',
            'Put four more spaces before this line.',
        ),
    ),
    (
        ('IndentationError',),
        r'unindent does not match',
        Mistake(
            'error/between-blocks',
            'This line begins in a column in which no line before it begins, so nobody knows to '
            'which block it belongs.',
            'Let it begin exactly below the other lines of its block.',
        ),
    ),
    (
        ('SyntaxError',),
        r"'(?P<bracket>[(\[{])' was never closed",
        Mistake(
            'error/open-bracket',
            'The bracket {bracket} is opened in this line, and never closed.',
            'Write its other half.',
        ),
    ),
    (
        ('SyntaxError',),
        r'unterminated (triple-quoted )?(f-)?string literal',
        Mistake(
            'error/open-text',
            'A text begins in this line, and its end is missing.',
            'End it with the quotation mark with which it begins.',
        ),
    ),
    (
        ('SyntaxError',),
        r"expected ':'",
        Mistake(
            'error/no-colon',
            'A line with class, def, if, for, while or with ends with a colon.',
            'Write a : at the end of this line.',
        ),
    ),
    (
        ('TypeError',),
        r'^rclpy_logging_rcutils_log\(\): incompatible function arguments',
        Mistake(
            'error/logs-no-text',
            'A log line is a text, and the logger got something else.',
            "Make a text of it: info(f'{{value}}'). The text of a message is msg.data.",
        ),
    ),
)

_UNQUOTED = Mistake(
    'error/no-quotes',
    '{name} stands here without quotation marks, so Python takes it for a variable.',
    'A text has quotation marks: {name!r}',
)
_UNKNOWN = Mistake(
    'error/unknown-name',
    'Python does not know the name {name}: it is misspelt, not imported, or a text without '
    'quotation marks.',
    'Correct it, import it, or write {name!r} if it is a text.',
)
# Where a text is asked for: the name of a node, topic or service, and the text of a message.
_TEXTS = (
    r'(?:\bNode|__init__|create_node)\(\s*{name}\b',
    r'create_(?:publisher|subscription|service|client)\([^,()]*,\s*{name}\b',
    r'\bString\(data=\s*{name}\b',
    r'\.(?:info|warning|error|debug)\(\s*{name}\s*\)',
)


def unquoted(error: BaseException) -> Mistake | None:
    """Return the slip where a name is unknown that no self would help: outside of a class.

    Args:
        error: What was raised; None is returned if it is no NameError of the learner's code.
    """
    if type(error) is not NameError:
        return None
    frames = [
        (frame.f_code, number)
        for frame, number in traceback.walk_tb(error.__traceback__)
        if is_learners(frame.f_code.co_filename)
    ]
    found = re.search(r"name '(?P<name>\w+)' is not defined", str(error))
    if not frames or found is None:
        return None
    code, number = frames[-1]
    name, line = found['name'], linecache.getline(code.co_filename, number)
    if any(re.search(text.replace('{name}', name), line) for text in _TEXTS):
        return _UNQUOTED.of(name=name)
    return _UNKNOWN.of(name=name) if code.co_name == '<module>' else None
