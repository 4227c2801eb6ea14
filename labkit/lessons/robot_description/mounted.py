"""Exercise: a camera that is mounted on a robot by one link and one fixed joint."""

from __future__ import annotations

import math
from dataclasses import dataclass

from labkit.descriptions.forward_kinematics import link_transforms
from labkit.descriptions.links_and_joints import Joint, Origin
from labkit.descriptions.urdf import read
from labkit.errors import nearest
from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Evidence, GraphClause
from labkit.exercises.figures import figure
from labkit.lessons.frames.places import Place, metres
from labkit.lessons.robot_description.heard import (
    SAME_M,
    SAME_RAD,
    TOPIC,
    Describes,
    described,
)
from labkit.lessons.robot_description.scout import SCOUT
from labkit.transforms.rotations import Vector, from_rpy

__all__ = ['exercise']

WORDS = words_of(__file__)

ROBOT, BASE, PARENT, CHILD = 'scout', 'base_link', 'head', 'camera_link'
# The task: where the camera is in base_link while the head looks ahead, m, and how far down it
# looks.
FROM_BASE: Vector = (0.09, 0.0, 0.15)
DOWN_DEG = 20.0
DOWN = math.radians(DOWN_DEG)

MISSING = WORDS.mistake('mounted/missing')
MISSPELT = WORDS.mistake('mounted/misspelt')
SWAPPED = WORDS.mistake('mounted/swapped')
ON_BASE = WORDS.mistake('mounted/on-base')
ON_OTHER = WORDS.mistake('mounted/on-other')
LOOSE = WORDS.mistake('mounted/loose')
CHANGED = WORDS.mistake('mounted/changed')
MEASURED = WORDS.mistake('mounted/measured')
UNITS = WORDS.mistake('mounted/units')
PLACE = WORDS.mistake('mounted/place')
DEGREES = WORDS.mistake('mounted/degrees')
NOT_TURNED = WORDS.mistake('mounted/not-turned')
TURN = WORDS.mistake('mounted/turn')
_TURNS = (
    (WORDS.mistake('mounted/up'), (0.0, -DOWN, 0.0)),
    (WORDS.mistake('mounted/roll'), (DOWN, 0.0, 0.0)),
    (WORDS.mistake('mounted/yaw'), (0.0, 0.0, DOWN)),
    (NOT_TURNED, (0.0, 0.0, 0.0)),
)


@dataclass(frozen=True)
class _Mounted(GraphClause):
    """A fixed joint holds the camera on the head, and nothing else has changed."""

    text = WORDS.of(parent=PARENT, child=CHILD).clause('mounted')
    own_life = True

    def judge(self, evidence: Evidence) -> str:
        robot, given = described(evidence, ROBOT), read(SCOUT)
        if CHILD not in robot.links:
            others = [name for name in robot.links if name not in given.links]
            mistake = MISSPELT if nearest(CHILD, others) else MISSING
            raise Fail(f'a link {CHILD}', f'links {", ".join(robot.links)}', mistake)
        joint = robot.holder.get(CHILD)
        expected = f'a joint with parent {PARENT} and child {CHILD}'
        if joint is None:
            raise Fail(expected, f'{CHILD} is the parent of all', SWAPPED)
        if joint.parent != PARENT:
            mistake = ON_BASE if joint.parent == BASE else ON_OTHER
            raise Fail(expected, f'parent {joint.parent} and child {CHILD}', mistake)
        if joint.type != 'fixed':
            raise Fail(f'{joint.name} of type fixed', f'type {joint.type}', LOOSE)
        for kind, before, now in (
            ('link', given.links, robot.links),
            ('joint', given.joints, robot.joints),
        ):
            for name, part in before.items():
                if now.get(name) != part:
                    seen = 'otherwise' if name in now else 'none'
                    raise Fail(f'the {kind} {name} as it was', seen, CHANGED.of(kind=kind))
        return f'{CHILD} turns with the {PARENT}.'


@dataclass(frozen=True)
class _Placed(GraphClause):
    """The camera is where the task says, and looks down as far."""

    text = WORDS.of(child=CHILD, base=BASE, x=FROM_BASE[0], z=FROM_BASE[2], down=DOWN_DEG).clause(
        'placed'
    )
    own_life = True

    def judge(self, evidence: Evidence) -> str:
        robot = described(evidence, ROBOT)
        joint = robot.holder[CHILD]
        found = link_transforms(robot)[CHILD]
        place = Place(found.translation, found.rotation)
        if place.away(Place(FROM_BASE)) > SAME_M:
            head = link_transforms(robot)[PARENT].translation
            raise Fail(
                f'{CHILD} in {BASE}: {metres(FROM_BASE)}',
                f'{metres(place.shift)}; that is the {PARENT} at {metres(head)}, and '
                f'{metres(joint.origin.xyz)} of the joint',
                _why(joint.origin, head),
            )
        if place.turned(Place(FROM_BASE, from_rpy(0.0, DOWN, 0.0))) > SAME_RAD:
            self._refuse_turn(joint, place)
        return f'{CHILD} is at {metres(place.shift)} in {BASE}, and looks down by {DOWN_DEG:.0f}°.'

    def _refuse_turn(self, joint: Joint, place: Place) -> None:
        rpy = joint.origin.rpy
        seen = ', '.join(
            f'{name} = {figure(angle)}'
            for name, angle in zip(('roll', 'pitch', 'yaw'), rpy, strict=True)
        )
        right = f'roll = 0, pitch = {figure(DOWN)}, yaw = 0 (rad)'
        if max(map(abs, rpy)) > math.tau:
            raise Fail(right, seen, DEGREES)
        for mistake, model in _TURNS:
            if place.turned(Place(FROM_BASE, from_rpy(*model))) <= SAME_RAD:
                raise Fail(right, seen, mistake)
        raise Fail(right, seen, TURN)


def _why(origin: Origin, head: Vector) -> Mistake:
    if math.dist(origin.xyz, FROM_BASE) <= SAME_M:
        return MEASURED
    step = [there - here for there, here in zip(FROM_BASE, head, strict=True)]
    for factor in (100.0, 1000.0):
        if math.dist(origin.xyz, [factor * part for part in step]) <= SAME_M:
            return UNITS
    return PLACE


exercise = Exercise(
    words=WORDS,
    clauses=(Describes(ROBOT), _Mounted(), _Placed()),
    shared=(TOPIC,),
)
