"""One place for environment variables, defaults, the headless switch and the choice of domain."""

from __future__ import annotations

import os
import socket
import sys
import zlib
from pathlib import Path

from labkit.errors import LabError

__all__ = [
    'LAST_DOMAIN_ID',
    'DomainClaim',
    'check_domain_id',
    'claim_domain',
    'claimed_domains',
    'dropped_variables',
    'headless',
    'in_kernel',
    'notebook_name',
    'prepare_environment',
    'read_domain_id',
    'state_dir',
]

# Domains 0 to 101 are safe on Linux: above them the ports of DDS overlap with the range that the
# system hands out by itself (docs.ros.org, "The ROS_DOMAIN_ID"). Domain 0 is everybody's default,
# so a notebook takes one of the others.
FIRST_DOMAIN_ID = 1
LAST_DOMAIN_ID = 101

# What `prepare_environment` has taken out of the environment, with the values.
dropped_variables: dict[str, str] = {}

# Names of sockets, see `DomainClaim`.
_CLAIM = 'labkit/ros-domain/'
_NAME = 'labkit/notebook/'


def prepare_environment() -> None:
    """Set the variables that have to be there before ROS is loaded. What is set already wins."""
    # Without it `Int16(data=40000)` arrives as -25536 and nobody says a word.
    os.environ.setdefault('ROS_PYTHON_CHECK_FIELDS', '1')
    _drop_unusable_middleware()
    _find_own_commands()
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


def headless() -> bool:
    """Tell whether a program, not a person, runs the notebook.

    True under nbval and `labkit record` (they set `LABKIT_HEADLESS=1`). Views are then shown in
    their static form, and a cell's output is cut where its last wait ended, so that it is the
    same each time.
    """
    return os.environ.get('LABKIT_HEADLESS', '') not in ('', '0')


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
    text = os.environ.get('ROS_DOMAIN_ID', '')
    if not text:
        return None
    if not text.isdecimal() or int(text) > 232:
        raise LabError(
            f'ROS_DOMAIN_ID must be a number from 0 to {LAST_DOMAIN_ID}, but it is {text!r}.',
            todo='Set it to a number, or unset it: then each notebook takes a domain of its own.',
        )
    return int(text)


def check_domain_id(domain_id: object) -> None:
    """Raise a LabError unless `domain_id` is None or a safe ROS domain."""
    if domain_id is None or (isinstance(domain_id, int) and 0 <= domain_id <= LAST_DOMAIN_ID):
        return
    raise LabError(
        f'domain_id must be a whole number from 0 to {LAST_DOMAIN_ID}, but it is {domain_id!r}.'
    )


class DomainClaim:
    """A ROS domain that no other notebook on this machine uses while this process lives.

    The claim is the name of a socket in Linux's abstract namespace. It takes no file, it counts
    for all users of the machine, and it ends with the process, however the process ends.

    Args:
        domain_id: The domain to claim.

    Raises:
        OSError: Another process has claimed it.
    """

    def __init__(self, domain_id: int) -> None:
        self.domain_id = domain_id
        # The second name tells others which notebook it is.
        notebook = Path(notebook_name()).name[-40:] or f'process {os.getpid()}'
        self._sockets: list[socket.socket] = []
        try:
            for name in (f'{_CLAIM}{domain_id}', f'{_NAME}{domain_id}/{notebook}'):
                self._sockets.append(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
                self._sockets[-1].bind(f'\0{name}')
        except OSError:
            self.close()
            raise

    def close(self) -> None:
        """Give the domain back."""
        for claim in self._sockets:
            claim.close()


def claimed_domains() -> dict[int, str]:
    """Return the domains that notebooks on this machine have claimed, and the notebooks' names."""
    try:
        table = Path('/proc/net/unix').read_text(encoding='utf-8', errors='replace')
    except OSError:
        return {}
    found = {}
    for line in table.splitlines():
        _, sign, name = line.partition(f'@{_NAME}')
        domain_id, slash, notebook = name.partition('/')
        if sign and slash and domain_id.isdecimal():
            found[int(domain_id)] = notebook
    return dict(sorted(found.items()))


def claim_domain() -> DomainClaim:
    """Claim a domain that no other notebook has.

    The search starts from a number made from the notebook's name, so that a notebook whose kernel
    is restarted mostly meets its own domain again.

    Raises:
        LabError: All domains are taken.
    """
    name = notebook_name() or str(os.getpid())
    count = LAST_DOMAIN_ID - FIRST_DOMAIN_ID + 1
    first = zlib.crc32(name.encode())
    for step in range(count):
        try:
            return DomainClaim(FIRST_DOMAIN_ID + (first + step) % count)
        except OSError:
            continue
    raise LabError(
        f'All {count} ROS domains of this machine are in use by other notebooks.',
        todo='Shut down kernels that are not needed any more (in JupyterLab: the square symbol '
        'at the left), or share a domain on purpose with lab.start(domain_id=...).',
    )
