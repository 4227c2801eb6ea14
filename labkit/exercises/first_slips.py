"""What goes wrong in a beginner's first hour, by what Python says: indents, brackets, quotes."""

from __future__ import annotations

import linecache
import re
import traceback

from labkit.exercises.mistakes import Mistake
from labkit.exercises.words import words_of

__all__ = ['SLIPS', 'unquoted']

WORDS = words_of(__file__)

# Names of the exception, what its text looks like, the misconception; see `learner_errors`.
SLIPS: tuple[tuple[tuple[str, ...], str, Mistake], ...] = (
    (
        ('TabError',),
        r'.',
        WORDS.mistake('error/tabs'),
    ),
    (
        ('IndentationError',),
        r'unexpected indent',
        WORDS.mistake('error/too-far-right'),
    ),
    (
        ('IndentationError',),
        r'expected an indented block',
        WORDS.mistake('error/no-block'),
    ),
    (
        ('IndentationError',),
        r'unindent does not match',
        WORDS.mistake('error/between-blocks'),
    ),
    (
        ('SyntaxError',),
        r"'(?P<bracket>[(\[{])' was never closed",
        WORDS.mistake('error/open-bracket'),
    ),
    (
        ('SyntaxError',),
        r'unterminated (triple-quoted )?(f-)?string literal',
        WORDS.mistake('error/open-text'),
    ),
    (
        ('SyntaxError',),
        r"expected ':'",
        WORDS.mistake('error/no-colon'),
    ),
    (
        ('TypeError',),
        r'^rclpy_logging_rcutils_log\(\): incompatible function arguments',
        WORDS.mistake('error/logs-no-text'),
    ),
)

_UNQUOTED = WORDS.mistake('error/no-quotes')
_UNKNOWN = WORDS.mistake('error/unknown-name')
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
    from labkit.background.tracebacks import is_learners

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
