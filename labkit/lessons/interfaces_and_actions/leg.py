"""Exercise: a type of message of one's own, and a node that drives the robot by it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, NotAttempted, anything, words_of
from labkit.exercises.clauses import WITHIN, Answers, Evidence, GraphClause, Named
from labkit.exercises.draws import MANY, MORE, draw_float, draw_size, in_a_row

__all__ = ['exercise', 'fields_of']

WORDS = words_of(__file__)

NODE, TOPIC, COMMANDS = '/walker', '/leg', '/cmd_vel'
PACKAGE, TYPE, TWIST = 'legs_lab', 'legs_lab/msg/Leg', 'geometry_msgs/msg/Twist'
FIELDS = {'speed': 'float64', 'turn': 'float64'}
# A line of a type: a field, with its type first. A constant has = behind its name.
_FIELD = re.compile(r'^\s*(\S+)[ \t]+(\w+)\b[ \t]*(?:$|[^\s=])', re.MULTILINE)

OTHER_TYPE = WORDS.mistake('leg/other-type')
OTHER_FIELDS = WORDS.mistake('leg/other-fields')
_SPEED, _TURN = 'command.linear.x = msg.speed', 'command.angular.z = msg.turn'
ALWAYS_THE_SAME = WORDS.mistake('leg/always-the-same', anything)
TO_THE_RIGHT = WORDS.mistake('leg/to-the-right', lambda turn: -turn)
DOES_NOT_TURN = WORDS.mistake('leg/does-not-turn', lambda turn: 0.0)
OTHER_TURN = WORDS.mistake('leg/other-turn', anything)


@dataclass(frozen=True)
class _HasType(GraphClause):
    """This notebook knows the type, with its fields."""

    text = WORDS.clause('has-type')

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
    large = [draw_size(0.5, 5.0), -draw_size(0.5, 5.0), draw_float(50.0, 900.0)]
    more = [draw_float(-0.2, 0.2) for _ in range(MANY + MORE)]
    return in_a_row(plain, [0.0, 0.001, *large], more)


exercise = Exercise(
    words=WORDS,
    clauses=(
        _HasType(),
        Named(NODE),
        Answers(
            TOPIC,
            COMMANDS,
            TYPE,
            WORDS.of(within=WITHIN).clause('answers'),
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
            WORDS.clause('answers-2'),
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
)
