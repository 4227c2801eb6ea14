"""Whose an endpoint is: this process's, another one's, another computer's. Read off its GUID.

Fast DDS makes the first 8 of an endpoint's 16 bytes once for each process: vendor (2), host (2),
process id, low bytes (2), random (2). The participant follows (4), so two contexts of one process
differ there and nowhere before. Source: fastrtps 2.14, src/cpp/rtps/common/GuidUtils.hpp.
"""

from __future__ import annotations

import functools
import os
from pathlib import Path

from rclpy.node import Node

from labkit import settings
from labkit.rosgraph.names import full_node_name

__all__ = [
    'foreign_nodes',
    'has_ended',
    'is_own',
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

# What the GUIDs of this process start with, once it is known, and the process: a fork is another.
_own: tuple[int, bytes] = (0, b'')
# What the GUIDs of processes start with that were killed: the graph forgets them 20 s later.
_ended: set[bytes] = set()


def is_own(gid: bytes, node: Node) -> bool:
    """Tell whether an endpoint belongs to this process, whichever of its contexts made it.

    Args:
        gid: The endpoint's GUID, as the graph gives it.
        node: A node of this process, to ask the graph with.
    """
    return gid[_PROCESS] == _own_start(node)


def participant_of(gid: bytes) -> bytes:
    """Return what the GUIDs of all endpoints of one DDS participant start with."""
    return gid[_PARTICIPANT]


def process_of(gid: bytes) -> bytes:
    """Return what the GUIDs of all endpoints of one process start with."""
    return gid[_PROCESS]


def note_end(process: bytes) -> None:
    """Let the endpoints of a process that has ended without a word be left out from now on.

    Args:
        process: What its GUIDs start with, see `process_of`.
    """
    _ended.add(process)


def has_ended(gid: bytes) -> bool:
    """Tell whether the process of an endpoint is known to have ended; the graph may not know."""
    return gid[_PROCESS] in _ended


def process_id(gid: bytes) -> int:
    """Return the lower 16 bits of the id of an endpoint's process."""
    return int.from_bytes(gid[_PROCESS_ID], 'little')


def foreign_nodes(node: Node) -> set[str]:
    """Return the full names of the nodes that other processes have in this domain.

    Args:
        node: A node of this process, to ask the graph with.
    """
    return _nodes(node, own=False)


def own_nodes(node: Node) -> set[str]:
    """Return the full names of the nodes of this process. They are known from their first moment.

    Args:
        node: A node of this process, to ask the graph with.
    """
    return _nodes(node, own=True)


def _nodes(node: Node, *, own: bool) -> set[str]:
    # Every node publishes on this topic.
    return {
        full_node_name(info.node_name, info.node_namespace)
        for info in node.get_publishers_info_by_topic('/parameter_events')
        if is_own(bytes(info.endpoint_gid), node) == own
        and not has_ended(bytes(info.endpoint_gid))
    }


def place(gid: bytes, node: Node) -> str:
    """Say where an endpoint runs.

    Args:
        gid: The endpoint's GUID, as the graph gives it.
        node: A node of this process, to ask the graph with.

    Returns:
        Words that follow a node's name, such as `'in this notebook'`.
    """
    own = _own_start(node)
    if gid[_PROCESS] == own:
        return 'in this notebook' if settings.in_kernel() else 'in this program'
    if gid[_HOST] != own[_HOST]:
        return 'on another computer or in another container'
    return _place_of_process(gid[_PROCESS])


def _own_start(node: Node) -> bytes:
    """Return what the GUIDs of this process start with, '' as long as the graph can't tell."""
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
def _place_of_process(start: bytes) -> str:
    pids = [pid for pid in _pids() if pid & 0xFFFF == process_id(start)]
    # With two processes whose ids end alike there is no telling which one it is.
    return _describe(pids[0]) if len(pids) == 1 else 'in another process'


def _describe(pid: int) -> str:
    command = _read(pid, 'cmdline')
    if any('ipykernel' in word for word in command):
        environment = dict(word.partition('=')[::2] for word in _read(pid, 'environ'))
        name = environment.get('JPY_SESSION_NAME', '')
        return f'in another notebook, {Path(name).name}' if name else 'in another notebook'
    words = [Path(word).name for word in command[:1]] + command[1:]
    # A program that is given with -c has several lines.
    text = ' '.join(' '.join(words).split())
    return f'in another process, {pid} ({text[:60]})'


def _pids() -> list[int]:
    try:
        return [int(name) for name in os.listdir('/proc') if name.isdecimal()]
    except OSError:
        return []


def _read(pid: int, name: str) -> list[str]:
    """Return the words of a file of /proc; none when it belongs to somebody else."""
    try:
        data = Path('/proc', str(pid), name).read_bytes()
    except OSError:
        return []
    return [word.decode(errors='replace') for word in data.split(b'\0') if word]
