"""The ROS graph as data: names, nodes, topics, types, and why two endpoints do not match.

Functions query the graph through a given node; names of nodes, topics and types are full names.
Nothing prints.
"""

from labkit import settings

if settings.in_kernel():
    # First, so that the stand-ins of `background.notebook_rclpy` are in place from the first use.
    import rclpy  # noqa: F401
