"""Names of nodes, topics and services: full, hidden, and those that say nothing about a node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.errors import LabError

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    'EVERY_NODE_HAS',
    'UNKNOWN_NODE',
    'full_node_name',
    'full_topic_name',
    'is_hidden',
    'split_node_name',
]

# Topics that every node publishes on, so they say nothing about one.
EVERY_NODE_HAS = ('/parameter_events', '/rosout')
# What ROS calls the node of an end as long as it does not know which one that is.
UNKNOWN_NODE = '_NODE_NAME_UNKNOWN_'


def is_hidden(name: str) -> bool:
    """Tell whether a node, topic or service is hidden: a part of its name starts with `_`."""
    return any(part.startswith('_') for part in name.split('/'))


def full_node_name(name: str, namespace: str) -> str:
    """Return a node's full name: `/talker`, or `/robot/talker` in a namespace."""
    return f'/{namespace.strip("/")}/{name}'.replace('//', '/')


def split_node_name(full_name: str) -> tuple[str, str]:
    """Return the name and the namespace of a node's full name: `'talker', '/robot'`."""
    namespace, _, name = full_name.rpartition('/')
    return name, namespace or '/'


def full_topic_name(topic: str, node: Node) -> str:
    """Return the name of a topic or service as the graph knows it: `'odds'` is mostly `/odds`.

    Args:
        topic: The name as a node of ROS takes it, perhaps relative or with `~`.
        node: The node whose name and namespace stand in for what is left out.

    Raises:
        LabError: It is no name of a topic.
    """
    # Here, so that the rest of this module needs no ROS.
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        name = str(expand_topic_name(topic, node.get_name(), node.get_namespace()))
        validate_full_topic_name(name)
    except (ValueError, TypeError, InvalidTopicNameException) as error:
        # The first line, without the place in rcl's source.
        reason = str(error).splitlines()[0].partition(', at /')[0].rstrip(':')
        raise LabError(
            f'{topic!r} is no name of a topic: {reason}.',
            todo='Use letters, digits, _ and /, such as /chatter.',
        ) from error
    return name
