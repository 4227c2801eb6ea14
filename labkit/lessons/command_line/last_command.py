"""Why a `ros2 topic pub` command has sent nothing where it should.

What a command has sent can be heard. What was refused, or sent elsewhere, can not, so the judges
look at the commands that this notebook has run. Commands of a terminal are not known here.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Sequence

from labkit.exercises import Fail, Mistake, common_mistakes, words_of
from labkit.rosgraph.refusals import Refusal

__all__ = ['commanded_rate', 'explain_last_command', 'forget_commands', 'other_topic']

WORDS = words_of(__file__)

# How much of two names has to be the same, from 0 to 1.
NEAR = 0.75
# What the lesson says to a refusal; the next step is that of the complaint.
_REFUSED = {
    Refusal.SPACE_AFTER_COLON: WORDS.mistake('command/space-after-colon'),
    Refusal.QUOTES_MISSING: WORDS.mistake('command/quotes'),
    Refusal.LIST_FOR_NUMBER: WORDS.mistake('command/list'),
    Refusal.NOT_A_WHOLE_NUMBER: WORDS.mistake('command/whole-number'),
    Refusal.OUT_OF_RANGE: WORDS.mistake('command/out-of-range'),
    Refusal.UNKNOWN_TYPE: WORDS.mistake('command/type'),
    Refusal.OTHER_TYPE: WORDS.mistake('command/other-type'),
    Refusal.NO_SUCH_FIELD: WORDS.mistake('command/field'),
    Refusal.FIELDS_WANTED: WORDS.mistake('command/braces'),
    Refusal.REPEATED_SLASH: WORDS.mistake('command/slash'),
}


def explain_last_command(topic: str, expected: str) -> None:
    """Explain the last `ros2 topic pub` of this notebook, if it was refused or went elsewhere.

    Args:
        topic: Full name of the topic where something should have come.
        expected: What should have come, in words.

    Raises:
        Fail: It was so, with the reason.
    """
    from labkit.ros2.shell import history

    tried = [
        ran for ran in history if ran.words[:2] == ('topic', 'pub') and _is_near(ran.topic, topic)
    ]
    if not tried:
        return
    last = tried[-1]
    if last.topic != topic and last.reason not in _REFUSED:
        mistake = (
            common_mistakes.CAPITALS if last.topic.lower() == topic else common_mistakes.OTHER_NAME
        )
        raise Fail(
            expected,
            f'a command that publishes on {last.topic}',
            mistake.of(seen=last.topic, wanted=topic).then(f'Write the topic as {topic}.'),
        )
    if last.reason is not None:
        what, _, todo = last.complaint.partition('\n')
        mistake = _REFUSED.get(last.reason, Mistake(''))
        raise Fail(expected, f'a command that was refused: {what}', mistake.then(todo))


def commanded_rate(topic: str) -> float | None:
    """Return the rate that the last command to a topic was given, Hz; None if there is none."""
    from labkit.ros2.shell import history

    for ran in reversed(history):
        if ran.words[:2] == ('topic', 'pub') and ran.topic == topic and ran.reason is None:
            return _rate(ran.words)
    return None


def other_topic(topic: str, msg_type: str, known: Collection[str]) -> str:
    """Return the topic to which a command has sent messages of a type after those to another one.

    Args:
        topic: Full name of the topic where they belong.
        msg_type: Name of their type.
        known: Topics that the lesson's own commands use.

    Returns:
        Its full name, `''` if there is none.
    """
    from labkit.ros2.shell import history

    last = msg_type.rsplit('/', 1)[-1]
    other = ''
    for ran in history:
        if ran.words[:2] != ('topic', 'pub') or ran.reason is not None:
            continue
        if ran.topic == topic:
            other = ''
        elif ran.topic not in known and any(w.rsplit('/', 1)[-1] == last for w in ran.words):
            other = ran.topic
    return other


def forget_commands() -> None:
    """Forget the commands so far: the next check is about what comes after this one."""
    from labkit.ros2.shell import history

    history.clear()


def _rate(words: Sequence[str]) -> float:
    for number, word in enumerate(words):
        found = re.fullmatch(r'(?:--rate=|-r)(.+)', word)
        value = found[1] if found else None
        if word in ('--rate', '-r'):
            value = words[number + 1]
        if value is not None:
            return float(value)
    return 1.0  # as the command has it


def _is_near(seen: str, topic: str) -> bool:
    """Tell whether a name was probably meant to be that of a topic."""
    one, other = seen.strip('/').lower(), topic.strip('/').lower()
    return difflib.SequenceMatcher(None, one, other).ratio() > NEAR
