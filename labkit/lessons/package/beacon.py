"""Exercise: a package with a quality of service that serves late listeners, and with a test."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, Probe, Solution, Style, Wrong, changed
from labkit.lessons.package.content import Built, Does, Runs, Tested, Work, judge_package

__all__ = ['beacon']

PACKAGE, TOPIC, BOOL = 'beacon_lab', '/lit', 'std_msgs/msg/Bool'

_BEACON = """
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool

LATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Beacon(Node):
    def __init__(self):
        super().__init__('beacon')
        self.publisher = self.create_publisher(Bool, 'lit', LATE)
        self.publisher.publish(Bool(data=True))


lab.export(Beacon, package='beacon_lab', folder='src', overwrite=True)
!colcon build --packages-select beacon_lab
!colcon test --packages-select beacon_lab
"""
_BUILD = '!colcon build --packages-select beacon_lab\n'
_TEST = '!colcon test --packages-select beacon_lab\n'
_OWN = 'from pathlib import Path\n\n'
_TESTS = "Path('src/beacon_lab/test/test_beacon.py')"


def _is_heard_late(work: Work) -> None:
    probe = work.probe
    ends = [end for end in probe.publishers(TOPIC) if end.node == '/beacon']
    if not ends or ends[0].msg_type != BOOL:
        raise Fail(
            f'a publisher of /beacon on {TOPIC}, of type {BOOL}',
            f'type {ends[0].msg_type}' if ends else 'it does not publish there',
            why='Topic and type have to be those of the task.',
            todo="self.create_publisher(Bool, 'lit', LATE)",
        )
    if ends[0].qos.durability.name != 'TRANSIENT_LOCAL':
        raise Fail(
            'durability TRANSIENT_LOCAL',
            f'durability {ends[0].qos.durability.name}',
            why='What is published before somebody subscribes is gone, unless the publisher keeps '
            'it.',
            todo='QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)',
        )
    watch = probe.watch(TOPIC, BOOL, latched=True)
    if not work.wait(lambda: len(watch) > 0):
        raise Fail(
            f'True on {TOPIC}, for who comes late',
            'nothing',
            why='The publisher keeps what it has published, and it has published nothing.',
            todo='self.publisher.publish(Bool(data=True)) in __init__',
        )
    if watch[-1].data is not True:
        raise Fail(
            'True',
            repr(watch[-1].data),
            why='A new message begins with False.',
            todo='Bool(data=True)',
        )


CLAUSES: Sequence[Built | Runs | Does | Tested] = [
    Built(PACKAGE),
    Runs('beacon', 'beacon', PACKAGE),
    Does(
        'who subscribes late to `/lit` (`std_msgs/msg/Bool`) with durability transient local gets '
        '`True`',
        _is_heard_late,
    ),
    Tested(PACKAGE),
]


def _judge(probe: Probe) -> str:
    return judge_package(probe, CLAUSES, PACKAGE)


beacon = Exercise(
    name='beacon',
    task='Make the package beacon_lab, whose node says once that it is lit, and test it.',
    clauses=CLAUSES,
    judge=_judge,
    hints=[
        'Lesson 08 has the profile: QoSProfile with a depth and a durability.',
        'The node publishes once, in its __init__. A publisher that is TRANSIENT_LOCAL keeps it.',
        'lab.export adds a test. Build first, then !colcon test --packages-select beacon_lab',
    ],
    answer=Solution(
        _BEACON,
        'The profile is a constant of the cell, and comes along. The test that lab.export adds '
        'makes the node, and looks at its name.',
    ),
    styles=[
        Style('the whole workspace', changed(_BEACON, (_BUILD, '!colcon build\n'))),
        Style(
            'the profile inside',
            changed(
                _BEACON,
                (
                    '\nLATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n',
                    '',
                ),
                (
                    '        self.publisher = self.create_publisher(Bool, ',
                    '        late = QoSProfile(depth=1)\n'
                    '        late.durability = DurabilityPolicy.TRANSIENT_LOCAL\n'
                    '        self.publisher = self.create_publisher(Bool, ',
                ),
                ("'lit', LATE", "'lit', late"),
            ),
        ),
        Style(
            'again and again',
            changed(
                _BEACON,
                (
                    '        self.publisher.publish(Bool(data=True))\n',
                    '        self.create_timer(0.5, self.on_timer)\n\n    def on_timer(self):\n'
                    '        self.publisher.publish(Bool(data=True))\n',
                ),
            ),
        ),
        Style(
            'a test of its own',
            changed(
                _BEACON,
                ('from rclpy.node', f'{_OWN}from rclpy.node'),
                (
                    _BUILD,
                    f"{_TESTS}.write_text('def test_sum():\\n    assert 1 + 1 == 2\\n')\n{_BUILD}",
                ),
            ),
        ),
    ],
    wrong=[
        Wrong(
            'not built', changed(_BEACON, (_BUILD + _TEST, '')), 'colcon build has not been run'
        ),
        Wrong('not tested', changed(_BEACON, (_TEST, '')), 'colcon build does not run tests.'),
        Wrong(
            'built after the test',
            changed(_BEACON, (_BUILD + _TEST, _BUILD + _TEST + _BUILD)),
            'no result of a test since the last build',
        ),
        Wrong(
            'a depth alone',
            changed(
                _BEACON,
                ('QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)', '10'),
                ('from rclpy.qos import DurabilityPolicy, QoSProfile\n', ''),
            ),
            'durability VOLATILE',
        ),
        Wrong(
            'publishes nothing',
            changed(_BEACON, ('        self.publisher.publish(Bool(data=True))\n', '')),
            'and it has published nothing',
        ),
        Wrong(
            'False', changed(_BEACON, ('Bool(data=True)', 'Bool()')), 'A new message begins with'
        ),
        Wrong(
            'another topic',
            changed(_BEACON, ("'lit'", "'light'")),
            'it does not publish there',
        ),
        Wrong(
            'another node name',
            changed(_BEACON, ("__init__('beacon')", "__init__('lamp')")),
            'The name of the node is what super().__init__() gets.',
        ),
        Wrong(
            'a test that fails',
            changed(
                _BEACON,
                ('from rclpy.node', f'{_OWN}from rclpy.node'),
                (
                    _BUILD,
                    f"{_TESTS}.write_text('def test_sum():\\n    assert 1 + 1 == 3\\n')\n{_BUILD}",
                ),
            ),
            '1 failures and 0 errors in 1 tests',
        ),
        Wrong(
            'a test that is not found',
            changed(
                _BEACON,
                ('from rclpy.node', f'{_OWN}from rclpy.node'),
                (_BUILD, f"{_TESTS}.write_text('assert 1 + 1 == 2\\n')\n{_BUILD}"),
            ),
            'no test that has run',
        ),
    ],
)
