"""`ros2 lifecycle` in a kernel, with a node that has states and one that has none."""

from __future__ import annotations

from tests.conftest import Kernel

NODES = """
import labkit as lab
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node

class Stubborn(LifecycleNode):
    def on_activate(self, state):
        return TransitionCallbackReturn.FAILURE

managed = lab.spin(Stubborn('managed'))
plain = lab.spin(Node('plain'))
"""


def said(kernel: Kernel, line: str) -> str:
    return kernel.run(f'%ros2 lifecycle {line}').text


def test_states_are_told_and_changed(kernel: Kernel) -> None:
    assert not kernel.run(NODES).error
    assert said(kernel, 'nodes') == '/managed\n'
    assert said(kernel, 'nodes -c') == '1\n'
    assert said(kernel, 'get /managed') == 'unconfigured [1]\n'
    assert said(kernel, 'list managed') == (
        '- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n'
        '- shutdown [5]\n\tStart: unconfigured\n\tGoal: shuttingdown\n'
    )
    assert said(kernel, 'set /managed configure') == 'Transitioning successful\n'
    assert said(kernel, 'get') == '/managed: inactive [2]\n'
    assert 'Transitioning failed' in said(kernel, 'set /managed activate')
    assert said(kernel, 'set /managed 2') == 'Transitioning successful\n'
    assert said(kernel, 'get /managed') == 'unconfigured [1]\n'
    assert 'Goal: activating' in said(kernel, 'list -a /managed')


def test_what_can_not_be_is_said(kernel: Kernel) -> None:
    assert not kernel.run(NODES).error
    answer = said(kernel, 'set /managed activate')
    assert 'Unknown transition requested, available ones are:\n- configure [1]' in answer
    assert '/plain has no states: it is no LifecycleNode.' in said(kernel, 'get /plain')
    assert 'Node not found' in said(kernel, 'get /manged')
    assert "Did you mean '/managed'" in said(kernel, 'get /manged')
