"""A ROS domain for each notebook, claimed while its kernel lives, and found by its terminals."""

from __future__ import annotations

import errno
import os
import pwd
import socket
import sys
import zlib
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from labkit.background.fast_dds import use_profile
from labkit.domain_ids import (
    BETWEEN,
    LAST_DOMAIN_ID,
    PORT_BETWEEN,
    PROFILE,
    PROFILES_FILE,
    between_is_possible,
    first_port,
    is_ours,
    ports_of_participants,
)
from labkit.errors import LabError, printable
from labkit.settings import notebook_name

__all__ = [
    'DomainClaim',
    'claim_domain',
    'claimed_domains',
    'domains_of_programs',
    'first_node_is_made',
    'follow_profile',
    'number_for_ros',
    'open_ports',
    'opened',
    'other_accounts_in',
]

# Without domain 0, which is everybody's default.
_KNOWN = range(1, LAST_DOMAIN_ID + 1)
# Domains used only for sharing with other computers. From 102 on the system may have given a port
# to another program: then Fast DDS takes the next one.
_FOR_SHARING = (*range(215, 233), *range(LAST_DOMAIN_ID + 1, 215))
# Of the ports of a domain, one that no process of it uses, nor of a domain beside it.
_CLAIM_PORT = 4
# Whom a claim's socket is connected to: so terminals find the domain of a notebook, and pass over
# one that is only shared.
_LISTED, _UNLISTED = '127.0.0.1', '127.0.0.2'
_READINGS = 100
# As the kernel's table has them: four bytes, read as a number of this machine.
_PEERS = {
    f'{int.from_bytes(socket.inet_aton(peer), sys.byteorder):08X}': peer
    for peer in (_LISTED, _UNLISTED)
}

# The file of the profile that Fast DDS uses in this process, '' for none; None until it reads one.
_profile: str | None = None


class DomainClaim:
    """A ROS domain that no other notebook on this machine uses while this process lives.

    The claim is a UDP socket on one of the domain's ports, from which nothing is sent. It needs no
    file, is visible to all users of the machine with the account that holds it, which nobody can
    forge, and ends with the process, however the process ends.

    Args:
        domain_id: The domain to claim.
        listed: Whether terminals find it as the domain of this notebook.
        beside: An account whose claims don't count.

    Raises:
        BlockingIOError: Another process has claimed it.
        OSError: The system refuses for another reason.
    """

    def __init__(self, domain_id: int, *, listed: bool = True, beside: int | None = None) -> None:
        self.domain_id = domain_id
        port = _claim_port(domain_id)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            try:
                self._socket.bind((_LISTED, port))
            except OSError as error:
                if error.errno != errno.EADDRINUSE or beside is None:
                    raise
                self._socket.bind((_LISTED, 0))
            # Seen by others even where the port is somebody else's.
            self._socket.connect((_LISTED if listed else _UNLISTED, port))
            own = os.fstat(self._socket.fileno()).st_ino
            if any(
                port in (other.port, other.peer_port) and other.inode != own
                for other in _udp_sockets()
                if other.user_id != beside
            ):
                raise OSError(errno.EADDRINUSE, os.strerror(errno.EADDRINUSE))
        except OSError as error:
            self.close()
            if error.errno == errno.EADDRINUSE:
                raise BlockingIOError(f'domain {domain_id} is taken') from error
            raise

    def close(self) -> None:
        """Release the domain."""
        self._socket.close()


def claim_domain(*, shared: bool = False, other_than: int | None = None) -> DomainClaim:
    """Claim a domain that no other notebook has.

    The first hundred notebooks get ordinary domains, the others those between them
    (`domain_ids.BETWEEN`). The search starts from a hash of the notebook's name, so a notebook
    usually has the same domain after a restart of its kernel. When all are taken, one of those of
    the account that holds the most is taken, unless that is this one.

    Args:
        shared: Whether to share it with other computers, which know domains up to 232. It is not
            listed as the domain of this notebook.
        other_than: A domain to exclude.

    Raises:
        LabError: All domains are taken, or the system refuses.
    """
    name = notebook_name() or str(os.getpid())
    first = zlib.crc32(name.encode(errors='replace')) % len(_KNOWN)
    wanted = [*_KNOWN[first:], *_KNOWN[:first]]
    if shared:
        wanted += _FOR_SHARING
    elif between_is_possible():
        wanted += BETWEEN
    others = [domain_id for domain_id in wanted if domain_id != other_than]
    claim = _first_free(others, listed=not shared)
    if claim is not None:
        return claim
    user_id, count = _greediest(wanted)
    if user_id is not None:
        claim = _first_free(others, listed=not shared, beside=user_id)
    if claim is not None:
        print(
            f'All {len(wanted)} ROS domains of this machine are taken, {count} of them by '
            f'{_account(user_id)}. This notebook takes domain {claim.domain_id} nevertheless: '
            'nodes of that account in it hear yours, and yours hear them.'
        )
        return claim
    raise LabError(
        f'All {len(wanted)} ROS domains of this machine are in use by other notebooks.',
        todo='Shut down kernels that are not needed any more (in JupyterLab: the square symbol '
        'at the left), or share a domain on purpose: '
        + ('lab.join(..., domain_id=7).' if shared else 'lab.start(domain_id=7).'),
    )


