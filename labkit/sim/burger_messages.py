"""The messages of a TurtleBot3 Burger, made from the simulation.

Frames, fields and units are those of the real robot. Sources: ROBOTIS-GIT/turtlebot3,
turtlebot3_node/src: odometry.cpp and, in sensors/, joint_state.cpp, imu.cpp, battery_state.cpp;
ROBOTIS-GIT/hls_lfcd_lds_driver, src/hlds_laser_publisher.cpp.
"""

from __future__ import annotations

import math
from array import array

import numpy as np
from builtin_interfaces.msg import Time
from nav_msgs.msg import Odometry
from numpy.typing import NDArray
from sensor_msgs.msg import BatteryState, CameraInfo, Image, Imu, JointState, LaserScan

from labkit.sim.camera import PI_CAMERA, picture
from labkit.sim.kinematics import Pose, Twist2, yaw_to_quaternion
from labkit.sim.simulator import Simulator

__all__ = [
    'battery_message',
    'camera_info_message',
    'image_message',
    'imu_message',
    'joint_state_message',
    'odometry_message',
    'scan_message',
    'time_message',
    'truth_message',
]

# Time for which a full battery drives the robot, s. Source: ROBOTIS e-manual, TurtleBot3,
# "Features > Specifications": 2 h 30 min.
BATTERY_TIME = 2.5 * 3600
# Its capacity, Ah. Source: battery_state.cpp.
BATTERY_CAPACITY = 1.8
# Voltage of the full and of the empty battery, V. Source: ROBOTIS-GIT/OpenCR, turtlebot3_ros2/src/
# turtlebot3/turtlebot3.cpp, update_battery_status_to_table: three cells of 4.1 V and of 3.5 V.
BATTERY_FULL, BATTERY_EMPTY = 12.3, 10.5
# The frame of images: x to the right, y down, z ahead (REP 103, "Suffix Frames"). Source:
# ROBOTIS-GIT/turtlebot3, turtlebot3_description/urdf/turtlebot3_waffle_pi.urdf.
CAMERA_FRAME = 'camera_rgb_optical_frame'


def _diagonal(*values: float) -> NDArray[np.float64]:
    return np.diag(np.array(values)).flatten()


# Covariance of x, y, z, roll, pitch and yaw, m² and rad². Source: the values that ROBOTIS proposes
# in odometry.cpp. What can't change on a floor is certain.
POSE_COVARIANCE = _diagonal(0.05, 0.05, 1e-9, 1e-9, 1e-9, 0.0872665)
TWIST_COVARIANCE = _diagonal(0.001, 1e-9, 1e-9, 1e-9, 1e-9, 0.001)


def time_message(seconds: float) -> Time:
    """Return a simulated time, s since the start, as a time stamp."""
    sec, nanosec = divmod(round(seconds * 1e9), 10**9)
    return Time(sec=sec, nanosec=nanosec)


def odometry_message(robot: Simulator, stamp: Time, prefix: str = '') -> Odometry:
    """Return the estimated pose and velocity; `prefix` is that of the frames, e.g. `'robot1/'`."""
    message = _motion_message(robot.odometry, robot.odometry_twist, stamp, prefix)
    message.header.frame_id = f'{prefix}odom'
    message.pose.covariance = POSE_COVARIANCE
    message.twist.covariance = TWIST_COVARIANCE
    return message


def truth_message(robot: Simulator, stamp: Time, prefix: str = '') -> Odometry:
    """Return the true pose and velocity; `prefix` is that of the robot's frame.

    The pose is in `map`, the frame that is fixed in the world (REP 105), and nothing is uncertain.
    """
    message = _motion_message(robot.pose, robot.twist, stamp, prefix)
    message.header.frame_id = 'map'
    pose = message.pose.pose
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = robot.orientation
    pose.position.z = robot.height
    return message


def _motion_message(place: Pose, speed: Twist2, stamp: Time, prefix: str) -> Odometry:
    message = Odometry()
    message.header.stamp = stamp
    message.child_frame_id = f'{prefix}base_footprint'
    pose, twist = message.pose.pose, message.twist.twist
    pose.position.x, pose.position.y, yaw = place
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w = yaw_to_quaternion(yaw)
    twist.linear.x, twist.angular.z = speed
    return message


