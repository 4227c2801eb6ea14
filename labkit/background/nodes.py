"""Node objects: find them, check them, destroy them."""

from __future__ import annotations

import gc
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary, WeakSet

from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle, NameValidationException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name

from labkit import settings
from labkit.background import compat
from labkit.background.console import Cell
from labkit.errors import LabError, quoted

if TYPE_CHECKING:
    from types import FrameType

    from labkit.background.foreground import Spin

__all__ = [
    'NodeEntry',
    'Origin',
    'after_destroy',
    'callback_name',
    'check_node',
    'destroy_node',
    'existing_nodes',
    'find_half_made',
    'full_name',
    'half_made',
    'has_begun',
    'helper_node',
    'made',
    'made_by',
    'node_exists',
    'state_of',
]


# Called after a node was destroyed, to destroy subscriptions of labkit's own: within one process,
# a remaining one would keep the next publisher of its topic from having another type.
after_destroy: list[Callable[[], None]] = []


@dataclass(eq=False)
class NodeEntry:
    """A node on the background executor.

    Attributes:
        node: The node itself.
        name: Its full name, such as `/talker`.
        cell: The execution of the cell that started it.
        counts: Number of callbacks run for each timer, subscription and so on.
        parameters: The values of its parameters when it was started.
        budget: Number of callbacks left before the node leaves the executor, None for no limit.
        took: Seconds that callbacks took the last three times, by timer or by name, once one has
            taken `LATE_SEC`, or longer than the period of its timer; without those in which it
            could have run, and others did.
        spins: The foreground spins of it, the last one of which gets what its callbacks raise.
        lasts: Whether it stays when these have ended.
    """

    node: Node
    name: str
    cell: Cell
    counts: dict[Any, int] = field(default_factory=dict)
    parameters: Mapping[str, Any] = field(default_factory=dict)
    budget: int | None = None
    took: dict[Any, tuple[float, ...]] = field(default_factory=dict)
    spins: list[Spin] = field(default_factory=list)
    lasts: bool = True

    @property
    def callbacks(self) -> int:
        """Return the number of its callbacks that were run."""
        return sum(self.counts.values())

    def count(self, entity: Any) -> None:
        """Count a callback of an entity, or one without entity if None."""
        self.counts[entity] = self.counts.get(entity, 0) + 1
        if self.budget is not None:
            self.budget -= 1

    @property
    def alive(self) -> bool:
        """Return whether the node can be used, see `node_exists`."""
        return node_exists(self.node)


def node_exists(node: Node) -> bool:
    """Return whether a node can be used: it is not destroyed, and its context not shut down."""
    try:
        with node.handle:
            return bool(node.context.ok())
    except (InvalidHandle, AttributeError):
        # AttributeError: its __init__ did not get far enough.
        return False


def full_name(node: Node) -> str:
    """Return the full name of a node, such as `/talker`; '' if it was destroyed."""
    try:
        return node.get_fully_qualified_name()
    except (InvalidHandle, AttributeError):
        return ''


def state_of(node: Node) -> tuple[str, str]:
    """Return what a node of labkit's own does, always and now, as predicates; '' for nothing.

    It is no fault, so it is told only where somebody looks at the node. Where outputs are compared
    nothing is said of now: it depends on the time.
    """
    said: Callable[[], tuple[str, str]] | None = getattr(node, '_labkit_state', None)
    always, now = said() if said is not None else ('', '')
    return always, '' if settings.audience().same_each_time else now


def callback_name(what: Any) -> str:
    """Return the name of a callback, given as such or by its entity."""
    callback = getattr(what, 'callback', None) or what
    return getattr(callback, '__name__', None) or type(what).__name__


@dataclass(frozen=True)
class Origin:
    """How a node was made: the execution of its cell, and its arguments for ROS.

    Attributes:
        cell: The execution.
        args: Arguments for this node alone.
        shared: Rules and parameters of its program, for all nodes of that.
        began: When, ns since 1970.
    """

    cell: Cell
    args: tuple[str, ...] = ()
    shared: tuple[str, ...] = ()
    began: int = field(default_factory=time.time_ns)


