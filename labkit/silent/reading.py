"""Read a `Scene`: the graph when it has changed, this process's own nodes each time.

It subscribes to nothing, and asks no node of the learner for anything but its attributes.
"""

from __future__ import annotations

import math
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from labkit.asking.silence import offers_service
from labkit.asking.traffic import Sent, sent_by
from labkit.background import compat, own_executors
from labkit.background.nodes import (
    callback_name,
    existing_nodes,
    full_name,
    half_made,
    made,
    made_by,
)
from labkit.background.runtime import runtime
from labkit.background.tracebacks import is_learners
from labkit.errors import cell_name
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import EVERY_NODE_OFFERS, is_hidden
from labkit.rosgraph.parameter_files import flat, sections_in
from labkit.rosgraph.snapshot import Graph, is_whole, read_graph
from labkit.rosgraph.yaml_loading import load_yaml_file
from labkit.settings import LATE_SEC
from labkit.silent.rereading import reads_only_in_init
from labkit.silent.scene import (
    Client,
    Held,
    Listening,
    LongCall,
    Making,
    OwnNode,
    ParameterFile,
    Publisher,
    Rule,
    Running,
    Scene,
    Sleeper,
    Subscription,
    Timer,
)
from labkit.transforms.listeners import listeners

if TYPE_CHECKING:
    from labkit.background.nodes import NodeEntry

__all__ = ['Reader', 'files_in', 'rules_in']

# A parameter file that is larger was not written by hand, bytes.
_LARGEST_FILE = 65536


@dataclass
class _Heard:
    """A subscription, as it was when it was first seen.

    Attributes:
        entry: The entry of its node, whose counts begin anew with each one.
        ahead: Number of messages that were published, and not heard, then.
        since: `time.monotonic()` then.
    """

    entry: NodeEntry | None
    ahead: int
    since: float


