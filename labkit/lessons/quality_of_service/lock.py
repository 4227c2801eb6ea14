"""A lock that hears a door. What its subscription asks for is to be found in the graph."""

from __future__ import annotations

from typing import Any

__all__ = ['DEADLINE_SEC', 'NODE', 'TOPIC', 'is_untouched', 'start_lock']

NODE = '/lock'
TOPIC = '/door'
DEADLINE_SEC = 1.0


def start_lock() -> Any:
    """Start the lock; return its node. `lock.heard` holds the numbers that have come."""
    from rclpy.duration import Duration
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import Int16

    from labkit.background.runtime import runtime

    class Lock(Node):
        def __init__(self) -> None:
            super().__init__(NODE.lstrip('/'))
            self.heard: list[int] = []
            profile = QoSProfile(  # type: ignore[no-untyped-call]
                depth=10,
                durability=DurabilityPolicy.TRANSIENT_LOCAL,
                deadline=Duration(seconds=DEADLINE_SEC),
            )
            # The door warns of what does not match. Two warnings would come in either order.
            silent = SubscriptionEventCallbacks(use_default_callbacks=False)
            self.create_subscription(Int16, TOPIC, self.on_door, profile, event_callbacks=silent)

        def on_door(self, msg: Int16) -> None:
            self.heard.append(msg.data)

    runtime.start()
    lock = Lock()
    runtime.add(lock)
    return lock


def is_untouched(profile: Any) -> bool:
    """Tell whether a QoS profile, as the graph has it, is that of the lock's subscription."""
    return bool(
        profile.reliability.name == 'RELIABLE'
        and profile.durability.name == 'TRANSIENT_LOCAL'
        and profile.deadline.nanoseconds == round(DEADLINE_SEC * 1e9)
    )
