"""The topics of the simulated robot, which drives in many lessons."""

from __future__ import annotations

__all__ = ['ROBOT_TOPICS']

ROBOT_TOPICS = (
    '/cmd_vel',
    '/odom',
    '/scan',
    '/joint_states',
    '/imu',
    '/battery_state',
    '/camera/image_raw',
    '/camera/camera_info',
)
