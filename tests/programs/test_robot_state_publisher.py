"""`robot_state_publisher`: what it publishes of a description, and what it refuses."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from labkit.background.domains import claim_domain
from labkit.errors import LabError
from labkit.programs.robot_state_publisher import RobotStatePublisher
from tests.stage import Stage

# A first build of the type of /tf takes seconds of processor time.
pytestmark = pytest.mark.timeout(900)

URDF = """
<robot name="arm">
  <link name="base"/>
  <joint name="up" type="fixed"><parent link="base"/><child link="post"/>
    <origin xyz="0 0 0.5"/></joint>
  <link name="post"/>
  <joint name="shoulder" type="continuous"><parent link="post"/><child link="arm"/>
    <axis xyz="0 0 1"/></joint>
  <link name="arm"/>
  <joint name="elbow" type="continuous"><parent link="arm"/><child link="hand"/>
    <origin xyz="1 0 0"/><axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="2"/></joint>
  <link name="hand"/>
</robot>
"""
BAD = '<robot name="r"><link name="a"/><link name="b"/></robot>'


class Ear(Node):
    """Hears what is published, latched or not, and moves joints."""

    def __init__(self) -> None:
        from tf2_msgs.msg import TFMessage

        super().__init__('ear')
        latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.texts: list[str] = []
        self.fixed: list[TransformStamped] = []
        self.moving: list[TransformStamped] = []
        self.joints = self.create_publisher(JointState, 'joint_states', 10)
        self.create_subscription(String, 'robot_description', self.hear, latched)
        self.create_subscription(TFMessage, '/tf_static', self.see_fixed, latched)
        self.create_subscription(TFMessage, '/tf', self.see_moving, 100)

    def hear(self, message: Any) -> None:
        self.texts.append(message.data)

    def see_fixed(self, message: Any) -> None:
        self.fixed.extend(message.transforms)

    def see_moving(self, message: Any) -> None:
        self.moving.extend(message.transforms)

    def move(self, at_sec: int, **positions: float) -> None:
        message = JointState(name=[*positions], position=[*positions.values()])
        message.header.stamp.sec = at_sec
        self.joints.publish(message)


@pytest.fixture
def stage() -> Iterator[Stage]:
    rclpy.init()
    stage = Stage()
    yield stage
    stage.close()
    rclpy.shutdown()


Made = tuple[RobotStatePublisher, Ear]


@pytest.fixture
def made(stage: Stage) -> Made:
    node = stage.add(RobotStatePublisher(URDF))
    ear = stage.add(Ear())
    stage.until(lambda: ear.joints.get_subscription_count() and ear.texts and ear.fixed)
    return node, ear


def placed(found: TransformStamped) -> tuple[str, str, tuple[float, ...], float]:
    """Return the frames, the place, and the angle about z."""
    shift, turn = found.transform.translation, found.transform.rotation
    assert (turn.x, turn.y) == (0.0, 0.0)
    angle = 2 * math.atan2(turn.z, turn.w)
    return found.header.frame_id, found.child_frame_id, (shift.x, shift.y, shift.z), angle


def test_the_description_and_fixed_frames_are_there_for_who_comes_late(made: Made):
    _, ear = made
    assert ear.texts == [URDF]
    assert [placed(one) for one in ear.fixed] == [('base', 'post', (0.0, 0.0, 0.5), 0.0)]


def test_joints_move_frames(stage: Stage, made: Made):
    _, ear = made
    ear.move(5, shoulder=0.3)
    stage.until(lambda: len(ear.moving) == 2)
    assert [placed(one)[:3] for one in ear.moving] == [
        ('post', 'arm', (0.0, 0.0, 0.0)),
        ('arm', 'hand', (1.0, 0.0, 0.0)),
    ]
    # The elbow turns twice as far.
    assert [placed(one)[3] for one in ear.moving] == pytest.approx([0.3, 0.6])
    assert {one.header.stamp.sec for one in ear.moving} == {5}


def test_what_comes_too_soon_or_twice_is_left_out(stage: Stage, made: Made):
    node, ear = made
    for at, angle in ((5, 0.1), (5, 0.2), (4, 0.3), (6, 0.4)):
        ear.move(at, shoulder=angle)
    stage.until(lambda: any(one.header.stamp.sec == 6 for one in ear.moving))
    seen = [placed(one)[3] for one in ear.moving if one.child_frame_id == 'arm']
    assert seen == pytest.approx([0.1, 0.4])
    node.set_parameters([Parameter('ignore_timestamp', value=True)])
    ear.move(3, shoulder=0.5)
    stage.until(lambda: ear.moving[-1].header.stamp.sec == 3)


def test_a_message_without_sense_is_left_out(stage: Stage, made: Made):
    _, ear = made
    ear.joints.publish(JointState(name=['shoulder']))
    ear.joints.publish(JointState(name=['shoulder'], position=[1.0, 2.0]))
    ear.move(5, wheel=1.0)
    ear.move(6, shoulder=0.25)
    stage.until(lambda: len(ear.moving) == 2)
    assert placed(ear.moving[0])[3] == pytest.approx(0.25)


def test_another_description_takes_its_place(stage: Stage, made: Made):
    node, ear = made
    (refused,) = node.set_parameters([Parameter('robot_description', value=BAD)])
    assert not refused.successful and '2 links have no parent' in refused.reason
    (refused,) = node.set_parameters([Parameter('publish_frequency', value=2000.0)])
    assert 'between 0 and 1000, but it is 2000' in refused.reason
    other = URDF.replace('0 0 0.5', '0 0 0.7')
    (taken,) = node.set_parameters([Parameter('robot_description', value=other)])
    assert taken.successful
    stage.until(lambda: len(ear.texts) == 2 and len(ear.fixed) == 2)
    assert ear.texts[1] == other
    assert placed(ear.fixed[1])[2] == (0.0, 0.0, 0.7)


def test_frames_may_have_a_prefix(stage: Stage, made: Made):
    node, ear = made
    node.set_parameters([Parameter('frame_prefix', value='left/')])
    ear.move(5, shoulder=0.3)
    stage.until(lambda: ear.moving)
    assert placed(ear.moving[0])[:2] == ('left/post', 'left/arm')


@pytest.mark.parametrize(('urdf', 'said'), [('', 'and it is empty'), (BAD, '2 links have no')])
def test_what_is_no_description_is_refused(stage: Stage, urdf: str, said: str):
    with pytest.raises(LabError, match=said):
        stage.add(RobotStatePublisher(urdf))


def test_a_program_that_is_called_wrongly_says_how(script: Callable[..., Any]):
    run = 'import runpy, sys; sys.argv = {!r}\nrunpy.run_module({!r}, run_name="__main__")'
    for words, said in (
        ([], 'The parameter robot_description is the URDF of the robot as a text, and it is'),
        (['no.urdf'], "The file 'no.urdf' can not be read: No such file or directory."),
        (['--ros-args', '-p', f'robot_description:={BAD}'], 'Line 1: 2 links have no parent'),
    ):
        program = ['robot_state_publisher', *words]
        done = script(run.format(program, 'labkit.programs.robot_state_publisher'))
        assert said in done.stderr and done.exit_code == 1, done
        assert 'Traceback' not in done.stderr


XACRO = """<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="height" default="0.5"/>
  <xacro:macro name="part" params="name">
    <link name="${name}"/>
    <joint name="to_${name}" type="fixed"><parent link="base"/><child link="${name}"/>
      <origin xyz="0 0 ${2 * $(arg height)}"/></joint>
  </xacro:macro>
  <link name="base"/>
  <xacro:part name="head"/>
