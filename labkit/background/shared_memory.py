"""What little room in /dev/shm means for ROS, told before Fast DDS says it in its own way."""

from __future__ import annotations

import shutil
from contextlib import suppress

__all__ = ['look_at_shared_memory']

_PLACE = '/dev/shm'
# What Fast DDS takes for a process.
_SEGMENT_BYTES = 650_000


def look_at_shared_memory() -> None:
    """Print a sentence if messages will not pass through shared memory.

    Without any room Fast DDS can't even be loaded: see `labkit.packages.imports`.
    """
    free = _SEGMENT_BYTES
    with suppress(OSError):
        free = shutil.disk_usage(_PLACE).free
    if free < _SEGMENT_BYTES:
        print(
            f'{_PLACE} has {free / 1e6:.2f} MB free, too little for shared memory. Fast DDS says '
            'so in red lines; messages between processes pass through the network of this '
            f'machine instead. Delete what fills it: ls -lS {_PLACE}'
        )
