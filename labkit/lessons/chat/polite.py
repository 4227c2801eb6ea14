"""Exercise: greet each person once, so that two who do so come to an end."""

from __future__ import annotations

from collections.abc import Generator, Sequence

from labkit.exercises import Exercise, Mistake, Solution
from labkit.exercises.clauses import WITHIN, Answers, Words
from labkit.exercises.draws import draw_names

__all__ = ['exercise']

TOPIC, STRING = '/lounge', 'std_msgs/msg/String'
ME = 'Ada'
NOTHING = Words(f'publish nothing for any other message, nor for what {ME} herself has said')


def _greet(message: str) -> str:
    return f'{ME}: Hello, {message.partition(": ")[0]}'


def _says_hello(message: str) -> bool:
    return 'Hello' in message.partition(': ')[2]


MISTAKES = (
    Mistake(
        'polite/herself',
        f'That was said by {ME} herself.',
        f'Leave out what {ME} has said: who != {ME!r}',
        model=lambda message: {ME: _greet(ME)}[message.partition(': ')[0]],
    ),
    Mistake(
        'polite/each-time',
        'The same person was greeted before. Two nodes that always reply never come to an end.',
        'Keep the names of those whom you have greeted, in a set: self.greeted.add(who)',
        model=lambda message: _greet(message) if _says_hello(message) else None,
        change=[('            self.greeted.add(who)\n', '')],
    ),
    Mistake(
        'polite/everything',
        'This message does not say Hello.',
        "Reply if 'Hello' in text.",
        model=_greet,
        change=[("'Hello' in text and ", 'msg.data != text and ')],
    ),
)
NOT_YET = Mistake(
    'polite/not-yet',
    '{who} says Hello and was not greeted yet.',
    'Greet each one at the first Hello, and only then put the name into the set.',
)


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
    bo, chidi, eva, finn, guo, hana, *more = draw_names(18)
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
        f'{finn}: Hello',
        f'{kitty}: Hello',
        f'{guo}: Hello',
        *(f'{name}: Hello' for name in (chidi, bo, eva)),
    ]


def _silent(message: str, came: Sequence[str]) -> Mistake | None:
    return None if came else NOT_YET.of(who=message.partition(': ')[0])


exercise = Exercise(
    name='polite',
    task='Greet each person on /lounge once, at the first Hello.',
    shared=[TOPIC],
    clauses=(
        Answers(
            TOPIC,
            TOPIC,
            STRING,
            f'when somebody says `Hello` for the first time on `{TOPIC}`, publish `{ME}: Hello, ` '
            f'and their name, {WITHIN}',
            answer=_politely,
            draw=_draw,
            mistakes=MISTAKES,
            explain=_silent,
            resume=None,
            otherwise=NOTHING.text,
        ),
        NOTHING,
    ),
    hints=[
        'A node hears what it publishes itself, if it subscribes to the same topic.',
        'A set holds each thing once: greeted = set(), greeted.add(who), who in greeted',
        "if 'Hello' in text and who not in self.greeted: with {'Ada'} in it from the beginning",
    ],
    answer=Solution(
        __file__,
        'polite.py',
        'The set remembers who was greeted. With their own name in it from the beginning, nobody '
        'greets himself.',
    ),
)
