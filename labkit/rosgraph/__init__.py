"""What ROS knows, as data: names, nodes, topics, types and why two ends do not match.

Functions here ask with a node that they are given, and return what they found. Nothing prints.
"""
