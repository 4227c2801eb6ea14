"""Where an endpoint of the graph runs: in this notebook, in another one, in which process."""

from __future__ import annotations

import functools
import os
import signal
import time
from collections.abc import Collection
from pathlib import Path

from labkit import settings

__all__ = ['interrupt_child', 'place', 'same_process', 'starting_children']

# Fast DDS makes the first bytes of a GUID so: vendor (2), host (2), process id, low bytes (2),
# random (2), participant (4). Source: fastrtps 2.14, src/cpp/rtps/common/GuidUtils.hpp.
_HOST = slice(2, 4)
_PROCESS = slice(4, 6)
_HOST_AND_PROCESS = slice(2, 6)

# How old a process that this notebook started may be and still count as starting.
_YOUNG_SEC = 5.0


def same_process(gid: bytes, own_gid: bytes) -> bool:
    """Tell whether two endpoints belong to one process."""
    return gid[_HOST_AND_PROCESS] == own_gid[_HOST_AND_PROCESS]


@functools.lru_cache(maxsize=256)
def place(gid: bytes, own_gid: bytes) -> str:
    """Say where an endpoint runs.

    Args:
        gid: The endpoint's global id, as the graph gives it.
        own_gid: That of any endpoint of this process.

    Returns:
        Words that follow a node's name, such as `'in this notebook'`.
    """
    if same_process(gid, own_gid):
        return 'in this notebook' if settings.in_kernel() else 'in this program'
    if gid[_HOST] != own_gid[_HOST]:
        return 'on another computer or in another container'
    low = int.from_bytes(gid[_PROCESS], 'little')
    pids = [pid for pid in _pids() if pid & 0xFFFF == low]
    # With two processes whose ids end alike there is no telling which one it is.
    return _describe(pids[0]) if len(pids) == 1 else 'in another process'


def starting_children(gids: Collection[bytes]) -> tuple[bool, bool]:
    """Tell whether this process has lately started others, whose nodes may be about to appear.

    Args:
        gids: Global ids of endpoints that are in the graph.

    Returns:
        Whether one of them has nothing in the graph yet, and whether one has: what else it makes
        may follow.
    """
    import psutil  # type: ignore[import-untyped]

    appeared = {int.from_bytes(gid[_PROCESS], 'little') for gid in gids}
    oldest = time.time() - _YOUNG_SEC
    found = set()
    for child in psutil.Process().children(recursive=True):
        try:
            if child.create_time() > oldest and child.status() != psutil.STATUS_ZOMBIE:
                found.add(child.pid & 0xFFFF in appeared)
        except psutil.NoSuchProcess:
            continue
    return False in found, True in found


def interrupt_child(gid: bytes) -> bool:
    """Press Ctrl-C in the process of an endpoint, if this process has started it.

    Returns:
        Whether it has.
    """
    import psutil

    low = int.from_bytes(gid[_PROCESS], 'little')
    for child in psutil.Process().children(recursive=True):
        if child.pid & 0xFFFF == low:
            child.send_signal(signal.SIGINT)
            return True
    return False


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
