"""Exercise: a node that calls a service when it hears a message, without waiting for itself."""

from __future__ import annotations

import random
from typing import Any

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.callback_count import find_node
from labkit.exercises.clauses import WITHIN, Answers, AsksForEach, Named
from labkit.exercises.draws import MANY

__all__ = ['exercise']

WORDS = words_of(__file__)

WISH, NEWS, SERVICE = '/wish', '/news', '/move_door'
BOOL, STRING = 'std_msgs/msg/Bool', 'std_msgs/msg/String'
NODE = '/porter'
# Not the one of the lesson: her name is in the text that stands in the notebook.
KEEPERS = ('Bo', 'Chidi', 'Dilek', 'Eva', 'Finn', 'Guo', 'Hana')


def _message(wish: bool) -> str:
    return f'{find_node("/door").keeper} {"opened" if wish else "closed"} the door'


OPPOSITE = WORDS.mistake('porter/opposite', lambda wish: not wish)
MISTAKES = (
    WORDS.mistake('porter/no-done-callback', lambda wish: None),
    WORDS.mistake('porter/other-response', lambda wish: _message(not wish)),
    WORDS.mistake('porter/own-text', anything),
)


def _change(door: Any) -> None:
    door.keeper = random.choice([name for name in KEEPERS if name != door.keeper])


exercise = Exercise(
    words=WORDS,
    clauses=(
        Named(NODE),
        AsksForEach(
            WISH,
            NODE,
            SERVICE,
            partner='/door',
            cell='door = lab.spin(make_door())',
            words=WORDS.clause('asks-for-each'),
            request='SetBool.Request(data=msg.data)',
            change=_change,
            mistakes=[OPPOSITE],
        ),
        Answers(
            WISH,
            NEWS,
            BOOL,
            WORDS.of(within=WITHIN).clause('answers'),
            answer=_message,
            draw=lambda: [True, False, *random.choices([True, False], k=MANY)],
            outer_type=STRING,
            by=NODE,
            mistakes=MISTAKES,
            # The door gets another keeper in each check.
            lasting=False,
        ),
    ),
)
