"""Random first passwords, and their hashes for logging in."""

from __future__ import annotations

import dbm
import os
import secrets
from collections.abc import Iterable
from pathlib import Path

import bcrypt

from labkit.files import write_atomically

__all__ = ['FIRST_PASSWORDS', 'HASHES', 'make_passwords', 'names_with_password']

HASHES = 'passwords.dbm'
"""Names and hashes, for jupyterhub-firstuseauthenticator."""
FIRST_PASSWORDS = 'first-passwords.txt'
"""The passwords for the teacher to hand out."""

# No look-alike characters, in three groups to be read from paper: 59 bits.
_SIGNS = 'abcdefghijkmnpqrstuvwxyz23456789'.replace('v', '')
_GROUPS, _SIGNS_EACH = 3, 4


def names_with_password(folder: Path) -> set[str]:
    """Return who has a password on the hub of a folder: all who were of the class ever."""
    try:
        with dbm.open(str(folder / HASHES), 'r') as hashes:
            return {os.fsdecode(name) for name in hashes.keys()}  # noqa: SIM118 (a dbm has no more)
    except dbm.error:
        return set()


def make_passwords(folder: Path, names: Iterable[str], *, anew: Iterable[str] = ()) -> list[str]:
    """Make a first password for everybody without one.

    Args:
        folder: The hub's folder, readable for root only.
        names: The members of the class.
        anew: Members who get a new password, because they have forgotten theirs.

    Returns:
        The names with new passwords, which are in the file `FIRST_PASSWORDS`.
    """
    with dbm.open(str(folder / HASHES), 'c', 0o600) as hashes:
        wanted = [name for name in names if name in set(anew) or name.encode() not in hashes]
        new = {name: _password() for name in wanted}
        for name, password in new.items():
            hashes[name] = bcrypt.hashpw(password.encode(), bcrypt.gensalt())
    if new:
        path = folder / FIRST_PASSWORDS
        kept = path.read_text(encoding='utf-8').splitlines() if path.exists() else []
        known = dict(line.split() for line in kept) | new
        width = max(map(len, known))
        text = ''.join(f'{name:<{width}}  {password}\n' for name, password in known.items())
        write_atomically(path, text.encode())
    return list(new)


def _password() -> str:
    groups = (''.join(secrets.choice(_SIGNS) for _ in range(_SIGNS_EACH)) for _ in range(_GROUPS))
    return '-'.join(groups)
