"""Exercise: make a new bag of an old one, with a node in between."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from labkit.exercises import Exercise, Fail, Mistake, anything, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.expect import digits
from labkit.exercises.mistakes import recognise
from labkit.lessons.bags.content import Found, InABag, IsThere, OnlyTopic

if TYPE_CHECKING:
    from labkit.bags.reader import BagMessage

__all__ = ['exercise']

WORDS = words_of(__file__)

SOURCE, PATH = 'bags/commands', 'bags/slow'
INNER, OUTER, TWIST = '/cmd_vel', '/slow/cmd_vel', 'geometry_msgs/msg/Twist'

TOO_FEW = WORDS.mistake('half_speed/begins-in-the-middle')
LAST_MISSING = WORDS.mistake('half_speed/last-missing')
LEFT_OUT = WORDS.mistake('half_speed/left-out')
MORE_AFTER = WORDS.mistake('half_speed/more-after')
TOO_MANY = WORDS.mistake('half_speed/played-twice')
OTHER = WORDS.mistake('half_speed/other', anything)
# The models return linear.x and angular.z from those of the command.
VALUES = (
    WORDS.mistake('half_speed/passed-on', lambda x, z: (x, z)),
    WORDS.mistake('half_speed/a-quarter', lambda x, z: (x / 4, z / 4)),
    WORDS.mistake('half_speed/doubled', lambda x, z: (2 * x, 2 * z)),
    WORDS.mistake('half_speed/linear-alone', lambda x, z: (x / 2, z)),
    WORDS.mistake('half_speed/angular-alone', lambda x, z: (x, z / 2)),
    OTHER,
)


def _commands() -> list[tuple[float, float]]:
    """Return the commands of the given bag."""
    from labkit.bags.reader import open_bag

    with open_bag(SOURCE) as bag:
        return _numbers(list(bag.messages(INNER)))


def _numbers(messages: Sequence[BagMessage]) -> list[tuple[float, float]]:
    return [(each.message.linear.x, each.message.angular.z) for each in messages]


def _count(found: Found) -> None:
    count, wanted = len(found.messages), len(_commands())
    if count != wanted:
        raise Fail(
            f'{wanted} messages on {OUTER}: as many as there are on {INNER} in {SOURCE}',
            f'{count}',
            _miscounted([(x / 2, z / 2) for x, z in _commands()], _numbers(found.messages)),
        )


def _miscounted(
    rights: Sequence[tuple[float, float]], seen: Sequence[tuple[float, float]]
) -> Mistake:
    """Return why there are too many messages, or too few."""

    def same(some: Sequence[tuple[float, float]], others: Sequence[tuple[float, float]]) -> bool:
        return all(math.dist(*pair) < 1e-6 for pair in zip(some, others, strict=False))

    more = len(seen) - len(rights)
    if more > 0:
        besides = same(rights, seen) and not same(seen[len(rights) :], rights)
        return MORE_AFTER.of(count=more) if besides else TOO_MANY
    if seen and same(seen, rights):
        return LAST_MISSING.of(count=len(seen))
    if seen and same(seen, rights[-more:]):
        return TOO_FEW
    number = _left_out(rights, seen)
    return LEFT_OUT.of(number=number) if number else TOO_FEW


def _left_out(rights: Sequence[tuple[float, float]], seen: Sequence[tuple[float, float]]) -> int:
    """Return which right message, from 1, is the first one missing; 0 if others came, too."""
    left, missing = list(seen), 0
    for number, right in enumerate(rights, start=1):
        if left and math.dist(right, left[0]) < 1e-6:
            del left[0]
        elif not missing:
            missing = number
    return 0 if left else missing


def _values(found: Found) -> None:
    commands, seen = _commands(), _numbers(found.messages)
    for number, ((x, z), told, one) in enumerate(
        zip(commands, seen, found.messages, strict=True), start=1
    ):
        others = _others(one.message)
        if others:
            raise Fail(
                f'linear.x and angular.z alone in message {number}, as in {SOURCE}', others, OTHER
            )
        right = x / 2, z / 2
        if math.dist(told, right) < 1e-6:
            continue
        wanted, had = (
            'linear.x = {}, angular.z = {}'.format(*map(digits, *pair))
            for pair in ((right, told), (told, right))
        )
        raise Fail(f'{wanted} in message {number}', had, _recognised(commands, seen))


def _others(message: Any) -> str:
    """Return the numbers of a Twist that none of the commands has, as far as they are not 0."""
    names = ('linear.y', 'linear.z', 'angular.x', 'angular.y')
    numbers = {name: attrgetter(name)(message) for name in names}
    return ', '.join(
        f'{name} = {digits(number, 0.0)}' for name, number in numbers.items() if number
    )


def _recognised(
    commands: Sequence[tuple[float, float]], seen: Sequence[tuple[float, float]]
) -> Mistake | None:
    # One command may fit several: half of 0.0 is 0.0. All of them fit one.
    def fits(mistake: Mistake) -> bool:
        model = mistake.model
        assert model is not None
        return model is anything or all(
            math.dist(model(*command), each) < 1e-6
            for command, each in zip(commands, seen, strict=True)
        )

    return recognise(VALUES, fits)


exercise = Exercise(
    words=WORDS,
    clauses=(
        IsThere(PATH, SOURCE),
        OnlyTopic(OUTER, TWIST),
        Asked(WORDS.clause('count'), _count),
        Asked(
            WORDS.clause('values'),
            _values,
        ),
    ),
    stage=InABag(PATH, OUTER),
    publishes={OUTER: TWIST},
    subscribes={INNER: TWIST},
)
