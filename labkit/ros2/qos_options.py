"""The `--qos-...` options, and the QoS profile that they ask for."""

from __future__ import annotations

import copy
from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)

from labkit.ros2.parser import Parser, positive_float, unsigned_int

__all__ = ['add_qos_options', 'match_all', 'matching_profile', 'profile_from']

_PRESETS: Any = QoSPresetProfiles
_POLICIES: dict[str, Any] = {
    'history': HistoryPolicy,
    'reliability': ReliabilityPolicy,
    'durability': DurabilityPolicy,
    'liveliness': LivelinessPolicy,
}


def add_qos_options(parser: Parser, default: str) -> None:
    """Add the `--qos-...` options.

    Args:
        parser: Where to add them.
        default: Short name of the preset profile that is the default, such as `'sensor_data'`.
    """
    parser.add(
        '--qos-profile',
        choices=_PRESETS.short_keys(),
        default=default,
        help=f'Quality of service preset profile (default: {default})',
    )
    parser.add(
        '--qos-depth',
        metavar='N',
        type=unsigned_int,
        help='Queue size setting (overrides depth value of --qos-profile option)',
    )
    for name, policy in _POLICIES.items():
        parser.add(
            f'--qos-{name}',
            choices=policy.short_keys(),
            help=f'Quality of service {name} setting (overrides {name} value of --qos-profile '
            'option)',
        )
    parser.add(
        '--qos-liveliness-lease-duration-seconds',
        metavar='SECONDS',
        type=positive_float,
        help='Quality of service liveliness lease duration setting (overrides that of '
        '--qos-profile option)',
    )


def profile_from(args: Namespace) -> QoSProfile:
    """Return the profile that the options ask for."""
    profile: QoSProfile = copy.copy(_PRESETS.get_from_short_key(args.qos_profile))
    for name, policy in _POLICIES.items():
        wanted = getattr(args, f'qos_{name}')
        if wanted is not None:
            setattr(profile, name, policy.get_from_short_key(wanted))
    if args.qos_liveliness_lease_duration_seconds is not None:
        seconds = args.qos_liveliness_lease_duration_seconds
        profile.liveliness_lease_duration = Duration(seconds=seconds)
    if args.qos_depth:
        profile.depth = args.qos_depth
    elif profile.durability == DurabilityPolicy.TRANSIENT_LOCAL and profile.depth == 0:
        profile.depth = 1
    return profile


def matching_profile(args: Namespace, node: Node, topic: str) -> tuple[QoSProfile, list[str]]:
    """Return the profile to subscribe with: by default one that all publishers match.

    Args:
        args: The arguments, with those of `add_qos_options`.
        node: The node to ask the graph with.
        topic: Full name of the topic.

    Returns:
        The profile, and lines that say so when publishers differ.
    """
    profile = profile_from(args)
    asked = (*(f'qos_{name}' for name in _POLICIES), 'qos_depth')
    asked += ('qos_liveliness_lease_duration_seconds',)
    publishers = node.get_publishers_info_by_topic(topic)
    if not publishers or any(getattr(args, name) is not None for name in asked):
        return profile, []
    return profile, match_all(profile, [end.qos_profile for end in publishers])


def match_all(profile: QoSProfile, offered: Sequence[QoSProfile]) -> list[str]:
    """Let a subscription's profile ask for the most that all publishers offer.

    Args:
        profile: The profile, which is changed.
        offered: The profiles of the publishers, at least one.

    Returns:
        Lines that say so when publishers differ.
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
