"""ROS in this process: the background thread, its nodes, their output, waiting for them."""

from labkit import settings

if settings.in_kernel():
    import rclpy  # noqa: F401  # see labkit.rosgraph
