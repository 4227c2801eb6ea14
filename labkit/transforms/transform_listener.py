"""Hear transforms on /tf and /tf_static, and put them into a buffer."""

from __future__ import annotations

from contextlib import suppress
from threading import Thread
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from labkit import settings
from labkit.background.runtime import runtime
from labkit.transforms.buffer_core import BufferCore
from labkit.transforms.listeners import listeners

__all__ = ['TransformListener']

QUEUE_DEPTH = 100
AUTHORITY = 'default_authority'


class TransformListener:
    """Puts the transforms that are published into a buffer.

    Args:
        buffer: The buffer.
        node: Subscribes to the two topics; its callbacks have to be called, so it is spun.
        spin_thread: Whether a thread spins the node. In a notebook it is the one of all nodes.
        qos: QoS profile, or queue depth, for /tf: volatile, 100 messages, by default.
        static_qos: The same for /tf_static: transient local, 100 messages, by default.
    """

    def __init__(
        self,
        buffer: BufferCore,
        node: Node,
        *,
        spin_thread: bool = False,
        qos: QoSProfile | int | None = None,
        static_qos: QoSProfile | int | None = None,
    ) -> None:
        # Built when it is first asked for.
        from tf2_msgs.msg import TFMessage

        if qos is None:
            qos = QoSProfile(depth=QUEUE_DEPTH)  # type: ignore[no-untyped-call]
        if static_qos is None:
            static_qos = QoSProfile(  # type: ignore[no-untyped-call]
                depth=QUEUE_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL
            )
        self.buffer = buffer
        self.node = node
        # So that another callback of the node can wait for a transform, in an executor with
        # several threads.
        self.group = ReentrantCallbackGroup()
        self.tf_sub = node.create_subscription(
            TFMessage, '/tf', self.callback, qos, callback_group=self.group
        )
        self.tf_static_sub = node.create_subscription(
            TFMessage, '/tf_static', self.static_callback, static_qos, callback_group=self.group
        )
        listeners.add(self)
        if spin_thread and settings.in_kernel():
            runtime.add(node)
        elif spin_thread:
            self.executor = SingleThreadedExecutor(context=node.context)
            self.executor.add_node(node)
            self.dedicated_listener_thread = Thread(target=self._spin)
            self.dedicated_listener_thread.start()

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            self.executor.spin()

    def unregister(self) -> None:
        """Stop listening."""
        listeners.discard(self)
        self.node.destroy_subscription(self.tf_sub)
        self.node.destroy_subscription(self.tf_static_sub)

    def callback(self, data: Any) -> None:
        """Put moving transforms into the buffer."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, AUTHORITY)

    def static_callback(self, data: Any) -> None:
        """Put static transforms into the buffer."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, AUTHORITY)
