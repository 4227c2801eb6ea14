"""The node to ask the graph with, and how long others may take to be discovered."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from rclpy.node import Node

from labkit.background.runtime import runtime
from labkit.domain_ids import first_port
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.snapshot import is_whole, node_names
from labkit.rosgraph.whose import participant_of

__all__ = [
    'DISCOVERY_SEC',
    'SOON_SEC',
    'alone',
    'asking_node',
    'calm',
    'has_all_services',
    'soon',
]

Found = TypeVar('Found')

# Nodes of other processes are heard of some tenths of a second after ROS was started here.
DISCOVERY_SEC = 0.5
# How long a name that is asked for may still be on its way.
SOON_SEC = 1.0
POLL_SEC = 0.01
# Discovery is over when all participants are known and the graph has not changed for so long, and
# for certain after so long.
CALM_SEC = 0.15
MOST_SEC = 10.0
# A new process has made all of its nodes when nothing was added for so long: it may have to load
# the types of its messages in between.
SETTLED_SEC = 0.3

# A node that lets its parameters be set from outside offers these, rclpy 7.1 and rclcpp 28.
PARAMETER_SERVICES = (
    *('describe_parameters', 'get_parameter_types', 'get_parameters', 'list_parameters'),
    *('set_parameters', 'set_parameters_atomically'),
)
# And this one after those, unless its parameter start_type_description_service says otherwise.
LAST_SERVICE = 'get_type_description'

# Ports of participants, DDSI-RTPS 2.5, 9.6.2.3: that of the domain + 10 + 2 * participant. Fast
# DDS looks for so many on this machine; behind them the ports of another domain begin.
_FIRST_PARTICIPANT = 10
_LOOKED_FOR = 32


def asking_node(spin_time: float = DISCOVERY_SEC) -> Node:
    """Return the node to ask the graph with. ROS is started if it is not up.

    Args:
        spin_time: Seconds that others may take to be discovered if ROS was started just now.
    """
    runtime.refuse_in_callback('Asking the graph')
    runtime.start()
    assert runtime.helper is not None
    if not alone() and time.monotonic() < runtime.started_at + MOST_SEC:
        # On this machine all that take part can be counted; on others only time helps.
        least = 0.0 if _local() else min(spin_time, 60.0)
        _discover(runtime.helper, runtime.started_at + least)
    return runtime.helper


def calm(node: Node) -> None:
    """Wait until the graph has stopped changing: a new node comes into it piece by piece."""
    seen: object = None
    changed = started = time.monotonic()
    while time.monotonic() < min(changed + SETTLED_SEC, started + SOON_SEC):
        topics = node.get_topic_names_and_types()
        ends = [(name, _count(node, name)) for name, _ in topics]
        graph = (node_names(node), ends, node.get_service_names_and_types())
        if graph != seen or not is_whole(node):
            seen, changed = graph, time.monotonic()
        time.sleep(POLL_SEC)


def has_all_services(node: Node, names: list[str]) -> bool:
    """Tell whether nodes offer all services that come with every node.

    Args:
        node: The node to ask the graph with.
        names: Full names of the nodes.

    Returns:
        Whether each offers the one that is made last, and, of those of its parameters, all or
        none: a node may be made without them.
    """
    offered = {service for service, _types in node.get_service_names_and_types()}
    for name in names:
        found = [f'{name}/{service}' in offered for service in PARAMETER_SERVICES]
        if f'{name}/{LAST_SERVICE}' not in offered or (any(found) and not all(found)):
            return False
    return True


def _count(node: Node, topic: str) -> tuple[int, int]:
    return node.count_publishers(topic), node.count_subscribers(topic)


def _discover(node: Node, until: float) -> None:
    """Wait until a time, and until all participants of this machine are known."""
    seen: object = None
    changed = 0.0
    while True:
        now = time.monotonic()
        graph = (node_names(node), node.get_topic_names_and_types())
        if graph != seen:
            seen, changed = graph, now
        if now >= until:
            others = _participants_here() - 1
            known = _participants_known(node) - 1
            if others <= 0 or (known >= others and now >= changed + CALM_SEC):
                return
            if now >= max(until, runtime.started_at + MOST_SEC):
                return
        time.sleep(POLL_SEC)


def _participants_here() -> int:
    """Return how many participants of this domain have opened their port on this machine."""
    ports = set()
    first = first_port(runtime.domain_id or 0) + _FIRST_PARTICIPANT
    try:
        table = Path('/proc/net/udp').read_text(encoding='ascii')
    except OSError:
        return 0
    for line in table.splitlines()[1:]:
        offset = int(line.split()[1].rpartition(':')[2], 16) - first
        if 0 <= offset < 2 * _LOOKED_FOR and offset % 2 == 0:
            ports.add(offset)
    return len(ports)


def _participants_known(node: Node) -> int:
    # Every node publishes there. Which node it is comes a moment later.
    ends = publishers(node, '/parameter_events')
    unknown = {participant_of(end.gid) for end in ends if not end.is_known}
    return len({participant_of(end.gid) for end in ends} - unknown)


def _local() -> bool:
    wide = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') != 'LOCALHOST'
    return not wide and not os.environ.get('ROS_STATIC_PEERS')


def alone() -> bool:
    """Tell whether nodes of other processes can't be discovered anyway."""
    return os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') == 'OFF'


def soon(look: Callable[[], Found], timeout_sec: float | None = None) -> Found:
    """Ask again and again until the answer is true, or the time is over.

    Args:
        look: Asks the graph.
        timeout_sec: Seconds to go on. By default as long as discovery may take.

    Returns:
        The last answer.
    """
    if timeout_sec is None:
        timeout_sec = 0.0 if alone() else SOON_SEC
    end = time.monotonic() + timeout_sec
    while True:
        found = look()
        if found or time.monotonic() >= end:
            return found
        time.sleep(POLL_SEC)
