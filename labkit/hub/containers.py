"""What containers of a class share: each learner's folder, with their own and the teachers'."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from labkit.hub.class_list import Member

__all__ = ['MOUNTED', 'make_class_volumes', 'mount_class']

MOUNTED = '/srv/class'
"""Where the folder of the class is inside of a container."""

# The user of the image, see Dockerfile.
_USER_ID = 1000


def make_class_volumes(folder: Path, members: Sequence[Member]) -> None:
    """Make sure that each member has a folder for what they share with the class.

    All containers have the same user, so it is not its owner that keeps a folder from other
    learners, but that it is not in their containers.

    Args:
        folder: Where these folders are. The way to it is closed to accounts of this machine.
        members: The class.
    """
    places = [(folder, 0, 0o755)]
    places += [(folder / member.name, _USER_ID, 0o750) for member in members]
    for place, owner, mode in places:
        place.mkdir(exist_ok=True)
        os.chown(place, owner, 0)
        place.chmod(mode)


def mount_class(folder: Path, members: Sequence[Member]) -> Callable[[Any], None]:
    """Return what gives a container its part of the folder of a class, before it starts.

    Learners get a folder of their own, in which they write, and nothing beside it. Teachers also
    get the whole, to read.

    Args:
        folder: What `make_class_volumes` has made.
        members: The class.
    """
    teachers = {member.name for member in members if member.teaches}

    def mount(spawner: Any) -> None:
        name = spawner.user.name
        volumes: dict[str, Any] = {str(folder / name): f'{MOUNTED}/{name}'}
        # Not `user.admin`: the hub keeps that for somebody who teaches no more.
        if name in teachers:
            volumes[str(folder)] = {'bind': MOUNTED, 'mode': 'ro'}
        spawner.volumes = {**spawner.volumes, **volumes}

    return mount