class _Made:
    """The nodes that were made since `follow`, by weak references.

    Attributes:
        origins: How they were made.
    """

    def __init__(self) -> None:
        self.origins: WeakKeyDictionary[Node, Origin] = WeakKeyDictionary()
        self._lock = threading.Lock()
        self._nodes: WeakSet[Node] | None = None
        self._kinds: WeakSet[type[Node]] = WeakSet()

    def follow(self) -> None:
        """Start tracking, beginning with all existing nodes."""
        with self._lock:
            if self._nodes is None:
                self._nodes = WeakSet(_on_the_heap())

    def forget(self) -> None:
        """Stop tracking."""
        with self._lock:
            self._nodes = None

    def add(self, node: Node, origin: Origin) -> None:
        """Add a node that is about to be made."""
        with self._lock:
            self.origins[node] = origin
            self._kinds.add(type(node))
            if self._nodes is not None:
                self._nodes.add(node)

    def kinds(self) -> list[type[Node]]:
        """Return the classes of all nodes ever added."""
        with self._lock:
            return list(self._kinds)

    def all(self) -> list[Node]:
        with self._lock:
            if self._nodes is not None:
                return list(self._nodes)
        return _on_the_heap()


made = _Made()
"""The nodes made in a notebook. A script, where rclpy is not patched, adds none."""


def existing_nodes() -> list[Node]:
    """Return all nodes of this process that can be used, spun or not."""
    return [node for node in made.all() if node_exists(node)]


def _on_the_heap() -> list[Node]:
    """Search all of Python's objects, which may take tenths of a second."""
    # type() and not isinstance(): some objects have a __class__ that raises or lies.
    return [thing for thing in gc.get_objects() if issubclass(type(thing), Node)]


half_made: WeakKeyDictionary[Node, Cell] = WeakKeyDictionary()
"""Nodes whose `__init__` has raised, with the execution of the cell that made them."""


def find_half_made(error: BaseException) -> list[Node]:
    """Return the nodes whose `__init__` is in the traceback of an error."""
    found = (made_by(frame) for frame, _ in traceback.walk_tb(error.__traceback__))
    return [node for node in found if node is not None]


def made_by(frame: FrameType) -> Node | None:
    """Return the node whose `__init__` a frame is, None if it is another function."""
    code = frame.f_code
    if code.co_name != '__init__' or not code.co_argcount:
        return None
    made_here: Any = frame.f_locals.get(code.co_varnames[0])
    return made_here if issubclass(type(made_here), Node) else None


def check_node(node: object, function: str = 'lab.spin') -> None:
    """Raise a LabError if `node` can't be spun by a function."""
    if isinstance(node, type) and issubclass(node, Node):
        raise LabError(
            f'{function}() expects a node, but got the class {node.__name__}.',
            todo=f'Make a node of it: {function}({node.__name__}())',
        )
    if isinstance(node, str):
        raise LabError(
            f'{function}() expects a node, but got the text {quoted(node)}.',
            todo='Pass the node itself: the variable that holds it, without quotation marks.',
        )
    if not isinstance(node, Node):
        raise LabError(
            f'{function}() expects a node, but got {quoted(node)}.',
            todo='Pass an object of a class that is made on rclpy.node.Node.',
        )
    if not node_exists(node):
        raise _gone(node)


def has_begun(node: Node) -> bool:
    """Return whether the `__init__` of a node's class has called the one of `Node`."""
    try:
        Node.context.fget(node)  # type: ignore[attr-defined]
    except AttributeError:
        return False
    return True


def _gone(node: Node) -> LabError:
    """Return why a node does not exist."""
    name = type(node).__name__
    if not has_begun(node):
        return LabError(
            f'This {name} is not a node yet: its __init__ has not called the one of Node.',
            todo="Let super().__init__('name_of_the_node') be the first line of its __init__.",
        )
    is_up = node.context.ok()
    why = 'it was destroyed' if is_up else 'ROS was shut down since it was made'
    return LabError(
        f'This {name} exists no more: {why}.',
        todo='Make it again; running its cell again does that.',
    )


