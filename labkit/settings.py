"""Environment variables, switches, and who looks at what is shown."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from labkit.errors import LabError

__all__ = [
    'BETWEEN',
    'LAST_DOMAIN_ID',
    'LEARNER',
    'PORT_BETWEEN',
    'PROFILE',
    'PROFILES_FILE',
    'RECORDING',
    'TERMINAL',
    'Audience',
    'audience',
    'between_is_possible',
    'check_domain_id',
    'check_profile',
    'check_shared_domain_id',
    'counts_ports',
    'dropped_variables',
    'first_port',
    'in_kernel',
    'notebook_name',
    'prepare_environment',
    'read_domain_id',
    'read_shared_domain_id',
    'set_domain',
    'state_dir',
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

# What `prepare_environment` has taken out of the environment, with the values.
dropped_variables: dict[str, str] = {}


def prepare_environment() -> None:
    """Set the variables that have to be there before ROS is loaded. What is set already wins."""
    # Without it `Int16(data=40000)` arrives as -25536 and nobody says a word.
    os.environ.setdefault('ROS_PYTHON_CHECK_FIELDS', '1')
    _drop_unusable_middleware()
    _find_own_commands()
    _choose_profile()
    # Only this machine takes part, unless the learner says otherwise.
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    # The flag is read when a module of messages is loaded; some may be there already.
    for name, module in list(sys.modules.items()):
        if ('.msg._' in name or '.srv._' in name) and hasattr(module, 'ros_python_check_fields'):
            vars(module)['ros_python_check_fields'] = os.environ['ROS_PYTHON_CHECK_FIELDS']


def _find_own_commands() -> None:
    """Let `!ros2` find the environment's own `ros2`, activated or not, after any other one."""
    own = os.path.join(sys.prefix, 'bin')
    folders = os.environ.get('PATH', os.defpath).split(os.pathsep)
    if sys.prefix != sys.base_prefix and own not in folders:
        os.environ['PATH'] = os.pathsep.join([*folders, own])


def _drop_unusable_middleware() -> None:
    """Forget an `RMW_IMPLEMENTATION` that would end the process as soon as rclpy is imported.

    rcl calls exit(102) when it was built for another middleware than the variable asks for. In a
    kernel nobody would learn why.
    """
    wanted = os.environ.get('RMW_IMPLEMENTATION', '')
    folder = os.path.join(sys.prefix, 'lib')
    here = os.path.exists(os.path.join(folder, 'librmw_fastrtps_cpp.so'))
    if wanted and here and not os.path.exists(os.path.join(folder, f'lib{wanted}.so')):
        dropped_variables['RMW_IMPLEMENTATION'] = os.environ.pop('RMW_IMPLEMENTATION')


@dataclass(frozen=True)
class Audience:
    """Who looks at what labkit shows, and what follows from it.

    Attributes:
        live: A page shows it to a person: views move, forms can be filled in.
        same_each_time: What is shown is stored and compared, so it depends on counts, never on
            time or on the machine: a cell's output is cut where its last wait ended, reports
            leave out what differs between healthy machines, progress is not kept.
        patience_sec: How long a command that nobody ends waits for others, s; None for no end,
            because there is a person with a stop button.
    """

    live: bool
    same_each_time: bool
    patience_sec: float | None


LEARNER = Audience(live=True, same_each_time=False, patience_sec=None)
"""A person in front of a notebook."""

TERMINAL = Audience(live=False, same_each_time=False, patience_sec=None)
"""A person in front of a terminal, or a script."""

RECORDING = Audience(live=False, same_each_time=True, patience_sec=5.0)
"""A program that runs a lesson: nbval and `labkit record`. They set `LABKIT_HEADLESS=1`."""


@functools.lru_cache(maxsize=1)
def audience() -> Audience:
    """Return who looks at what this process shows; it is found out once, at the first question."""
    if os.environ.get('LABKIT_HEADLESS', '') not in ('', '0'):
        return RECORDING
    return LEARNER if in_kernel() else TERMINAL


def in_kernel() -> bool:
    """Tell whether this process is a Jupyter kernel."""
    ipython = sys.modules.get('IPython')
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, 'kernel')


def notebook_name() -> str:
    """Return the path of this kernel's notebook as Jupyter gives it, '' if it is not known."""
    return os.environ.get('JPY_SESSION_NAME', '')


def state_dir() -> Path:
    """Return the folder where labkit keeps what it has to remember: `$LABKIT_HOME` if set."""
    home = os.environ.get('LABKIT_HOME')
    if home:
        return Path(home)
    data = os.environ.get('XDG_DATA_HOME') or Path.home() / '.local' / 'share'
    return Path(data) / 'labkit'


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
    _choose_profile()


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


def _choose_profile() -> None:
    """Name the profile that `ROS_DOMAIN_ID` needs. One that the learner has named stays."""
    if _number(os.environ.get('ROS_DOMAIN_ID', '')) in BETWEEN:
        if between_is_possible():
            os.environ[PROFILES_FILE] = str(PROFILE)
    elif counts_ports():
        del os.environ[PROFILES_FILE]
