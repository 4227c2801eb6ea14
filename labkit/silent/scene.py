"""What a look sees: the graph, and this process's own nodes, at one moment, as data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from labkit.rosgraph.snapshot import Graph
    from labkit.transforms.tree import Edge

__all__ = [
    'Broadcast',
    'Client',
    'Held',
    'Listening',
    'LongCall',
    'Making',
    'OwnNode',
    'ParameterFile',
    'Publisher',
    'Rule',
    'Running',
    'Scene',
    'Sleeper',
    'Subscription',
    'Timer',
]


@dataclass(frozen=True)
class Timer:
    """A timer of a node: period in seconds, name of its callback, and whose object that is."""

    period: float
    callback: str
    identity: Any
    is_canceled: bool = False


@dataclass
class Broadcast:
    """What a publisher of this process has said of one frame in one parent.

    Attributes:
        parent: The parent.
        child: The frame.
        first: `time.monotonic()` of the first message with it.
        last: Of the last one.
        count: Number of messages with it.
        looked_at: Of the last one whose numbers were looked at.
        stamp: Time in that, ns.
        place: Where the frame was in it: translation, m, and quaternion.
        changes: How often that was another one than before.
        found: What is odd about that one: id of a kind -> words.
    """

    parent: str
    child: str
    first: float = 0.0
    last: float = 0.0
    count: int = 0
    looked_at: float = -math.inf
    stamp: int = 0
    place: tuple[float, ...] = ()
    changes: int = 0
    found: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Listening:
    """A transform listener of this process, and what its buffer knows.

    Attributes:
        node: The node that listens.
        edges: The frames that have a parent.
        names: All frames.
        moves: The last changes of the parent of a frame: `time.monotonic()`, and both parents.
        asked: Pairs of frames between which callbacks look in vain, and for how long, s.
    """

    node: str
    edges: tuple[Edge, ...] = ()
    names: frozenset[str] = frozenset()
    moves: Mapping[str, tuple[tuple[float, str, str], ...]] = field(default_factory=dict)
    asked: Mapping[tuple[str, str], float] = field(default_factory=dict)


@dataclass(frozen=True)
class Publisher:
    """A publisher, and what it has published.

    Attributes:
        topic: Full name of the topic.
        msg_type: Name of the type.
        qos: Its QoS profile.
        count: Number of messages published.
        first: `time.monotonic()` of the first one.
        last: Of the last one.
        found: What is odd about the last message that was looked at: id of a kind -> words.
        stamp: Time in its header, ns; None if it has none.
        frame: The frame in its header; '' if it has none, or needs none.
        broadcasts: What it has said of frames, if it is one of transforms.
    """

    topic: str
    msg_type: str
    qos: Any
    count: int = 0
    first: float = 0.0
    last: float = 0.0
    found: Mapping[str, str] = field(default_factory=dict)
    stamp: int | None = None
    frame: str = ''
    broadcasts: tuple[Broadcast, ...] = ()

    @property
    def interval(self) -> float:
        """Seconds between two messages, on average; 0 if there are too few to tell."""
        return (self.last - self.first) / (self.count - 1) if self.count > 3 else 0.0


@dataclass(frozen=True)
class Subscription:
    """A subscription, and how many messages its callback got.

    Attributes:
        topic: Full name of the topic.
        msg_type: Name of the type.
        qos: Its QoS profile.
        identity: Its callback.
        heard: Number of messages.
        missed: Number of messages of this process that were published and never got.
        since: `time.monotonic()` when it was first seen.
    """

    topic: str
    msg_type: str
    qos: Any
    identity: Any
    heard: int = 0
    missed: int = 0
    since: float = 0.0


@dataclass(frozen=True)
class Client:
    """A client of a service: requests without an answer, and whether a server is there."""

    service: str
    srv_type: str
    pending: int
    is_ready: bool


@dataclass(frozen=True)
class LongCall:
    """A callback that took long.

    Attributes:
        callback: Its name.
        seconds: For how long.
        least: The least of the last three times; 0 if there were fewer.
        period: The period of its timer, if any.
    """

    callback: str
    seconds: float
    least: float = 0.0
    period: float = math.inf


@dataclass(frozen=True)
class Running:
    """The callback that is running: its node, its name, the seconds, and if the node has ended."""

    node: str
    callback: str
    seconds: float
    cell: Any = None
    ended: bool = False


@dataclass(frozen=True)
class Making:
    """A node that the running cell is making.

    Attributes:
        node: Its full name, or that of its class.
        words: Its `__init__`, in words, with the line where it is.
        seconds: For how long it has been seen there.
        cell: The cell.
    """

    node: str
    words: str
    seconds: float
    cell: Any = None


@dataclass(frozen=True)
class Held:
    """A callback that holds up an executor of the learner's own.

    Attributes:
        node: Its node.
        callback: Its name.
        seconds: For how long it has been running.
        others: What can't run meanwhile, in words.
        waits: What it waits for, in words; '' if for nothing that is known.
    """

    node: str
    callback: str
    seconds: float
    others: str
    waits: str = ''


@dataclass(frozen=True)
class Rule:
    """A remapping rule: `node:old:=new`, `node` is '' for all nodes."""

    node: str
    old: str
    new: str

    def __str__(self) -> str:
        return f'{self.node and self.node + ":"}{self.old}:={self.new}'


@dataclass(frozen=True, eq=False)
class ParameterFile:
    """A file of parameters: for each name of a node, in order, its parameters and their values."""

    path: str
    sections: tuple[tuple[str, Mapping[str, Any]], ...]


@dataclass(frozen=True)
class Sleeper:
    """A thread that waits for a node: the name of that, words for the wait, and the cell."""

    node: str
    words: str
    cell: Any


@dataclass(frozen=True)
class OwnNode:
    """A node of this process.

    Attributes:
        name: Its full name.
        namespace: Its namespace.
        cell: The execution of the cell that made it.
        is_spun: Whether an executor runs it.
        in_executor: Whether it is in an executor of the learner's own.
        sim_time: Whether it uses simulated time.
        now: Time of its clock, ns.
        went_back: Seconds by which its clock has jumped back.
        overrides: Names of the parameters it was given.
        declared: Names of the parameters it has declared.
        unread: Parameters that were set since it was spun, though it has read them before and
            does not read them again: name, value then, value now.
        rules: Remapping rules for it alone.
        files: Parameter files for it alone.
        shared_rules: Remapping rules of its program, which all nodes of that have.
        shared_files: Parameter files of its program.
        services: Full names of its services and actions; empty if no rule may rename them.
        offers: Whether it offers a service of its own.
    """

    name: str
    namespace: str
    cell: Any = None
    is_spun: bool = True
    in_executor: bool = False
    sim_time: bool = False
    now: int = 0
    went_back: float = 0.0
    overrides: frozenset[str] = frozenset()
    declared: frozenset[str] = frozenset()
    unread: tuple[tuple[str, Any, Any], ...] = ()
    rules: tuple[Rule, ...] = ()
    files: tuple[ParameterFile, ...] = ()
    shared_rules: tuple[Rule, ...] = ()
    shared_files: tuple[ParameterFile, ...] = ()
    publishers: tuple[Publisher, ...] = ()
    subscriptions: tuple[Subscription, ...] = ()
    clients: tuple[Client, ...] = ()
    services: tuple[str, ...] = ()
    offers: bool = False
    timers: tuple[Timer, ...] = ()
    long_calls: tuple[LongCall, ...] = ()

    @property
    def makes_clock(self) -> bool:
        """Whether it publishes /clock, the time that it puts into its stamps."""
        return any(publisher.topic == '/clock' for publisher in self.publishers)

    def ends(self) -> Iterator[str]:
        """Yield the full names of all its topics and services."""
        yield from (publisher.topic for publisher in self.publishers)
        yield from (subscription.topic for subscription in self.subscriptions)
        yield from (client.service for client in self.clients)
        yield from self.services


@dataclass(frozen=True)
class Scene:
    """The graph, and the nodes of this process that are made completely.

    Attributes:
        graph: The graph, without what is hidden.
        publishers: For each topic, the number of its publishers, hidden ones too.
        nodes: The nodes of this process.
        sleepers: What threads wait for though nobody spins the node.
        running: The callback that is running in the background, None if none is.
        held: The callbacks that hold up executors of the learner's own.
        making: The node whose `__init__` runs, None if none does.
        now: `time.monotonic()`.
        listeners: The transform listeners of this process.
        since: `time.monotonic()` of the end of the last check, which had a time of its own.
    """

    graph: Graph
    publishers: Mapping[str, int]
    nodes: tuple[OwnNode, ...] = ()
    sleepers: tuple[Sleeper, ...] = ()
    running: Running | None = None
    held: tuple[Held, ...] = ()
    making: Making | None = None
    now: float = 0.0
    listeners: tuple[Listening, ...] = ()
    since: float = 0.0

    def own(self, name: str) -> OwnNode | None:
        """Return the node of this process of a full name, None if there is none."""
        return next((node for node in self.nodes if node.name == name), None)

    def mended_first(self, *names: str) -> tuple[str, ...]:
        """Return names of nodes, those of this process first: there it can be mended."""
        here = {node.name for node in self.nodes}
        return tuple(sorted(dict.fromkeys(names), key=lambda name: name not in here))
