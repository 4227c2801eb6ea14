"""Exercise: a node class with two publishers, of two other types, made into a package."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Fail, Outcome, Probe, Solution, Style, Wrong, changed
from labkit.lessons.package.content import Built, Does, Runs, Work, judge_package

if TYPE_CHECKING:
    from labkit.exercises.watch import Watch

__all__ = ['counter']

PACKAGE = 'counter_lab'
TYPES = {'/count': 'std_msgs/msg/Int16', '/half': 'std_msgs/msg/Float64'}
ENOUGH = 6
# Shortest period of the task, s, and what is left of it where a tick comes late.
SHORTEST_SEC = 0.05
SHARE = 0.8

_COUNTER = """
from rclpy.node import Node
from std_msgs.msg import Float64, Int16


class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        self.count_publisher = self.create_publisher(Int16, 'count', 10)
        self.half_publisher = self.create_publisher(Float64, 'half', 10)
        self.timer = self.create_timer(0.2, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.count_publisher.publish(Int16(data=self.count))
        self.half_publisher.publish(Float64(data=self.count / 2))
        self.count += 1


lab.export(Counter, package='counter_lab', folder='src', overwrite=True)
!colcon build --packages-select counter_lab
"""
_EXPORT = "lab.export(Counter, package='counter_lab', folder='src', overwrite=True)\n"
_BUILD = '!colcon build --packages-select counter_lab\n'
_HALF = '        self.half_publisher.publish(Float64(data=self.count / 2))\n'
_SELF = 'self.count / 2'


def _heard(work: Work, topic: str) -> Watch:
    """Return what the node says on a topic."""
    probe, msg_type = work.probe, TYPES[topic]
    ends = [end for end in probe.publishers(topic) if end.node == '/counter']
    if not ends:
        others = [end.topic for end in probe.all_publishers() if end.node == '/counter']
        raise Fail(
            f'a publisher of /counter on {topic}',
            f'it publishes on: {", ".join(sorted(others))}' if others else 'it publishes nothing',
            why='Names must be equal to the last letter.'
            if others
            else 'A node publishes what its class creates a publisher for.',
            todo=f"create_publisher(..., '{topic[1:]}', 10)",
        )
    if ends[0].msg_type != msg_type:
        raise Fail(
            f'messages of type {msg_type} on {topic}',
            f'messages of type {ends[0].msg_type}',
            why='Each topic has its own type here.',
            todo=f'create_publisher({msg_type.rpartition("/")[2]}, ...)',
        )
    watch = probe.watch(topic, msg_type)
    if not work.wait(lambda: len(watch) >= ENOUGH):
        raise Fail(
            f'{ENOUGH} messages on {topic}',
            f'{len(watch)}, after some seconds',
            why='No timer calls publish() again and again, or its period is in seconds.',
            todo='self.create_timer(0.2, self.on_timer)',
        )
    return watch


def _counts(work: Work) -> None:
    watch = _heard(work, '/count')
    gaps = [later.stamp - before.stamp for before, later in pairwise(watch.samples)]
    if median(gaps) < SHARE * SHORTEST_SEC:
        raise Fail(
            'at most 20 numbers a second on /count',
            f'{1 / max(median(gaps), 1e-6):.0f} a second',
            why='The node hardly rests. Who listens can not keep up with it.',
            todo='self.create_timer(0.2, self.on_timer)',
        )
    values = watch.values('data')
    if any(later - before != 1 for before, later in pairwise(values)):
        raise Fail(
            'numbers on /count of which each is one more than the one before',
            str(values),
            why='The number that is published has to rise by one each time.',
            todo='self.count += 1, once each time the timer calls.',
        )


def _halves(work: Work) -> None:
    values = _heard(work, '/half').values('data')
    if any(later - before != 0.5 for before, later in pairwise(values)) or values[0] % 0.5:
        raise Fail(
            'numbers on /half of which each is 0.5 more than the one before',
            str(values),
            why='It is not half of the count: // cuts off what stands behind the point.'
            if all(value == int(value) for value in values)
            else 'It is not half of the count.',
            todo='self.count / 2',
        )


CLAUSES: Sequence[Built | Runs | Does] = [
    Built(PACKAGE),
    Runs('counter', 'counter', PACKAGE),
    Does(
        'the node publishes whole numbers on `/count` (`std_msgs/msg/Int16`), 2 to 20 a second, '
        'each one more than the one before',
        _counts,
    ),
    Does('it publishes half of each of them on `/half` (`std_msgs/msg/Float64`)', _halves),
]


def _judge(probe: Probe) -> str:
    return judge_package(probe, CLAUSES, PACKAGE)


counter = Exercise(
    name='counter',
    task='Make the package counter_lab, whose node counts, and publishes on two topics.',
    clauses=CLAUSES,
    judge=_judge,
    hints=[
        'A node may have as many publishers as it likes, each with a type and a topic.',
        'First write the class, as in the lessons before. One timer may publish on both topics.',
        "lab.export(Counter, package='counter_lab', folder='src', overwrite=True), then build.",
    ],
    answer=Solution(
        _COUNTER,
        'The class is that of a notebook. lab.export adds main(), setup.py and package.xml.',
    ),
    styles=[
        Style('the whole workspace', changed(_COUNTER, (_BUILD, '!colcon build\n'))),
        Style(
            'a constant and a function of other lines',
            changed(
                _COUNTER,
                (
                    '\n\nclass Counter',
                    '\nPERIOD = 0.2\n\n\ndef half(x):\n    return x / 2\n\n\nclass Counter',
                ),
                ('create_timer(0.2', 'create_timer(PERIOD'),
                (_SELF, 'half(self.count)'),
            ),
        ),
        Style(
            'two timers',
            changed(
                _COUNTER,
                (
                    '        self.count = 0\n',
                    '        self.second = self.create_timer(0.2, self.on_second)\n'
                    '        self.count = self.other = 0\n',
                ),
                (_HALF, ''),
                (
                    '\n\nlab.export',
                    '\n    def on_second(self):\n'
                    '        self.half_publisher.publish(Float64(data=self.other / 2))\n'
                    '        self.other += 1\n\n\nlab.export',
                ),
            ),
        ),
        Style(
            'a base class',
            changed(
                _COUNTER,
                ('class Counter(Node)', 'class Named(Node)'),
                (
                    "super().__init__('counter')\n",
                    "super().__init__('counter')\n\n\nclass Counter(Named):\n    def __init__("
                    'self):\n        super().__init__()\n',
                ),
            ),
        ),
    ],
    wrong=[
        Wrong(
            'not exported',
            changed(_COUNTER, (_EXPORT, ''), (_BUILD, '')) + 'lab.spin(Counter())\n',
            'runs in this notebook, and there is no package',
        ),
        Wrong('not built', changed(_COUNTER, (_BUILD, '')), 'colcon build has not been run since'),
        Wrong(
            'beside src',
            changed(_COUNTER, (", folder='src'", '')),
            'Packages lie in the folder src of a workspace.',
        ),
        Wrong(
            'leans on the notebook',
            changed(_COUNTER, ('self.count += 1', 'self.count += lab.start() or 1')),
            "it uses 'lab'",
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'another class name',
            _COUNTER.replace('Counter', 'Count'),
            'executables: count',
        ),
        Wrong(
            'another node name',
            changed(_COUNTER, ("__init__('counter')", "__init__('count')")),
            'The name of the node is what super().__init__() gets.',
        ),
        Wrong(
            'one publisher',
            changed(
                _COUNTER,
                (_HALF, ''),
                ("        self.half_publisher = self.create_publisher(Float64, 'half', 10)\n", ''),
                ('Float64, Int16', 'Int16'),
            ),
            'a publisher of /counter on /half',
        ),
        Wrong(
            'two of one type',
            changed(
                _COUNTER,
                ("(Float64, 'half'", "(Int16, 'half'"),
                ('Float64(data=self.count / 2)', 'Int16(data=self.count // 2)'),
                ('Float64, Int16', 'Int16'),
            ),
            'messages of type std_msgs/msg/Int16',
        ),
        Wrong(
            'by two',
            changed(_COUNTER, ('self.count += 1', 'self.count += 2')),
            'has to rise by one',
        ),
        Wrong(
            'cut off',
            changed(_COUNTER, (_SELF, 'float(self.count // 2)')),
            '// cuts off what stands behind the point',
        ),
        Wrong(
            'without a rest',
            changed(_COUNTER, ('create_timer(0.2', 'create_timer(0.001')),
            'Who listens can not keep up with it.',
        ),
        Wrong(
            'ms for s',
            changed(_COUNTER, ('create_timer(0.2', 'create_timer(200')),
            'its period is in seconds',
        ),
    ],
)