def joint_state_message(robot: Simulator, stamp: Time, prefix: str = '') -> JointState:
    """Return angles and speeds of the wheels, rad and rad/s; `prefix` is that of the frame."""
    message = JointState()
    message.header.stamp = stamp
    message.header.frame_id = f'{prefix}base_link'
    message.name = ['wheel_left_joint', 'wheel_right_joint']
    message.position = array('d', robot.wheels)
    message.velocity = array('d', robot.wheel_rates)
    return message


def imu_message(robot: Simulator, stamp: Time, prefix: str = '') -> Imu:
    """Return the measurements of the inertial sensor in the middle of the axle.

    Orientation, angular velocity and acceleration are the true ones, whatever odometry estimates.
    A sensor at rest measures 1 g upwards; in a curve it measures the centripetal acceleration.
    Covariances are zero, which means unknown, as on the real robot.
    """
    message = Imu()
    message.header.stamp = stamp
    message.header.frame_id = f'{prefix}imu_link'
    turn, rate = message.orientation, message.angular_velocity
    turn.x, turn.y, turn.z, turn.w = robot.orientation
    rate.x, rate.y, rate.z = robot.angular_velocity
    linear = message.linear_acceleration
    linear.x, linear.y, linear.z = robot.specific_force
    return message


def battery_message(robot: Simulator, stamp: Time) -> BatteryState:
    """Return the state of the battery: a plain model, not a measurement.

    Charge and voltage fall linearly with simulated time, whatever the robot does, until the
    battery is empty after 2.5 h. The robot drives on then. Like the real one, it fills in the
    charge in percent (the message specifies 0 to 1), the voltage, the design capacity and the
    presence of the battery; the frame is empty.
    """
    charge = max(0.0, 1 - robot.time / BATTERY_TIME)
    message = BatteryState()
    message.header.stamp = stamp
    message.design_capacity = BATTERY_CAPACITY
    message.percentage = 100 * charge
    message.voltage = BATTERY_EMPTY + charge * (BATTERY_FULL - BATTERY_EMPTY)
    message.present = True
    return message


def scan_message(robot: Simulator, stamp: Time, prefix: str = '') -> LaserScan:
    """Return a laser scan; `prefix` is that of the frame."""
    spec = robot.robot
    message = LaserScan()
    message.header.stamp = stamp
    message.header.frame_id = f'{prefix}base_scan'
    # The last beam is one increment short of a full turn. All beams have the same time.
    message.angle_min = 0.0
    message.angle_increment = math.tau / spec.scan_beams
    message.angle_max = message.angle_increment * (spec.scan_beams - 1)
    message.scan_time = 1 / spec.scan_rate
    message.range_min = spec.range_min
    message.range_max = spec.range_max
    message.ranges = array('f', robot.scan())
    return message


def image_message(robot: Simulator, stamp: Time, prefix: str = '') -> Image:
    """Return a camera image; `prefix` is that of the frame."""
    pixels = picture(robot.world, robot.pose, but=robot.name)
    message = Image()
    message.header.stamp = stamp
    message.header.frame_id = prefix + CAMERA_FRAME
    message.height, message.width, depth = pixels.shape
    message.encoding = 'rgb8'
    message.step = message.width * depth
    message.data = array('B', pixels.tobytes())
    return message


def camera_info_message(stamp: Time, prefix: str = '') -> CameraInfo:
    """Return the camera's calibration: a pinhole without distortion."""
    focal, middle_x, middle_y = PI_CAMERA.focal_length, PI_CAMERA.width / 2, PI_CAMERA.height / 2
    message = CameraInfo()
    message.header.stamp = stamp
    message.header.frame_id = prefix + CAMERA_FRAME
    message.height, message.width = PI_CAMERA.height, PI_CAMERA.width
    message.distortion_model = 'plumb_bob'
    message.d = [0.0] * 5
    message.k = [focal, 0.0, middle_x, 0.0, focal, middle_y, 0.0, 0.0, 1.0]
    message.r = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    message.p = [focal, 0.0, middle_x, 0.0, 0.0, focal, middle_y, 0.0, 0.0, 0.0, 1.0, 0.0]
    return message
