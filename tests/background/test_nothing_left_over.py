"""Nodes that are hard to destroy: they are gone all the same, and their error is shown."""

from __future__ import annotations

import pytest

SETUP = """
import sys
import labkit as lab
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from labkit.background.runtime import runtime
from labkit.rosgraph.snapshot import node_names

lab.start()

def gone(name='/mover'):
    lab.wait_until(lambda: name not in node_names(runtime.helper))
"""
MOVER = """
class Mover(Node):
    def __init__(self):
        super().__init__('mover')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.ticks = 0
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.ticks += 1

    def destroy_node(self):
        {wrong}
"""
SPIN = 'mover = lab.spin(Mover())\nlab.wait_until(lambda: mover.ticks)\n'
RIGHT = MOVER.format(wrong='super().destroy_node()') + SPIN
# Body of a learner's destroy_node -> the error shown.
WRONG = {
    'self.publisher.publish(Twist)': 'TypeError',
    'Twist().linear.x = 1': "The 'x' field must be of type 'float'",
    'self.publsher.publish(Twist())': "no attribute 'publsher'",
    'super().destroy_nod()': "no attribute 'destroy_nod'",
    'sys.exit(3)': 'SystemExit: 3',
    'self.publisher.publish(Twist())': 'End it with super().destroy_node().',
}
ENDS = {
    'its cell is run again': RIGHT,
    'removed by name': "lab.remove('mover')",
    'removed': 'lab.remove(mover)',
    'stopped': 'lab.stop()\nlab.start()',
}

LEAVES = {
    'removed': 'lab.remove(mover)',
    'stopped': 'lab.stop()\nlab.start()',
    'destroyed in a cell': 'mover.destroy_node()',
    'destroyed in a callback': "helper = Node('helper')\n"
    'helper.create_timer(0.01, lambda: mover.destroy_node())\nlab.spin(helper)',
}


@pytest.mark.parametrize('wrong', WRONG)
def test_a_node_whose_end_fails_is_gone_and_its_error_is_shown(kernel, wrong):
    kernel.run(SETUP)
    for way, code in ENDS.items():
        assert not kernel.run(MOVER.format(wrong=wrong) + SPIN).error, way
        ended = kernel.run(code)
        assert ended.error == '', way
        assert 'destroy_node() of /mover failed.' in ended.text, way
        assert WRONG[wrong] in ended.text, way
        if way == 'its cell is run again':
            once = kernel.run(
                "lab.wait_until(lambda: node_names(runtime.helper).count('/mover') == 1)"
            )
            assert once.error == ''
            assert not kernel.run("lab.remove('mover')").text
        assert kernel.run('gone()').error == '', way
    assert kernel.run(RIGHT).text == ''


@pytest.mark.parametrize('how', LEAVES)
def test_no_service_of_a_node_that_has_ended_is_left(kernel, how):
    """rclpy leaves the type description service, and its memory."""

    def services():
        lines = kernel.run('%ros2 service list').text.splitlines()
        return [line for line in lines if line.startswith('/mover/')]

    kernel.run(SETUP)
    for _ in range(2):
        assert kernel.run(RIGHT).error == ''
        assert len(services()) == 7
    assert kernel.run(LEAVES[how] + '\ngone()').error == ''
    assert services() == []


def test_the_kernel_ends_with_such_a_node(kernel):
    kernel.run(SETUP)
    kernel.run(MOVER.format(wrong='self.publisher.publish(Twist)') + SPIN)
    assert kernel.shutdown() == 0
    assert 'terminate called' not in kernel.log


def test_a_script_ends_with_such_a_node(script):
    result = script(SETUP + MOVER.format(wrong='self.publisher.publish(Twist)') + SPIN)
    assert result.exit_code == 0
    assert 'destroy_node() of /mover failed.' in result.stderr
    assert 'self.publisher.publish(Twist)' in result.stderr