class Reader:
    """Reads scenes, and remembers what it needs to see a change."""

    def __init__(self) -> None:
        self._mark: object = None
        self._graph = Graph((), ())
        self._heard: WeakKeyDictionary[Any, _Heard] = WeakKeyDictionary()
        self._clocks: WeakKeyDictionary[Any, tuple[int, float]] = WeakKeyDictionary()
        self._since = time.monotonic()
        # The node that is being made, and when that was seen first.
        self._begun: tuple[Any, float] = (None, 0.0)

    def forget(self) -> None:
        """Begin anew: what has happened up to now counts for nothing."""
        self._mark = None
        self._heard.clear()
        self._clocks.clear()
        self._since = time.monotonic()

    def read(self) -> Scene:
        """Return the scene, with the same graph as at the last call if nothing has changed."""
        helper = runtime.helper
        if helper is None:
            return Scene(Graph((), ()), {})
        nodes = [node for node in existing_nodes() if _is_learners(node)]
        counts = {
            topic: (helper.count_publishers(topic), helper.count_subscribers(topic))
            for topic, _ in helper.get_topic_names_and_types()
        }
        mark = (counts, helper.get_service_names_and_types(), list(map(_identities, nodes)))
        if mark != self._mark:
            # The name of a node of another process comes a moment after its ends, which are left
            # out of the graph until then.
            self._mark = mark if is_whole(helper) else None
            self._graph = read_graph(helper, include_services=True)
        running = runtime.console.running_cell
        own = []
        sent = _sent(nodes)
        for node in nodes:
            with suppress(InvalidHandle, AttributeError):  # destroyed meanwhile
                own.append(self._node(node, running, sent))
        return Scene(
            self._graph,
            {topic: count for topic, (count, _) in counts.items()},
            tuple(own),
            tuple(_sleepers(nodes)),
            _running(),
            tuple(_held(nodes)),
            self._making(running),
            time.monotonic(),
            tuple(_listening()),
            self._since,
        )

    def _node(self, node: Node, running: object, sent: Mapping[str, list[Sent]]) -> OwnNode:
        """Return a node of this process; only its requests while its cell is making it."""
        entry = runtime.entry_of(node)
        origin = made.origins.get(node)
        cell = entry.cell if entry is not None else origin and origin.cell
        in_executor = entry is None and node.executor is not None
        is_spun = entry is not None or own_executors.is_spun(node)
        name, namespace = full_name(node), node.get_namespace()
        clients = tuple(_clients(node))
        if not is_spun and cell is not None and cell is running:
            return OwnNode(name, namespace, cell, is_spun=False, clients=clients)
        given, declared = compat.parameters_of(node)
        args, shared = (origin.args, origin.shared) if origin else ((), ())
        rules, shared_rules = rules_in(args), rules_in(('--ros-args', *shared))
        sim_time = bool('use_sim_time' in declared and node.get_parameter('use_sim_time').value)
        now = node.get_clock().now().nanoseconds
        return OwnNode(
            name,
            namespace,
            cell,
            is_spun,
            in_executor,
            sim_time,
            now,
            self._jump(node, now) if sim_time else 0.0,
            frozenset(given),
            frozenset(declared),
            _unread(node, entry),
            rules,
            files_in(args),
            shared_rules,
            files_in(('--ros-args', *shared)),
            tuple(_publishers(node)),
            tuple(self._subscriptions(node, entry, sent)),
            clients,
            self._names(node, name) if rules or shared_rules else (),
            offers_service(node),
            tuple(_timer(timer) for timer in node.timers),
            tuple(_long_calls(entry)),
        )

    def _making(self, cell: Any) -> Making | None:
        """Return the node in whose `__init__` the running cell is."""
        frame = sys._current_frames().get(threading.main_thread().ident or 0)
        inner = None
        while frame is not None and cell is not None:
            if inner is None and is_learners(frame.f_code.co_filename):
                inner = frame
            node = made_by(frame)
            if node is not None and is_learners(frame.f_code.co_filename):
                break
            frame = frame.f_back
        else:
            node = None
        if node is None or inner is None:
            self._begun = (None, 0.0)
            return None
        if self._begun[0] is not node:
            self._begun = (node, time.monotonic())
        kind, place = type(node).__name__, cell_name(inner.f_code.co_filename)
        where = f'line {inner.f_lineno}' + f' of {place}' * bool(place)
        words = f'{kind}.__init__, which is in {where},'
        seconds = time.monotonic() - self._begun[1]
        return Making(full_name(node) or kind, words, seconds, cell)

    def _names(self, node: Node, name: str) -> tuple[str, ...]:
        """Return the full names of the services and actions of a node."""
        actions = (a.name for a in self._graph.actions if name in (*a.servers, *a.clients))
        return (*(service.handle.name for service in node.services), *actions)

    def _jump(self, node: Node, now: int) -> float:
        """Return by how many seconds a clock has last jumped back, 0 if it never did."""
        last, back = self._clocks.get(node, (now, 0.0))
        if now < last:
            back = (last - now) * 1e-9
        self._clocks[node] = (now, back)
        return back

    def _subscriptions(
        self, node: Node, entry: NodeEntry | None, sent: Mapping[str, list[Sent]]
    ) -> Iterator[Subscription]:
        for sub in node.subscriptions:
            heard = entry.counts.get(sub, 0) if entry is not None else 0
            all_sent = sent.get(sub.topic_name, [])
            ahead = sum(each.count for each in all_sent) - heard
            known = self._heard.get(sub)
            if known is None or known.entry is not entry or ahead < known.ahead:
                since = known.since if known is not None else time.monotonic()
                before = ahead
                made_at = getattr(sub, '_labkit_since', 0.0)
                if known is None and made_at > self._since:
                    # What has begun to publish later owes it all messages.
                    before = sum(each.count for each in all_sent if each.first < made_at)
                known = self._heard[sub] = _Heard(entry, min(ahead, before), since)
            yield Subscription(
                sub.topic_name,
                type_name(sub.msg_type),
                sub.qos_profile,
                sub.callback,
                heard,
                # What waits in the queue, and is being handled, may still be heard.
                max(0, ahead - known.ahead - sub.qos_profile.depth - 1) if entry else 0,
                known.since,
            )


