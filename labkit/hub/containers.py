"""Volumes of a class in containers: each learner's own folder, and all of them for teachers."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from labkit.hub.class_list import Member

__all__ = ['HUB_IP', 'MOUNTED', 'make_class_volumes', 'mount_class']

HUB_IP = '172.17.0.1'
"""The address of the hub for containers: this machine's end of Docker's bridge."""
MOUNTED = '/srv/class'
"""The folder of the class inside a container."""

# The user in the image, see Dockerfile.
_USER_ID = 1000


def make_class_volumes(folder: Path, members: Sequence[Member]) -> None:
    """Make sure that each member has a folder to share progress with the class.

    All containers have the same user, so folders are protected from other learners not by
    ownership but by being absent from their containers.

    Args:
        folder: The parent folder, inaccessible to accounts of this machine.
        members: The class.
    """
    places = [(folder, 0, 0o755)]
    places += [(folder / member.name, _USER_ID, 0o750) for member in members]
    for place, owner, mode in places:
        place.mkdir(exist_ok=True)
        os.chown(place, owner, 0)
        place.chmod(mode)


def mount_class(folder: Path, members: Sequence[Member]) -> Callable[[Any], None]:
    """Return a hook that gives a container its part of the class's folder before it starts.

    Learners get only their own folder, writable. Teachers also get the whole, read-only.

    Args:
        folder: The folder of `make_class_volumes`.
        members: The class.
    """
    teachers = {member.name for member in members if member.teaches}

    def mount(spawner: Any) -> None:
        name = spawner.user.name
        volumes: dict[str, Any] = {str(folder / name): f'{MOUNTED}/{name}'}
        if name in teachers:
            volumes[str(folder)] = {'bind': MOUNTED, 'mode': 'ro'}
        spawner.volumes = {**spawner.volumes, **volumes}

    return mount
