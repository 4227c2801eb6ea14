"""Exercise: make a new bag of an old one, with a node in between."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from labkit.exercises import Exercise, Fail, Mistake, Solution, anything
from labkit.exercises.clauses import Asked
from labkit.exercises.expect import digits
from labkit.exercises.mistakes import recognise
from labkit.lessons.bags.content import Found, InABag, IsThere, OnlyTopic

if TYPE_CHECKING:
    from labkit.bags.reader import BagMessage

__all__ = ['exercise']

SOURCE, PATH = 'bags/commands', 'bags/slow'
INNER, OUTER, TWIST = '/cmd_vel', '/slow/cmd_vel', 'geometry_msgs/msg/Twist'

TOO_FEW = Mistake(
    'half_speed/begins-in-the-middle',
    'The recording was not there from the first message to the last one.',
    'Begin to record, then play to the end, then stop.',
    change=[('wait=True', 'start_offset=0.8, wait=True'), ('wait_for(30)', 'wait_for(5)')],
)
TOO_MANY = Mistake(
    'half_speed/played-twice',
    'Commands came more than once: from a second node, or a second playing.',
    'Let one node publish, and play the bag once from its beginning.',
    change=[
        (
            '    recording.wait_for(30)\n',
            "    lab.play('bags/commands', '/cmd_vel', wait=True)\n    recording.wait_for(60)\n",
        ),
    ],
)
_HALVE = 'Publish new messages in the callback, with half of each speed.'
OTHER = Mistake(
    'half_speed/other',
    'That is not half of the command at this place.',
    'Halve each command, and publish it in the callback, so that the order stays.',
    model=anything,
)
# The models return linear.x and angular.z from those of the command.
VALUES = (
    Mistake(
        'half_speed/passed-on',
        'The commands are in the bag as they were.',
        _HALVE,
        model=lambda x, z: (x, z),
    ),
    Mistake(
        'half_speed/a-quarter',
        'The speeds were halved twice.',
        'Let one node halve them, and once.',
        model=lambda x, z: (x / 4, z / 4),
        change=[('msg.linear.x / 2', 'msg.linear.x / 4'), ('z / 2', 'z / 4')],
    ),
    Mistake(
        'half_speed/doubled',
        'The speeds were doubled.',
        'Divide by 2, or multiply by 0.5.',
        model=lambda x, z: (2 * x, 2 * z),
        change=[('msg.linear.x / 2', 'msg.linear.x * 2'), ('z / 2', 'z * 2')],
    ),
    Mistake(
        'half_speed/linear-alone',
        'linear.x is half of what it was, angular.z is not.',
        'Halve both: a robot that turns as fast as before drives another path.',
        model=lambda x, z: (x / 2, z),
        change=[('msg.angular.z / 2', 'msg.angular.z')],
    ),
    Mistake(
        'half_speed/angular-alone',
        'angular.z is half of what it was, linear.x is not.',
        _HALVE,
        model=lambda x, z: (x, z / 2),
        change=[('msg.linear.x / 2', 'msg.linear.x')],
    ),
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
            TOO_FEW if count < wanted else TOO_MANY,
        )


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
    name='half_speed',
    task='Make a bag with the commands of bags/commands at half the speed.',
    clauses=(
        IsThere(PATH, SOURCE),
        OnlyTopic(OUTER, TWIST),
        Asked(f'it has one message for each one on `{INNER}` in `{SOURCE}`', _count),
        Asked(
            '`linear.x` and `angular.z` are half of what they were there, in the same order',
            _values,
        ),
    ),
    stage=InABag(PATH, OUTER),
    publishes={OUTER: TWIST},
    subscribes={INNER: TWIST},
    hints=[
        'Three things work together: something plays the old bag, a node hears it and publishes, '
        'and something records the new bag.',
        'Begin the recording before the playing, so that it hears the first message.',
        "with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording: and inside, "
        "lab.play('bags/commands', wait=True) and recording.wait_for(30)",
    ],
    answer=Solution(
        __file__,
        'half_speed.py',
        'The node does not know that a bag plays. The recording begins first and ends last.',
    ),
)
