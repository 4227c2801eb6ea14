"""Publish where moving frames are, on /tf."""

from __future__ import annotations

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import QoSProfile

__all__ = ['TransformBroadcaster', 'as_list']

QUEUE_DEPTH = 100


class TransformBroadcaster:
    """Publishes moving transforms.

    Args:
        node: Its publisher is used.
        qos: QoS profile, or queue depth; 100 messages by default.
    """

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        # Built when it is first asked for.
        from tf2_msgs.msg import TFMessage

        self._type = TFMessage
        self.pub_tf = node.create_publisher(TFMessage, '/tf', QUEUE_DEPTH if qos is None else qos)

    def sendTransform(  # the real one's name
        self, transform: TransformStamped | Iterable[TransformStamped]
    ) -> None:
        """Publish a transform, or several in one message."""
        self.pub_tf.publish(self._type(transforms=as_list(transform)))


def as_list(transform: TransformStamped | Iterable[TransformStamped]) -> list[TransformStamped]:
    """Return one transform, or several, as a list."""
    return list(transform) if hasattr(transform, '__iter__') else [transform]