def _unread(node: Node, entry: NodeEntry | None) -> tuple[tuple[str, Any, Any], ...]:
    """Return the parameters that were set since, in vain; their values then and now."""
    before = entry.parameters if entry is not None else {}
    now = compat.parameter_values(node)
    found = tuple((key, was, now[key]) for key, was in before.items() if now.get(key, was) != was)
    if not found or compat.has_parameter_callbacks(node):
        return ()
    ends: tuple[Any, ...] = (*node.timers, *node.subscriptions, *node.services)
    callbacks = [end.callback for end in ends if not _is_of_rclpy(end.callback)]
    return found if reads_only_in_init(type(node), Node, callbacks) else ()


def _is_of_rclpy(callback: Any) -> bool:
    module = getattr(getattr(callback, '__func__', callback), '__module__', None)
    return str(module).startswith('rclpy.')


def _sent(nodes: Sequence[Node]) -> dict[str, list[Sent]]:
    """Return what the publishers of nodes have published, by topic."""
    sent: dict[str, list[Sent]] = {}
    for node in nodes:
        with suppress(InvalidHandle):
            for publisher in node.publishers:
                sent.setdefault(publisher.topic_name, []).append(sent_by(publisher))
    return sent


def _is_learners(node: Node) -> bool:
    name = full_name(node)
    # What has ended the __init__ of one that is half made, its cell has told.
    return bool(name) and not is_hidden(name) and node not in half_made


def _identities(node: Node) -> tuple[int, ...]:
    """Return what changes when an end of a node is made again in the meantime."""
    ends = (node.publishers, node.subscriptions, node.clients, node.services)
    return tuple(id(end) for found in ends for end in found)


def _publishers(node: Node) -> Iterator[Publisher]:
    for publisher in node.publishers:
        sent = sent_by(publisher)
        yield Publisher(
            publisher.topic_name,
            type_name(publisher.msg_type),
            publisher.qos_profile,
            sent.count,
            sent.first,
            sent.last,
            sent.found,
            sent.stamp,
            sent.frame,
            tuple(replace(each) for each in tuple(sent.parts.values())),
        )


def _listening() -> Iterator[Listening]:
    for listener in tuple(listeners):
        buffer, name = listener.buffer, full_name(listener.node)
        if not name or is_hidden(name):
            continue
        tree = buffer.tree
        yield Listening(
            name,
            tuple(tree.edges()),
            frozenset(tree.names()),
            {child: tuple(moves) for child, moves in tuple(tree.moves.items())},
            buffer.in_vain(),
        )


def _clients(node: Node) -> Iterator[Client]:
    for client in node.clients:
        pending = compat.pending_requests(client)
        is_ready = bool(pending) and client.service_is_ready()
        name = client.handle.service_name
        yield Client(name, type_name(client.srv_type), pending, is_ready)


def _timer(timer: Any) -> Timer:
    return Timer(
        timer.timer_period_ns / 1e9,
        callback_name(timer),
        timer.callback,
        bool(timer.is_canceled()),
    )


def _long_calls(entry: NodeEntry | None) -> Iterator[LongCall]:
    if entry is None:
        return
    running = runtime.executor.running_for()
    if running is not None and running[0] is entry and running[2] >= LATE_SEC:
        yield LongCall(*running[1:])
    timers = {*entry.node.timers}
    for what, times in dict(entry.took).items():
        timed = what in timers and not what.is_canceled()
        period = what.timer_period_ns / 1e9 if timed else math.inf
        if times[-1] >= min(period, LATE_SEC):
            least = min(times) if len(times) == 3 else 0.0
            yield LongCall(callback_name(what), times[-1], least, period)


def _running() -> Running | None:
    running = runtime.executor.running_for()
    if running is None or is_hidden(running[0].name):
        return None
    entry, callback, seconds = running
    ended = runtime.executor.runs_for_an_ended_node()
    return Running(entry.name, callback, seconds, entry.cell, ended)


