"""`joint_state_publisher`: positions for all joints, from a description that it hears."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from labkit.errors import LabError
from labkit.programs.joint_state_publisher import JointStatePublisher
from tests.stage import Stage

URDF = """
<robot name="arm">
  <link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/>
  <joint name="turn" type="continuous"><parent link="a"/><child link="b"/></joint>
  <joint name="far" type="prismatic"><parent link="b"/><child link="c"/>
    <limit lower="0.2" upper="0.6" effort="1" velocity="1"/></joint>
  <joint name="still" type="fixed"><parent link="c"/><child link="d"/></joint>
  <joint name="same" type="continuous"><parent link="d"/><child link="e"/>
    <mimic joint="turn" multiplier="-1" offset="0.5"/></joint>
</robot>
"""


@pytest.fixture
def stage() -> Iterator[Stage]:
    rclpy.init()
    stage = Stage()
    yield stage
    stage.close()
    rclpy.shutdown()


def test_it_publishes_all_joints_that_move(stage: Stage) -> None:
    heard: list[JointState] = []
    ear = stage.add(Node('ear'))
    ear.create_subscription(JointState, 'joint_states', heard.append, 10)
    node = stage.add(JointStatePublisher())
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    ear.create_publisher(String, 'robot_description', latched).publish(String(data=URDF))
    stage.until(lambda: heard)
    assert heard[0].name == ['turn', 'far', 'same']
    # 0 is beyond the limits of one, which begins in the middle.
    assert list(heard[0].position) == pytest.approx([0.0, 0.4, 0.5])
    assert list(heard[0].velocity) == list(heard[0].effort) == []
    node.positions['turn'] = 1.0
    stage.until(lambda: heard[-1].position[0] == 1.0)
    assert heard[-1].position[2] == pytest.approx(-0.5)
    # Another description: joints that are in both keep their positions.
    node.take(URDF.replace('far', 'near'))
    assert node.positions == {'turn': 1.0, 'near': pytest.approx(0.4)}


def test_it_takes_positions_of_others_and_zeros() -> None:
    rclpy.init(
        args=[
            *('--ros-args', '-p', 'zeros.turn:=0.25', '-p', 'source_list:=[moves]'),
            *('-p', 'publish_default_velocities:=true', '-p', 'rate:=50'),
        ]
    )
    stage = Stage()
    try:
        node = stage.add(JointStatePublisher(URDF))
        assert node.positions == {'turn': 0.25, 'far': pytest.approx(0.4)}
        heard: list[JointState] = []
        ear = stage.add(Node('ear'))
        ear.create_subscription(JointState, 'joint_states', heard.append, 10)
        source = ear.create_publisher(JointState, 'moves', 10)
        stage.until(lambda: source.get_subscription_count() and heard)
        source.publish(JointState(name=['far', 'other'], position=[0.5, 1.0]))
        stage.until(lambda: heard[-1].position[1] == 0.5)
        assert list(heard[-1].velocity) == [0.0] * 3
    finally:
        stage.close()
        rclpy.shutdown()


def test_what_makes_no_sense_is_refused(stage: Stage) -> None:
    with pytest.raises(LabError, match='begins with <robot>'):
        stage.add(JointStatePublisher('<sdf/>'))
    node = stage.add(JointStatePublisher(URDF, name='other'))
    ear = stage.add(Node('ear'))
    publisher = ear.create_publisher(
        String,
        'robot_description',
        QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    )
    publisher.publish(String(data='<sdf/>'))
    stage.until(lambda: publisher.get_subscription_count())
    assert node.description is not None and node.zero_of(node.description.joints['turn']) == 0.0
    assert math.isfinite(sum(node.positions.values()))
