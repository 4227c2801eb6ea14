"""A simulated TurtleBot3 Burger: its motion, its surroundings, its sensor, its ROS node.

Importing this package imports nothing else; take names from its modules.
"""
