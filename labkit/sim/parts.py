"""Where the parts of the robot are: frames and transforms as a TurtleBot3 Burger publishes them.

The places are those of `burger.urdf`, which names their sources. Odometry says where
`base_footprint` is in `odom`: ROBOTIS-GIT/turtlebot3, branch jazzy, turtlebot3_node/src/
odometry.cpp; robot_state_publisher publishes fixed joints on /tf_static and the others on /tf.
"""

from __future__ import annotations

import functools
import re
from pathlib import Path

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped

from labkit.descriptions.forward_kinematics import Transform, joint_transform
from labkit.descriptions.links_and_joints import Description
from labkit.descriptions.urdf import read
from labkit.sim.kinematics import yaw_to_quaternion
from labkit.sim.simulator import Simulator

__all__ = ['description', 'footprint', 'static_parts', 'urdf', 'wheel_parts']

WHEELS = ('wheel_left_joint', 'wheel_right_joint')


def urdf(prefix: str = '') -> str:
    """Return the robot in URDF; `prefix` is that of its links, whose names are those of frames."""
    text = Path(__file__).with_name('burger.urdf').read_text(encoding='utf-8')
    return re.sub(r'(<link name="|link=")', lambda found: found[0] + prefix, text)


@functools.cache
def description() -> Description:
    """Return the robot."""
    return read(urdf())


def static_parts(stamp: Time, prefix: str = '') -> list[TransformStamped]:
    """Return where the parts are that do not move; `prefix` is that of the frames."""
    return [
        _transform(stamp, prefix + joint.parent, prefix + joint.child, joint_transform(joint))
        for joint in description().joints.values()
        if not joint.moves
    ]


def footprint(robot: Simulator, stamp: Time, prefix: str = '') -> TransformStamped:
    """Return where its odometry says that the robot is."""
    x, y, yaw = robot.odometry
    base = Transform((x, y, 0.0), yaw_to_quaternion(yaw))
    return _transform(stamp, f'{prefix}odom', f'{prefix}base_footprint', base)


def wheel_parts(robot: Simulator, stamp: Time, prefix: str = '') -> list[TransformStamped]:
    """Return where its wheels are, and how they are turned."""
    found = []
    for name, angle in zip(WHEELS, robot.wheels, strict=True):
        joint = description().joints[name]
        step = joint_transform(joint, angle)
        found.append(_transform(stamp, prefix + joint.parent, prefix + joint.child, step))
    return found


def _transform(stamp: Time, parent: str, child: str, step: Transform) -> TransformStamped:
    found = TransformStamped()
    found.header.stamp = stamp
    found.header.frame_id, found.child_frame_id = parent, child
    shift, rotation = found.transform.translation, found.transform.rotation
    shift.x, shift.y, shift.z = step.translation
    rotation.x, rotation.y, rotation.z, rotation.w = step.rotation
    return found
