"""Nodes as objects: which exist, which can be used, how to be rid of one."""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakSet

from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.parameter import Parameter

from labkit.background.console import Cell
from labkit.errors import LabError

__all__ = [
    'NodeEntry',
    'after_destroy',
    'check_node',
    'destroy_node',
    'existing_nodes',
    'helper_node',
    'made',
    'node_exists',
]


# Called after a node was destroyed. In one process a subscription that is left over keeps the next
# publisher of its topic from having another type.
after_destroy: list[Callable[[], None]] = []


@dataclass(eq=False)
class NodeEntry:
    """A node on the background executor, and where it came from.

    Attributes:
        node: The node itself.
        name: Its full name, such as `/talker`.
        cell: The execution of the cell that started it.
        counts: How many callbacks have been run for each timer, subscription and so on.
        budget: How many more may be run before the node leaves the executor; None for no end.
    """

    node: Node
    name: str
    cell: Cell
    counts: dict[Any, int] = field(default_factory=dict)
    budget: int | None = None

    @property
    def callbacks(self) -> int:
        """Return how many of its callbacks have been run."""
        return sum(self.counts.values())

    @property
    def alive(self) -> bool:
        """Tell whether the node still exists, i.e. nobody has called `destroy_node()`."""
        return node_exists(self.node)


def node_exists(node: Node) -> bool:
    """Tell whether a node can be used: it is not destroyed, and its ROS is not shut down."""
    try:
        with node.handle:
            return bool(node.context.ok())
    except (InvalidHandle, AttributeError):
        # AttributeError: its __init__ did not get far enough.
        return False


class _Made:
    """The nodes that were made since `follow`, as long as something holds them."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._nodes: WeakSet[Node] | None = None

    def follow(self) -> None:
        """Keep track from now on; those that are there are looked for once."""
        with self._lock:
            if self._nodes is None:
                self._nodes = WeakSet(_on_the_heap())

    def forget(self) -> None:
        """Keep track no more."""
        with self._lock:
            self._nodes = None

    def add(self, node: Node) -> None:
        """Note a node that is about to be made."""
        with self._lock:
            if self._nodes is not None:
                self._nodes.add(node)

    def all(self) -> list[Node]:
        with self._lock:
            if self._nodes is not None:
                return list(self._nodes)
        return _on_the_heap()


made = _Made()
"""In a notebook each new node is noted here. In a script, where rclpy is untouched, none is."""


def existing_nodes() -> list[Node]:
    """Return all nodes of this process that exist, whether they are spun or not."""
    return [node for node in made.all() if node_exists(node)]


def _on_the_heap() -> list[Node]:
    """Look through all objects of Python, which takes tenths of a second if there are many."""
    # type() and not isinstance(): some objects answer to __class__ with surprises.
    return [thing for thing in gc.get_objects() if issubclass(type(thing), Node)]


def check_node(node: object) -> None:
    """Raise a LabError if `node` is no node that can be spun."""
    if isinstance(node, type) and issubclass(node, Node):
        raise LabError(
            f'lab.spin() expects a node, but got the class {node.__name__}.',
            todo=f'Make a node of it: lab.spin({node.__name__}())',
        )
    if not isinstance(node, Node):
        raise LabError(
            f'lab.spin() expects a node, but got {node!r}.',
            todo='Pass an object of a class that is made on rclpy.node.Node.',
        )
    if not node_exists(node):
        raise LabError(
            f'This {type(node).__name__} exists no more: it was destroyed, or ROS was shut down '
            'since it was made.',
            todo='Make it again; running its cell again does that.',
        )


def destroy_node(node: Node) -> None:
    """Destroy a node, whatever state it is in."""
    try:
        node.destroy_node()  # type: ignore[no-untyped-call]
    except (InvalidHandle, AttributeError):
        pass  # destroyed before, or never finished
    for tell in tuple(after_destroy):
        tell()


def helper_node(
    name: str,
    *,
    namespace: str | None = None,
    context: Context | None = None,
    enable_rosout: bool = False,
) -> Node:
    """Make a node of labkit's own, which costs next to nothing: it has no services.

    Args:
        name: Its name; a leading `_` hides it from lists.
        namespace: Its namespace, the root if None.
        context: What `rclpy.init` has started; the default one if None.
        enable_rosout: Whether its log messages go to `/rosout`.
    """
    node = Node(
        name,
        namespace=namespace,
        context=context,
        enable_rosout=enable_rosout,
        start_parameter_services=False,
        use_global_arguments=False,
        parameter_overrides=[Parameter('start_type_description_service', value=False)],  # type: ignore[no-untyped-call]
    )
    # Each entity makes every wake-up of the executor dearer, events of a publisher among them.
    for publisher in node.publishers:
        handlers: Any = publisher.event_handlers  # a list, whatever its annotation says
        while handlers:
            handler = handlers.pop()
            node.remove_waitable(handler)
            handler.destroy()
    return node
