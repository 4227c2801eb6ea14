"""QoS profiles from the short names of the command line, and one that hears all publishers."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)

__all__ = ['POLICIES', 'PRESETS', 'make_profile', 'match_all']

_PRESETS: Any = QoSPresetProfiles
_POLICIES: dict[str, Any] = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}

PRESETS: tuple[str, ...] = tuple(_PRESETS.short_keys())
"""Short names of the preset profiles, such as `'sensor_data'`."""

POLICIES: dict[str, tuple[str, ...]] = {
    name: tuple(policy.short_keys()) for name, policy in _POLICIES.items()
}
"""Policy -> the short names of its kinds: `'reliability'` -> `'best_effort'`, ..."""


def make_profile(
    preset: str,
    policies: Mapping[str, str] | None = None,
    *,
    depth: int | None = None,
    lease_duration_sec: float | None = None,
) -> QoSProfile:
    """Return a new QoS profile.

    Args:
        preset: Short name of the profile that it differs from, one of `PRESETS`.
        policies: Policy -> short name of its kind, as in `POLICIES`.
        depth: How many messages are kept; that of the preset if None or 0.
        lease_duration_sec: Lease duration of liveliness, in seconds; that of the preset if None.
    """
    profile: QoSProfile = copy.copy(_PRESETS.get_from_short_key(preset))
    for name, kind in (policies or {}).items():
        setattr(profile, name, _POLICIES[name].get_from_short_key(kind))
    if lease_duration_sec is not None:
        profile.liveliness_lease_duration = Duration(seconds=lease_duration_sec)
    if depth:
        profile.depth = depth
    elif profile.durability == DurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1
    return profile


def match_all(profile: QoSProfile, offered: Sequence[QoSProfile]) -> list[str]:
    """Let a subscription's profile ask for the most that all publishers offer.

    Args:
        profile: The profile, which is changed.
        offered: The profiles of the publishers, at least one.

    Returns:
        Lines that say so when publishers differ, in the words of the real `ros2`.
    """
    notes = []
    for name, strong, weak in (
        ('reliability', ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        ('durability', DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
    ):
        count = sum(getattr(each, name) == strong for each in offered)
        setattr(profile, name, strong if count == len(offered) else weak)
        if 0 < count < len(offered):
            kind = f'QoS{name.capitalize()}Policy'
            notes += [
                f'Some, but not all, publishers are offering {kind}.{strong.name}. Falling back '
                f'to {kind}.{weak.name} as it will connect to all publishers'
            ]
    return notes
