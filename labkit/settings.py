"""Environment variables, switches, and the audience of outputs."""

from __future__ import annotations

import atexit
import functools
import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from labkit import domain_ids

__all__ = [
    'LATE_SEC',
    'LEARNER',
    'LONG_SEC',
    'RECORDING',
    'SCRIPT',
    'SHORT_SEC',
    'TERMINAL',
    'Audience',
    'after_start',
    'audience',
    'dropped_variables',
    'give_environment_back',
    'in_kernel',
    'is_ros2_command',
    'language',
    'notebook_name',
    'prepare_environment',
    'prepared_variables',
    'shell',
    'state_dir',
    'variant_seed',
]

after_start: list[Callable[[], None]] = []
"""Called each time ROS has been started, in the thread that started it."""

# A callback that takes so long is felt by people, s.
LONG_SEC = 1.0
# One that is shorter is not looked at: it is as likely the machine that was busy, s.
LATE_SEC = 0.2
# Nor is the callback of a timer that is shorter, though it outlasts the period, s.
SHORT_SEC = 0.01

is_ros2_command = False
"""Whether this process is `ros2` of a terminal: it is on the graph as the real one is."""

# Set for what a notebook's cells start: a cell shows their output, though it is a pipe.
_CELL = 'LABKIT_CELL'

# Variables removed by `prepare_environment`, with their values.
dropped_variables: dict[str, str] = {}
# All variables as it has found them, and as it has left them: a cell may set others since.
_found_variables: dict[str, str] = {}
prepared_variables: dict[str, str] = {}
_added_folders: list[str] = []
_STAND_INS = os.path.join(os.path.dirname(__file__), 'packages', 'stand_ins')


def prepare_environment() -> None:
    """Set the variables that ROS reads when it is loaded. Variables already set win."""
    _found_variables.update(os.environ)
    # Without it `Int16(data=40000)` silently arrives as -25536.
    os.environ.setdefault('ROS_PYTHON_CHECK_FIELDS', '1')
    # Set wherever ROS 2 is sourced: programs and launch files ask it for the release.
    os.environ.setdefault('ROS_DISTRO', 'jazzy')
    _drop_unusable_middleware()
    _find_own_commands()
    _find_stand_ins()
    if in_kernel():
        # ipykernel requests colours (FORCE_COLOR) of all child processes. Python has them since
        # 3.13: errors of `ros2 run` would be different text there, and `grep` would not find it.
        os.environ.setdefault('PYTHON_COLORS', '0')
        os.environ[_CELL] = '1'
        _find_log_folder()
    # Stay on this machine, unless the learner says otherwise. To ROS, '' is the network.
    if not os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE'):
        os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    domain_ids.choose_profile()
    # The flag is read when a message module is loaded; some may be loaded already.
    for name, module in list(sys.modules.items()):
        if ('.msg._' in name or '.srv._' in name) and hasattr(module, 'ros_python_check_fields'):
            vars(module)['ros_python_check_fields'] = os.environ['ROS_PYTHON_CHECK_FIELDS']
    prepared_variables.update(os.environ)


def give_environment_back() -> None:
    """Undo `prepare_environment`, but for variables that somebody has set since."""
    for name, value in prepared_variables.items():
        before = _found_variables.get(name)
        if value != before and os.environ.get(name) == value:
            del os.environ[name]
            if before is not None:
                os.environ[name] = before
    os.environ.update(dropped_variables)
    sys.path[:] = [folder for folder in sys.path if folder not in _added_folders]


def _find_own_commands() -> None:
    """Let `!ros2` find the environment's `ros2`, activated or not, after any other one."""
    own = os.path.join(sys.prefix, 'bin')
    folders = os.environ.get('PATH', os.defpath).split(os.pathsep)
    if sys.prefix != sys.base_prefix and own not in folders:
        os.environ['PATH'] = os.pathsep.join([*folders, own])


def _find_stand_ins() -> None:
    """Let this process and those that it starts find what stands in for packages, last of all."""
    if _STAND_INS not in sys.path:
        sys.path.append(_STAND_INS)
        _added_folders.append(_STAND_INS)
    paths = list(filter(None, os.environ.get('PYTHONPATH', '').split(os.pathsep)))
    if _STAND_INS not in paths:
        os.environ['PYTHONPATH'] = os.pathsep.join([*paths, _STAND_INS])