def _first_free(
    wanted: list[int], *, listed: bool, beside: int | None = None
) -> DomainClaim | None:
    taken = {
        port
        for other in _udp_sockets()
        if other.user_id != beside
        for port in (other.port, other.peer_port)
    }
    for domain_id in wanted:
        if _claim_port(domain_id) in taken:
            continue
        try:
            return DomainClaim(domain_id, listed=listed, beside=beside)
        except BlockingIOError:
            continue
        except OSError as error:
            raise LabError(
                f'The system does not let a ROS domain be claimed: {error}.',
                todo='Choose a domain yourself: lab.start(domain_id=7)',
            ) from error
    return None


def _greediest(wanted: list[int]) -> tuple[int | None, int]:
    """Return the account that holds most of some domains, and how many; None if it is this one."""
    ports = {_claim_port(domain_id) for domain_id in wanted}
    held = {(s.user_id, port) for s in _udp_sockets() for port in (s.port, s.peer_port)}
    counts = Counter(user_id for user_id, port in held if port in ports)
    user_id, count = max(counts.items(), key=lambda item: (item[1], -item[0]), default=(None, 0))
    return (user_id, count) if count > counts[os.getuid()] else (None, count)


def claimed_domains() -> dict[int, str]:
    """Return the domains that this user's notebooks have claimed, with the notebooks' names.

    The notebook whose kernel was started last comes first.
    """
    known = {_claim_port(domain_id): domain_id for domain_id in (*_KNOWN, *BETWEEN)}
    found = {
        known[each.peer_port]: each.inode
        for each in _udp_sockets()
        if each.user_id == os.getuid() and each.peer == _LISTED and each.peer_port in known
    }
    names = _notebooks(set(found.values())) if found else {}
    told = {domain_id: names.get(found[domain_id], (0, 'a notebook')) for domain_id in found}
    newest_first = sorted(told, key=lambda domain_id: (-told[domain_id][0], domain_id))
    return {domain_id: told[domain_id][1] for domain_id in newest_first}


def domains_of_programs() -> list[int]:
    """Return the domains in which other programs of this user have nodes, but no notebook has."""
    own = _links(Path('/proc/self/fd'))
    opened = {
        each.port
        for each in _udp_sockets()
        if each.user_id == os.getuid() and f'socket:[{each.inode}]' not in own
    }
    notebooks = claimed_domains()
    return [
        domain_id
        for domain_id in range(LAST_DOMAIN_ID + 1)
        if domain_id not in notebooks and opened & {*ports_of_participants(domain_id)}
    ]


def other_accounts_in(domain_id: int) -> list[str]:
    """Return the other accounts of this machine that have nodes in a domain, in words."""
    its = {*ports_of_participants(domain_id)}
    users = {each.user_id for each in _udp_sockets() if each.port in its}
    return sorted(_account(user_id) for user_id in users - {os.getuid()})


def open_ports() -> set[int]:
    """Return the UDP ports that processes of this machine have opened."""
    return {each.port for each in _udp_sockets()}


class _UdpSocket(NamedTuple):
    port: int
    peer: str
    peer_port: int
    user_id: int
    inode: int