def _sleepers(nodes: Sequence[Node]) -> Iterator[Sleeper]:
    for entity, (words, cell, _) in tuple(runtime.waits.items()):
        for node in nodes:
            known = entity in (*node.timers, *node.clients)
            if known and runtime.entry_of(node) is None and not own_executors.is_spun(node):
                yield Sleeper(full_name(node), words, cell)


def _held(nodes: Sequence[Node]) -> Iterator[Held]:
    """Yield the callbacks of executors of the learner's own for which others have to wait."""
    own = {node.executor for node in nodes if node.executor is not None}
    for executor in own - {runtime.executor}:
        for call in own_executors.calls_in(executor):
            group = getattr(call.entity, 'callback_group', None)
            ends = [end for node in executor.get_nodes() for end in _ends(node)]
            others = 'of its executor'
            if isinstance(executor, MultiThreadedExecutor):
                if not isinstance(group, MutuallyExclusiveCallbackGroup):
                    continue
                others = 'of its callback group'
                ends = [end for end in ends if group.has_entity(end) and end is not call.entity]
                if not ends:
                    continue
            waits = next(
                (
                    words
                    for entity, (words, _, thread) in tuple(runtime.waits.items())
                    if thread == call.thread and entity in ends
                ),
                '',
            )
            node = call.node or next(iter(executor.get_nodes()), None)
            if node is not None and full_name(node):
                yield Held(full_name(node), call.callback, call.seconds, others, waits)


def _ends(node: Node) -> Iterator[Any]:
    """Yield the ends of a node that may have something to do."""
    yield from (timer for timer in node.timers if not _timer(timer).is_canceled)
    yield from node.subscriptions
    yield from (client for client in node.clients if compat.pending_requests(client))
    yield from (
        service
        for service in node.services
        if service.srv_name.rpartition('/')[2] not in EVERY_NODE_OFFERS
    )


# -- arguments ------------------------------------------------------------------------------------


def _values_of(args: Sequence[str], *flags: str) -> Iterator[str]:
    """Yield the values of an option among the arguments for ROS."""
    inside = False
    if len(args) < 2:
        return  # most nodes have none, and all are read once a second
    for word, value in zip(args, [*args[1:], ''], strict=False):
        if word in ('--ros-args', '--'):
            inside = word == '--ros-args'
        elif inside and word in flags and value:
            yield value


def rules_in(args: Sequence[str]) -> tuple[Rule, ...]:
    """Return the remapping rules in arguments for ROS, without those for a node's own name."""
    found = []
    for text in _values_of(args, '-r', '--remap'):
        old, _, new = text.partition(':=')
        node, colon, name = old.partition(':')
        alone = not colon or name.startswith('//')
        rule = Rule('', old, new) if alone else Rule(node, name, new)
        if not rule.old.startswith('__'):
            found.append(rule)
    return tuple(found)


def files_in(args: Sequence[str]) -> tuple[ParameterFile, ...]:
    """Return the parameter files in arguments for ROS, as far as they can be read."""
    return tuple(
        file
        for path in _values_of(args, '--params-file')
        for file in [_file(path)]
        if file is not None
    )


_files: dict[tuple[str, float], ParameterFile | None] = {}


def _file(path: str) -> ParameterFile | None:
    try:
        seen = Path(path).stat()
    except OSError:
        return None
    key = (path, seen.st_mtime)
    if key not in _files:
        _files[key] = _read_file(path) if seen.st_size <= _LARGEST_FILE else None
    return _files[key]


def _read_file(path: str) -> ParameterFile | None:
    try:
        tree = load_yaml_file(path)
    except (OSError, ValueError):
        return None
    if not isinstance(tree, dict):
        return None
    sections = [(key, values) for key, values in sections_in(tree) if isinstance(values, dict)]
    return ParameterFile(path, tuple((key, dict(flat(values))) for key, values in sections))
