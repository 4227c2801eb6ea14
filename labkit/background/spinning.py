"""Spin nodes in the background: `start`, `spin`, `remove`, `stop`."""

from __future__ import annotations

from typing import TypeVar

from rclpy.node import Node

from labkit.background.nodes import full_name
from labkit.background.runtime import runtime
from labkit.errors import LabError, nearest

__all__ = ['remove', 'spin', 'start', 'stop']

AnyNode = TypeVar('AnyNode', bound=Node)


def start(*, domain_id: int | None = None) -> None:
    """Start ROS in the background.

    Everything in labkit that needs ROS does this by itself; call it to choose a domain.

    Args:
        domain_id: The ROS domain to take part in, 0 to 101, or that of another notebook. By
            default `ROS_DOMAIN_ID` if it is set, else, in a notebook, a domain that no other
            notebook on this machine has.

    Raises:
        LabError: ROS runs in another domain already, with nodes in it.
    """
    runtime.start(domain_id=domain_id)


def spin(node: AnyNode) -> AnyNode:
    """Run a node in the background: its callbacks are called while cells come and go.

    A node of the same name that this notebook started before is destroyed first, so a cell may
    be run again as often as you like.

    Args:
        node: An object of a class made on `rclpy.node.Node`.

    Returns:
        The node.

    Raises:
        LabError: It is not a node, or it has been destroyed.
    """
    runtime.add(node)
    return node


def remove(node: Node | str) -> None:
    """End a node: it is taken from the background and destroyed.

    Args:
        node: The node, or its name: `'talker'` or `'/talker'`, with its namespace if it has one.

    Raises:
        LabError: No node of that name runs here.
    """
    if isinstance(node, Node):
        runtime.destroy(node)
        return
    for each in _find(node):
        runtime.destroy(each)


def stop() -> None:
    """Destroy all nodes, end the background thread and shut ROS down.

    `lab.start()`, `lab.spin()` and the rest work again afterwards.
    """
    runtime.stop()


def _find(name: str) -> list[Node]:
    """Return the nodes of a name: mostly one, spun or not."""
    running = [entry.node for entry in runtime.nodes()]
    wanted = name if name.startswith('/') else f'/{name}'
    found = [node for node in [*running, *runtime.unspun_nodes()] if full_name(node) == wanted]
    if found:
        return found
    names = [full_name(node) for node in running]
    near = nearest(wanted, names)
    if wanted in runtime.foreign_nodes():
        todo = 'It runs in another process: end it where that was started.'
    elif near:
        todo = f'Did you mean {near!r}?'
    elif names:
        todo = f'Running here: {", ".join(names)}.'
    else:
        todo = 'No node runs here.'
    raise LabError(f'No node called {name!r} runs in this notebook.', todo=todo)
