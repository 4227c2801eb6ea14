"""Start JupyterLab on the learner's folder: `python3 -m labkit lab`."""

from __future__ import annotations

import os
import platform
import re
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NoReturn

from labkit.course import learner_folder
from labkit.course.copies import copies_folder
from labkit.errors import SetupError
from labkit.settings import state_dir
from labkit.setup.environment import (
    PYTHON,
    ROOT,
    environment_variables,
    make_environment,
)

__all__ = [
    'HOME',
    'lesson_options',
    'lesson_variables',
    'prepare',
    'start_command',
    'start_lab',
    'write_home',
]

# The overview of all lessons; see `labkit.exercises.record.progress_page`.
HOME = 'Home.md'


def start_lab(arguments: Sequence[str]) -> NoReturn:
    """Make the environment, update the lessons, and become JupyterLab.

    Args:
        arguments: Further options for JupyterLab.

    Raises:
        SetupError: This machine, or a requested port, does not allow it.
    """
    _check_port(arguments)
    python = prepare()
    variables = lesson_variables()
    print('Starting JupyterLab. To stop it, press Ctrl+C here, twice. Its address:', flush=True)
    first = write_home(python, variables)
    options = [
        *lesson_options(),
        '--ServerApp.ip=127.0.0.1',
        f'--LabApp.default_url=/lab/tree/{first}',
        # Do not restore what is open in another JupyterLab of the learner's.
        f'--LabApp.workspaces_dir={state_dir() / "workspaces"}',
        # Otherwise each kernel warns that others on this machine could listen in.
        '--KernelManager.transport_encryption=auto',
    ]
    if _requested_port(arguments) is not None:
        options.append('--ServerApp.port_retries=0')
    if os.geteuid() == 0:
        options.append('--allow-root')  # containers, and WSL set up without a user
    if 'microsoft' in platform.release().lower() or os.path.exists('/snap/bin/firefox'):
        # A Windows browser, or Firefox as a snap, can't read the file that JupyterLab usually
        # opens.
        options.append('--ServerApp.use_redirect_file=False')
    os.chdir(learner_folder.WORK)
    # Isolated, so that the learner's modules can't shadow those that JupyterLab needs.
    server = str(Path(__file__).with_name('server.py'))
    os.execve(python, [str(python), '-I', server, *options, *arguments], variables)


def prepare() -> Path:
    """Make the environment, and update the lessons.

    Returns:
        The environment's interpreter.

    Raises:
        SetupError: This machine does not allow it.
    """
    python = make_environment()
    for sentence in learner_folder.copy_lessons():
        print(sentence)
    return python


def start_command(command: Sequence[str]) -> NoReturn:
    """Become an external command that starts JupyterLab, as on Binder.

    Programs come from the environment, and it starts in the learner's folder.

    Args:
        command: The command with its options. The course's settings for JupyterLab are in a file,
            in the folder named by `JUPYTER_CONFIG_PATH`.
    """
    variables = lesson_variables()
    write_home(PYTHON, variables)
    os.chdir(learner_folder.WORK)
    os.execvpe(command[0], list(command), variables)


def lesson_options() -> list[str]:
    """Return the options of every JupyterLab on the learner's folder."""
    return [
        f'--ServerApp.root_dir={learner_folder.WORK}',
        # Otherwise a server without a terminal starts login shells, which may reset PATH: then the
        # command `ros2` would be gone.
        f'--ServerApp.terminado_settings=shell_command={os.environ.get("SHELL") or "/bin/sh"}',
        # Half of it is how long a kernel may end ROS by itself. A slow machine needs more than the
        # usual 2.5 s; one that ends sooner is not waited for.
        '--KernelManager.shutdown_wait_time=30',
    ]


def lesson_variables() -> dict[str, str]:
    """Return the variables of every JupyterLab on the learner's folder."""
    variables = environment_variables()
    # A kernel installed for the user would belong to another Python, without ROS.
    variables['JUPYTER_PREFER_ENV_PATH'] = '1'
    variables['LABKIT_COPIES'] = str(copies_folder())
    variables['LABKIT_HOME_PAGE'] = str(learner_folder.WORK / HOME)
    return variables


def write_home(python: Path, variables: Mapping[str, str]) -> str:
    """Write the overview of all lessons.

    Args:
        python: The environment's interpreter.
        variables: The result of `lesson_variables`.

    Returns:
        The file to open: the overview, once there is progress to show.
    """
    page = variables['LABKIT_HOME_PAGE']
    done = subprocess.run(
        [str(python), '-m', 'labkit.exercises.record.progress_page', page],
        cwd=ROOT,
        env=variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    begun = (state_dir() / 'progress.json').exists()
    return HOME if done.returncode == 0 and begun else learner_folder.FIRST


def _requested_port(arguments: Sequence[str]) -> int | None:
    """Return the port requested in the options, None if there is none."""
    text = ' '.join(arguments)
    found = re.search(r'--(?:port|ServerApp\.port)[= ](\d+)', text)
    return int(found[1]) if found else None


def _check_port(arguments: Sequence[str]) -> None:
    port = _requested_port(arguments)
    if port is None:
        return  # JupyterLab takes the first free one from 8888 on
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(('127.0.0.1', port))
        except (OSError, OverflowError) as error:
            raise SetupError(
                f'Port {port} can not be used: {error}.',
                todo='Give another one with --port, or none: then a free one is taken.',
            ) from error


if __name__ == '__main__':
    start_command(sys.argv[1:])
