"""Exercise: greet each person once, so that two who do so come to an end."""

from __future__ import annotations

from collections.abc import Generator, Sequence

from labkit.exercises import Exercise, Mistake, words_of
from labkit.exercises.clauses import WITHIN, Answers, Words
from labkit.exercises.draws import draw_names

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING = '/lounge', 'std_msgs/msg/String'
ME = 'Ada'
NOTHING = Words(WORDS.clause('nothing'))


def _greet(message: str) -> str:
    return f'{ME}: Hello, {message.partition(": ")[0]}'


def _says_hello(message: str) -> bool:
    return 'Hello' in message.partition(': ')[2]


MISTAKES = (
    WORDS.mistake('polite/herself', lambda message: {ME: _greet(ME)}[message.partition(': ')[0]]),
    WORDS.mistake(
        'polite/each-time', lambda message: _greet(message) if _says_hello(message) else None
    ),
    WORDS.mistake('polite/everything', _greet),
)
NOT_YET = WORDS.mistake('polite/not-yet')


def _politely(_memory: object) -> Generator[str | None, str, None]:
    """Greet each person once."""
    greeted: set[str] = {f'{ME}: Hello, {ME}'}
    reply = None
    while True:
        message = yield reply
        reply = _greet(message) if _says_hello(message) else None
        reply = None if reply in greeted else reply
        greeted |= {reply} if reply else set()


def _draw() -> list[str]:
    """Return what people say whom nobody knows yet, and whom all know by then."""
    bo, chidi, eva, finn, guo, hana, last, *more = draw_names(22)
    kitty = f'Hello {draw_names(2)[0]}'
    # A name that begins as that of the greeter does, and is another one.
    adam = f'{ME}m {draw_names(2)[0]}'
    return [
        f'{bo}: Hello',
        f'{chidi}: How are you?',
        f'{bo}: Hello again',
        f'{chidi}: Well, Hello',
        f'{eva}: Hello {ME}',
        f'{eva}: Hello {ME}',
        f'{finn}: {bo} says Hi',
        f'{bo}: Hello {finn}',
        f'{ME}: Hello',
        f'{kitty}: Good morning',
        f'{adam}: Hello Hello',
        f'{guo}: hello',
        f'{guo}: HELLO',
        f'{hana}: at 7: 30 I say Hello',
        *(f'{name}: Hello' for name in more),
        f'{finn}: Hello World: 1',
        f'{kitty}: Hello',
        f'{guo}: Hello',
        *(f'{name}: Hello' for name in (chidi, bo, eva, last)),
    ]


def _silent(message: str, came: Sequence[str]) -> Mistake | None:
    return None if came else NOT_YET.of(who=message.partition(': ')[0])


exercise = Exercise(
    words=WORDS,
    shared=[TOPIC],
    clauses=(
        Answers(
            TOPIC,
            TOPIC,
            STRING,
            WORDS.of(within=WITHIN).clause('answers'),
            answer=_politely,
            draw=_draw,
            mistakes=MISTAKES,
            explain=_silent,
            resume=None,
            otherwise=NOTHING.text,
        ),
        NOTHING,
    ),
)
