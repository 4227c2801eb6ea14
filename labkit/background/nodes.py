"""Nodes as objects: which exist, which can be used, how to be rid of one."""

from __future__ import annotations

import gc
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary, WeakSet

from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.parameter import Parameter

from labkit.background import compat
from labkit.background.console import Cell
from labkit.errors import LabError

__all__ = [
    'NodeEntry',
    'after_destroy',
    'callback_name',
    'check_node',
    'destroy_node',
    'existing_nodes',
    'find_half_made',
    'full_name',
    'half_made',
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

    def count(self, entity: Any) -> None:
        """Count one more callback, of an entity or, with None, of none."""
        self.counts[entity] = self.counts.get(entity, 0) + 1
        if self.budget is not None:
            self.budget -= 1

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


def full_name(node: Node) -> str:
    """Return the full name of a node, such as `/talker`; '' if it exists no more."""
    try:
        return node.get_fully_qualified_name()
    except (InvalidHandle, AttributeError):
        return ''


def callback_name(what: Any) -> str:
    """Return the name of a callback, or of that of a timer, a subscription or a service."""
    callback = getattr(what, 'callback', None) or what
    return getattr(callback, '__name__', None) or type(what).__name__


class _Made:
    """The nodes that were made since `follow`, as long as something holds them.

    Attributes:
        count: How many were ever made.
    """

    def __init__(self) -> None:
        self.count = 0
        self._lock = threading.Lock()
        self._nodes: WeakSet[Node] | None = None
        self._kinds: WeakSet[type[Node]] = WeakSet()

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
            self.count += 1
            self._kinds.add(type(node))
            if self._nodes is not None:
                self._nodes.add(node)

    def kinds(self) -> list[type[Node]]:
        """Return the classes of all nodes that were ever noted."""
        with self._lock:
            return list(self._kinds)

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


half_made: WeakKeyDictionary[Node, Cell] = WeakKeyDictionary()
"""Nodes whose `__init__` has raised, and the execution of the cell that was to make them."""


def find_half_made(error: BaseException) -> list[Node]:
    """Return the nodes whose `__init__` a traceback comes from."""
    found: list[Node] = []
    for frame, _ in traceback.walk_tb(error.__traceback__):
        code = frame.f_code
        if code.co_name == '__init__' and code.co_argcount:
            made_here: Any = frame.f_locals.get(code.co_varnames[0])
            if issubclass(type(made_here), Node):
                found.append(made_here)
    return found


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


def destroy_node(node: Node) -> BaseException | None:
    """Destroy a node for certain, whatever its own `destroy_node` does.

    A node whose `__init__` has raised is not asked: it may lack what `destroy_node` uses.

    Args:
        node: The node, in whatever state it is.

    Returns:
        What its own `destroy_node` has raised, or a LabError if that does not call the one of
        `Node`; None if nothing is wrong with it.

    Raises:
        KeyboardInterrupt: The stop button was pressed meanwhile. The node is destroyed all the
            same.
    """
    error: BaseException | None = None
    usable = node_exists(node)
    try:
        compat.end_type_descriptions(node)
        if not (node in half_made or _is_destroyed(node)):
            node.destroy_node()  # type: ignore[no-untyped-call]
            if not _is_destroyed(node):
                error = LabError(
                    f'destroy_node() of {type(node).__name__} does not destroy the node.',
                    todo='End it with super().destroy_node().',
                )
    except KeyboardInterrupt:
        raise
    except BaseException as raised:  # by code of a learner's, sys.exit() included
        error = raised if usable else None  # once ROS is shut down, nothing can be published
    finally:
        _destroy_actions(node)
        _destroy_handle(node)
        for tell in tuple(after_destroy):
            tell()
    return error


def _is_destroyed(node: Node) -> bool:
    """Tell whether nothing of a node is left, or its `__init__` did not get as far as ROS."""
    try:
        with node.handle:
            return False
    except (InvalidHandle, AttributeError):
        return True


def _destroy_actions(node: Node) -> None:
    """Destroy the action servers and clients of a node, which rclpy leaves alive."""
    for waitable in list(getattr(node, 'waitables', ())):
        if isinstance(waitable, (ActionServer, ActionClient)):
            with suppress(InvalidHandle, ValueError):
                waitable.destroy()  # type: ignore[no-untyped-call]


def _destroy_handle(node: Node) -> None:
    """Destroy what a node has in ROS, without asking the node."""
    if _is_destroyed(node):
        return
    try:
        Node.destroy_node(node)  # type: ignore[no-untyped-call]
    except Exception:
        # Its __init__ did not get far enough, or what it looks at was written over.
        if not _is_destroyed(node):
            node.handle.destroy_when_not_in_use()


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
