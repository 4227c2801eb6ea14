"""What a check says where something is there, and nothing of it is what the exercise asks for."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from typing import Any, cast

import pytest
from rclpy.node import Node
from std_msgs.msg import Int16, String

from labkit.exercises import Exercise, Lesson, Outcome, Solution
from labkit.exercises.attempts import _may_mean
from labkit.exercises.clauses import Publishes
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION, Scope

INT16 = 'std_msgs/msg/Int16'
TWIST = 'geometry_msgs/msg/Twist'


@pytest.fixture
def lesson(lab: ModuleType) -> Lesson:
    def asking(name: str) -> Exercise:
        return Exercise(
            name=name,
            task='A task.',
            publishes={f'/{name}': INT16},
            clauses=[Publishes(f'/{name}', 5.0, INT16)],
            hints=['', ''],
            answer=Solution('', '', ''),
        )

    return Lesson(
        'odds', '04_odds.ipynb', exercises=[asking('ones'), asking('evens')], topics=['/demo']
    )


def test_a_node_that_does_something_else_is_named(lab: ModuleType, lesson: Lesson) -> None:
    node = lab.spin(Node('eager'))
    node.create_publisher(String, 'answers', 10)
    verdict = lesson.ones.check()
    assert verdict.outcome is Outcome.FAIL
    assert '/eager, which publishes on /answers (std_msgs/msg/String)' in verdict.seen
    assert lesson.ones.clauses[0].text in verdict.expected


def test_a_node_that_does_nothing_is_named(lab: ModuleType, lesson: Lesson) -> None:
    lab.spin(Node('idle'))
    assert '/idle, which neither publishes nor subscribes' in lesson.ones.check().seen


def test_a_node_of_another_exercise_or_of_the_lesson_is_no_trace(
    lab: ModuleType, lesson: Lesson
) -> None:
    lab.spin(Node('maker')).create_publisher(Int16, 'evens', 10)
    lab.spin(Node('guide')).create_publisher(Int16, 'demo', 10)
    assert lesson.ones.check().outcome is Outcome.NOT_ATTEMPTED


def test_a_class_that_is_never_used_is_named(kernel: Any) -> None:
    kernel.run('import labkit as lab; lesson = lab.lesson("odds")')
    kernel.run('from rclpy.node import Node\nclass Ones(Node): ...')
    assert 'NOT ATTEMPTED' in kernel.run('lesson.ones.check()').text
    kernel.run("class Ones(Node):\n    def __init__(self):\n        super().__init__('ones')")
    assert 'the class Ones, and no node of it' in kernel.run('lesson.ones.check()').text
    kernel.run('node = Ones(); lab.remove(node)')
    assert 'the class Ones' not in kernel.run('lesson.ones.check()').text


@pytest.mark.slow('several kernels')
def test_a_node_with_a_name_that_the_lesson_uses_is_the_learners(kernel: Any) -> None:
    kernel.run('import labkit as lab; lesson = lab.lesson("odds")')
    kernel.run('from rclpy.node import Node\nfrom std_msgs.msg import Int16')
    made = "node = lab.spin(Node('announcer')); node.create_publisher(Int16, 'ones', 10)"
    kernel.run(made, cell_id='repair')
    assert 'NOT ATTEMPTED' in kernel.run('lesson.ones.check()').text
    kernel.run(made, cell_id='ones-starter')
    assert kernel.run('lesson.ones.check()').text.startswith('FAIL: ones')


def test_a_process_that_has_ended_is_named(kernel: Any) -> None:
    kernel.run('import labkit as lab, subprocess, sys; lesson = lab.lesson("odds")')
    kernel.run("other = subprocess.Popen([sys.executable, '-c', 'pass']); other.wait()")
    assert 'NOT ATTEMPTED' in kernel.run('lesson.ones.check()').text
    kernel.run("""program = "raise SystemExit(3)  # was to publish on /ones" """)
    kernel.run("mine = subprocess.Popen([sys.executable, '-c', program]); mine.wait()")
    assert 'has ended with exit code 3' in kernel.run('lesson.ones.check()').text


def test_a_program_of_an_earlier_exercise_is_no_trace_where_all_roles_are_theirs() -> None:
    speaks, hears = (PUBLISHER, '/cmd_vel'), (SUBSCRIPTION, '/odom')
    scope = Scope(publishes={'/cmd_vel': TWIST}, earlier=frozenset({speaks, hears}))
    probe = cast(Any, SimpleNamespace(scope=scope))
    program = "node.create_publisher(Twist, 'cmd_vel', 10)\n"
    assert _may_mean(probe, program)
    assert not _may_mean(probe, program + "node.create_subscription(Odometry, 'odom', f, 10)")


SPIN_IN_THREAD = (
    'import threading\nspun = threading.Thread(target=rclpy.spin, args=(node,))\n'
    'spun.start()\nspun.join()'
)


@pytest.mark.slow('several kernels')
@pytest.mark.parametrize(
    ('how', 'said', 'spin'),
    [
        ('rclpy.shutdown()', 'called rclpy.shutdown()', 'lab.spin(node)'),
        ('raise SystemExit', 'ended its program (SystemExit)', 'lab.spin(node)'),
        ('raise SystemExit', 'ended its program (SystemExit)', 'rclpy.spin(node)'),
        ('raise SystemExit', 'ended its program (SystemExit)', SPIN_IN_THREAD),
    ],
)
def test_a_node_that_has_ended_itself_is_named(
    kernel: Any, how: str, said: str, spin: str
) -> None:
    kernel.run('import labkit as lab, rclpy; lesson = lab.lesson("odds")')
    kernel.run(
        'from rclpy.node import Node\nfrom std_msgs.msg import Int16\n'
        "node = Node('ones'); node.create_publisher(Int16, 'ones', 10)\n"
        f'def last():\n    {how}\n'
        f'timer = node.create_timer(0.1, last)\n{spin}'
    )
    kernel.run('from labkit.background.runtime import runtime')
    kernel.run('import time\nwhile not runtime.ended: time.sleep(0.01)')
    told = kernel.run('lesson.ones.check()').text
    assert f'/ones has ended, because its callback last {said}' in ' '.join(told.split())


@pytest.mark.slow('another process is killed')
def test_a_node_of_which_the_graph_has_lost_the_name_is_told_so(
    lab: ModuleType, lesson: Lesson
) -> None:
    earlier = Node('maker')
    with earlier.handle:
        # Past labkit, which would wait until nobody holds it.
        Node.destroy_node(earlier)
        node = lab.spin(Node('maker'))
        node.create_publisher(Int16, 'ones', 10)
    assert 'the graph has lost the name' in lesson.ones.check().seen
