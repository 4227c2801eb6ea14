"""Exercise: a type of message of one's own, and a node that drives the robot by it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, Mistake, NotAttempted, Solution, anything
from labkit.exercises.clauses import WITHIN, Answers, Evidence, GraphClause, Named
from labkit.exercises.draws import MANY, draw_float, in_a_row

__all__ = ['exercise', 'fields_of']

NODE, TOPIC, COMMANDS = '/walker', '/leg', '/cmd_vel'
PACKAGE, TYPE, TWIST = 'legs_lab', 'legs_lab/msg/Leg', 'geometry_msgs/msg/Twist'
FIELDS = {'speed': 'float64', 'turn': 'float64'}
# A line of a type: a field, with its type first. A constant has = behind its name.
_FIELD = re.compile(r'^\s*(\S+)[ \t]+(\w+)\b[ \t]*(?:$|[^\s=])', re.MULTILINE)

OTHER_TYPE = Mistake(
    'leg/other-type',
    'A type is called like its file, and capital letters count.',
    'Name the file msg/Leg.msg, also in CMakeLists.txt. Build it, and restart the kernel.',
)
OTHER_FIELDS = Mistake(
    'leg/other-fields',
    'A line of a type is a field: its type, a space, its name.',
    'Correct msg/Leg.msg and build it; a program loads a type once, so restart the kernel.',
)
_SPEED, _TURN = 'command.linear.x = msg.speed', 'command.angular.z = msg.turn'
ALWAYS_THE_SAME = Mistake(
    'leg/always-the-same',
    'The speed is not that of the leg that has come.',
    _SPEED,
    model=anything,
    change=[(_SPEED, 'command.linear.x = 0.2')],
)
TO_THE_RIGHT = Mistake(
    'leg/to-the-right',
    'The sign is the other one: a positive angular.z turns to the left.',
    _TURN,
    model=lambda turn: -turn,
    change=[(_TURN, 'command.angular.z = -msg.turn')],
)
DOES_NOT_TURN = Mistake(
    'leg/does-not-turn',
    'The robot turns about its axis z, which points up.',
    _TURN,
    model=lambda turn: 0.0,
    change=[(_TURN, 'command.angular.x = msg.turn')],
)
OTHER_TURN = Mistake(
    'leg/other-turn',
    'The turn is not that of the leg that has come.',
    _TURN,
    model=anything,
    change=[(_TURN, 'command.angular.z = msg.speed')],
)


@dataclass(frozen=True)
class _HasType(GraphClause):
    """This notebook knows the type, with its fields."""

    text = f'the type `{TYPE}` has the fields `speed` and `turn`, both `float64`'

    def find(self, evidence: Evidence) -> None:
        from labkit.rosgraph.interfaces import names_in, path_of

        known = names_in(PACKAGE)
        if not known:
            raise NotAttempted(
                f'Not attempted yet: this notebook knows no package {PACKAGE} with types. Write '
                'its files, build it, and run this cell again.'
            )
        if TYPE not in known:
            raise Fail(f'the type {TYPE}', f'types: {", ".join(known)}', OTHER_TYPE)
        fields = fields_of(path_of(TYPE).read_text(encoding='utf-8', errors='replace'))
        if fields != FIELDS:
            raise Fail(_shown(FIELDS), _shown(fields) or 'no fields', OTHER_FIELDS)


def fields_of(text: str) -> dict[str, str]:
    """Return the names and types of the fields in the text of a type."""
    without_comments = '\n'.join(line.partition('#')[0] for line in text.splitlines())
    return {name: type_name for type_name, name in _FIELD.findall(without_comments)}


def _shown(fields: dict[str, str]) -> str:
    return ', '.join(f'{type_name} {name}' for name, type_name in fields.items())


def _draw() -> Sequence[float]:
    # Ahead and back, left and right, the same twice in a row, and none at all.
    plain = [draw_float(0.05, 0.2), draw_float(-0.2, -0.05)]
    return in_a_row(plain, [0.0], [draw_float(-0.2, 0.2) for _ in range(MANY)])


exercise = Exercise(
    name='leg',
    task=f'Make the type {TYPE}, and a node that drives the robot by such messages on {TOPIC}.',
    clauses=(
        _HasType(),
        Named(NODE),
        Answers(
            TOPIC,
            COMMANDS,
            TYPE,
            f'each leg on `{TOPIC}` leads to one command on `{COMMANDS}` (`{TWIST}`) {WITHIN}, '
            'with `speed` as its speed ahead',
            answer=lambda speed: speed,
            draw=_draw,
            outer_type=TWIST,
            field='speed',
            outer_field='linear.x',
            by=NODE,
            mistakes=[ALWAYS_THE_SAME],
        ),
        Answers(
            TOPIC,
            COMMANDS,
            TYPE,
            'and with `turn` as its turn to the left',
            answer=lambda turn: turn,
            draw=_draw,
            outer_type=TWIST,
            field='turn',
            outer_field='angular.z',
            by=NODE,
            mistakes=[TO_THE_RIGHT, DOES_NOT_TURN, OTHER_TURN],
        ),
    ),
    reliable=(COMMANDS,),
    hints=[
        'The package needs three files, as lab_interfaces does, with the other names in them.',
        'msg/Leg.msg has a line for each field. In CMakeLists.txt: msg/Leg.msg. Then '
        "lab.build('legs_ws').",
        'from legs_lab.msg import Leg; in the callback a Twist with linear.x = msg.speed and '
        'angular.z = msg.turn',
    ],
    answer=Solution(
        __file__,
        'leg.ipy',
        'The two files are those of lab_interfaces, with other names in them. The node does not '
        'care who has made a type: it imports and uses it like all others.',
    ),
)
