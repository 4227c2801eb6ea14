"""The numbers of ROS domains: which are safe, which lie between two others, and their ports."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from labkit.errors import LabError

__all__ = [
    'BETWEEN',
    'LAST_DOMAIN_ID',
    'PORT_BETWEEN',
    'PROFILE',
    'PROFILES_FILE',
    'between_is_possible',
    'check_domain_id',
    'check_profile',
    'check_shared_domain_id',
    'choose_profile',
    'counts_ports',
    'first_port',
    'read_domain_id',
    'read_shared_domain_id',
    'set_domain',
]

# Domains 0 to 101 are safe on Linux: above them the ports of DDS overlap with the range that the
# system hands out by itself (docs.ros.org, "The ROS_DOMAIN_ID"). Those of 215 to 232 lie above it,
# and then there are no ports left.
LAST_DOMAIN_ID = 101
_FIRST_ABOVE, _LAST_OF_ALL = 215, 232

# A hundred domains are too few for a class, and each has more ports than it uses: 250, of which
# the 32 processes that look for each other on one machine take 64 (rmw_fastrtps asks Fast DDS for
# so many, `maxInitialPeersRange`). So there is room for three more domains between two. With the
# profile `domains_between.xml`, Fast DDS counts ports instead of domains: domain 4776 begins 4776
# ports after port 7000. No such number is one of 0 to 232, and a program without the profile ends
# with the words that the number is too high. It never lands in the domain of somebody else.
#
# A process is looked for at every second port. The domains begin 63 ports after each other, so
# those of neighbours are even and odd in turn: only with 63 processes does one meet the next but
# one.
_PORT, _PORTS = 7400, 250
PORT_BETWEEN = 7000
_STEP = 63
# After 101 and after 232 there is no room: ports that the system hands out, and the last port.
_SAFE = (*range(1, LAST_DOMAIN_ID), *range(_FIRST_ABOVE, _LAST_OF_ALL))
BETWEEN = tuple(
    _PORT - PORT_BETWEEN + _PORTS * domain_id + _STEP * place
    # Those in the middle first, they are the furthest from others.
    for place in (2, 1, 3)
    for domain_id in _SAFE
)
"""The numbers of the domains that lie between two others."""

PROFILES_FILE = 'FASTRTPS_DEFAULT_PROFILES_FILE'
"""The variable that tells Fast DDS 2 (Jazzy's) where the profile lies."""
PROFILE = Path(__file__).with_name('background') / 'domains_between.xml'


def read_domain_id() -> int | None:
    """Return the domain that `ROS_DOMAIN_ID` asks for, None if it is not set.

    Raises:
        LabError: It is set to something that is not a domain.
    """
    otherwise = 'then each notebook takes a domain of its own.'
    return _read_domain('ROS_DOMAIN_ID', BETWEEN, otherwise)


def read_shared_domain_id() -> int | None:
    """Return the domain that `LABKIT_SHARED_DOMAIN_ID` asks for, None if it is not set.

    Raises:
        LabError: It is set to something that is not a domain that every computer knows.
    """
    return _read_domain('LABKIT_SHARED_DOMAIN_ID', (), 'then lab.join() takes one that is free.')


def _read_domain(variable: str, more: Sequence[int], otherwise: str) -> int | None:
    text = os.environ.get(variable, '')
    if not text:
        return None
    domain_id = _number(text)
    if domain_id is None or (domain_id > _LAST_OF_ALL and domain_id not in more):
        raise LabError(
            f'{variable} must be a number from 0 to {LAST_DOMAIN_ID}, but it is {text!r}.',
            todo=f'Set it to a number, or unset it: {otherwise}',
        )
    return domain_id


def _number(text: str) -> int | None:
    return int(text) if text.isdecimal() and len(text) < 6 else None


def check_domain_id(domain_id: object) -> None:
    """Raise a LabError unless `domain_id` is None or a domain that a notebook may be in."""
    _check(domain_id, (*range(LAST_DOMAIN_ID + 1), *BETWEEN), ', or that of another notebook')


def check_shared_domain_id(domain_id: object) -> None:
    """Raise a LabError unless `domain_id` is None or a domain that every computer knows."""
    _check(domain_id, range(_LAST_OF_ALL + 1), '')


def _check(domain_id: object, good: Sequence[int], more: str) -> None:
    if domain_id is None or (isinstance(domain_id, int) and domain_id in good):
        return
    raise LabError(
        f'domain_id must be a whole number from 0 to {LAST_DOMAIN_ID}{more}, but it is '
        f'{domain_id!r}.'
    )


def first_port(domain_id: int) -> int:
    """Return the first of the ports that belong to a domain."""
    if domain_id in BETWEEN:
        return PORT_BETWEEN + domain_id
    return _PORT + _PORTS * domain_id


def set_domain(domain_id: int) -> None:
    """Let ROS take part in a domain, in this process and in those that it starts.

    Raises:
        LabError: See `check_profile`.
    """
    check_profile(domain_id)
    os.environ['ROS_DOMAIN_ID'] = str(domain_id)
    choose_profile()


def check_profile(domain_id: int) -> None:
    """Raise a LabError if the variables keep Fast DDS from the domains between, and it is one."""
    if domain_id in BETWEEN and not between_is_possible():
        raise LabError(
            f'Domain {domain_id} needs Fast DDS, and a profile of its own, but these are set: '
            f'RMW_IMPLEMENTATION={os.environ.get("RMW_IMPLEMENTATION", "")} '
            f'{PROFILES_FILE}={os.environ.get(PROFILES_FILE, "")}',
            todo='Unset them and restart the kernel, or choose a domain from 0 to '
            f'{LAST_DOMAIN_ID}.',
        )


def between_is_possible() -> bool:
    """Tell whether ROS, as the variables are, can take part in a domain between two others."""
    middleware = os.environ.get('RMW_IMPLEMENTATION', '')
    free = not os.environ.get(PROFILES_FILE) or counts_ports()
    return free and middleware in ('', 'rmw_fastrtps_cpp')


def counts_ports() -> bool:
    """Tell whether the variables name the profile of the domains between."""
    # Perhaps that of another environment: it is the same.
    return Path(os.environ.get(PROFILES_FILE, '')).name == PROFILE.name


def choose_profile() -> None:
    """Name the profile that `ROS_DOMAIN_ID` needs. One that the learner has named stays."""
    if _number(os.environ.get('ROS_DOMAIN_ID', '')) in BETWEEN:
        if between_is_possible():
            os.environ[PROFILES_FILE] = str(PROFILE)
    elif counts_ports():
        del os.environ[PROFILES_FILE]
