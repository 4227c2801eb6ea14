"""First passwords, made by chance; what is kept for logging in are their hashes."""

from __future__ import annotations

import dbm
import secrets
from collections.abc import Iterable
from pathlib import Path

import bcrypt

from labkit.files import write_atomically

__all__ = ['FIRST_PASSWORDS', 'HASHES', 'make_passwords']

HASHES = 'passwords.dbm'
"""What jupyterhub-firstuseauthenticator compares with: names and hashes."""
FIRST_PASSWORDS = 'first-passwords.txt'
"""What the teacher hands out."""

# No signs that look like others, in three groups to be read from paper: 59 bits.
_SIGNS = 'abcdefghijkmnpqrstuvwxyz23456789'.replace('v', '')
_GROUPS, _SIGNS_EACH = 3, 4


def make_passwords(folder: Path, names: Iterable[str], *, anew: Iterable[str] = ()) -> list[str]:
    """Make a first password for everybody who has none.

    Args:
        folder: The hub's folder, which only root can look into.
        names: The members of the class.
        anew: Those of them who get another password, because they have forgotten theirs.

    Returns:
        Whose password is new; the file `FIRST_PASSWORDS` tells it.
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
