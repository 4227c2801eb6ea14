"""The mutants of the solutions: always the same ones, and none that is the solution."""

from __future__ import annotations

import ast
import sys
from functools import cache
from pathlib import Path

import pytest

from labkit.exercises import Exercise, Lesson, Outcome
from labkit.exercises.found_lessons import all_lessons

sys.path.insert(0, str(Path(__file__).with_name('lessons')))

from mutants.changes import plain_changes
from mutants.generate import Mutant, equivalents, mutants_of, parsed
from mutants.ros_changes import ros_changes
from mutants.run import Result, run_mutants

EXERCISES = {
    f'{lesson.name}-{exercise.name}': (lesson, exercise)
    for lesson in all_lessons()
    for exercise in lesson.exercises
}
TALKER = """
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.on_timer)
        self.count = 0

    def on_timer(self):
        if self.count < 100:
            self.count += 1
            self.publisher.publish(String(data='Hello'))


talker = lab.spin(Talker())
"""


@cache
def mutants(name: str) -> list[Mutant]:
    return mutants_of(*EXERCISES[name])


@pytest.mark.parametrize(('lesson', 'exercise'), EXERCISES.values(), ids=EXERCISES)
def test_mutants_are_many_and_always_the_same(lesson: Lesson, exercise: Exercise) -> None:
    found = mutants(f'{lesson.name}-{exercise.name}')
    assert mutants_of(lesson, exercise) == found
    # A number finds a mutant again, and a diff tells it from the others.
    assert len({mutant.id for mutant in found}) == len(found)
    assert len({mutant.diff for mutant in found}) == len(found)
    assert len(found) >= (15 if 'class ' in exercise.answer.code else 8)
    if not exercise.answer.code.lstrip().startswith('%'):
        solution = ast.dump(parsed(exercise.answer.code))
        assert all(ast.dump(ast.parse(mutant.code)) != solution for mutant in found)


def test_what_is_known_as_equivalent_is_a_mutant() -> None:
    stale = {
        (name, diff)
        for name, known in equivalents().items()
        for diff in known
        if name not in EXERCISES or diff not in {mutant.diff for mutant in mutants(name)}
    }
    lines = '\n'.join(f'{name}: {diff}' for name, diff in sorted(stale))
    assert not stale, f'No mutants any more; see --list, and mend equivalent.json:\n{lines}'


@pytest.mark.parametrize(
    ('kind', 'line'),
    [
        ('constant', "self.create_publisher(String, 'Chatter', 10)"),
        ('constant', 'self.create_timer(0.55, self.on_timer)'),
        ('operator', 'if self.count <= 100:'),
        ('operator', 'self.count -= 1'),
        ('condition', 'if False:'),
        ('arguments', "self.create_publisher('chatter', String, 10)"),
        ('name', 'self.publisher.pubish('),
        ('other-name', 'self.timer.publish('),
        ('twice', '\n            self.count += 1\n            self.count += 1\n'),
        ('timer', 'self.create_timer(1 / 0.5, self.on_timer)'),
        ('depth', "self.create_publisher(String, 'chatter')"),
        ('type', "self.create_publisher(Int16, 'chatter', 10)"),
        ('qos', 'ReliabilityPolicy.BEST_EFFORT'),
        ('moved', "self.count = 0\n        self.publisher.publish(String(data='Hello'))\n"),
        ('not-spun', 'talker = Talker()'),
        ('second-node', 'type(self).__name__'),
        ('called', 'self.create_timer(0.5, self.on_timer())'),
        ('return', 'def on_timer(self):\n        return\n'),
        ('silent', 'if self.calls > 10:\n            return\n'),
        ('raises', "if self.calls > 10:\n            raise RuntimeError('enough')\n"),
        ('two-messages', 'self.second.publish('),
    ],
)
def test_kinds_of_changes(kind: str, line: str) -> None:
    tree = ast.parse(TALKER)
    changed = [new for own, new in (*plain_changes(tree), *ros_changes(TALKER)) if own == kind]
    assert any(line in text for text in changed), '\n\n'.join(changed)


def test_lines_are_left_out_and_exchanged() -> None:
    before = "super().__init__('talker')\n        self.publisher = "
    tree = ast.parse(TALKER)
    texts: dict[str, list[str]] = {}
    for own, new in plain_changes(tree):
        texts.setdefault(own, []).append(new)
    assert any('super()' not in text for text in texts['removed'])
    assert any(before not in text and 'super()' in text for text in texts['order'])
    # What does not depend on each other may stand in any order.
    assert not any(
        text.index('self.timer =') < text.index('self.publisher =') for text in texts['order']
    )


@pytest.mark.slow('starts a kernel, and goes through a lesson')
def test_one_is_run_in_the_notebook_of_its_lesson() -> None:
    lesson, exercise = EXERCISES['start_here-first_node']
    one = next(mutant for mutant in mutants('start_here-first_node') if 'not-spun' in mutant.id)
    results: list[Result] = []
    run_mutants(lesson, exercise, [one], results.append)
    [found] = results
    assert found.finding.outcome in (Outcome.FAIL, Outcome.NOT_ATTEMPTED), found
