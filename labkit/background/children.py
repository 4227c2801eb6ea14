"""The children of this process, whoever has started them, and by whatever means.

The processes that labkit starts itself, and shows, are in `child_processes`.
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

from labkit.background.patience import busyness
from labkit.rosgraph.whose import process_id

__all__ = [
    'SUPERVISOR',
    'EndedChild',
    'ended_children',
    'interrupt_child',
    'is_of_child',
    'starting_children',
]

# What stands between this process and one that labkit has started.
SUPERVISOR = Path(__file__).with_name('supervisor.py')
# How old a process that this notebook started may be and still count as starting; and how much of
# a processor it may have used: Python and rclpy need 1 s of it until a node is made.
_YOUNG_SEC = 5.0
_STARTING_CPU_SEC = 4.0


def starting_children(gids: Collection[bytes], others: Collection[int] = ()) -> tuple[bool, bool]:
    """Tell whether this process has lately started others, whose nodes may be about to appear.

    Args:
        gids: Global ids of endpoints that are in the graph.
        others: Ids of processes that are known to have all that they make, see `Process.pids`.

    Returns:
        Whether one of them has nothing in the graph yet, and whether one has: what else it makes
        may follow.
    """
    import psutil  # type: ignore[import-untyped]

    appeared = {process_id(gid) for gid in gids}
    oldest = time.time() - _YOUNG_SEC * busyness()

    def is_starting(child: psutil.Process) -> bool:
        if child.create_time() > oldest:
            return bool(child.status() != psutil.STATUS_ZOMBIE)
        # On a busy machine it may take long to get as far as this. What has not used much of a
        # processor yet, and wants one, is still starting.
        at_work = child.status() in (psutil.STATUS_RUNNING, psutil.STATUS_DISK_SLEEP)
        used = child.cpu_times()
        return at_work and used.user + used.system < _STARTING_CPU_SEC

    found = set()
    # One by one, and not all at once: a shell starts its command whenever it likes.
    to_do = psutil.Process().children()
    while to_do:
        child = to_do.pop()
        try:
            inner = child.children()
            to_do += inner
            if inner and child.status() == psutil.STATUS_SLEEPING:
                continue  # a supervisor or a shell, which only waits
            if child.pid & 0xFFFF not in others and is_starting(child):
                found.add(child.pid & 0xFFFF in appeared)
        except psutil.NoSuchProcess:
            continue
    return False in found, True in found


def is_of_child(gid: bytes) -> bool:
    """Tell whether an endpoint belongs to a process that this process has started."""
    import psutil

    children = psutil.Process().children(recursive=True)
    return process_id(gid) in {child.pid & 0xFFFF for child in children}


def interrupt_child(gid: bytes) -> bool:
    """Press Ctrl-C in the process of an endpoint, if this process has started it.

    Returns:
        Whether it has.
    """
    import psutil

    for child in psutil.Process().children(recursive=True):
        if child.pid & 0xFFFF == process_id(gid):
            with contextlib.suppress(psutil.NoSuchProcess):
                child.send_signal(signal.SIGINT)
                return True
    return False


@dataclass(frozen=True)
class EndedChild:
    """A process that this one has started, with whatever means, and that has ended.

    Attributes:
        pid: Its process id.
        command: The program and its arguments, as they were given; none if nobody knows them.
        exit_code: As `subprocess` tells it, -2 for Ctrl-C; None if it is not known, as that of a
            process of `asyncio` before the cell ends.
    """

    pid: int
    command: tuple[str, ...]
    exit_code: int | None


def ended_children() -> list[EndedChild]:
    """Return the processes that this one has started and that have ended, without labkit's own.

    Those that nobody has waited for yet are found in any case; others as long as there is a
    `subprocess.Popen` of them, which `asyncio` makes too. Nothing is changed: whoever waits for
    one of them still hears of its end. All objects of Python are looked at, which takes tenths of
    a second.
    """
    import psutil

    popens = [popen for popen in _popens() if hasattr(popen, 'pid')]
    commands = {popen.pid: _words(popen.args) for popen in popens}
    codes: dict[int, int | None] = {popen.pid: popen.returncode for popen in popens}
    for child in psutil.Process().children():
        with contextlib.suppress(psutil.NoSuchProcess):
            codes.pop(child.pid, None)  # it runs, or a later process has the same id
            if child.status() == psutil.STATUS_ZOMBIE:
                codes[child.pid] = _exit_code(child.pid)
    ended = [EndedChild(pid, commands.get(pid, ()), code) for pid, code in codes.items()]
    return [child for child in ended if str(SUPERVISOR) not in child.command]


def _popens() -> list[subprocess.Popen[Any]]:
    # type() and not isinstance(): some objects answer to __class__ with surprises.
    return [thing for thing in gc.get_objects() if issubclass(type(thing), subprocess.Popen)]


def _words(args: Any) -> tuple[str, ...]:
    """Return what `Popen` was given as words; a line for the shell is one."""
    words = [args] if isinstance(args, (str, bytes, os.PathLike)) else args
    return tuple(os.fsdecode(word) for word in words)


def _exit_code(pid: int) -> int | None:
    """Return the exit code of a child that nobody has waited for, and let others wait for it."""
    try:
        ended = os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return None
    if ended is None:
        return None
    return ended.si_status if ended.si_code == os.CLD_EXITED else -ended.si_status
