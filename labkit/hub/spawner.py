"""A learner's server as a process of their account: limits, a certificate, and places of its own.

`LimitedSpawner` is for machines without systemd, such as a container, with limits that every Linux
has. With systemd, `GroupSpawner` is used: its limits apply to all processes of a learner together.
"""

from __future__ import annotations

import ctypes
import os
import pwd
import resource
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from jupyterhub.spawner import LocalProcessSpawner
from systemdspawner import SystemdSpawner  # type: ignore[import-untyped]
from traitlets import HasTraits, Integer, Unicode, default

from labkit.hub import leftovers

__all__ = ['GroupSpawner', 'LimitedSpawner']

# Out of 1000: when memory runs out, the kernel kills a learner's process, not the hub.
_OOM_SCORE = 500
# The hub and its proxy have priority.
_NICENESS = 5
# Of sched.h and sys/mount.h.
_CLONE_NEWNS, _MS_REC, _MS_SLAVE, _MS_BIND = 0x00020000, 0x4000, 0x80000, 0x1000
_MS_NOSUID, _MS_NODEV = 0x2, 0x4
# What is in shared memory is of no process, so no limit of processes holds for it, and it stays
# when they end. A node takes some 1 MB; Docker gives a container 64 MB. Empty files take some too.
_SHARED_MEMORY = b'mode=1777,size=256m,nr_inodes=10k'
_libc = ctypes.CDLL(None, use_errno=True)


class _OwnAddress(HasTraits):
    """A server at an address of its own, with a certificate for that address alone.

    Who takes the port of another learner's server can't show that one's certificate, so the
    proxy leads nobody there. With one address for all, any learner's certificate would do.
    """

    user: Any
    ip: str
    private_folder = Unicode(help='A folder for certificates, which learners can pass.').tag(
        config=True
    )
    ssl_alt_names_include_local = False

    @default('ip')
    def _own_ip(self) -> str:
        return f'127.64.{self.user.id // 250}.{self.user.id % 250 + 1}'

    @default('ssl_alt_names')
    def _own_name(self) -> list[str]:
        return [f'IP:{self.ip}']

    async def move_certs(self, paths: dict[str, str]) -> dict[str, str]:
        """Copy the server's key and certificate to where only the learner reads them.

        Not into the home, as JupyterHub does: there, root would follow the learner's links.

        Args:
            paths: Key, certificate and trusted certificates, in the hub's folder.

        Returns:
            The copies.
        """
        group = pwd.getpwnam(self.user.name).pw_gid
        folder = Path(self.private_folder, self.user.name)
        folder.mkdir(exist_ok=True)
        copies = {kind: folder / Path(path).name for kind, path in paths.items()}
        for kind, copy in copies.items():
            shutil.copyfile(paths[kind], copy)
            copy.chmod(0o640)
            os.chown(copy, 0, group)
        folder.chmod(0o750)
        os.chown(folder, 0, group)
        return {kind: str(copy) for kind, copy in copies.items()}


class GroupSpawner(_OwnAddress, SystemdSpawner):  # type: ignore[misc]
    """JupyterHub's spawner of control groups."""


class LimitedSpawner(_OwnAddress, LocalProcessSpawner):  # type: ignore[misc]
    """JupyterHub's spawner of local processes, with limits on memory, processes and processors.

    `mem_limit` applies to each process of a learner. Threads count as processes. `cpu_limit` is
    the number of processors for a learner; without it all learners share all processors, divided
    evenly by the system. `/tmp` and `/dev/shm` (256 MB) are the learner's own, where the system
    allows it.
    """

    process_limit = Integer(
        600, min=50, help='How many processes and threads a learner may have.'
    ).tag(config=True)

    def make_preexec_fn(self, name: str) -> Callable[[], None]:
        """Return what the new process does first: set the limits, then become the learner.

        Args:
            name: The learner's account.
        """
        become = super().make_preexec_fn(name)
        limits = {resource.RLIMIT_NPROC: self.process_limit, resource.RLIMIT_CORE: 0}
        if self.mem_limit:
            # Not the address space: Fast DDS and numpy reserve much more than they use.
            limits[resource.RLIMIT_DATA] = self.mem_limit
        processors = self._processors()
        own = self._own_tmp()

        def prepare() -> None:
            for kind, most in limits.items():
                resource.setrlimit(kind, (most, most))
            os.sched_setaffinity(0, processors)
            os.nice(_NICENESS)
            with open('/proc/self/oom_score_adj', 'w') as file:
                file.write(str(_OOM_SCORE))
            _take_places(own)
            become()

        return prepare

    def _own_tmp(self) -> bytes | None:
        """Return an empty folder to become the learner's `/tmp`.

        None if `/tmp` has what they need, as in a test.
        """
        needed = Path(sys.prefix), Path(self.private_folder)
        if any(path.is_relative_to('/tmp') for path in needed):
            return None
        account = pwd.getpwnam(self.user.name)
        folder = Path(self.private_folder, f'{self.user.name}-tmp')
        if left := leftovers.remove(folder):
            self.log.warning(left)
        folder.mkdir()
        os.chown(folder, account.pw_uid, account.pw_gid)
        folder.chmod(0o700)
        return bytes(folder)

    def _processors(self) -> list[int]:
        """Return the processors for this learner, assigned in rotation."""
        there = sorted(os.sched_getaffinity(0))
        count = max(1, min(len(there), round(self.cpu_limit or len(there))))
        first = self.user.id * count
        return [there[(first + step) % len(there)] for step in range(count)]


def _take_places(tmp: bytes | None) -> None:
    """Give this process a `/tmp` and shared memory of its own, and no other one a look at them.

    Fast DDS makes its shared memory readable for everybody. Where the system forbids mounts, as in
    many containers, all stays as it is, and the log says so.
    """
    steps: tuple[tuple[Any, ...], ...] = (
        (_libc.unshare, _CLONE_NEWNS),
        (_libc.mount, b'none', b'/', None, _MS_REC | _MS_SLAVE, None),
        (_libc.mount, b'tmpfs', b'/dev/shm', b'tmpfs', _MS_NOSUID | _MS_NODEV, _SHARED_MEMORY),
        *([(_libc.mount, tmp, b'/tmp', None, _MS_BIND, None)] if tmp is not None else []),
    )
    for call, *arguments in steps:
        if call(*(ctypes.c_ulong(a) if isinstance(a, int) else a for a in arguments)) != 0:
            reason = os.strerror(ctypes.get_errno())
            os.write(2, f'/tmp and /dev/shm are shared among learners: {reason}\n'.encode())
            return
