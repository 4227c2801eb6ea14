"""Why a `ros2 topic pub` command has sent nothing where it should.

What a command has sent can be heard. What was refused, or sent elsewhere, can not, so the judges
look at the commands that this notebook has run. Commands of a terminal are not known here.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from labkit.errors import LabError
from labkit.exercises import Fail

__all__ = ['explain_last_command', 'forget_commands']

# How much of two names has to be the same, from 0 to 1.
NEAR = 0.75
# A part of a complaint -> the misconception behind it. The first that fits counts.
_WHY = {
    'A space is missing after the colon': 'In YAML a colon is followed by a space: data: 1',
    'YAML goes in quotation marks': 'A space ends a word of a command. Quotation marks around the '
    'YAML hold its words together.',
    'but got [': 'The brackets make a list. A field of this type holds one number, so each number '
    'needs a message of its own.',
    'must be a whole number': 'An Int16 holds whole numbers from -32768 to 32767, written in '
    'digits.',
    'is not known': 'The name of a type has three parts: the package, the word msg, and the type.',
    'of another type': 'A topic carries one type of message. Another type is refused, or nobody '
    'hears it.',
    'has no field': 'The message has other fields. Fields that are messages themselves take '
    'braces of their own.',
    "repeated '/'": 'One slash at the beginning is enough.',
}


def explain_last_command(topic: str, expected: str) -> None:
    """Raise Fail if the last `ros2 topic pub` of this notebook was refused, or went elsewhere.

    Args:
        topic: Full name of the topic where something should have come.
        expected: What should have come, in words.

    Raises:
        Fail: It was so, with the reason.
    """
    from labkit.ros2.shell import history

    tried = [
        ran
        for ran in history
        if ran.words[:2] == ('topic', 'pub') and any(_is_near(word, topic) for word in ran.words)
    ]
    if not tried:
        return
    words, complaint = tried[-1].words, tried[-1].complaint
    other = _topic_of(words)
    if other not in ('', topic) and not any(part in complaint for part in _WHY):
        why = f'{other} is not {topic}: names must be equal to the last letter.'
        if other.lower() == topic:
            why = f'Capital and small letters differ in names: {other} and {topic} are two topics.'
        raise Fail(
            expected,
            f'a command that publishes on {other}',
            why=why,
            todo=f'Write the topic as {topic}.',
        )
    if complaint:
        line, _, rest = complaint.partition('\n')
        raise Fail(
            expected,
            f'a command that was refused: {line}',
            why=next((why for part, why in _WHY.items() if part in complaint), ''),
            todo='' if rest.startswith('usage') else rest,
        )


def forget_commands() -> None:
    """Forget the commands so far: the next check is about what comes after this one."""
    from labkit.ros2.shell import history

    history.clear()


def _is_near(word: str, topic: str) -> bool:
    """Tell whether a word of a command was probably meant to be a topic."""
    one, other = word.strip('/').lower(), topic.strip('/').lower()
    return difflib.SequenceMatcher(None, one, other).ratio() > NEAR


def _topic_of(words: Sequence[str]) -> str:
    """Return the topic that a `topic pub` command names, '' if it can't be told."""
    from labkit.ros2.parser import Done
    from labkit.ros2.topic_pub import PUB

    try:
        name = str(PUB.parser('topic').read(list(words[2:])).topic_name)
    except (LabError, Done):
        return ''
    return name if name.startswith('/') else f'/{name}'
