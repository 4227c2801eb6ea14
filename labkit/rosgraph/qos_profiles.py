"""QoS profiles from the short names of the command line, and one that matches all publishers."""

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

from labkit.errors import LabError, quoted
from labkit.rosgraph.yaml_loading import load_yaml_file

__all__ = ['POLICIES', 'PRESETS', 'make_profile', 'match_all', 'read_overrides']

_PRESETS: Any = QoSPresetProfiles
_POLICIES: dict[str, Any] = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}

_TIMES = ('deadline', 'lifespan', 'liveliness_lease_duration')
_PLAIN: dict[str, type[int]] = {'depth': int, 'avoid_ros_namespace_conventions': bool}

PRESETS: tuple[str, ...] = tuple(_PRESETS.short_keys())
"""Short names of the preset profiles, such as `'sensor_data'`."""

POLICIES: dict[str, tuple[str, ...]] = {
    name: tuple(policy.short_keys()) for name, policy in _POLICIES.items()
}
"""Policy -> short names of its kinds: `'reliability'` -> `'best_effort'`, ..."""


def make_profile(
    preset: str,
    policies: Mapping[str, str] | None = None,
    *,
    depth: int | None = None,
    lease_duration_sec: float | None = None,
) -> QoSProfile:
    """Return a new QoS profile.

    Args:
        preset: Short name of the preset to start from, one of `PRESETS`.
        policies: Policy -> short name of its kind, as in `POLICIES`.
        depth: Queue depth; that of the preset if None or 0.
        lease_duration_sec: Lease duration of liveliness, s; that of the preset if None.
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


def read_overrides(path: str) -> dict[str, QoSProfile]:
    """Return the QoS profiles by topic of a file of overrides, in the form of `ros2 bag`.

    Raises:
        LabError: It can't be read, or has another form.
    """
    try:
        topics = load_yaml_file(path) or {}
        return {str(name): _profile_from(policies) for name, policies in topics.items()}
    except OSError as error:
        raise LabError(f'{quoted(path)} can not be read: {error.strerror}.') from error
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise LabError(
            f'{quoted(path)} is no file of QoS profiles: {error}.',
            todo='Such as: /scan: {reliability: best_effort, history: keep_last, depth: 5}',
        ) from error


def _profile_from(policies: Mapping[str, Any]) -> QoSProfile:
    profile: Any = copy.copy(_PRESETS.get_from_short_key('default'))
    for name, value in policies.items():
        if name in POLICIES and value in POLICIES[name]:
            setattr(profile, name, _POLICIES[name].get_from_short_key(value))
        elif name in _TIMES:
            setattr(profile, name, Duration(seconds=value['sec'], nanoseconds=value['nsec']))
        elif name in _PLAIN and isinstance(value, _PLAIN[name]) and value >= 0:
            setattr(profile, name, value)
        else:
            raise ValueError(f'{name} can not be {quoted(value)}')
    return profile  # type: ignore[no-any-return]


def match_all(profile: QoSProfile, offered: Sequence[QoSProfile]) -> list[str]:
    """Make a subscription's profile request the most that all publishers offer.

    Args:
        profile: The profile, which is changed.
        offered: The profiles of the publishers, at least one.

    Returns:
        Notes about publishers that differ, in the words of the real `ros2`.
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
