"""A learner's server as a process of their account, with limits that every Linux has.

For machines without systemd, such as a container. Where systemd runs, SystemdSpawner is used: its
limits are for all processes of a learner together.
"""

from __future__ import annotations

import os
import resource
from collections.abc import Callable

from jupyterhub.spawner import LocalProcessSpawner
from traitlets import Integer

__all__ = ['LimitedSpawner']

# Of 1000: when the machine's memory is full, the kernel ends a learner's process, not the hub.
_OOM_SCORE = 500
# The hub and its proxy go first.
_NICENESS = 5


class LimitedSpawner(LocalProcessSpawner):  # type: ignore[misc]
    """JupyterHub's spawner of local processes, with limits of memory, processes and processors.

    `mem_limit` holds for each process of a learner. Threads count as processes. `cpu_limit` says
    how many processors the learner's processes may be on; without it all learners share all of
    them, and the system divides them evenly.
    """

    process_limit = Integer(
        600, min=50, help='How many processes and threads a learner may have.'
    ).tag(config=True)

    def make_preexec_fn(self, name: str) -> Callable[[], None]:
        """Return what the new process does first: take the limits, then become the learner.

        Args:
            name: The learner's account.
        """
        become = super().make_preexec_fn(name)
        limits = {resource.RLIMIT_NPROC: self.process_limit, resource.RLIMIT_CORE: 0}
        if self.mem_limit:
            # Not the address space: Fast DDS and numpy reserve much that they never use.
            limits[resource.RLIMIT_DATA] = self.mem_limit
        processors = self._processors()

        def prepare() -> None:
            for kind, most in limits.items():
                resource.setrlimit(kind, (most, most))
            os.sched_setaffinity(0, processors)
            os.nice(_NICENESS)
            with open('/proc/self/oom_score_adj', 'w') as file:
                file.write(str(_OOM_SCORE))
            become()

        return prepare

    def _processors(self) -> list[int]:
        """Return the processors for this learner; they go round, learner by learner."""
        there = sorted(os.sched_getaffinity(0))
        count = max(1, min(len(there), round(self.cpu_limit or len(there))))
        first = self.user.id * count
        return [there[(first + step) % len(there)] for step in range(count)]
