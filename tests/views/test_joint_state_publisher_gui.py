"""Sliders for joints: what they publish, and what is stored of them."""

from __future__ import annotations

from typing import Any

import pytest

START = """
import labkit as lab
from rclpy.node import Node
from sensor_msgs.msg import JointState

URDF = '''
<robot name="arm">
  <link name="a"/><link name="b"/><link name="c"/>
  <joint name="turn" type="continuous"><parent link="a"/><child link="b"/></joint>
  <joint name="far" type="prismatic"><parent link="b"/><child link="c"/>
    <limit lower="0.2" upper="0.6" effort="1" velocity="1"/></joint>
</robot>
'''
heard = []
ear = lab.spin(Node('ear'))
ear.create_subscription(
    JointState, '/joint_states', lambda m: heard.append(dict(zip(m.name, m.position))), 100)
sliders = lab.joint_state_publisher_gui(URDF)

def page(**content):
    sliders._widget._handle_custom_msg(content, [])

def wait_for(**positions):
    lab.wait_until(lambda: heard and heard[-1] == positions)
"""


@pytest.fixture
def sliders(kernel: Any) -> Any:
    def run(code: str) -> str:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return str(result.text).strip()

    run(START)
    return run


def test_sliders_move_joints_within_their_limits(sliders: Any) -> None:
    sliders('wait_for(turn=0.0, far=0.4)')
    sliders("page(name='turn', position=1.5); wait_for(turn=1.5, far=0.4)")
    sliders("page(name='far', position=9.0); wait_for(turn=1.5, far=0.6)")
    # What a page can't send is left out.
    sliders(
        "page(name='far', position=float('nan')); page(name='no', position=1.0); page(name=[])"
    )
    sliders('page(centre=True); wait_for(turn=0.0, far=0.4)')
    sliders('sliders.set(turn=-9, far=0.5); wait_for(turn=-3.141592653589793, far=0.5)')
    shown = sliders('print(repr(sliders))')
    assert shown.splitlines() == [
        'turn    -3.142 rad  (-3.14 to 3.14)',
        'far      0.500 m    (0.2 to 0.6)',
    ]
    wrong = sliders(
        'try:\n    sliders.set(tur=1)\nexcept lab.LabError as error:\n    print(error)'
    )
    assert wrong.splitlines() == [
        "There is no joint 'tur' that can be moved.",
        "Did you mean 'turn'?",
    ]


def test_the_cell_can_be_run_again_and_without_a_description_says_so(sliders: Any) -> None:
    sliders('first = sliders')
    sliders('sliders = lab.joint_state_publisher_gui()')
    assert 'Nobody publishes a description yet' in sliders('print(repr(sliders))')
    sliders('sliders.close()')
    assert (
        sliders('print([n for n, _ in ear.get_node_names_and_namespaces()])').count('joint') == 0
    )
