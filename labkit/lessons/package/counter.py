"""Exercise: a node class with two publishers, of two other types, made into a package."""

from __future__ import annotations

from itertools import pairwise

from labkit.exercises import Exercise, Fail, common_mistakes, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.figures import figure, many
from labkit.exercises.messages_heard import Lived
from labkit.exercises.observation import Life
from labkit.lessons.package.content import Built, InAWorkspace, Runs, Work

__all__ = ['exercise']

WORDS = words_of(__file__)

PACKAGE = 'counter_lab'
TYPES = {'/count': 'std_msgs/msg/Int16', '/half': 'std_msgs/msg/Float64'}
# Numbers a second, and how far a rate may be off, as a part of it.
LEAST, MOST, OFF = 2, 20, 0.02
# So many halves may be just outside of what was seen, at the beginning and at the end.
EDGE = 1

TOO_FEW = WORDS.mistake('counter/ms-for-s')
TOO_OFTEN = WORDS.mistake('counter/without-a-rest')
OTHER_STEP = WORDS.mistake('counter/by-two')
CUT_OFF = WORDS.mistake('counter/cut-off')
NOT_HALF = WORDS.mistake('counter/not-half')


def _counts(work: Work) -> None:
    life, samples = _seen(work)
    gaps = [later.at - before.at for before, later in pairwise(samples)]
    rate, few = len(gaps) / sum(gaps), (1 - OFF) * LEAST
    if rate < few or max(gaps) > 1.5 / LEAST + life.step:
        raise Fail(
            f'at least {LEAST} numbers a second on /count, all the time',
            f'{figure(rate)} a second, up to {figure(max(gaps))} s from one to the next',
            TOO_FEW,
        )
    if life.seconds - samples[-1].at > 1.5 / LEAST + life.step:
        raise Fail(
            'numbers on /count without an end',
            f'{many(len(samples), "number")}, and none after {samples[-1].at:.1f} s',
            common_mistakes.STOPS,
        )
    if rate > (1 + OFF) * MOST:
        raise Fail(f'at most {MOST} numbers a second on /count', f'{rate:.0f} a second', TOO_OFTEN)
    values = [sample.message.data for sample in samples]
    wrong = next((pair for pair in pairwise(values) if pair[1] - pair[0] != 1), None)
    if wrong is not None:
        raise Fail(
            'numbers on /count of which each is one more than the one before',
            f'{wrong[1]} after {wrong[0]}',
            OTHER_STEP,
        )


def _halves(work: Work) -> None:
    life, samples = _seen(work)
    # A publisher numbers its messages: the first half belongs to the first number.
    halves = {sample.number: sample.message.data for sample in life.on('/half')}
    for sample in samples[EDGE:-EDGE]:
        right, seen = sample.message.data / 2, halves.get(sample.number)
        if seen != right:
            raise Fail(
                f'{right} on /half for {sample.message.data} on /count',
                'nothing' if seen is None else str(seen),
                CUT_OFF if all(half == int(half) for half in halves.values()) else NOT_HALF,
            )


def _seen(work: Work) -> tuple[Life, list[Lived]]:
    """Return what the node says in half a minute, and its numbers."""
    for topic, msg_type in TYPES.items():
        work.end('/counter', topic, msg_type)
    # More than the task allows has to show.
    life = work.life('/counter', TYPES, step=0.4 / MOST)
    samples = life.on('/count')
    if len(samples) < 2:
        seen = f'{len(samples)} in {life.seconds:.0f} s'
        raise Fail(f'at least {LEAST} messages a second on /count', seen, TOO_FEW)
    return life, samples


exercise = Exercise(
    words=WORDS,
    clauses=(
        Built(PACKAGE),
        Runs('counter', 'counter', PACKAGE),
        Asked(
            WORDS.of(least=LEAST, most=MOST).clause('counts'),
            _counts,
        ),
        Asked(WORDS.clause('halves'), _halves),
    ),
    stage=InAWorkspace(PACKAGE),
)
