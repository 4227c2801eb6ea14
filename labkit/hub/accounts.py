"""A system account for each member of a class, to separate files and processes."""

from __future__ import annotations

import grp
import os
import pwd
import subprocess
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path

from labkit.errors import LabError
from labkit.hub import leftovers
from labkit.hub.class_list import Member

__all__ = [
    'GROUP',
    'end_processes',
    'make_accounts',
    'make_class_folder',
    'make_private_folder',
]

GROUP = 'labkit-class'
"""The group of all accounts made here, to tell them from others."""


def make_accounts(names: Iterable[str]) -> list[str]:
    """Make sure that everybody has an account, with a home that nobody else can read.

    The accounts have no password: they can't be used to log in to the machine itself.

    Args:
        names: The members of the class.

    Returns:
        The names of new accounts.

    Raises:
        LabError: A name belongs to an account that was not made here, such as `root`, which a
            login on the hub would open.
    """
    ours = _members()
    missing = [name for name in names if name not in ours]
    for name in missing:
        if _exists(name):
            raise LabError(
                f'{name!r} is an account of this machine that was not made for a class.',
                todo='Choose another name in the list of the class.',
            )
    if missing:
        _run('groupadd', '--force', GROUP)
    for name in missing:
        _run(
            *('useradd', '--create-home', '--user-group', '--groups', GROUP),
            *('--shell', '/bin/bash', '--comment', 'of a class on labkit hub', name),
        )
        home = Path(pwd.getpwnam(name).pw_dir)
        os.chmod(home, 0o700)
    return missing


def make_class_folder(folder: Path, members: Sequence[Member]) -> None:
    """Make sure that each member has a folder to share progress with the class.

    Only its owner can write in it, and only teachers can read it as well. Only root can create
    folders beside it, so its name is reliable.

    Args:
        folder: The parent folder, for one class only.
        members: The class; all have an account.
    """
    group = f'{GROUP}-{zlib.crc32(str(folder).encode()):08x}'
    teachers = [member.name for member in members if member.teaches]
    _run('groupadd', '--force', group)
    _run('gpasswd', '--members', ','.join(teachers), group)
    number = grp.getgrnam(group).gr_gid
    places = [(folder, 0, 0o751)]
    places += [(folder / m.name, pwd.getpwnam(m.name).pw_uid, 0o750) for m in members]
    for place, owner, mode in places:
        place.mkdir(exist_ok=True)
        os.chown(place, owner, number)
        place.chmod(mode)
    known = {member.name for member in members}
    for place in folder.iterdir():
        # Its account may be gone, and the next one get its number.
        if place.name not in known:
            os.chown(place, 0, number)
            place.chmod(0o750)


def make_private_folder(folder: Path, names: Iterable[str]) -> str:
    """Make sure that servers have a place for their certificates and temporary files.

    What is left there of others goes: another account may have got their number. What those still
    run, with a server of this hub, ends before.

    Args:
        folder: The folder of one class.
        names: The members of the class.

    Returns:
        A sentence about what could not be removed, '' if nothing is left.
    """
    folder.mkdir(exist_ok=True)
    folder.chmod(0o711)
    names = list(names)
    for name in _members():
        if name not in names and (folder / name).exists():
            end_processes(name)
    kept = {leftovers.ASIDE, *(place for name in names for place in (name, f'{name}-tmp'))}
    said = [leftovers.remove(place) for place in [*folder.iterdir()] if place.name not in kept]
    return said[-1] if said else ''


def end_processes(name: str) -> None:
    """End all that an account runs, also what is no child of its server, as behind `nohup`."""
    # In one moment: one after the other they could begin anew.
    subprocess.run(['runuser', '-u', name, '--', 'kill', '-KILL', '--', '-1'])


def _members() -> list[str]:
    try:
        return grp.getgrnam(GROUP).gr_mem
    except KeyError:
        return []


def _exists(name: str) -> bool:
    try:
        pwd.getpwnam(name)
    except KeyError:
        return False
    return True


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise LabError(f'{" ".join(command)} failed: {done.stderr.strip()}')
