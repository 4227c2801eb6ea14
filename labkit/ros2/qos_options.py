"""The `--qos-...` options, and the QoS profile they describe."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from labkit.ros2.parser import Parser, positive_float, unsigned_int
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.qos_profiles import POLICIES, PRESETS, make_profile, match_all

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__all__ = ['add_qos_options', 'matching_profile', 'profile_from']


def add_qos_options(parser: Parser, default: str) -> None:
    """Add the `--qos-...` options.

    Args:
        parser: The parser to extend.
        default: Short name of the default preset, such as `'sensor_data'`.
    """
    parser.add(
        '--qos-profile',
        choices=PRESETS,
        default=default,
        help=f'Quality of service preset profile (default: {default})',
    )
    parser.add(
        '--qos-depth',
        metavar='N',
        type=unsigned_int,
        help='Queue size setting (overrides depth value of --qos-profile option)',
    )
    for name, kinds in POLICIES.items():
        parser.add(
            f'--qos-{name}',
            choices=kinds,
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
    """Return the profile described by the options."""
    return make_profile(
        args.qos_profile,
        _policies(args),
        depth=args.qos_depth,
        lease_duration_sec=args.qos_liveliness_lease_duration_seconds,
    )


def matching_profile(args: Namespace, node: Node, topic: str) -> tuple[QoSProfile, list[str]]:
    """Return the profile to subscribe with, by default one that matches all publishers.

    Args:
        args: The arguments, including those of `add_qos_options`.
        node: The node to query the graph with.
        topic: Full name of the topic.

    Returns:
        The profile, and notes about publishers that differ.
    """
    profile = profile_from(args)
    numbers = (args.qos_depth, args.qos_liveliness_lease_duration_seconds)
    offered = [end.qos for end in publishers(node, topic)]
    if not offered or _policies(args) or numbers != (None, None):
        return profile, []
    return profile, match_all(profile, offered)


def _policies(args: Namespace) -> dict[str, str]:
    """Return the policies that were set explicitly."""
    asked = {name: getattr(args, f'qos_{name}') for name in POLICIES}
    return {name: kind for name, kind in asked.items() if kind is not None}
