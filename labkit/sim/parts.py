"""Where the parts of the robot are: frames and transforms as a TurtleBot3 Burger publishes them.

Sources: ROBOTIS-GIT/turtlebot3, branch jazzy: turtlebot3_description/urdf/turtlebot3_burger.urdf
(the numbers, and the order of the angles), turtlebot3_node/src/odometry.cpp (odom to
base_footprint); robot_state_publisher publishes fixed joints on /tf_static and the others on /tf.
The camera stands where ROBOTIS-GIT/turtlebot3_simulations has it, turtlebot3_gazebo/models/
turtlebot3_burger_cam/model.sdf, with the frames of turtlebot3_waffle_pi.urdf.
"""

from __future__ import annotations

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped

from labkit.sim.kinematics import yaw_to_quaternion
from labkit.sim.simulator import Simulator
from labkit.transforms.rotations import Quaternion, Vector, from_rpy, product

__all__ = ['moving_parts', 'static_parts']

# Parent, frame, place in m, and angles about the fixed axes x, y and z in rad, one after another.
_FIXED: tuple[tuple[str, str, Vector, Vector], ...] = (
    ('base_footprint', 'base_link', (0.0, 0.0, 0.010), (0.0, 0.0, 0.0)),
    ('base_link', 'caster_back_link', (-0.081, 0.0, -0.004), (-1.57, 0.0, 0.0)),
    ('base_link', 'imu_link', (-0.032, 0.0, 0.068), (0.0, 0.0, 0.0)),
    ('base_link', 'base_scan', (-0.032, 0.0, 0.172), (0.0, 0.0, 0.0)),
    ('base_link', 'camera_link', (0.040, 0.0, 0.110), (0.0, 0.0, 0.0)),
    ('camera_link', 'camera_rgb_frame', (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    ('camera_rgb_frame', 'camera_rgb_optical_frame', (0.0, 0.0, 0.0), (-1.57, 0.0, -1.57)),
)
# They turn about their own z axis.
_WHEELS: tuple[tuple[str, Vector], ...] = (
    ('wheel_left_link', (0.0, 0.08, 0.023)),
    ('wheel_right_link', (0.0, -0.080, 0.023)),
)
_ON_AXLE = from_rpy(-1.57, 0.0, 0.0)


def static_parts(stamp: Time, prefix: str = '') -> list[TransformStamped]:
    """Return where the parts are that do not move; `prefix` is that of the frames."""
    return [
        _transform(stamp, prefix + parent, prefix + child, place, from_rpy(*angles))
        for parent, child, place, angles in _FIXED
    ]


def moving_parts(robot: Simulator, stamp: Time, prefix: str = '') -> list[TransformStamped]:
    """Return where its odometry says that the robot is, and how its wheels are turned."""
    x, y, yaw = robot.odometry
    turn = yaw_to_quaternion(yaw)
    found = [_transform(stamp, f'{prefix}odom', f'{prefix}base_footprint', (x, y, 0.0), turn)]
    for (wheel, place), angle in zip(_WHEELS, robot.wheels, strict=True):
        turn = product(_ON_AXLE, yaw_to_quaternion(angle))
        found.append(_transform(stamp, f'{prefix}base_link', prefix + wheel, place, turn))
    return found


def _transform(
    stamp: Time, parent: str, child: str, place: Vector, turn: Quaternion
) -> TransformStamped:
    found = TransformStamped()
    found.header.stamp = stamp
    found.header.frame_id, found.child_frame_id = parent, child
    shift, rotation = found.transform.translation, found.transform.rotation
    shift.x, shift.y, shift.z = place
    rotation.x, rotation.y, rotation.z, rotation.w = turn
    return found
