"""`ros2 doctor`: likely causes of trouble in this machine and in the graph.

For the course's own environment and notebooks, `lab.doctor()` knows more.
"""

from __future__ import annotations

import itertools
import os
import platform
import sys
from argparse import Namespace
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from labkit.ros2.graph_queries import add_discovery_options, asking_node
from labkit.ros2.parser import Command, Parser, Verb
from labkit.rosgraph.endpoints import Endpoint, publishers, subscriptions
from labkit.rosgraph.listings import own_topics
from labkit.rosgraph.matching import qos_mismatch
from labkit.rosgraph.names import split_node_name

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['COMMAND']

_LOOPBACK, _MULTICAST = 0x8, 0x1000  # flags of an interface, see netdevice(7)
_DISTRIBUTION = 'jazzy'

Section = tuple[str, list[tuple[str, object]]]


def doctor(args: Namespace) -> int:
    """Print warnings and the number of failed checks, or a full report."""
    node = asking_node(args)
    if args.report:
        for title, items in _report(node):
            print(f'\n   {title}')
            width = max(len(key) for key, _ in items) + 4
            for key, value in items:
                print(f'{key:{width}}: {value}')
        print()
        return 0
    failed = []
    for name, check in _CHECKS.items():
        warnings, errors = check(node)
        for text in warnings:
            print(f'UserWarning: {text}', file=sys.stderr)
        for text in errors:
            print(f'UserWarning: ERROR: {text}', file=sys.stderr)
        if errors or (warnings and args.include_warnings):
            failed.append(name)
    if not failed:
        print(f'\nAll {len(_CHECKS)} checks passed\n')
        return 0
    print(f'\n{len(failed)}/{len(_CHECKS)} check(s) failed\n')
    print('Failed modules:', *failed)
    return 1


Findings = tuple[list[str], list[str]]


def _check_platform(_: Node) -> Findings:
    distribution = os.environ.get('ROS_DISTRO', _DISTRIBUTION)
    if distribution != _DISTRIBUTION:
        return [], [f'ROS_DISTRO is {distribution}, but what runs is {_DISTRIBUTION}.']
    return [], []


def _check_network(_: Node) -> Findings:
    flags = [flag for _, flag, _ in _interfaces()]
    if not any(flag & _LOOPBACK for flag in flags):
        return [], ['No loopback IP address is found.']
    warnings = []
    if all(flag & _LOOPBACK for flag in flags):
        warnings += ['Only loopback IP address is found.']
    if not any(flag & _MULTICAST for flag in flags):
        warnings += ['No multicast IP address is found.']
    return warnings, []


def _check_topics(node: Node) -> Findings:
    warnings = []
    for topic in own_topics(node):
        sources, sinks = node.count_publishers(topic), node.count_subscribers(topic)
        if sources > sinks == 0:
            warnings += [f'Publisher without subscriber detected on {topic}.']
        elif sinks > sources == 0:
            warnings += [f'Subscriber without publisher detected on {topic}.']
    return [*warnings, *_silent_faults()], []


def _silent_faults() -> list[str]:
    from labkit.silent.watch import faults

    # Profiles that do not match are told in the words of the real one.
    return [f'{one} {one.advice}' for one in faults() if not one.kind.id.startswith('qos.')]


def _check_qos(node: Node) -> Findings:
    return [], [
        f"QoS compatibility error found on topic '{publisher.topic}': {reason};"
        for publisher, _, reason in _pairs(node)
        if reason
    ]


_CHECKS: dict[str, Callable[..., Findings]] = {
    'platform': _check_platform,
    'network': _check_network,
    'topic': _check_topics,
    'middleware': _check_qos,
}


def _report(node: Node) -> list[Section]:
    from rclpy.utilities import get_rmw_implementation_identifier

    network: list[tuple[str, object]] = []
    for name, flag, mtu in _interfaces():
        kinds = [
            word
            for bit, word in ((_LOOPBACK, 'LOOPBACK'), (_MULTICAST, 'MULTICAST'))
            if flag & bit
        ]
        network += [('device', name), ('flags', f'<{",".join(kinds)}>'), ('mtu', mtu)]
    pairs: list[tuple[str, object]] = []
    for publisher, subscription, reason in _pairs(node):
        pairs += [
            ('topic [type]', f'{publisher.topic} [{publisher.msg_type}]'),
            ('publisher node', split_node_name(publisher.node)[0]),
            ('subscriber node', split_node_name(subscription.node)[0]),
            ('compatibility status', f'ERROR: {reason};' if reason else 'OK'),
        ]
    topics: list[tuple[str, object]] = []
    for topic in own_topics(node):
        topics += [
            ('topic', topic),
            ('publisher count', node.count_publishers(topic)),
            ('subscriber count', node.count_subscribers(topic)),
        ]
    none: list[tuple[str, object]] = [
        ('compatibility status', 'No publisher/subscriber pairs found')
    ]
    return [
        ('NETWORK CONFIGURATION', network or [('device', 'none')]),
        (
            'PLATFORM INFORMATION',
            [
                ('system', platform.system()),
                ('platform info', platform.platform()),
                ('release', platform.release()),
                ('processor', platform.machine()),
                ('python', platform.python_version()),
            ],
        ),
        ('QOS COMPATIBILITY LIST', pairs or none),
        ('RMW MIDDLEWARE', [('middleware name', get_rmw_implementation_identifier())]),
        (
            'ROS 2 INFORMATION',
            [('distribution name', _DISTRIBUTION), ('distribution type', 'ros2')],
        ),
        ('TOPIC LIST', topics or [('topic', 'none')]),
    ]


def _pairs(node: Node) -> Iterator[tuple[Endpoint, Endpoint, str]]:
    """Yield each publisher with each subscription of its topic, and the reason for a mismatch."""
    for topic in own_topics(node):
        for publisher, subscription in itertools.product(
            publishers(node, topic), subscriptions(node, topic)
        ):
            yield publisher, subscription, qos_mismatch(publisher.qos, subscription.qos)


def _interfaces() -> list[tuple[str, int, int]]:
    """Return name, flags and MTU of each network interface."""
    found = []
    for folder in sorted(Path('/sys/class/net').glob('*')):
        try:
            flags = int((folder / 'flags').read_text(), 16)
            found += [(folder.name, flags, int((folder / 'mtu').read_text()))]
        except (OSError, ValueError):
            continue
    return found


def _arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.flag('-r, --report', 'Print all reports.')
    parser.flag(
        '-iw, --include-warnings',
        'Include warnings as failed checks. Warnings are ignored by default.',
    )


COMMAND = Command(
    'doctor',
    'Check ROS setup and other potential issues',
    (
        Verb(
            'doctor',
            'Check ROS setup and other potential issues',
            doctor,
            _arguments,
            'A failed check gives exit code 1 here; the real one ends with 0.',
        ),
    ),
)
