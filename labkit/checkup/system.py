"""Network, shared memory, disk and compiler."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import struct
import sys
import tempfile
from pathlib import Path

from labkit import settings
from labkit.errors import LabError
from labkit.setup.compiler import check_compiler

__all__ = ['compiler', 'disk', 'network', 'shared_memory']

SHARED_MEMORY = Path('/dev/shm')
# Fast DDS takes 0.65 MB per process.
SHARED_MEMORY_BYTES = 8_000_000
# A bag of one hour of odometry is 80 MB.
DISK_BYTES = 200_000_000
# Discovery group of DDS: DDSI-RTPS 2.5, 9.6.1.4.1.
MULTICAST_GROUP = '239.255.0.1'
ANSWER_SEC = 0.5


def network() -> str:
    """Check that packets come back on the loopback interface, and by multicast."""
    try:
        _send_and_receive('127.0.0.1')
    except OSError as error:
        raise LabError(
            f'A packet sent to this machine itself (127.0.0.1) does not arrive: {error}.',
            todo='Switch the loopback interface on (sudo ip link set lo up), or let the firewall '
            'pass it. Processes find each other through it.',
        ) from error
    others = [(index, name) for index, name in socket.if_nameindex() if name != 'lo']
    names = [name for index, name in others if _multicast_works(index)]
    if names:
        return 'loopback works, and multicast on ' + ', '.join(names)
    value = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE', '')
    if value not in ('SUBNET', 'SYSTEM_DEFAULT'):
        return 'loopback works; multicast, which only other machines would need, does not'
    raise LabError(
        f'ROS_AUTOMATIC_DISCOVERY_RANGE is {value!r}, so other machines are looked for by '
        'multicast, but a multicast packet does not come back on any network.',
        todo='Connect to the network and let the firewall pass UDP, or name the other '
        "machines: ROS_STATIC_PEERS='192.168.1.7;192.168.1.8'",
    )


def _multicast_works(interface: int) -> bool:
    # struct ip_mreqn, see ip(7)
    place = struct.pack('4s4si', socket.inet_aton(MULTICAST_GROUP), bytes(4), interface)
    try:
        _send_and_receive(MULTICAST_GROUP, place)
    except OSError:
        return False
    return True


def _send_and_receive(address: str, place: bytes = b'') -> None:
    """Send a packet and wait for it to come back.

    Args:
        address: Destination.
        place: For a multicast group: the network interface.

    Raises:
        OSError: It can't be sent, or does not come back.
    """
    word = os.urandom(8)
    with contextlib.ExitStack() as stack:
        receiver = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sender = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        receiver.bind((address, 0))
        receiver.settimeout(ANSWER_SEC)
        if place:
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, place)
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, place)
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)  # not beyond here
        sender.sendto(word, (address, receiver.getsockname()[1]))
        while receiver.recv(64) != word:
            pass


def shared_memory() -> str:
    """Check the memory through which processes on one machine exchange messages."""
    if not SHARED_MEMORY.is_dir() or not os.access(SHARED_MEMORY, os.W_OK | os.X_OK):
        raise LabError(
            f'{SHARED_MEMORY} can not be written to; messages between processes pass through it.',
            todo=f'Make it writable: sudo mount -o remount,rw,mode=1777 {SHARED_MEMORY}',
        )
    stale, size = _stale_files()
    left = f'{stale} files ({size / 1e6:.1f} MB) of killed processes are left' if stale else ''
    free = shutil.disk_usage(SHARED_MEMORY).free
    if free >= SHARED_MEMORY_BYTES:
        text = f'{free / 1e6:.0f} MB free'
        return f'{text}; {left}, which does no harm' if left else text
    clean = f'Remove what killed processes left: {Path(sys.prefix, "bin", "fastdds")} shm clean'
    raise LabError(
        f'{SHARED_MEMORY} has {free / 1e6:.1f} MB free; '
        f'ROS needs {SHARED_MEMORY_BYTES / 1e6:.0f} MB.' + (f' {left}.' if left else ''),
        todo=clean if stale else 'Make it larger. For a container: docker run --shm-size=256m',
    )


def _stale_files() -> tuple[int, int]:
    """Return number and size in bytes of Fast DDS's files that belong to no living process.

    A process locks the file of a segment or port through a second file whose name ends in `_el`.
    Locks are read from the system's list: trying one would disturb its owner.
    """
    device = os.stat(SHARED_MEMORY).st_dev
    # The list names a file by device, in hexadecimal, and inode. See proc_locks(5).
    start = f'{os.major(device):02x}:{os.minor(device):02x}:'
    with open('/proc/locks', encoding='ascii') as file:
        locked = {line.split()[-3] for line in file}
    count = size = 0
    for lock in SHARED_MEMORY.glob('fastrtps_*_el'):
        name = lock.name[: -len('_el')]
        with contextlib.suppress(OSError):  # another process may remove it just now
            if f'{start}{lock.stat().st_ino}' in locked:
                continue
            for path in (lock, SHARED_MEMORY / name, SHARED_MEMORY / f'sem.{name}_mutex'):
                with contextlib.suppress(FileNotFoundError):
                    size += 512 * path.stat().st_blocks
                    count += 1
    return count, size


def disk() -> str:
    """Check the disk space for the learner's files and labkit's state."""
    folder, state = Path.cwd(), settings.state_dir()
    existing = next(path for path in (state, *state.parents) if path.exists())
    for path in (folder, existing):
        try:
            with tempfile.TemporaryFile(dir=path):
                pass
        except OSError as error:
            raise LabError(
                f'{str(path)!r} can not be written to: {error.strerror}.',
                todo='Work in a folder of your own, and set LABKIT_HOME to one for your progress.',
            ) from error
        free = shutil.disk_usage(path).free
        if free < DISK_BYTES:
            raise LabError(
                f'{free / 1e6:.0f} MB are free in {str(path)!r}; '
                f'the course needs {DISK_BYTES / 1e6:.0f} MB.',
                todo='Delete what is not needed: old bags, downloads, the trash.',
            )
    return f'{shutil.disk_usage(folder).free / 1e9:.1f} GB free'


def compiler() -> str:
    """Check the compiler for interfaces. Only lesson 12 needs it, so it may be missing."""
    try:
        return check_compiler()
    except LabError as error:
        return f'{error.message} Only lesson 12 builds any; it is installed with: {error.todo}'
