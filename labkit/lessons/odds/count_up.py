"""Exercise: the odd numbers, one after the other."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from labkit.exercises import Exercise, Fail, Probe, Solution, expect, words_of
from labkit.exercises.clauses import Messages, Publishes, Stream, often
from labkit.exercises.figures import figure
from labkit.exercises.observation import live
from labkit.exercises.variants import varied

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, INT16 = '/odds', 'std_msgs/msg/Int16'
# The first number that does not fit into an Int16.
LIMIT = 2**15

SAME = WORDS.mistake('count-up/same')
IN_TURN = WORDS.mistake('count-up/in-turn')
EVEN = WORDS.mistake('count-up/even')
STARTS_OVER = WORDS.mistake('count-up/starts-over')
ANOTHER_STEP = WORDS.mistake('count-up/another-step')
ANOTHER_START = WORDS.mistake('count-up/another-start')


def _judge(stream: Stream, first: int, step: int, numbers: str) -> str:
    values = stream.values('data')
    gaps = [later - earlier for earlier, later in pairwise(values)]
    told = expect.show(values)
    found = None
    if not all(value % 2 for value in values):
        found = IN_TURN if any(value % 2 for value in values) else EVEN
    elif any(gap != step for gap in gaps):
        found = STARTS_OVER if min(gaps) < 0 else ANOTHER_STEP
    if found is not None and not any(gaps[1:]):
        found = SAME
    start = stream.samples[0]
    # An Int16 holds no more after so many odd numbers: then the count has to start over.
    if found is None and start.number < (LIMIT - first) // step - 383:
        began = values[0] - step * (start.number - 1)
        if start.number and began != first:
            told = f'{values[0]} as message number {start.number}, so the first one said {began}'
            found = ANOTHER_START
    early = stream.values('data', earlier=True)[: len(stream.earlier)]
    if found is None and early != [first + step * number for number in range(len(early))]:
        told, found = f'{expect.show(early)} before the check', ANOTHER_START
    if found is not None:
        raise Fail(
            f'odd numbers on {TOPIC}: {numbers}',
            f'data = {told} on {TOPIC}',
            found.of(first=first, step=step, number=values[-1]),
        )
    return f'The numbers are {told}.'


def _variant(*, first: int = 1, step: int = 2, hz: float = 5.0) -> Exercise:
    numbers = f'{first}, {first + step}, {first + 2 * step}, ...'
    period, rate = figure(1 / hz), often(hz).partition(' (')[0]
    words = WORDS.of(numbers=numbers, first=first, step=step, period=period, rate=rate)
    return Exercise(
        words=words,
        clauses=(
            Publishes(TOPIC, hz, INT16),
            Messages(
                TOPIC,
                words.clause('messages'),
                lambda stream: _judge(stream, first, step, numbers),
            ),
        ),
        answer=Solution.of(words).changed(
            ('self.number = 1', f'self.number = {first}'),
            ('self.number += 2', f'self.number += {step}'),
            ('create_timer(0.2,', f'create_timer({period},'),
        ),
    )


def _guess(probe: Probe) -> dict[str, Any] | None:
    source = expect.publisher(probe, TOPIC)
    samples = live(probe, {TOPIC: INT16}, 5.0, nodes=[source.node]).on(TOPIC)
    if len(samples) < 3:
        return None
    (first, second), gap = samples[:2], samples[2].at - samples[1].at
    step = second.message.data - first.message.data
    return {
        'first': first.message.data - step * (first.number - 1),
        'step': step,
        'hz': round(1 / gap, 3) if gap else 0.0,
    }


# None is another one plus or minus a few steps.
exercise = varied(
    _variant(), _variant, _guess, first=range(15, 2000, 14), step=(4, 6), hz=(1.0, 2.0)
)