def _find_log_folder() -> None:
    """Let programs start where nothing can be written to the home: rclpy.init() would raise."""
    home = os.environ.get('ROS_HOME') or os.path.join(os.path.expanduser('~'), '.ros')
    if os.environ.get('ROS_LOG_DIR'):
        return
    try:
        os.makedirs(os.path.join(home, 'log'), exist_ok=True)
    except OSError:
        with suppress(OSError):  # no room for anything
            folder = tempfile.TemporaryDirectory(prefix='ros_log_')
            atexit.register(folder.cleanup)
            os.environ['ROS_LOG_DIR'] = folder.name


def _drop_unusable_middleware() -> None:
    """Drop an `RMW_IMPLEMENTATION` that would end the process when rclpy is imported.

    rcl calls exit(102) if it was built for another middleware than requested. In a kernel nobody
    would learn why.
    """
    wanted = os.environ.get('RMW_IMPLEMENTATION', '')
    folder = os.path.join(sys.prefix, 'lib')
    here = os.path.exists(os.path.join(folder, 'librmw_fastrtps_cpp.so'))
    if wanted and here and not os.path.exists(os.path.join(folder, f'lib{wanted}.so')):
        dropped_variables['RMW_IMPLEMENTATION'] = os.environ.pop('RMW_IMPLEMENTATION')


@dataclass(frozen=True)
class Audience:
    """The audience of labkit's outputs, and its consequences.

    Attributes:
        live: Whether a page shows it to a person: views move, forms can be filled in.
        same_each_time: Whether outputs are stored and compared, so that they depend on counts,
            never on time or the machine: a cell's output is cut where its last wait ended, reports
            leave out what differs between healthy machines, progress is not kept.
        patience_sec: Time that a command waits for others, s; None for no limit, because a person
            can press the stop button.
        wants_reasons: Whether `ros2` explains what the real one is silent about, or tells in other
            words, which scripts rely on.
    """

    live: bool
    same_each_time: bool
    patience_sec: float | None
    wants_reasons: bool = True


LEARNER = Audience(live=True, same_each_time=False, patience_sec=None)
"""A person in a notebook."""

TERMINAL = Audience(live=False, same_each_time=False, patience_sec=None)
"""A person in a terminal, or a script."""

SCRIPT = Audience(live=False, same_each_time=False, patience_sec=None, wants_reasons=False)
"""A program that runs `ros2`: its output goes into a pipe or a file, and not into a cell."""

RECORDING = Audience(live=False, same_each_time=True, patience_sec=5.0)
"""A program that runs a lesson: nbval and `labkit record`. They set `LABKIT_HEADLESS=1`."""


@functools.lru_cache(maxsize=1)
def audience() -> Audience:
    """Return the audience of this process, determined on the first call."""
    if os.environ.get('LABKIT_HEADLESS', '') not in ('', '0'):
        return RECORDING
    if in_kernel():
        return LEARNER
    is_read_by_program = is_ros2_command and not sys.stdout.isatty() and _CELL not in os.environ
    return SCRIPT if is_read_by_program else TERMINAL


def shell() -> Any:
    """Return the running IPython, None in a program."""
    ipython = sys.modules.get('IPython')
    return ipython.get_ipython() if ipython is not None else None


def in_kernel() -> bool:
    """Return whether this process is a Jupyter kernel."""
    return hasattr(shell(), 'kernel')


def notebook_name() -> str:
    """Return the path of this kernel's notebook as Jupyter gives it, '' if unknown."""
    return os.environ.get('JPY_SESSION_NAME', '')


def state_dir() -> Path:
    """Return the folder of labkit's state: `$LABKIT_HOME` if set."""
    home = os.environ.get('LABKIT_HOME')
    if home:
        return Path(home)
    data = os.environ.get('XDG_DATA_HOME') or Path.home() / '.local' / 'share'
    return Path(data) / 'labkit'


def language() -> str:
    """Return the language of the lessons, such as `'de'`: `$LABKIT_LANGUAGE`; `''` is English."""
    name = os.environ.get('LABKIT_LANGUAGE', '')
    # It becomes the name of a folder.
    return name if name.isascii() and name.isalpha() else ''


def variant_seed() -> str:
    """Return the seed of the numbers and names in exercises, `''` for those of the notebook.

    It is `$LABKIT_VARIANT`; with `LABKIT_VARIANTS=1`, set by a hub, it is the user's name.
    """
    seed = os.environ.get('LABKIT_VARIANT', '').strip()
    if not seed and os.environ.get('LABKIT_VARIANTS', '') not in ('', '0'):
        seed = os.environ.get('JUPYTERHUB_USER', '').strip()
    return seed
