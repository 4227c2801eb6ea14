"""Exercise: an action client that does not wait for itself."""

from __future__ import annotations

import random
from typing import Any

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.callback_count import find_node
from labkit.exercises.clauses import WITHIN, Answers, AsksForEach, Named
from labkit.exercises.draws import MANY

__all__ = ['exercise']

WORDS = words_of(__file__)

WISH, SUM, NAME = '/wish', '/sum', '/add_up'
INT16, INT32 = 'std_msgs/msg/Int16', 'std_msgs/msg/Int32'
NODE = '/asker'

NOT_ASKED = WORDS.mistake('asker/the-result-is-not-asked-for')
OTHER_NUMBER = WORDS.mistake('asker/the-first-number', anything)


def _change(calculator: Any) -> None:
    # With some factors the last sum is the least one.
    calculator.factor = random.choice((-1, 1)) * random.randint(2, 9)


exercise = Exercise(
    words=WORDS,
    clauses=(
        Named(NODE),
        AsksForEach(
            WISH,
            NODE,
            NAME,
            partner='/calculator',
            cell='calculator = lab.spin(make_calculator())',
            words=WORDS.clause('asks-for-each'),
            request='Fibonacci.Goal(order=msg.data)',
            change=_change,
            is_action=True,
        ),
        Answers(
            WISH,
            SUM,
            INT16,
            WORDS.of(within=WITHIN).clause('answers'),
            answer=lambda order: int(find_node('/calculator').factor) * order * (order + 1) // 2,
            # Many, of which two are the same, with the smallest one and a large one.
            draw=lambda: [
                3,
                3,
                1,
                random.randint(2000, 3000),
                *random.sample(range(2, 60), k=MANY),
            ],
            outer_type=INT32,
            by=NODE,
            mistakes=[OTHER_NUMBER],
            explain=lambda order, came: NOT_ASKED,
        ),
    ),
)
