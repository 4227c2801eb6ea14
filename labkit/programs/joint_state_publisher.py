"""`ros2 run joint_state_publisher joint_state_publisher`: positions for the joints of a robot.

It does what the real one does with a description in URDF (ros/joint_state_publisher, branch ros2,
joint_state_publisher/joint_state_publisher.py), for machines where that is not installed: it hears
`robot_description`, and publishes `joint_states` ten times a second, with the middle of the limits
where 0 is outside of them. `lab.joint_state_publisher_gui` has sliders for it.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from labkit.descriptions.forward_kinematics import all_positions
from labkit.descriptions.links_and_joints import Description, Joint
from labkit.descriptions.urdf import read
from labkit.errors import LabError, quoted
from labkit.files import read_limited
from labkit.programs.program import spin_until_interrupted

__all__ = ['JointStatePublisher', 'limits_of', 'main']

QUEUE_DEPTH = 10
RATE = 10
# Most often that it publishes, Hz.
MOST_FREQUENT = 1000


class JointStatePublisher(Node):
    """Publishes positions of all joints of a robot that one number moves.

    Its parameters are those of the real one: `rate`, Hz; `zeros.NAME`, where a joint begins, rad
    or m; `source_list`, topics with positions of joints; `publish_default_positions`,
    `publish_default_velocities` and `publish_default_efforts`.

    Args:
        urdf: The description; '' if it is to be heard.
        name: The node's name.

    Attributes:
        description: The robot, None until it is known.
        positions: Positions of the joints that follow no other, rad or m, by their names.

    Raises:
        LabError: The text is no description, or a parameter makes no sense.
    """

    def __init__(self, urdf: str = '', *, name: str = 'joint_state_publisher') -> None:
        super().__init__(name, automatically_declare_parameters_from_overrides=True)
        rate = self._value('rate', RATE)
        if not 0 < rate <= MOST_FREQUENT:
            raise LabError(
                f'rate must be more than 0, up to {MOST_FREQUENT} Hz, but it is {rate}.'
            )
        zeros: Any = self.get_parameters_by_prefix('zeros')
        self._zeros = {key: parameter.value for key, parameter in zeros.items()}
        self._fields = {
            field: self._value(f'publish_default_{what}', field == 'position')
            for field, what in (
                ('position', 'positions'),
                ('velocity', 'velocities'),
                ('effort', 'efforts'),
            )
        }
        self.description: Description | None = None
        self.positions: dict[str, float] = {}
        if urdf:
            self.take(urdf)
        else:
            self._log.info(
                'Waiting for robot_description to be published on the robot_description topic...'
            )
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # type: ignore[no-untyped-call]
        self.create_subscription(String, 'robot_description', self._on_description, latched)
        for topic in self._value('source_list', ['']):
            if topic:
                self.create_subscription(JointState, topic, self._on_source, QUEUE_DEPTH)
        self._publisher = self.create_publisher(JointState, 'joint_states', QUEUE_DEPTH)
        self.create_timer(1.0 / rate, self.publish_all)

    def take(self, urdf: str) -> None:
        """Take a description. Joints that it had before keep their positions.

        Raises:
            LabError: It is none.
        """
        found = read(urdf)
        before = self.positions
        self.positions = {
            joint.name: before.get(joint.name, self.zero_of(joint)) for joint in found.free_joints
        }
        self.description = found

    def zero_of(self, joint: Joint) -> float:
        """Return where a joint begins: at 0, or in the middle if that is beyond its limits."""
        lower, upper = limits_of(joint)
        middle = (lower + upper) / 2 if lower > 0 or upper < 0 else 0.0
        return float(self._zeros.get(joint.name, middle))

    def publish_all(self) -> None:
        """Publish where all joints are."""
        if self.description is None:
            return
        message = JointState()
        message.header.stamp = self.get_clock().now().to_msg()
        positions = all_positions(self.description, self.positions)
        message.name = [j.name for j in self.description.joints.values() if j.name in positions]
        for field, wanted in self._fields.items():
            if wanted:
                is_position = field == 'position'
                numbers = [positions[name] if is_position else 0.0 for name in message.name]
                setattr(message, field, numbers)
        if message.name:
            self._publisher.publish(message)

    def _on_description(self, message: String) -> None:
        try:
            self.take(message.data)
        except LabError as error:
            self._log.warning(str(error))

    def _on_source(self, message: JointState) -> None:
        for name, position in zip(message.name, message.position, strict=False):
            if name in self.positions:
                self.positions[name] = position

    def _value(self, name: str, default: Any) -> Any:
        if not self.has_parameter(name):
            self.declare_parameter(name, default)
        return self.get_parameter(name).value

    @property
    def _log(self) -> Any:
        return self.get_logger()  # type: ignore[no-untyped-call]


def limits_of(joint: Joint) -> tuple[float, float]:
    """Return how far a joint goes, rad or m: half a turn each way if it has no end."""
    if joint.type == 'continuous' or joint.limits is None:
        return -math.pi, math.pi
    return joint.limits.lower, joint.limits.upper


def main() -> None:
    """Publish until it is interrupted."""
    words = remove_ros_args(sys.argv)[1:]
    rclpy.init(args=sys.argv)
    try:
        node = JointStatePublisher(read_limited(Path(words[0])).decode() if words else '')
    except OSError as error:
        rclpy.shutdown()
        sys.exit(f'The file {quoted(words[0])} can not be read: {error.strerror}.')
    except LabError as error:
        rclpy.shutdown()
        sys.exit(str(error))
    spin_until_interrupted(node)


if __name__ == '__main__':
    main()
