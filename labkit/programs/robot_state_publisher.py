"""`ros2 run robot_state_publisher robot_state_publisher`: where the links of a robot are.

It does what the real one does (ros/robot_state_publisher, src/robot_state_publisher.cpp), for
machines where that is not installed: the parameter `robot_description` goes out on the topic of
that name, fixed joints go to /tf_static, and moving ones to /tf as joint_states come in. Beyond
that it says in sentences what is wrong with a description.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import rclpy
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from labkit.descriptions.forward_kinematics import Transform, all_positions, joint_transform
from labkit.descriptions.links_and_joints import Description, Joint
from labkit.descriptions.urdf import DescriptionError, Reading, examine
from labkit.errors import LabError, did_you_mean, quoted
from labkit.files import read_limited
from labkit.programs.program import spin_until_interrupted
from labkit.transforms.static_transform_broadcaster import StaticTransformBroadcaster
from labkit.transforms.transform_broadcaster import TransformBroadcaster

__all__ = ['RobotStatePublisher', 'main']

# How often it publishes a joint by default, and at most, Hz.
FREQUENCY, MOST_FREQUENT = 20.0, 1000.0


class RobotStatePublisher(Node):
    """Publishes a description, and where its links are.

    Its parameters: `robot_description`, the text; `publish_frequency`, how often a joint is
    published at most, Hz; `frame_prefix`, put before the names of frames; `ignore_timestamp`,
    whether messages are taken whose stamp is not later than that of the last one.

    Args:
        urdf: The description, if the parameter has none.

    Raises:
        LabError: There is no description, or none that can be taken.
    """

    def __init__(self, urdf: str = '') -> None:
        super().__init__('robot_state_publisher')
        given = self.declare_parameter('robot_description', '').value
        if not given and urdf:
            self.set_parameters([Parameter('robot_description', value=urdf)])  # type: ignore[no-untyped-call]
        problem = _why_not_frequency(self.declare_parameter('publish_frequency', FREQUENCY).value)
        if problem:
            raise LabError(problem)
        self.declare_parameter('frame_prefix', '')
        self.declare_parameter('ignore_timestamp', False)
        reading = _read(given or urdf)
        self._moving = TransformBroadcaster(self)
        self._static = StaticTransformBroadcaster(self)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # type: ignore[no-untyped-call]
        self._publisher = self.create_publisher(String, 'robot_description', latched)
        # Per joint, the stamp of the last message that was published, ns.
        self._published: dict[str, int] = {}
        self._last_call = 0
        self._unknown: set[str] = set()
        self._take(given or urdf, reading)
        self.create_subscription(
            JointState, 'joint_states', self._on_joints, qos_profile_sensor_data
        )
        self.add_on_set_parameters_callback(self._may_set)
        self.add_post_set_parameters_callback(self._has_set)

    # -- the description ------------------------------------------------------------------------

    def _take(self, text: str, reading: Reading) -> None:
        """Publish a description, and where its fixed links are."""
        assert reading.description is not None
        for doubt in reading.problems:
            self._log.warning(f'{doubt} {doubt.todo}'.strip())
        self._robot: Description = reading.description
        root = self._robot.links[self._robot.root]
        if root.inertial is not None:
            self._log.warning(
                f'The root link {root.name} has an inertia specified in the URDF, but KDL does '
                'not support a root link with an inertia.  As a workaround, you can add an extra '
                'dummy link to your URDF.'
            )
        self._publisher.publish(String(data=text))
        self._log.info('Robot initialized')
        stamp = self.get_clock().now().to_msg()
        # The real one has no place for a floating joint, and takes a planar one as fixed.
        fixed = [j for j in self._robot.ordered if not j.moves and j.type != 'floating']
        for joint in self._robot.ordered:
            if joint.type in ('floating', 'planar'):
                self._log.warning(
                    f'The joint {quoted(joint.name)} is {joint.type}: one number does not say '
                    'where it is. '
                    + (
                        'Another node has to say on /tf where its child is.'
                        if joint.type == 'floating'
                        else 'It is taken as fixed.'
                    )
                )
        self._static.sendTransform([self._transform(j, joint_transform(j), stamp) for j in fixed])

    def _may_set(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            reason = ''
            if parameter.name == 'robot_description':
                try:
                    _read(parameter.value)
                except LabError as error:
                    reason = str(error)
            elif parameter.name == 'publish_frequency':
                reason = _why_not_frequency(parameter.value)
            if reason:
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _has_set(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == 'robot_description':
                self._take(parameter.value, _read(parameter.value))

    # -- joints ---------------------------------------------------------------------------------

    def _on_joints(self, message: JointState) -> None:
        if len(message.name) != len(message.position):
            if message.position:
                self._log.error('Robot state publisher ignored an invalid JointState message')
            else:
                self._log.warning(
                    'Robot state publisher ignored a JointState message about joint(s) '
                    f'"{message.name[0]}"(,...) whose position member was empty.'
                )
            return
        now = self.get_clock().now().nanoseconds
        if now < self._last_call:
            self._log.warning('Moved backwards in time, re-publishing joint transforms!')
            self._published.clear()
        self._last_call = now
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        oldest = min([now, *(self._published.get(name, 0) for name in message.name)])
        if not self._value('ignore_timestamp') and stamp < oldest + self._interval():
            return
        given = dict(zip(message.name, message.position, strict=True))
        self._warn_of_unknown(given)
        found = []
        for name, position in all_positions(self._robot, given).items():
            joint = self._robot.joints.get(name)
            if joint is not None and joint.moves:
                step = joint_transform(joint, position)
                found.append(self._transform(joint, step, message.header.stamp))
        self._moving.sendTransform(found)
        self._published.update(dict.fromkeys(message.name, stamp))

    def _interval(self) -> int:
        """Return the least time between two messages of a joint, in whole ms, ns."""
        frequency = self._value('publish_frequency')
        return int(1000 / frequency) * 10**6 if frequency else 0

    def _warn_of_unknown(self, given: dict[str, float]) -> None:
        """Say which joints are not in the description: the real one leaves them out."""
        for name in given.keys() - self._robot.joints.keys() - self._unknown:
            self._unknown.add(name)
            known = [joint.name for joint in self._robot.free_joints]
            self._log.warning(
                f'The joint {quoted(name)} of joint_states is not in the description. '
                + did_you_mean(name, known, f'It has: {", ".join(known) or "none that moves"}.')
            )

    def _transform(self, joint: Joint, step: Transform, stamp: Any) -> TransformStamped:
        prefix = self._value('frame_prefix')
        found = TransformStamped()
        found.header.stamp = stamp
        found.header.frame_id = prefix + joint.parent
        found.child_frame_id = prefix + joint.child
        shift, turn = found.transform.translation, found.transform.rotation
        shift.x, shift.y, shift.z = step.translation
        turn.x, turn.y, turn.z, turn.w = step.rotation
        return found

    def _value(self, name: str) -> Any:
        return self.get_parameter(name).value

    @property
    def _log(self) -> Any:
        return self.get_logger()  # type: ignore[no-untyped-call]


def _read(text: str) -> Reading:
    """Return what a description says.

    Raises:
        LabError: It is empty, or describes no robot.
    """
    if not text:
        raise LabError(
            'The parameter robot_description is the URDF of the robot as a text, and it is empty.',
            todo='In a launch file: Command(["xacro ", path]); in a terminal: --ros-args -p '
            'robot_description:="$(xacro FILE)"',
        )
    reading = examine(text)
    if reading.description is None:
        raise DescriptionError(reading.errors)
    return reading


def _why_not_frequency(value: float) -> str:
    """Return why a frequency can not be, '' if it can."""
    if not 0 <= value <= MOST_FREQUENT:
        return f'publish_frequency must be between 0 and 1000, but it is {value:g}'
    return ''


def main() -> None:
    """Publish until it is interrupted."""
    words = remove_ros_args(sys.argv)[1:]
    rclpy.init(args=sys.argv)
    try:
        urdf = ''
        if words:
            # As in the real one, where it is deprecated: the name of a file.
            urdf = read_limited(Path(words[0])).decode()
        node = RobotStatePublisher(urdf)
    except OSError as error:
        rclpy.shutdown()
        sys.exit(f'The file {quoted(words[0])} can not be read: {error.strerror}.')
    except LabError as error:
        rclpy.shutdown()
        sys.exit(str(error))
    spin_until_interrupted(node)


if __name__ == '__main__':
    main()
