"""The owner of an endpoint: this process, another one, another computer. Read from its GUID.

Fast DDS makes the first 8 of the 16 bytes once per process: vendor (2), host (2), process id, low
bytes (2), random (2). The participant follows (4), so two contexts of one process differ only
there. Source: fastrtps 2.14, src/cpp/rtps/common/GuidUtils.hpp.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Collection
from pathlib import Path

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from labkit import settings
from labkit.rosgraph.names import UNKNOWN_NODE, full_node_name

__all__ = [
    'all_are_named',
    'foreign_nodes',
    'has_ended',
    'is_missing',
    'is_own',
    'missing_nodes',
    'nodes_of',
    'note_end',
    'own_nodes',
    'participant_of',
    'place',
    'process_id',
    'process_of',
]

_HOST = slice(2, 4)
_PROCESS_ID = slice(4, 6)
_PROCESS = slice(0, 8)
_PARTICIPANT = slice(0, 12)

# The process id and the prefix of its GUIDs, once known: a fork is another process.
_own: tuple[int, bytes] = (0, b'')
# GUID prefixes of killed processes: the graph forgets them only after 20 s.
_ended: set[bytes] = set()


def is_own(gid: bytes, node: Node) -> bool:
    """Return whether an endpoint belongs to this process, in any of its contexts.

    Args:
        gid: The endpoint's GUID from the graph.
        node: A node of this process, to ask the graph with.
    """
    return gid[_PROCESS] == _own_prefix(node)


def participant_of(gid: bytes) -> bytes:
    """Return the GUID prefix of a DDS participant."""
    return gid[_PARTICIPANT]


def process_of(gid: bytes) -> bytes:
    """Return the GUID prefix of a process."""
    return gid[_PROCESS]


def note_end(process: bytes) -> None:
    """Leave out the endpoints of a process that was killed from now on.

    Args:
        process: The prefix of its GUIDs, see `process_of`.
    """
    _ended.add(process)


def has_ended(gid: bytes) -> bool:
    """Return whether the process of an endpoint is known to have ended; the graph may not know."""
    return gid[_PROCESS] in _ended


def is_missing(gid: bytes, node: Node) -> bool:
    """Return whether an endpoint says that it is of this machine, and its process is not there.

    It was killed, and the graph does not know; or it is in a container that has the address of
    this machine, and numbers of its own for processes.

    Args:
        gid: The endpoint's GUID from the graph.
        node: A node of this process, to ask the graph with.
    """
    own = _own_prefix(node)
    if gid[_PROCESS] == own or gid[_HOST] != own[_HOST]:
        return False
    pids = _pids()
    return bool(pids) and all(pid & 0xFFFF != process_id(gid) for pid in pids)


def process_id(gid: bytes) -> int:
    """Return the lower 16 bits of the process id of an endpoint."""
    return int.from_bytes(gid[_PROCESS_ID], 'little')


def all_are_named(node: Node) -> bool:
    """Return whether the name of each node in this domain is known: it comes after its ends.

    Args:
        node: A node of this process, to ask the graph with.
    """
    return not any(info.node_name == UNKNOWN_NODE for info in _infos(node))


def foreign_nodes(node: Node) -> set[str]:
    """Return the full names of the nodes of other processes in this domain.

    Args:
        node: A node of this process, to ask the graph with.
    """
    return _nodes(node, own=False)


def nodes_of(process_ids: Collection[int], node: Node) -> set[str]:
    """Return the full names of the nodes of some processes of this machine.

    One whose name is not known yet is `'/' + UNKNOWN_NODE`.

    Args:
        process_ids: The lower 16 bits of their ids.
        node: A node of this process, to ask the graph with.
    """
    return {
        full_node_name(info.node_name, info.node_namespace)
        for info in _infos(node)
        if process_id(bytes(info.endpoint_gid)) in process_ids
    }


def missing_nodes(node: Node) -> set[str]:
    """Return the full names of nodes in the graph whose process is not there, see `is_missing`.

    Args:
        node: A node of this process, to ask the graph with.
    """
    return {
        full_node_name(info.node_name, info.node_namespace)
        for info in _infos(node)
        if is_missing(bytes(info.endpoint_gid), node)
    }


def own_nodes(node: Node) -> set[str]:
    """Return the full names of the nodes of this process, which are known at once.

    Args:
        node: A node of this process, to ask the graph with.
    """
    return _nodes(node, own=True)


def _nodes(node: Node, *, own: bool) -> set[str]:
    return {
        full_node_name(info.node_name, info.node_namespace)
        for info in _infos(node)
        if info.node_name != UNKNOWN_NODE and is_own(bytes(info.endpoint_gid), node) == own
    }


def _infos(node: Node) -> list[TopicEndpointInfo]:
    """Return one publisher of each node whose process is not known to have ended."""
    # Every node publishes on this topic.
    infos = node.get_publishers_info_by_topic('/parameter_events')
    return [info for info in infos if not has_ended(bytes(info.endpoint_gid))]


def place(gid: bytes, node: Node) -> str:
    """Return where an endpoint runs.

    Args:
        gid: The endpoint's GUID from the graph.
        node: A node of this process, to ask the graph with.

    Returns:
        A phrase to follow a node's name, such as `'in this notebook'`.
    """
    own = _own_prefix(node)
    if gid[_PROCESS] == own:
        return 'in this notebook' if settings.in_kernel() else 'in this program'
    if gid[_HOST] != own[_HOST]:
        return 'on another computer or in another container'
    return _place_of_process(gid[_PROCESS])


def _own_prefix(node: Node) -> bytes:
    """Return the GUID prefix of this process, empty while the graph can't tell."""
    global _own
    if _own[0] != os.getpid():
        mine = (node.get_name(), node.get_namespace())
        for info in node.get_publishers_info_by_topic('/parameter_events'):
            gid = bytes(info.endpoint_gid)
            # Another process may have a node of the same name.
            if process_id(gid) == os.getpid() & 0xFFFF and mine == (
                info.node_name,
                info.node_namespace,
            ):
                _own = (os.getpid(), gid[_PROCESS])
                return _own[1]
        return b''
    return _own[1]


@functools.lru_cache(maxsize=256)
def _place_of_process(prefix: bytes) -> str:
    pids = [pid for pid in _pids() if pid & 0xFFFF == process_id(prefix)]
    # Two processes with the same low bytes can't be told apart.
    return _describe(pids[0]) if len(pids) == 1 else 'in another process'


def _describe(pid: int) -> str:
    command = _read(pid, 'cmdline')
    if any('ipykernel' in word for word in command):
        environment = dict(word.partition('=')[::2] for word in _read(pid, 'environ'))
        name = environment.get('JPY_SESSION_NAME', '')
        return f'in another notebook, {Path(name).name}' if name else 'in another notebook'
    words = [Path(word).name for word in command[:1]] + command[1:]
    # A program passed with -c has several lines.
    text = ' '.join(' '.join(words).split())
    return f'in another process, {pid} ({text[:60]})'


def _pids() -> list[int]:
    try:
        return [int(name) for name in os.listdir('/proc') if name.isdecimal()]
    except OSError:
        return []


def _read(pid: int, name: str) -> list[str]:
    """Return the words of a file in /proc; none if it belongs to another user."""
    try:
        data = Path('/proc', str(pid), name).read_bytes()
    except OSError:
        return []
    return [word.decode(errors='replace') for word in data.split(b'\0') if word]
