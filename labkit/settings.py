"""Environment variables, switches, and who looks at what is shown."""

from __future__ import annotations

import functools
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from labkit import domain_ids

__all__ = [
    'LEARNER',
    'RECORDING',
    'TERMINAL',
    'Audience',
    'audience',
    'dropped_variables',
    'in_kernel',
    'notebook_name',
    'prepare_environment',
    'state_dir',
    'variant_seed',
]

# What `prepare_environment` has taken out of the environment, with the values.
dropped_variables: dict[str, str] = {}


def prepare_environment() -> None:
    """Set the variables that have to be there before ROS is loaded. What is set already wins."""
    # Without it `Int16(data=40000)` arrives as -25536 and nobody says a word.
    os.environ.setdefault('ROS_PYTHON_CHECK_FIELDS', '1')
    _drop_unusable_middleware()
    _find_own_commands()
    domain_ids.choose_profile()
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


def variant_seed() -> str:
    """Return whose numbers and names exercises ask for, `''` for those of the notebook.

    It is `$LABKIT_VARIANT`; with `LABKIT_VARIANTS=1`, as a hub sets it for all, the user's name.
    """
    seed = os.environ.get('LABKIT_VARIANT', '').strip()
    if not seed and os.environ.get('LABKIT_VARIANTS', '') not in ('', '0'):
        seed = os.environ.get('JUPYTERHUB_USER', '').strip()
    return seed
