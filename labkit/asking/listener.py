"""Listen to a topic with one subscription, whose QoS matches all publishers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from labkit.background.nodes import node_exists
from labkit.rosgraph.matching import qos_mismatch
from labkit.rosgraph.qos_profiles import match_all

__all__ = ['Listener', 'least_profile']

DEPTH = 100


def least_profile(depth: int = DEPTH) -> QoSProfile:
    """Return a profile that matches publishers of any profile."""
    return QoSProfile(  # type: ignore[no-untyped-call]
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
    )


class Listener:
    """A subscription until it is closed; a context manager.

    It requests the most that all publishers offer. It prints nothing if a publisher does not
    match; that is up to the caller.

    Args:
        node: The node that subscribes. If no executor spins it, the caller takes the messages.
        topic: Full name of the topic.
        msg_type: Class of the messages.
        take: Called with each message.
        offered: QoS profiles of the existing publishers.
        qos_profile: QoS profile to use whatever is offered, or a queue depth.
        depth: Queue depth if there is no `qos_profile`.
        raw: Whether `take` gets serialized messages.
        events: Callbacks for QoS events. Each costs a tenth of a message's time.

    Attributes:
        profile: QoS profile of the subscription.
        notes: Remarks on how publishers differ, see `match_all`.

    Raises:
        RCLError, LabError: The topic has another type in this process.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        msg_type: Any,
        take: Callable[..., None],
        *,
        offered: Sequence[QoSProfile] = (),
        qos_profile: QoSProfile | int | None = None,
        depth: int = DEPTH,
        raw: bool = False,
        events: SubscriptionEventCallbacks | None = None,
    ) -> None:
        self.msg_type = msg_type
        self.notes: list[str] = []
        self._node, self._topic, self._take, self._raw = node, topic, take, raw
        self._wanted, self._depth = qos_profile, depth
        self._events = events or SubscriptionEventCallbacks(use_default_callbacks=False)
        self._subscribe(self._profile(offered))

    def __enter__(self) -> Listener:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Destroy the subscription."""
        if node_exists(self._node):
            self._node.destroy_subscription(self.subscription)

    def hears_all(self, offered: Sequence[QoSProfile]) -> bool:
        """Return whether publishers of these profiles all match."""
        return not any(qos_mismatch(each, self.profile) for each in offered)

    def follow(self, offered: Sequence[QoSProfile]) -> None:
        """Subscribe again if publishers of these profiles require another one."""
        profile, old = self._profile(offered), self.profile
        if (profile.reliability, profile.durability) != (old.reliability, old.durability):
            self.close()
            self._subscribe(profile)

    def _profile(self, offered: Sequence[QoSProfile]) -> QoSProfile:
        if isinstance(self._wanted, QoSProfile):
            return self._wanted
        profile = QoSProfile(depth=self._wanted or self._depth)  # type: ignore[no-untyped-call]
        if offered and self._wanted is None:
            self.notes = match_all(profile, offered)
        return profile

    def _subscribe(self, profile: QoSProfile) -> None:
        self.profile = profile
        self.subscription: Subscription = self._node.create_subscription(
            self.msg_type,
            self._topic,
            self._take,
            profile,
            event_callbacks=self._events,
            raw=self._raw,
        )
