"""A ROS domain for each notebook: claimed while its kernel lives, found by its terminals.

The first hundred take domains that every program knows, the others those of `domain_ids.BETWEEN`.
"""

from __future__ import annotations

import errno
import os
import socket
import zlib
from pathlib import Path

from labkit.domain_ids import (
    BETWEEN,
    LAST_DOMAIN_ID,
    PORT_BETWEEN,
    between_is_possible,
    counts_ports,
    first_port,
)
from labkit.errors import LabError
from labkit.settings import notebook_name

__all__ = [
    'DomainClaim',
    'claim_domain',
    'claimed_domains',
    'first_node_is_made',
    'number_for_ros',
]

# Domain 0 is everybody's default, so a notebook takes one of the others.
_KNOWN = range(1, LAST_DOMAIN_ID + 1)
# Domains that notebooks leave to what they share with other computers. Of those from 102 on, the
# system may have given a port to another program: then Fast DDS takes the next one.
_FOR_SHARING = (*range(215, 233), *range(LAST_DOMAIN_ID + 1, 215))
# Names of sockets, see `DomainClaim`. The first holds for all users of the machine, the second
# tells terminals of one user which of the notebooks are theirs.
_CLAIM = 'labkit/ros-domain/{domain_id}'
_NOTEBOOK = 'labkit/notebook/{user_id}/{domain_id}/'
# Bytes in the name of a socket, the zero at its start included (unix(7), sun_path).
_LONGEST = 108

# Whether Fast DDS counts ports in this process, None before it has read a profile.
_counts_ports: bool | None = None


class DomainClaim:
    """A ROS domain that no other notebook on this machine uses while this process lives.

    The claim is the name of a socket in Linux's abstract namespace. It takes no file, it counts
    for all users of the machine, and it ends with the process, however the process ends.

    Args:
        domain_id: The domain to claim.
        listed: Whether terminals find it as the domain of this notebook.

    Raises:
        BlockingIOError: Another process has claimed it.
        OSError: The system refuses, for another reason.
    """

    def __init__(self, domain_id: int, *, listed: bool = True) -> None:
        self.domain_id = domain_id
        notebook = Path(notebook_name()).name or f'process {os.getpid()}'
        # The second one tells others which notebook it is.
        start = _NOTEBOOK.format(user_id=os.getuid(), domain_id=domain_id)
        self._sockets: list[socket.socket] = []
        try:
            names = (_CLAIM.format(domain_id=domain_id), start + _printable(notebook))
            for name in names if listed else names[:1]:
                self._sockets.append(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
                self._sockets[-1].bind(_address(name))
        except OSError as error:
            self.close()
            if error.errno == errno.EADDRINUSE:
                raise BlockingIOError(f'domain {domain_id} is taken') from error
            raise

    def close(self) -> None:
        """Give the domain back."""
        for claim in self._sockets:
            claim.close()


def claim_domain(*, shared: bool = False, other_than: int | None = None) -> DomainClaim:
    """Claim a domain that no other notebook has.

    The first hundred notebooks have domains that every program knows, the others have one between
    two of those (`domain_ids.BETWEEN`). The search starts from a number made from the notebook's
    name, so that a notebook whose kernel is restarted mostly meets its own domain again.

    Args:
        shared: Whether it is to be shared with other computers, which know domains up to 232. It
            is not listed as the domain of this notebook.
        other_than: A domain that is not wanted, though nobody may have claimed it.

    Raises:
        LabError: All domains are taken, or the system lets none be claimed.
    """
    name = notebook_name() or str(os.getpid())
    first = zlib.crc32(name.encode(errors='replace')) % len(_KNOWN)
    wanted = [*_KNOWN[first:], *_KNOWN[:first]]
    if shared:
        wanted += _FOR_SHARING
    elif between_is_possible():
        wanted += BETWEEN
    for domain_id in wanted:
        if domain_id == other_than:
            continue
        try:
            return DomainClaim(domain_id, listed=not shared)
        except BlockingIOError:
            continue
        except OSError as error:
            raise LabError(
                f'The system does not let a ROS domain be claimed: {error}.',
                todo='Choose a domain yourself: lab.start(domain_id=7)',
            ) from error
    raise LabError(
        f'All {len(wanted)} ROS domains of this machine are in use by other notebooks.',
        todo='Shut down kernels that are not needed any more (in JupyterLab: the square symbol '
        'at the left), or share a domain on purpose: '
        + ('lab.join(..., domain_id=7).' if shared else 'lab.start(domain_id=7).'),
    )


def claimed_domains() -> dict[int, str]:
    """Return the domains that this user's notebooks have claimed, and the notebooks' names.

    The names are text of others: what is no printable character in them is shown as `?`.
    """
    try:
        table = Path('/proc/net/unix').read_text(encoding='utf-8', errors='replace')
    except OSError:
        return {}
    start = _NOTEBOOK.format(user_id=os.getuid(), domain_id='').rstrip('/') + '/'
    known = {str(domain_id) for domain_id in (*_KNOWN, *BETWEEN)}
    found = {}
    for line in table.splitlines():
        _, sign, name = line.partition(f'@{start}')
        domain_id, slash, notebook = name.partition('/')
        if sign and slash and domain_id in known:
            found[int(domain_id)] = _printable(notebook)
    return dict(sorted(found.items()))


def number_for_ros(domain_id: int) -> int:
    """Return the number by which ROS in this process knows a domain.

    Fast DDS reads its profile once, when the first node of a process is made. If that was the
    one of the domains between (`domain_ids.BETWEEN`), it counts ports from then on.

    Args:
        domain_id: The domain, as `ROS_DOMAIN_ID` has it.

    Raises:
        LabError: It lies between two others, and the first node was made without that profile.
    """
    counts = domain_id in BETWEEN if _counts_ports is None else _counts_ports
    if counts:
        return first_port(domain_id) - PORT_BETWEEN
    if domain_id in BETWEEN:
        raise LabError(
            f'Domain {domain_id} can only be the first that a notebook takes part in.',
            todo=f'Restart the kernel, and begin with lab.start(domain_id={domain_id}).',
        )
    return domain_id


def first_node_is_made() -> None:
    """Note which profile Fast DDS has read; called when this process has made a node."""
    global _counts_ports
    if _counts_ports is None:
        _counts_ports = counts_ports()


def _address(name: str) -> bytes:
    """Return a name as the address of an abstract socket, with as much of its end as fits."""
    start, slash, end = name.rpartition('/')
    room = _LONGEST - 1 - len(f'{start}{slash}'.encode())
    kept = end.encode()[-room:].decode(errors='ignore')
    return b'\0' + f'{start}{slash}{kept}'.encode()


def _printable(text: str) -> str:
    """Return text without what could move a terminal's cursor, or end a line."""
    text = text.encode(errors='replace').decode()
    return ''.join(char if char.isprintable() else '?' for char in text)