</robot>
"""
LAUNCH_PY = """
from launch import LaunchDescription
from launch.substitutions import Command
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

def generate_launch_description():
    text = ParameterValue(Command(['xacro ', 'arm.urdf.xacro', ' height:=0.75']), value_type=str)
    return LaunchDescription([
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{'robot_description': text}]),
    ])
"""
LAUNCH_XML = """
<launch>
  <node pkg="robot_state_publisher" exec="robot_state_publisher">
    <param name="robot_description" value="$(command 'xacro arm.urdf.xacro height:=0.75')"
           type="str"/>
  </node>
</launch>
"""


@pytest.fixture
def kernel(start_kernel: Callable[..., Any]) -> Iterator[Any]:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    kernel = start_kernel(**env)
    kernel.run('import labkit as lab')
    yield kernel
    claim.close()


@pytest.mark.slow('several processes')
@pytest.mark.parametrize(
    ('name', 'text'), [('arm.launch.py', LAUNCH_PY), ('arm.launch.xml', LAUNCH_XML)]
)
def test_a_launch_file_gives_it_what_xacro_makes(kernel: Any, name: str, text: str):
    assert kernel.run('from tf2_msgs.msg import TFMessage', timeout=800).error == ''
    (kernel.folder / 'arm.urdf.xacro').write_text(XACRO)
    (kernel.folder / name).write_text(text)
    assert kernel.run(f'arm = lab.launch({name!r})').error == ''
    shown = kernel.run(
        'from rclpy.node import Node\n'
        'from tf2_ros import Buffer, TransformListener\n'
        "ear = lab.spin(Node('ear'))\n"
        'buffer = Buffer()\n'
        'listener = TransformListener(buffer, ear)\n'
        'from rclpy.duration import Duration\n'
        'from rclpy.time import Time\n'
        "found = buffer.lookup_transform('base', 'head', Time(), Duration(seconds=60))\n"
        'print(found.transform.translation.z)',
        timeout=200,
    )
    assert (shown.error, shown.text) == ('', '1.5\n')


def test_xacro_is_a_program_of_its_own(capsys: pytest.CaptureFixture[str]):
    from labkit.ros2.shell import run_line

    assert run_line('pkg executables robot_state_publisher') == 0
    assert run_line('pkg executables xacro') == 0
    assert capsys.readouterr().out.splitlines() == [
        'robot_state_publisher robot_state_publisher',
        'xacro xacro',
    ]
