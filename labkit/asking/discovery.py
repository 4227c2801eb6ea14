"""Graph queries while nodes of other processes may still be being discovered."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import TypeVar

from rclpy.node import Node

from labkit.background.domains import open_ports
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.domain_ids import ports_of_participants
from labkit.rosgraph.names import LAST_SERVICE, PARAMETER_SERVICES
from labkit.rosgraph.snapshot import is_whole

__all__ = [
    'DISCOVERY_SEC',
    'MOST_SEC',
    'SOON_SEC',
    'asking_node',
    'discover',
    'has_all_services',
    'is_only_process',
    'poll_until',
    'wait_until_announced',
]

Found = TypeVar('Found')

# Nodes of other processes are discovered some tenths of a second after ROS was started here.
DISCOVERY_SEC = 0.5
# How long a name may take to be discovered.
SOON_SEC = 1.0
# Discovery is complete when all is there that participants of this machine announce, and at the
# latest after this time: one may be there that announces nothing.
MOST_SEC = 10.0


def asking_node(spin_time: float = DISCOVERY_SEC) -> Node:
    """Return the node for graph queries, and start ROS if it is not up.

    Args:
        spin_time: Seconds to wait for discovery if ROS was just started.
    """
    runtime.refuse_in_callback('Asking the graph')
    runtime.start()
    assert runtime.helper is not None
    if not is_only_process() and time.monotonic() < runtime.started_at + MOST_SEC:
        # Participants on this machine can be counted; for others there is only time.
        least = 0.0 if _is_local() else min(spin_time, 60.0)
        discover(runtime.helper, runtime.started_at + least, runtime.started_at + MOST_SEC)
    return runtime.helper


def wait_until_announced(node: Node) -> None:
    """Wait until all is in the graph that processes of this machine have announced by now.

    A process announces an endpoint when it makes it. What a node that has answered was to have
    from the start is announced by then: its `__init__` has ended.
    """
    now = time.monotonic()
    discover(node, now, now + SOON_SEC)


def has_all_services(node: Node, names: list[str]) -> bool:
    """Return whether the nodes of some full names offer all standard services.

    That is the service that is made last, and all or none of the parameter services: a node may be
    made without them.
    """
    offered = {service for service, _types in node.get_service_names_and_types()}
    for name in names:
        found = [f'{name}/{service}' in offered for service in PARAMETER_SERVICES]
        if f'{name}/{LAST_SERVICE}' not in offered or (any(found) and not all(found)):
            return False
    return True


def discover(node: Node, least: float, most: float) -> None:
    """Wait until all that participants of this machine announce is in the graph.

    Args:
        node: The node to ask with.
        least: When to return at the earliest, as `time.monotonic()`.
        most: When to return at the latest.
    """
    if time.monotonic() >= least and _participants_here() <= 1:
        return
    # Loaded here: it costs only those who wait.
    from labkit.asking.announced import Announced

    with Announced(node) as announced:

        def all_known() -> bool:
            if time.monotonic() < least:
                return False
            others = _participants_here() - 1
            return others <= 0 or (announced.participants() - 1 >= others and is_whole(node))

        wait_for(all_known, max(least, most) - time.monotonic())


def _participants_here() -> int:
    """Return the number of participants of this domain with an open port on this machine."""
    return len(open_ports() & {*ports_of_participants(runtime.domain_id or 0)})


def _is_local() -> bool:
    wide = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') != 'LOCALHOST'
    return not wide and not os.environ.get('ROS_STATIC_PEERS')


def is_only_process() -> bool:
    """Return whether discovery is off."""
    return os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') == 'OFF'


def poll_until(look: Callable[[], Found], timeout_sec: float = SOON_SEC) -> Found:
    """Query the graph until the answer is true or the time is over; return the last answer.

    Args:
        look: The query.
        timeout_sec: Seconds to wait, if there can be other processes.
    """
    return wait_for(look, 0.0 if is_only_process() else timeout_sec)
