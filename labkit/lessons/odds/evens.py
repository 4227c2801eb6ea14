"""Exercise: a program in a file that hears the odd numbers, and publishes even ones."""

from __future__ import annotations

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.clauses import WITHIN, Answers
from labkit.exercises.draws import draw_int16s
from labkit.lessons._terminal import RunsFile

__all__ = ['exercise']

WORDS = words_of(__file__)

INT16 = 'std_msgs/msg/Int16'
MORE = 1

MISTAKES = (
    WORDS.mistake('evens/passed-on', lambda n: n),
    WORDS.mistake('evens/subtracted', lambda n: n - 1),
    WORDS.mistake('evens/no-sign', lambda n: abs(n) + 1),
    WORDS.mistake('evens/doubled', lambda n: 2 * n),
    WORDS.mistake('evens/of-its-own', anything),
)

exercise = Exercise(
    words=WORDS,
    clauses=(
        RunsFile('nodes/evens.py', ['/evens']),
        Answers(
            '/odds',
            '/evens',
            INT16,
            WORDS.of(more=MORE, within=WITHIN).clause('answers'),
            answer=lambda number: number + MORE,
            draw=lambda: draw_int16s(-32767, 32765, 2),
            mistakes=MISTAKES,
        ),
    ),
)
