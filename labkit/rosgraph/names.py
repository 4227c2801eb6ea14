"""Names of nodes, topics and services."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.errors import LabError, printable, quoted

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    'EVERY_NODE_HAS',
    'EVERY_NODE_OFFERS',
    'LAST_SERVICE',
    'PARAMETER_SERVICES',
    'UNKNOWN_NODE',
    'full_node_name',
    'full_topic_name',
    'is_hidden',
    'split_node_name',
]

# Topics that every node publishes on.
EVERY_NODE_HAS = ('/parameter_events', '/rosout')
# Services of every node with parameter services, under its name, in rclpy 7.1 and rclcpp 28.
PARAMETER_SERVICES = (
    *('describe_parameters', 'get_parameter_types', 'get_parameters', 'list_parameters'),
    *('set_parameters', 'set_parameters_atomically'),
)
# Created last, unless the parameter start_type_description_service is false.
LAST_SERVICE = 'get_type_description'
EVERY_NODE_OFFERS = frozenset({*PARAMETER_SERVICES, LAST_SERVICE})
# Node name that ROS reports while it does not know the node of an endpoint.
UNKNOWN_NODE = '_NODE_NAME_UNKNOWN_'


def is_hidden(name: str) -> bool:
    """Return whether a node, topic or service is hidden: a part of its name starts with `_`."""
    return any(part.startswith('_') for part in name.split('/'))


def full_node_name(name: str, namespace: str) -> str:
    """Return a node's full name: `/talker`, or `/robot/talker` in a namespace."""
    return f'/{namespace.strip("/")}/{name}'.replace('//', '/')


def split_node_name(full_name: str) -> tuple[str, str]:
    """Split a node's full name into name and namespace: `'talker', '/robot'`."""
    namespace, _, name = full_name.rpartition('/')
    return name, namespace or '/'


def full_topic_name(topic: str, node: Node) -> str:
    """Return the full name of a topic or service: `'odds'` is usually `/odds`.

    Args:
        topic: The name as passed to a node: absolute, relative or with `~`.
        node: The node whose name and namespace complete it.

    Raises:
        LabError: The name is invalid.
    """
    # Imported here, so that the rest of this module needs no ROS.
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.expand_topic_name import expand_topic_name
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        if not isinstance(topic, str) or '\0' in topic:
            raise TypeError('no text')
        name = str(expand_topic_name(topic, node.get_name(), node.get_namespace()))
        validate_full_topic_name(name)
    except (ValueError, TypeError, InvalidTopicNameException) as error:
        # The first line, without the location in rcl's source.
        reason = printable(str(error).splitlines()[0].partition(', at /')[0].rstrip(':'))
        if isinstance(error, (TypeError, UnicodeError)):
            reason = 'it is no text in UTF-8'
        raise LabError(
            f'{quoted(topic)} is no name of a topic: {reason}.',
            todo='Use letters, digits, _ and /, such as /chatter.',
        ) from error
    return name
