"""Exercise: 1, 3 and 5 from the command line, one message each."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from labkit.exercises import Exercise, Fail, NotAttempted, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.expect import show
from labkit.exercises.messages_heard import Sample
from labkit.lessons.command_line.sent import Commands, OnTopic, Sent

__all__ = ['exercise']

WORDS = words_of(__file__)

INT16 = 'std_msgs/msg/Int16'
TOPIC = '/odds'
WANTED = [1, 3, 5]
EXPECTED = f'the numbers 1, 3 and 5 on {TOPIC}, one message each'


# The next step depends on what is right so far.
GOES_ON = WORDS.mistake('odds/goes-on')
REPEATED = WORDS.mistake('odds/twice-each')
EVEN = WORDS.mistake('odds/evens')
MISSING = WORDS.mistake('odds/only-two')
OTHER_ORDER = WORDS.mistake('odds/in-another-order')
OTHERS_TOO = WORDS.mistake('odds/others-too')


def _values(samples: Sequence[Sample]) -> list[int]:
    return [sample.message.data for sample in samples]


def _is_whole(samples: Sequence[Sample]) -> bool:
    return len(_beginning(samples)) == len(WANTED)


def _beginning(samples: Sequence[Sample]) -> Sequence[Sample]:
    """Return the last messages that are 1, 3 and 5, or 1 and 3, or 1; else nothing."""
    for count in range(len(WANTED), 0, -1):
        before, last = samples[:-count], samples[-count:]
        if _values(last) != WANTED[:count]:
            continue
        # What the same publisher has sent just before belongs to it, unless it was whole, too.
        begins = not before or not _is_next(before[-1], last[0])
        if begins or before[-1].message.data == WANTED[-1]:
            return last
    return ()


def _is_next(earlier: Sample, later: Sample) -> bool:
    """Tell whether two messages are one publisher's, one after the other."""
    return 0 < earlier.number == later.number - 1


def _is_repeated(samples: Sequence[Sample]) -> bool:
    """Tell whether one publisher has sent the same number twice in a row."""
    return any(
        _is_next(earlier, later) and earlier.message.data == later.message.data
        for earlier, later in pairwise(samples)
    )


def _right_so_far(sent: Sent) -> Sequence[Sample]:
    """Return the messages that the next attempt may go on from: a wrong one changes nothing."""
    begun = _beginning(sent.samples)
    return begun if 0 < len(begun) < len(WANTED) else sent.earlier


def _expect_once(sent: Sent) -> None:
    seen = f'data = {show(_values(sent.samples))}'
    if sent.goes_on:
        raise Fail(EXPECTED, f'messages that go on coming: {seen}', GOES_ON)
    if _is_repeated(sent.samples) and not _is_whole(sent.samples):
        raise Fail(EXPECTED, seen, REPEATED.then(_next_step(sent)))


def _expect_numbers(sent: Sent) -> None:
    if _is_whole(sent.samples):
        return
    values = _values(sent.samples)
    if sent.is_running and _beginning(sent.samples):
        raise NotAttempted(
            f'data = {show(values)} so far, and a command still runs. Run this cell again when it '
            'has ended.'
        )
    missing = [number for number in WANTED if number not in values]
    mistake = OTHER_ORDER if sorted(values) == WANTED else OTHERS_TOO
    if all(value % 2 == 0 for value in _values(sent.new)):
        mistake = EVEN
    elif missing:
        mistake = MISSING.of(missing=', '.join(map(str, missing)))
    raise Fail(EXPECTED, f'data = {show(values)}', mistake.then(_next_step(sent)))


def _next_step(sent: Sent) -> str:
    kept = len(_right_so_far(sent))
    if not kept:
        return 'Publish all three numbers again: 1, then 3, then 5.'
    return f'Go on with {", then ".join(map(str, WANTED[kept:]))}.'


_WHERE = OnTopic(TOPIC, INT16)

exercise = Exercise(
    words=WORDS,
    clauses=(
        _WHERE,
        Asked(WORDS.clause('expect-once'), _expect_once),
        Asked(
            WORDS.of(numbers=', then '.join(map(str, WANTED))).clause('expect-numbers'),
            _expect_numbers,
        ),
    ),
    shared=[TOPIC],
    stage=Commands(
        _WHERE,
        EXPECTED,
        'The numbers 1, 3 and 5 came on /odds, one message each.',
        is_whole=_is_whole,
        is_too_much=_is_repeated,
        keep=_right_so_far,
    ),
    records=[TOPIC],
)
