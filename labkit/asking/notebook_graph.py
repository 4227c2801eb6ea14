"""A notebook tells the terminals of its user what is on the graph.

A process that has just been started discovers the others bit by bit, which takes seconds on a busy
machine. A notebook knows them already, as the daemon of the real `ros2` does, and when a cell
of it was run last. It listens on a socket of Linux's abstract namespace, which goes with its
process (unix(7)). Anybody can take the name of such a socket, so each end looks at the user of the
other.
"""

from __future__ import annotations

import json
import os
import socket
import struct
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from typing import Any

from rclpy.node import Node

from labkit import domain_ids, settings
from labkit.asking.discovery import MOST_SEC, discover, is_only_process
from labkit.background.runtime import runtime
from labkit.rosgraph.listings import NamesAndTypes, actions, services, topics
from labkit.rosgraph.snapshot import node_names

__all__ = ['KINDS', 'ask_notebook', 'last_used', 'serve']

# A graph of 10,000 topics has less, bytes.
_MOST_BYTES = 10_000_000
_MOST_WORD = 20
# `struct ucred` of unix(7): process, user, group.
_CREDENTIALS = struct.Struct('3i')

KINDS: Mapping[str, Callable[[Node], NamesAndTypes]] = {
    'actions': partial(actions, include_hidden=True),
    'nodes': lambda node: [(name, []) for name in node_names(node)],
    'services': partial(services, include_hidden=True),
    'topics': partial(topics, include_hidden=True),
}
"""What a notebook can be asked for, and how it looks."""

_USED = 'used'
_USED_SEC = 1.0

_server: socket.socket | None = None
# When a cell was run last, on the clock that all processes of a machine share, s.
_used = 0.0


def ask_notebook(kind: str) -> NamesAndTypes | None:
    """Return what a running notebook of this user and domain knows of the graph.

    Args:
        kind: One of `KINDS`.

    Returns:
        All names with their types, hidden ones, too. None if there is no such notebook, or if it
        can not answer.
    """
    if settings.in_kernel() or not _is_open_here():
        return None
    with suppress(ValueError, TypeError):
        # A notebook waits so long for processes that have just been started.
        told = _answer_of(domain_ids.read_domain_id() or 0, kind, 2 * MOST_SEC)
        return [(name, types) for name, types in told]
    return None


def last_used(domain_id: int) -> float:
    """Return when a cell of the notebook of a domain was run last, s; 0 if it does not tell.

    The times of notebooks on one machine can be compared.
    """
    with suppress(ValueError, TypeError):
        return float(_answer_of(domain_id, _USED, _USED_SEC))
    return 0.0


def _answer_of(domain_id: int, question: str, timeout_sec: float) -> Any:
    """Return what a notebook of this user answers; None if there is none, or no answer.

    Raises:
        ValueError: The answer is no JSON.
    """
    with suppress(OSError), socket.socket(socket.AF_UNIX) as asking:
        asking.settimeout(timeout_sec)
        asking.connect(_address(domain_id))
        if _is_own_user(asking):
            asking.sendall(f'{question}\n'.encode())
            with asking.makefile('rb') as answer:
                return json.loads(answer.read(_MOST_BYTES))
    return None


def _is_open_here() -> bool:
    # With others on the network a notebook may not know them all; without discovery, nobody.
    return domain_ids.stays_here() and not is_only_process()


def _address(domain_id: int) -> str:
    return f'\0labkit-graph-{os.getuid()}-{domain_id}'


def _is_own_user(connection: socket.socket) -> bool:
    found = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    return bool(_CREDENTIALS.unpack(found)[1] == os.getuid())


def serve() -> None:
    """Listen for terminals of the domain that ROS has been started in."""
    global _server
    shell = settings.shell()
    if shell is not None:
        _note_use()
        shell.events.register('pre_run_cell', _note_use)  # once, however often it is called
    address = _address(runtime.domain_id or 0)
    if _server is not None and _server.getsockname() == address.encode():
        return
    _close()
    if not _is_open_here():
        return
    # Not on a system without such sockets, and not if another notebook of the domain answers.
    with suppress(OSError, AttributeError):
        server = socket.socket(socket.AF_UNIX)
        server.bind(address)
        server.listen()
        _server = server
        threading.Thread(target=_answer, args=(server,), daemon=True).start()


def _note_use(*_: object) -> None:
    global _used
    _used = time.monotonic()


def _close() -> None:
    if _server is not None:
        with suppress(OSError):
            _server.shutdown(socket.SHUT_RDWR)  # which ends its thread's accept()
        _forget()


def _forget() -> None:
    global _server
    if _server is not None:
        _server.close()
        _server = None


os.register_at_fork(after_in_child=_forget)


def _answer(server: socket.socket) -> None:
    while server is _server:
        try:
            connection, _ = server.accept()
        except OSError:
            return  # it was closed
        # The terminal has gone, or ROS is being stopped: then the terminal looks for itself.
        with connection, suppress(Exception):
            connection.settimeout(MOST_SEC)
            node = runtime.helper
            if node is not None and _is_own_user(connection):
                with connection.makefile('rb') as question:
                    kind = question.readline(_MOST_WORD).decode(errors='replace').strip()
                if kind == _USED:
                    connection.sendall(json.dumps(_used).encode())
                if kind in KINDS:
                    discover(node, least=0.0, most=time.monotonic() + MOST_SEC)
                    connection.sendall(json.dumps(KINDS[kind](node)).encode())