def test_who_ends_a_node_learns_what_its_end_has_raised(kernel):
    kernel.run(SETUP)
    kernel.run(MOVER.format(wrong='1 / 0') + SPIN)
    result = kernel.run(
        'error = runtime.discard(runtime.entry_of(mover))\n'
        'known = runtime.console.errors[-1]\n'
        'print(type(error).__name__, known.error is error, known.node_name, known.callback)\n'
        'print(runtime.destroy(mover))'
    )
    assert 'ZeroDivisionError True /mover destroy_node\nNone\n' in result.text


def test_the_stop_button_ends_a_node_that_does_not_want_to(kernel):
    kernel.run(SETUP)
    endless = MOVER.format(
        wrong="print('ending', flush=True)\n        while True:\n            pass"
    )
    for end in ("lab.remove('mover')", 'lab.stop()'):
        kernel.run('lab.start()')
        kernel.run('other = lab.spin(Node("other"))\n' + endless + SPIN)
        cell = kernel.start(end)
        kernel.wait_for_output(cell, 'ending')
        kernel.interrupt()
        assert kernel.finish(cell).error.startswith('KeyboardInterrupt')
        result = kernel.run('lab.start()\ngone()\nprint(runtime.unspun_nodes())')
        assert (result.error, result.text) == ('', '[]\n')


@pytest.mark.parametrize(
    'left',
    [
        "idle = Node('mover')",
        "Node('mover').create_publisher(Twist, 'cmd_vel', '10')",
        MOVER.format(wrong='1 / 0') + '        super().destroy_node()\nmover = Mover()',
        MOVER.format(wrong='self.publsher.publish(Twist())').replace('create_timer', 'creat_timer')
        + 'mover = Mover()',
    ],
)
def test_a_node_that_was_never_spun_is_removed_by_name(kernel, left):
    kernel.run(SETUP)
    for end in ("lab.remove('mover')", RIGHT + "lab.remove('mover')"):
        kernel.run(left)
        ended = kernel.run(f'print(node_names(runtime.helper).count("/mover"))\n{end}')
        assert (ended.error, ended.text[:2]) == ('', '1\n')
        assert kernel.run('gone()').error == ''
    assert "No node called 'mover' runs" in kernel.run("lab.remove('mover')").error


def test_a_node_on_an_executor_of_its_own_is_gone_when_its_cell_is_run_again(kernel):
    kernel.run(SETUP)
    code = MOVER.format(wrong='super().destroy_node()') + (
        'import threading\n'
        'from rclpy.executors import SingleThreadedExecutor\n'
        'mover, executor = Mover(), SingleThreadedExecutor()\n'
        'executor.add_node(mover)\n'
        'threading.Thread(target=executor.spin, daemon=True).start()\n'
        'lab.wait_until(lambda: mover.ticks > 2)\n'
    )
    one = "lab.wait_until(lambda: node_names(runtime.helper).count('/mover') == 1)"
    for _ in range(5):
        assert kernel.run(code).error == ''
        assert kernel.run(one).error == ''
    assert kernel.shutdown() == 0


def test_a_half_made_node_is_gone_when_its_cell_gives_it_another_name(kernel):
    kernel.run(SETUP)
    broken = MOVER.format(wrong='self.timer.cancel()').replace('create_timer', 'creat_timer')
    assert kernel.run(broken + SPIN, cell_id='mover').error.startswith('AttributeError')
    named = broken.replace("'mover'", "'shaker'")
    assert kernel.run(named + SPIN, cell_id='other').error.startswith('AttributeError')
    right = RIGHT.replace("'mover'", "'mower'")
    corrected = kernel.run(right + 'gone()\nprint(runtime.unspun_nodes())', cell_id='mover')
    assert corrected.error == ''
    # That of another cell is left in peace, until it is asked for.
    assert 'Mover' in corrected.text
    removed = kernel.run("lab.remove('shaker')\ngone('/shaker')\nprint(runtime.unspun_nodes())")
    assert (removed.error, removed.text) == ('', '[]\n')
