"""Matchers for whether callbacks run: none that does not return, and a node that is spun."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.exercises.hanging import Hanging, find_hanging
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['hanging', 'how_to_spin', 'runs', 'spun']

# How long a node of another process may take to answer, if it is spun.
ANSWER_SEC = 2.5


def hanging(found: Hanging | None = None) -> None:
    """Raise Fail if a callback of this notebook is running and does not return.

    Args:
        found: What was found not to return; it is looked for if None.
    """
    found = found or find_hanging()
    if found is None:
        return
    where = f' ({found.line})' if found.line else ''
    if not found.node:
        raise Fail(
            'callbacks of this notebook that run',
            f'none of them has run for a while, though some were ready{where}',
            why='Something keeps them all from running, such as the condition of a wait that does '
            'not return.',
            todo='Stop what waits, and check again. If that does not help, restart the kernel.',
        )
    raise Fail(
        'callbacks that return at once',
        f'the callback {found.callback} of {found.node} is still running{where}',
        why='While a callback runs, no other one can: no message is taken, no timer ticks. '
        'A callback that waits or loops holds everything up.',
        todo='Do one small step in the callback and return. For "again later" use a timer.',
    )


def spun(probe: Probe, endpoint: Endpoint) -> None:
    """Raise Fail if nobody runs the callbacks of an endpoint's node."""
    if not runs(probe, endpoint.node):
        raise Fail(
            f'{endpoint.node} takes its messages and calls its callbacks',
            f'{endpoint.node} is there, but it is not spun',
            why='Messages come and wait in the queue. Nothing takes them out.',
            todo=how_to_spin(probe, endpoint.node),
        )


def how_to_spin(probe: Probe, name: str) -> str:
    """Say how a node of this process, or of another one, is spun."""
    if probe.node_object(name) is None:
        return 'Call rclpy.spin(node) in its program.'
    return 'Hand the node over: lab.spin(node)'


def runs(probe: Probe, name: str) -> bool:
    """Tell whether somebody runs the callbacks of a node.

    A node of another process is asked a question. One without parameter services can't be asked,
    and counts as spun.
    """
    node = probe.node_object(name)
    if node is not None:
        return node.executor is not None
    from labkit.background.patience import answer_sec
    from labkit.background.service_calls import wait_until_spun

    service, asker = f'{name}/list_parameters', probe.spun_node
    # Services come into the graph after the name of their node.
    found = probe.wait_to_appear(lambda: service in dict(asker.get_service_names_and_types()))
    return not found or wait_until_spun(asker, name, answer_sec(ANSWER_SEC))
