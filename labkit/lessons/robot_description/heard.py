"""The description that a learner's node publishes, as it was heard."""

from __future__ import annotations

from dataclasses import dataclass

from labkit.descriptions.links_and_joints import Description
from labkit.descriptions.urdf import Reading, examine
from labkit.exercises import Fail, NotAttempted, expect, words_of
from labkit.exercises.clauses import Evidence, GraphClause
from labkit.exercises.messages_heard import Sample
from labkit.exercises.what_is_asked import PUBLISHER, Role

__all__ = ['SAME_M', 'SAME_RAD', 'TOPIC', 'Describes', 'described']

WORDS = words_of(__file__)

TOPIC, STRING = '/robot_description', 'std_msgs/msg/String'
# The robots of this lesson; the simulated one says what it looks like on the same topic.
ROBOTS = ('cart', 'scout', 'turtlebot3_burger')
# What differs by less is the same: a learner may round pi / 2 to 1.57.
SAME_M, SAME_RAD = 5e-4, 0.01
# How long what is latched may take to come, s.
COMES_SEC = 5.0

NO_URDF = WORDS.mistake('heard/no-urdf')
NOT_SENT = WORDS.mistake('heard/not-sent')
OTHER_NAME = WORDS.mistake('heard/other-name')


@dataclass(frozen=True)
class Describes(GraphClause):
    """A description of a robot is published, for those who come later, too.

    Attributes:
        robot: The name of the robot.
    """

    robot: str
    own_life = True

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(topic=TOPIC, robot=self.robot).clause('describes')

    @property
    def roles(self) -> dict[Role, str]:
        """Somebody publishes there."""
        return {(PUBLISHER, TOPIC): STRING}

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher."""
        expect.qos(evidence.publisher(TOPIC), durability='transient_local')

    def judge(self, evidence: Evidence) -> str:
        """Read what was heard."""
        found = described(evidence, self.robot)
        return f'{self.robot} has {len(found.links)} links and {len(found.joints)} joints.'


def described(evidence: Evidence, robot: str) -> Description:
    """Return the description that was heard last, and is of no other robot of the lesson.

    Raises:
        NotAttempted: There are only those of other robots of the lesson.
        Fail: There is none, or it is of a robot with another name.
    """
    from labkit.rosgraph.endpoints import publishers

    probe = evidence.probe
    if TOPIC not in evidence.heard:
        watch = evidence.heard[TOPIC] = probe.watch(TOPIC, STRING, latched=True)
        probe.allow(COMES_SEC)
        # Each publisher keeps one; a newer one may come after an older one of somebody else.
        probe.wait(lambda: 0 < len(publishers(probe.node, TOPIC)) <= len(watch), COMES_SEC)
    watch = evidence.heard[TOPIC]
    newest: tuple[Sample, Reading] | None = None
    for sample in sorted(watch.samples, key=lambda sample: sample.stamp):
        reading = examine(sample.message.data)
        name = reading.description.name if reading.description else robot
        if name == robot or name not in ROBOTS:
            newest = sample, reading
    if newest is None and watch.samples:
        raise NotAttempted
    if newest is None:
        raise Fail(f'a description of {robot}', 'none', NOT_SENT)
    reading = newest[1]
    if reading.description is None:
        error = reading.errors[0]
        todo = error.todo or 'See docs/descriptions.md: it lists what is refused.'
        raise Fail(f'a description of {robot} in URDF', str(error), NO_URDF.of(todo=todo))
    name = reading.description.name
    if name != robot:
        raise Fail(f'<robot name="{robot}">', f'<robot name="{name}">', OTHER_NAME.of(robot=robot))
    return reading.description
