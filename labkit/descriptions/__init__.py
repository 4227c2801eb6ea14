"""Descriptions of robots: links, joints and shapes, as URDF has them; where the links are.

Nothing here needs ROS. Importing this package imports nothing else; take names from its modules.
"""
