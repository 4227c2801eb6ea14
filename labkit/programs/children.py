"""All child processes of this one, however they were started.

Those that labkit itself starts and shows are in `child_processes`.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import subprocess
import time
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from labkit.rosgraph.whose import process_id

__all__ = [
    'SUPERVISOR',
    'EndedChild',
    'child_ids',
    'child_of',
    'ended_children',
    'interrupt_child',
    'is_at_work',
    'is_of_child',
    'starting_children',
]

# The parent of each process that labkit starts.
SUPERVISOR = Path(__file__).with_name('supervisor.py')
# A child younger than this counts as starting.
_YOUNG_SEC = 5.0
# So does one that has used less processor time: Python and rclpy need 1 s until a node is made.
_STARTING_CPU_SEC = 4.0


def starting_children(
    gids: Collection[bytes],
    others: Collection[int] = (),
    ports: Collection[int] = (),
    used: dict[int, float] | None = None,
) -> tuple[bool, bool]:
    """Return whether nodes of recently started children may be about to appear.

    Args:
        gids: GIDs of the endpoints in the graph.
        others: Ids of processes whose nodes are known to be complete, see `Process.pids`.
        ports: UDP ports of the domain. Who has one, and is not in the graph, is on the way there:
            rmw_fastrtps takes them when the first node is made.
        used: The processor time of each child at the last look, s. It is filled. Who has used
            some since then is at work, and so may be one that is seen for the first time.

    Returns:
        Whether a starting child has nothing in the graph yet, and whether one has something: more
        may follow.
    """
    import psutil  # type: ignore[import-untyped]

    appeared = {process_id(gid) for gid in gids}
    oldest = time.time() - _YOUNG_SEC

    last = {} if used is None else used

    def is_starting(child: psutil.Process) -> bool:
        status = child.status()
        if child.create_time() > oldest:
            return bool(status != psutil.STATUS_ZOMBIE)
        times, before = child.cpu_times(), last.get(child.pid)
        now: float = times.user + times.system
        last[child.pid] = now
        # On a busy machine it may take long to get that far.
        if is_at_work(child.pid):
            return now < _STARTING_CPU_SEC
        if child.pid & 0xFFFF in appeared or status == psutil.STATUS_ZOMBIE:
            return False
        if now < _STARTING_CPU_SEC and (before is None or now > before):
            return True
        sockets = child.net_connections('udp')
        return any(socket.laddr.port in ports for socket in sockets if socket.laddr)

    found = set()
    # One by one and not recursively: a shell may start its command in between.
    to_do = psutil.Process().children()
    while to_do:
        child = to_do.pop()
        try:
            inner = child.children()
            to_do += inner
            if inner and child.status() == psutil.STATUS_SLEEPING:
                continue  # a supervisor or shell that only waits
            if child.pid & 0xFFFF not in others and is_starting(child):
                found.add(child.pid & 0xFFFF in appeared)
        except psutil.NoSuchProcess:
            continue
    return False in found, True in found


def is_at_work(pid: int) -> bool:
    """Return whether a thread of a process runs, or waits for a processor or a disk."""
    for stat in Path(f'/proc/{pid}/task').glob('*/stat'):
        with contextlib.suppress(OSError):
            if stat.read_text(errors='replace').rpartition(')')[2].split()[0] in 'RD':
                return True
    return False


def child_ids() -> set[int]:
    """Return the lower 16 bits of the ids of all child processes, see `process_id`."""
    import psutil

    return {child.pid & 0xFFFF for child in psutil.Process().children(recursive=True)}


def child_of(gid: bytes) -> Any:
    """Return the child process of an endpoint, None if it is of no child."""
    import psutil

    children = psutil.Process().children(recursive=True)
    return next((child for child in children if child.pid & 0xFFFF == process_id(gid)), None)


def is_of_child(gid: bytes) -> bool:
    """Return whether an endpoint belongs to a child process."""
    return child_of(gid) is not None


def interrupt_child(gid: bytes) -> bool:
    """Send SIGINT to the child process of an endpoint; return False if it is no child."""
    import psutil

    child = child_of(gid)
    with contextlib.suppress(psutil.NoSuchProcess):
        if child is not None:
            child.send_signal(signal.SIGINT)
            return True
    return False


@dataclass(frozen=True)
class EndedChild:
    """A child process that has ended.

    Attributes:
        pid: Its process id.
        command: The program and its arguments as given; empty if unknown.
        exit_code: The exit code as in `subprocess`, -2 for Ctrl-C; None if unknown, as that of an
            `asyncio` process before the cell ends.
    """

    pid: int
    command: tuple[str, ...]
    exit_code: int | None


def ended_children() -> list[EndedChild]:
    """Return the children that have ended, without labkit's own.

    A child that was not waited for is always found; another one as long as its
    `subprocess.Popen` exists, which `asyncio` makes too. It can still be waited for afterwards.
    Looking through all of Python's objects takes tenths of a second.
    """
    import psutil

    popens = {popen.pid: popen for popen in _popens() if hasattr(popen, 'pid')}
    children = {child.pid: _exit_code(child.pid) for child in psutil.Process().children()}
    codes = {
        pid: popen.returncode
        for pid, popen in popens.items()
        if pid not in children or popen.returncode is not None  # waited for just now
    }
    codes |= {pid: code for pid, code in children.items() if code is not None}
    commands = {pid: _words(popens[pid].args) if pid in popens else () for pid in codes}
    ended = [EndedChild(pid, commands[pid], code) for pid, code in codes.items()]
    return [child for child in ended if str(SUPERVISOR) not in child.command]


def _popens() -> list[subprocess.Popen[Any]]:
    # type() and not isinstance(): some objects have a __class__ that raises or lies.
    return [thing for thing in gc.get_objects() if issubclass(type(thing), subprocess.Popen)]


def _words(args: Any) -> tuple[str, ...]:
    """Return the arguments of a `Popen` as words; a shell command is one word."""
    words = [args] if isinstance(args, (str, bytes, os.PathLike)) else args
    return tuple(os.fsdecode(word) for word in words)


def _exit_code(pid: int) -> int | None:
    """Return the exit code of a child that can be waited for, and leave it so; None if it runs.

    Its status does not tell that: it is a zombie while threads of it are still at work.
    """
    try:
        ended = os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:  # somebody has waited for it just now
        return None
    if ended is None:
        return None
    return ended.si_status if ended.si_code == os.CLD_EXITED else -ended.si_status
