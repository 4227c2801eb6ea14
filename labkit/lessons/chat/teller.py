"""Exercise: say what was typed, with the name of who says it."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import WITHIN, Answers, Words

__all__ = ['teller']

INNER, OUTER, STRING = '/typed', '/hall', 'std_msgs/msg/String'
WHO = 'Ada'
NOTHING = Words('for a text that is empty, or all spaces, publish nothing')


def _say(text: str) -> str | None:
    return f'{WHO}: {text.strip()}' if text.strip() else None


MISTAKES = (
    Mistake(
        'teller/without-a-name',
        'It does not say who says it.',
        'Put the name, a colon and a space before the text.',
        model=lambda text: text.strip() or None,
        change=[("f'Ada: {text}'", 'text')],
    ),
    Mistake(
        'teller/with-the-blanks',
        'There are spaces at an end of what was typed.',
        'Use msg.data.strip().',
        model=lambda text: f'{WHO}: {text}' if text.strip() else None,
        change=[('msg.data.strip()', 'msg.data'), ('if text:', 'if text.strip():')],
    ),
    Mistake(
        'teller/another-text',
        'What is said is not what was typed.',
        'Use the message that came: msg.data',
        model=anything,
    ),
)

teller = Exercise(
    name='teller',
    task='Publish what was typed on /hall, with the name of who says it.',
    clauses=(
        Answers(
            INNER,
            OUTER,
            STRING,
            f'publish each text of `{INNER}`, without spaces at its ends, as `{WHO}: <text>` on '
            f'`{OUTER}` (both `{STRING}`), once, {WITHIN}',
            answer=_say,
            mistakes=MISTAKES,
            otherwise=NOTHING.text,
        ),
        NOTHING,
    ),
    hints=[
        'The node has a subscription and a publisher. The callback of the one uses the other.',
        'strip() returns a text without the spaces at its two ends. What is left of spaces alone?',
        "text = msg.data.strip(), then if text: publish String(data=f'Ada: {text}')",
    ],
    answer=Solution(
        __file__,
        'teller.py',
        'A text that is empty counts as False, so `if text` leaves out what holds nothing.',
    ),
)