def destroy_node(node: Node) -> BaseException | None:
    """Destroy a node in any state, whatever its own `destroy_node` does.

    If its `__init__` has raised, its own `destroy_node` is not called: it may use attributes that
    the node lacks.

    Returns:
        The error of its own `destroy_node`, or a LabError if that does not call the one of `Node`.

    Raises:
        KeyboardInterrupt: The stop button was pressed. The node is destroyed all the same.
    """
    error: BaseException | None = None
    waitables: list[Any] = []
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
    except BaseException as raised:  # by the learner's code, sys.exit() included
        error = raised if usable else None  # publishing, for one, fails once ROS is shut down
    finally:
        # rclpy leaves action servers and clients alive. Without super().__init__() there are none.
        with suppress(AttributeError):
            waitables = list(node.waitables)
        for waitable in waitables:
            if isinstance(waitable, (ActionServer, ActionClient)):
                with suppress(InvalidHandle, ValueError):
                    waitable.destroy()  # type: ignore[no-untyped-call]
        _destroy_handle(node)
        for tell in tuple(after_destroy):
            tell()
    return error


def _is_destroyed(node: Node) -> bool:
    """Return whether a node has no handle: it was destroyed, or its `__init__` failed early."""
    try:
        with node.handle:
            return False
    except (InvalidHandle, AttributeError):
        return True


def _destroy_handle(node: Node) -> None:
    """Destroy a node without calling its own methods."""
    if _is_destroyed(node):
        return
    try:
        Node.destroy_node(node)  # type: ignore[no-untyped-call]
    except Exception:
        # Its __init__ did not get far enough, or the learner has overwritten attributes.
        if not _is_destroyed(node):
            node.handle.destroy_when_not_in_use()


class _Helper(Node):
    """A node that lists what ROS allows: any program of DDS may announce other names.

    rclpy lists those names too, and raises when it is asked about one.
    """

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        found = _told(super().get_topic_names_and_types, no_demangle)
        return found if no_demangle else [each for each in found if _is_topic(each[0])]

    def get_service_names_and_types(self) -> list[tuple[str, list[str]]]:
        found = _told(super().get_service_names_and_types)
        return [each for each in found if _is_topic(each[0])]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        found = _told(super().get_node_names_and_namespaces)
        return [pair for pair in found if _is_node(*pair)]


def _told(ask: Callable[..., list[Any]], *arguments: bool) -> list[Any]:
    """Return a list of names, or say why ROS tells none: a single one may keep it from all."""
    try:
        return ask(*arguments)
    except (RuntimeError, UnicodeDecodeError) as error:
        if isinstance(error, RuntimeError) and 'empty node name' not in str(error):
            raise
        raise LabError(
            'A program in this domain announces a name that is empty or no text. As long as it '
            'runs, ROS can not list the names of the domain.',
            todo='End that program, or take another domain: lab.start(domain_id=...), in a '
            'notebook whose kernel was restarted.',
        ) from error


def _is_topic(name: str) -> bool:
    with suppress(NameValidationException):
        return bool(validate_full_topic_name(name))
    return False


def _is_node(name: str, namespace: str) -> bool:
    with suppress(NameValidationException):
        return bool(validate_node_name(name) and validate_namespace(namespace))
    return False


def helper_node(
    name: str,
    *,
    namespace: str | None = None,
    context: Context | None = None,
    enable_rosout: bool = False,
) -> Node:
    """Make a cheap node for labkit's own use, without services.

    Args:
        name: Its name; a leading `_` hides it from lists.
        namespace: Its namespace, the root if None.
        context: Its context, the default one if None.
        enable_rosout: Whether its log messages go to `/rosout`.
    """
    node = _Helper(
        name,
        namespace=namespace,
        context=context,
        enable_rosout=enable_rosout,
        start_parameter_services=False,
        use_global_arguments=False,
        parameter_overrides=[Parameter('start_type_description_service', value=False)],  # type: ignore[no-untyped-call]
    )
    # Each entity slows down every wake-up of the executor, and event handlers are entities.
    for publisher in node.publishers:
        handlers: Any = publisher.event_handlers  # a list, whatever its annotation says
        while handlers:
            handler = handlers.pop()
            node.remove_waitable(handler)
            handler.destroy()
    return node
