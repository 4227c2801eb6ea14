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

# The page with all lessons; see `labkit.exercises.home`.
HOME = 'Home.md'


def start_lab(arguments: Sequence[str]) -> NoReturn:
    """Make the environment, bring the lessons up to date, and become JupyterLab.

    Args:
        arguments: Options for JupyterLab, besides those set here.

    Raises:
        SetupError: This machine, or a port that was asked for, does not allow it.
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
        # What is open in another JupyterLab of the learner's is not looked for here.
        f'--LabApp.workspaces_dir={state_dir() / "workspaces"}',
        # Else each kernel warns that others on this machine could listen to it.
        '--KernelManager.transport_encryption=auto',
    ]
    if _asked_port(arguments) is not None:
        options.append('--ServerApp.port_retries=0')
    if os.geteuid() == 0:
        options.append('--allow-root')  # containers, and WSL set up without a user
    if 'microsoft' in platform.release().lower() or os.path.exists('/snap/bin/firefox'):
        # A Windows browser, or Firefox as a snap, can't read the file through which JupyterLab
        # opens its page otherwise.
        options.append('--ServerApp.use_redirect_file=False')
    os.chdir(learner_folder.WORK)
    # Isolated: no module of the learner's takes the place of one that JupyterLab needs.
    server = str(Path(__file__).with_name('server.py'))
    os.execve(python, [str(python), '-I', server, *options, *arguments], variables)


def prepare() -> Path:
    """Make the environment, and bring the lessons up to date.

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
    """Become a command of somebody else's that starts JupyterLab, as Binder has one.

    Its programs are taken from the environment, and it starts in the learner's folder.

    Args:
        command: The command. Its options are its own; what the course sets for JupyterLab lies in
            a file, in the folder that the variable `JUPYTER_CONFIG_PATH` names.
    """
    variables = lesson_variables()
    write_home(PYTHON, variables)
    os.chdir(learner_folder.WORK)
    os.execvpe(command[0], list(command), variables)


def lesson_options() -> list[str]:
    """Return the options for a JupyterLab on the learner's folder, wherever it runs."""
    return [
        f'--ServerApp.root_dir={learner_folder.WORK}',
        # Without it a server whose output is no terminal gives login shells, and those may set
        # PATH anew: the command `ros2` would be gone.
        f'--ServerApp.terminado_settings=shell_command={os.environ.get("SHELL") or "/bin/sh"}',
    ]


def lesson_variables() -> dict[str, str]:
    """Return the variables of a JupyterLab on the learner's folder, wherever it runs."""
    variables = environment_variables()
    # A kernel that was installed for the user would belong to another Python, without ROS.
    variables['JUPYTER_PREFER_ENV_PATH'] = '1'
    variables['LABKIT_HOME_PAGE'] = str(learner_folder.WORK / HOME)
    return variables


def write_home(python: Path, variables: Mapping[str, str]) -> str:
    """Write the page with all lessons.

    Args:
        python: The environment's interpreter.
        variables: What `lesson_variables` has returned.

    Returns:
        The file to open: the page, if it has news.
    """
    page = variables['LABKIT_HOME_PAGE']
    done = subprocess.run(
        [str(python), '-m', 'labkit.exercises.home', page],
        cwd=ROOT,
        env=variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    begun = (state_dir() / 'progress.json').exists()
    return HOME if done.returncode == 0 and begun else learner_folder.FIRST


def _asked_port(arguments: Sequence[str]) -> int | None:
    """Return the port that is asked for in the options, None if there is none."""
    text = ' '.join(arguments)
    found = re.search(r'--(?:port|ServerApp\.port)[= ](\d+)', text)
    return int(found[1]) if found else None


def _check_port(arguments: Sequence[str]) -> None:
    port = _asked_port(arguments)
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