def _udp_sockets() -> list[_UdpSocket]:
    """Return the UDP sockets of this machine with their owners, as the kernel knows them.

    The kernel hands out its table in pieces, and finds the next piece by counting sockets. Where
    one before it has gone meanwhile, another is passed over; where one has come, another is there
    twice. So the table is whole if nothing is there twice, and if the next one is the same: what
    has gone would be missing in that.
    """
    before: list[int] = []
    # Somebody who opens and closes sockets without end must not hold up others.
    for _ in range(_READINGS):
        found = _read_udp_sockets()
        inodes = sorted(each.inode for each in found if each.inode)
        if inodes == before and len(set(inodes)) == len(inodes):
            break
        before = inodes
    return found


def _read_udp_sockets() -> list[_UdpSocket]:
    found = []
    for path in ('/proc/net/udp', '/proc/net/udp6'):
        try:
            lines = Path(path).read_text(encoding='ascii').splitlines()[1:]
        except OSError:
            continue
        for words in map(str.split, lines):
            port, peer_port = (int(word.rpartition(':')[2], 16) for word in words[1:3])
            peer = _PEERS.get(words[2].partition(':')[0], '')
            found.append(
                _UdpSocket(port, peer, peer_port if peer else 0, int(words[7]), int(words[9]))
            )
    return found


def _notebooks(inodes: set[int]) -> dict[int, tuple[int, str]]:
    """Return when this user's processes that hold some sockets began, and their notebooks."""
    wanted = {f'socket:[{inode}]': inode for inode in inodes}
    found = {}
    for process in Path('/proc').glob('[0-9]*'):
        for link in wanted.keys() & _links(process / 'fd'):
            name = printable(_name(process) or f'process {process.name}')
            found[wanted[link]] = _begun(process), name
    return found


def _links(folder: Path) -> set[str]:
    """Return where the links of a folder lead, of those that can be read."""
    found = set()
    with suppress(OSError):
        for name in os.listdir(folder):
            with suppress(OSError):
                found.add(os.readlink(folder / name))
    return found


def _begun(process: Path) -> int:
    """Return when a process began, in ticks since the start of the machine (proc(5)), or 0."""
    with suppress(OSError, ValueError, IndexError):
        return int((process / 'stat').read_text().rpartition(')')[2].split()[19])
    return 0


def _name(process: Path) -> str:
    """Return the notebook of a kernel, as the server has told it: only its user can read that."""
    with suppress(OSError):
        for variable in (process / 'environ').read_bytes().split(b'\0'):
            name, _, value = variable.partition(b'=')
            if name == b'JPY_SESSION_NAME':
                return Path(os.fsdecode(value)).name
    return ''


def _claim_port(domain_id: int) -> int:
    return first_port(domain_id) + _CLAIM_PORT


def _account(user_id: int | None) -> str:
    try:
        return f'the account {pwd.getpwuid(user_id or 0).pw_name}'
    except KeyError:
        return f'the account with the number {user_id}'


def number_for_ros(domain_id: int) -> int:
    """Return the number that `rclpy.init` in this process needs for a domain.

    With the profile of `domain_ids.BETWEEN`, domain ids are port numbers to Fast DDS.

    Args:
        domain_id: The domain, as in `ROS_DOMAIN_ID`.

    Raises:
        LabError: It is in `BETWEEN`, and Fast DDS has not that profile.
    """
    counts = domain_id in BETWEEN if _profile is None else Path(_profile).name == PROFILE.name
    if counts:
        return first_port(domain_id) - PORT_BETWEEN
    if domain_id in BETWEEN:
        raise LabError(
            f'Domain {domain_id} is one that only the whole notebook can be in.',
            todo=f'Call lab.stop(), then lab.start(domain_id={domain_id}).',
        )
    return domain_id


def first_node_is_made() -> None:
    """Note which profile Fast DDS has read for the first node of this process."""
    global _profile
    if _profile is None:
        _profile = os.environ.get(PROFILES_FILE, '')


def follow_profile() -> None:
    """Let Fast DDS, which reads its profile once, use the one that is set now.

    Raises:
        LabError: See `use_profile`.
    """
    wanted = os.environ.get(PROFILES_FILE, '')
    if _profile is not None and (not wanted or is_ours(wanted)):
        _use(wanted)


@contextmanager
def opened() -> Iterator[None]:
    """Let other computers reach the participants that are made meanwhile.

    Raises:
        LabError: See `use_profile`.
    """
    before = _profile or ''
    if not is_ours(before):
        yield
        return
    _use('')
    try:
        yield
    finally:
        _use(before)


def _use(path: str) -> None:
    global _profile
    if path != _profile:
        use_profile(path)
        _profile = path
