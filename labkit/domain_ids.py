"""ROS domain ids: which are safe, the extra ones between two others, and their ports."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from labkit.errors import LabError

__all__ = [
    'BETWEEN',
    'LAST_DOMAIN_ID',
    'PORT_BETWEEN',
    'PROFILE',
    'PROFILES_FILE',
    'THIS_MACHINE',
    'between_is_possible',
    'check_domain_id',
    'check_profile',
    'check_shared_domain_id',
    'choose_profile',
    'counts_ports',
    'first_port',
    'how_to_join',
    'is_ours',
    'ports',
    'ports_of_participants',
    'read_domain_id',
    'read_shared_domain_id',
    'set_domain',
    'stays_here',
]

# Domains 0 to 101 are safe on Linux: above them the ports of DDS overlap with the ephemeral ports
# of the system (docs.ros.org, "The ROS_DOMAIN_ID"). Those of 215 to 232 are above that range, and
# after them there are no ports left.
LAST_DOMAIN_ID = 101
_FIRST_ABOVE, _LAST_OF_ALL = 215, 232

# A hundred domains are too few for a class, and each has more ports than it uses: 250, of which
# the 32 processes that look for each other on one machine take 64 (rmw_fastrtps sets
# `maxInitialPeersRange` of Fast DDS to 32). So there is room for three more domains between two.
# With the profile `domains_between.xml`, Fast DDS counts ports instead of domains: domain 4776
# starts 4776 ports after port 7000. No such number is in 0 to 232, and a program without the
# profile ends with the error that the number is too high. It never ends up in the domain of
# somebody else.
#
# Processes use every second port. The domains are 63 ports apart, so those of neighbours are
# alternately even and odd: only with 63 processes does one meet the next but one.
_PORT, _PORTS = 7400, 250
PORT_BETWEEN = 7000
_STEP = 63
# After 101 and after 232 there is no room: ephemeral ports, and the last port.
_SAFE = (*range(1, LAST_DOMAIN_ID), *range(_FIRST_ABOVE, _LAST_OF_ALL))
BETWEEN = tuple(
    _PORT - PORT_BETWEEN + _PORTS * domain_id + _STEP * place
    # Those in the middle first: they are furthest from others.
    for place in (2, 1, 3)
    for domain_id in _SAFE
)
"""The ids of the domains between two others."""

PROFILES_FILE = 'FASTRTPS_DEFAULT_PROFILES_FILE'
"""The variable with the path of the profile for Fast DDS 2 (Jazzy)."""
PROFILE = Path(__file__).with_name('sharing') / 'domains_between.xml'
"""That of the domains between."""
THIS_MACHINE = PROFILE.with_name('this_machine.xml')
"""That of the other domains, while nothing says that other computers may take part."""
# Other computers may take part if one of these is set, or the range is wider.
_RANGE, _OTHERS = 'ROS_AUTOMATIC_DISCOVERY_RANGE', ('ROS_STATIC_PEERS', 'ROS_DISCOVERY_SERVER')


def read_domain_id() -> int | None:
    """Return the domain set in `ROS_DOMAIN_ID`, None if it is not set.

    Raises:
        LabError: It is not a domain.
    """
    otherwise = 'then each notebook takes a domain of its own.'
    return _read_domain('ROS_DOMAIN_ID', BETWEEN, otherwise)


def read_shared_domain_id() -> int | None:
    """Return the domain set in `LABKIT_SHARED_DOMAIN_ID`, None if it is not set.

    Raises:
        LabError: It is not a domain that every computer knows.
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
    """Return the first port of a domain."""
    if domain_id in BETWEEN:
        return PORT_BETWEEN + domain_id
    return _PORT + _PORTS * domain_id


def ports(domain_id: int) -> range:
    """Return the ports that processes of a domain have."""
    return range(first_port(domain_id), first_port(domain_id) + _STEP)


def ports_of_participants(domain_id: int) -> range:
    """Return the ports of participants in a domain, one for each: DDSI-RTPS 2.5, 9.6.2.3.

    It is that of the domain + 10 + 2 * participant. Fast DDS looks for 32 on this machine; the
    next ports belong to another domain.
    """
    first = first_port(domain_id) + 10
    return range(first, first + 2 * 32, 2)


def set_domain(domain_id: int) -> None:
    """Make ROS join a domain, in this process and its children.

    Raises:
        LabError: See `check_profile`.
    """
    check_profile(domain_id)
    os.environ['ROS_DOMAIN_ID'] = str(domain_id)
    choose_profile()


def check_profile(domain_id: int) -> None:
    """Raise a LabError if a domain lies between two others and the variables rule that out."""
    if domain_id in BETWEEN and not between_is_possible():
        names = 'RMW_IMPLEMENTATION', PROFILES_FILE, _RANGE, *_OTHERS
        raise LabError(
            f'Domain {domain_id} needs Fast DDS, a profile of its own, and nobody from outside, '
            f'but these are set: {" ".join(f"{n}={os.environ[n]}" for n in names if _is_set(n))}',
            todo='Unset them and restart the kernel, or choose a domain from 0 to '
            f'{LAST_DOMAIN_ID}.',
        )


def stays_here() -> bool:
    """Return whether the variables say that no other computer may take part."""
    reach = os.environ.get(_RANGE)
    return reach == 'OFF' or (reach == 'LOCALHOST' and not any(map(_is_set, _OTHERS)))


def between_is_possible() -> bool:
    """Return whether the variables allow domains between two others."""
    return _is_free() and stays_here()


def _is_free() -> bool:
    """Return whether Fast DDS is used, with no profile of the learner's own."""
    middleware = os.environ.get('RMW_IMPLEMENTATION', '')
    profile = os.environ.get(PROFILES_FILE, '')
    return (not profile or is_ours(profile)) and middleware in ('', 'rmw_fastrtps_cpp')


def _is_set(variable: str) -> bool:
    return bool(os.environ.get(variable))


def is_ours(profile: str) -> bool:
    """Return whether a profile is one of labkit's."""
    # Maybe that of another environment, which is the same.
    return Path(profile).name in (PROFILE.name, THIS_MACHINE.name)


def counts_ports(variables: Mapping[str, str] = os.environ) -> bool:
    """Return whether the variables name the profile of the domains between."""
    return Path(variables.get(PROFILES_FILE, '')).name == PROFILE.name


def how_to_join(domain_id: int, *, profile: Path | None = None) -> str:
    """Return the line that lets what a terminal starts join a domain, also plain `python3`.

    Args:
        domain_id: The domain.
        profile: The profile that is set even if the domain needs none.
    """
    profile = PROFILE if domain_id in BETWEEN else profile
    more = f' {PROFILES_FILE}={shlex.quote(str(profile))}' if profile else ''
    return f'export ROS_DOMAIN_ID={domain_id}{more}'


def choose_profile() -> None:
    """Set the profile that the other variables need, unless the learner has set one."""
    if not _is_free():
        return
    if _number(os.environ.get('ROS_DOMAIN_ID', '')) in BETWEEN and stays_here():
        os.environ[PROFILES_FILE] = str(PROFILE)
    elif os.environ.get(_RANGE) == 'LOCALHOST' and stays_here():
        os.environ[PROFILES_FILE] = str(THIS_MACHINE)
    else:
        os.environ.pop(PROFILES_FILE, None)
