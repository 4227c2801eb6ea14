"""Exercise: the frame of a sensor that is mounted as a drawing says."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, expect, words_of
from labkit.exercises.clauses import Evidence, GraphClause, Named
from labkit.exercises.figures import figure
from labkit.exercises.what_is_asked import PUBLISHER, Role
from labkit.lessons.frames.arm import SHEET
from labkit.lessons.frames.places import TF, Place, degrees, metres, on_floor

__all__ = ['NODE', 'SAME_M', 'SAME_RAD', 'TOPIC', 'Static', 'exercise', 'static_messages']

WORDS = words_of(__file__)

NODE, TOPIC = '/sonar_driver', '/tf_static'
PARENT, CHILD = 'base_link', 'sonar_link'
# The drawing, images/14_mount.svg: cm ahead, to the left and up, degrees to the left.
CM, DEG = (6.0, 4.0, 12.0), 30.0
MOUNT = on_floor(CM[0] / 100, CM[1] / 100, math.radians(DEG), CM[2] / 100)
# Places and angles that differ by less are the same: a learner may round sin and cos.
SAME_M, SAME_RAD = 1e-4, 0.01
# How long what is latched may take to come, s.
COMES_SEC = 5.0

MOVING = WORDS.mistake('mount/moving')
SWAPPED = WORDS.mistake('mount/swapped')
OTHER_PARENT = WORDS.mistake('mount/other-parent')
OTHER_CHILD = WORDS.mistake('mount/other-child')
NOT_SENT = WORDS.mistake('mount/not-sent')
OTHER_PLACE = WORDS.mistake('mount/other-place')
OTHER_TURN = WORDS.mistake('mount/other-turn')
NO_LENGTH = WORDS.mistake('mount/length')
_MODELS: Sequence[tuple[Mistake, Place]] = (
    (WORDS.mistake('mount/centimetres'), Place(CM, MOUNT.turn)),
    (WORDS.mistake('mount/to-the-right'), Place((0.06, -0.04, 0.12), MOUNT.turn)),
    (WORDS.mistake('mount/inverted'), MOUNT.back),
    (WORDS.mistake('mount/degrees'), on_floor(0.06, 0.04, DEG, 0.12)),
    (WORDS.mistake('mount/clockwise'), on_floor(0.06, 0.04, -math.radians(DEG), 0.12)),
    (WORDS.mistake('mount/whole-angle'), on_floor(0.06, 0.04, 2 * math.radians(DEG), 0.12)),
    (WORDS.mistake('mount/not-turned'), Place(MOUNT.shift)),
)


def static_messages(evidence: Evidence, found: Callable[[list[Any]], bool]) -> list[Any]:
    """Return the messages on /tf_static, when a condition on them is true or time is over."""
    watch = evidence.probe.watch(TOPIC, TF, latched=True)

    def messages() -> list[Any]:
        watch.pump()
        return [sample.message for sample in watch.samples]

    evidence.probe.wait(lambda: found(messages()), COMES_SEC)
    return messages()


@dataclass(frozen=True)
class Static(GraphClause):
    """A node sends transforms on /tf_static, for those who come later, too.

    Attributes:
        words: What is asked for, in words of the task.
        node: Full name of the node.
    """

    words: str
    node: str
    own_life = True

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    @property
    def roles(self) -> dict[Role, str]:
        """It publishes there."""
        return {(PUBLISHER, TOPIC): TF}

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher."""
        probe = evidence.probe

        def speaks(topic: str) -> bool:
            return self.node in {end.node for end in probe.publishers(topic)}

        if probe.publishers('/tf') and speaks('/tf') and not speaks(TOPIC):
            raise Fail(f'{self.node} publishes on {TOPIC}', 'it publishes on /tf', MOVING)
        expect.qos(evidence.publisher(TOPIC, self.node), durability='transient_local')


def _transforms(messages: Sequence[Any]) -> list[Any]:
    return [each for message in messages for each in message.transforms]


def _mine(messages: Sequence[Any]) -> list[Any]:
    return [
        each
        for each in _transforms(messages)
        if CHILD in (each.child_frame_id, each.header.frame_id)
    ]


@dataclass(frozen=True)
class _AsDrawn(GraphClause):
    """The transform is that of the drawing."""

    text = WORDS.of(parent=PARENT, child=CHILD).clause('as-drawn')
    own_life = True

    def judge(self, evidence: Evidence) -> str:
        messages = static_messages(evidence, lambda found: bool(_mine(found)))
        mine = _mine(messages)
        expected = f'a transform from {PARENT} to {CHILD}'
        if not mine:
            others = _strange(_transforms(messages))
            seen = f'transforms to {", ".join(others)}' if others else 'none'
            raise Fail(expected, seen, OTHER_CHILD if others else NOT_SENT)
        names = [(each.header.frame_id, each.child_frame_id) for each in mine]
        for parent, child in names:
            if (parent, child) == (PARENT, CHILD):
                continue
            mistake = SWAPPED if parent == CHILD else OTHER_PARENT.of(parent=parent)
            raise Fail(expected, f'one from {parent!r} to {child!r}', mistake)
        place = Place.of(mine[-1].transform)
        right = f'{metres(MOUNT.shift)}; {degrees(MOUNT.turn)}'
        seen = f'{metres(place.shift)}; {degrees(place.turn)}'
        if not place.is_rotation:
            parts = zip('xyzw', place.turn, strict=True)
            seen = ', '.join(f'{name} = {figure(part)}' for name, part in parts)
            seen += f', of length {figure(place.length)}'
            raise Fail('a quaternion of length 1', seen, NO_LENGTH)
        if not _same(place, MOUNT):
            found = next((each for each, model in _MODELS if _same(place, model)), None)
            if found is None:
                found = OTHER_PLACE if place.away(MOUNT) > SAME_M else OTHER_TURN
            raise Fail(right, seen, found)
        return f'{CHILD} is at {metres(place.shift)} in {PARENT}, turned by {DEG:.0f}\u00b0.'


def _same(one: Place, other: Place) -> bool:
    return one.away(other) <= SAME_M and one.turned(other) <= SAME_RAD


def _strange(transforms: Sequence[Any]) -> list[str]:
    """Return the frames that are not parts of the robot, and no frames of other exercises."""
    from builtin_interfaces.msg import Time

    from labkit.sim.parts import static_parts

    known = {*SHEET, *(each.child_frame_id for each in static_parts(Time()))}
    return sorted({each.child_frame_id for each in transforms} - known)


exercise = Exercise(
    words=WORDS,
    clauses=(
        Named(NODE),
        Static(WORDS.of(topic=TOPIC).clause('static'), NODE),
        _AsDrawn(),
    ),
    shared=(TOPIC,),
)
