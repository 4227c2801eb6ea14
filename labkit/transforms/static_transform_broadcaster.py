"""Publish where frames are that do not move, on /tf_static: once, for all who come later, too."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from labkit.transforms.transform_broadcaster import as_list

__all__ = ['StaticTransformBroadcaster']


class StaticTransformBroadcaster:
    """Publishes static transforms.

    Args:
        node: Its publisher is used.
        qos: QoS profile, or queue depth; by default transient local, one message, so that it
            reaches those who subscribe later.
    """

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        # Built when it is first asked for.
        from tf2_msgs.msg import TFMessage

        if qos is None:
            qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # type: ignore[no-untyped-call]
        self._type = TFMessage
        self.pub_tf = node.create_publisher(TFMessage, '/tf_static', qos)
        self._sent: dict[str, TransformStamped] = {}

    def sendTransform(  # the real one's name
        self, transform: TransformStamped | Iterable[TransformStamped]
    ) -> None:
        """Publish one or several transforms, with all those sent before: the last message counts.

        A frame that was sent before is replaced, as in C++. (The real one in Python then sends
        the old one again.)
        """
        # Copies: a program may fill in the same message again.
        self._sent.update((each.child_frame_id, deepcopy(each)) for each in as_list(transform))
        self.pub_tf.publish(self._type(transforms=list(self._sent.values())))
