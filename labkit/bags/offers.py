"""What a player offers for what the publishers had offered when they were recorded."""

from __future__ import annotations

import copy

from rclpy.qos import HistoryPolicy, QoSProfile

__all__ = ['offered_profile']

DEFAULT_DEPTH = 10


def offered_profile(recorded: list[QoSProfile]) -> QoSProfile:
    """Return what to offer for what was offered, as the real player does.

    If the publishers did not offer the same, or nothing is known of them: the default profile.
    """
    if not recorded or any(_asked(profile) != _asked(recorded[0]) for profile in recorded):
        return QoSProfile(depth=DEFAULT_DEPTH)  # type: ignore[no-untyped-call]
    profile = copy.copy(recorded[0])
    # The graph does not know history and depth.
    if profile.history != HistoryPolicy.KEEP_ALL:
        profile.history = HistoryPolicy.KEEP_LAST
        profile.depth = profile.depth or DEFAULT_DEPTH
    return profile


def _asked(profile: QoSProfile) -> tuple[object, ...]:
    """Return what decides whether a publisher is heard."""
    times = (profile.deadline, profile.liveliness_lease_duration)
    policies = (profile.reliability, profile.durability, profile.liveliness)
    return (*policies, *(duration.nanoseconds for duration in times))
