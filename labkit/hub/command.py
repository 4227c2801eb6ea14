"""The command `labkit hub`: make all that a hub needs, and become JupyterHub.

This part runs in a bare Python. When the environment is there, `labkit.hub.start` goes on in it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from labkit.errors import LabError
from labkit.hub.class_list import read_class
from labkit.hub.proxy import install_proxy
from labkit.setup.environment import environment_variables, make_environment

__all__ = ['FOLDER', 'REQUIREMENTS', 'run_hub']

REQUIREMENTS = ('environment.txt', 'labkit/hub/requirements.txt')
FOLDER = Path('/var/lib/labkit-hub')
"""What the hub keeps: who is logged in, hashes of passwords, first passwords."""


def run_hub(
    arguments: Sequence[str],
    *,
    class_list: str | None,
    folder: str | None = None,
    image: str | None = None,
    new_password: str | None = None,
    prepare: bool = False,
) -> int:
    """Make the environment and the proxy, then become the hub of a class.

    Args:
        arguments: Options for JupyterHub.
        class_list: The file that names the class.
        folder: The hub's folder, `FOLDER` if None.
        image: The image of Docker for learners' servers. Processes of this machine if None.
        new_password: Somebody of the class who gets another password; then no hub is started.
        prepare: Whether to end when all is installed, as while an image is built.

    Returns:
        The exit code, if there is a way back.

    Raises:
        LabError: This machine, the list, or an option does not allow it.
    """
    if not prepare:
        _check(arguments, class_list)
    os.umask(0o022)  # learners use the environment, whoever has made it
    python = make_environment(REQUIREMENTS)
    install_proxy()
    # In the environment's Python, since it is about its packages.
    command = [str(python), '-m', 'labkit.hub.start']
    if class_list is not None and not prepare:
        command += ['--class', os.path.abspath(class_list)]
        command += ['--folder', os.path.abspath(folder or FOLDER)]
        command += ['--image', image] if image else []
        command += ['--new-password', new_password] if new_password else []
        command += ['--', *arguments]
    os.execve(python, command, environment_variables())


def _check(arguments: Sequence[str], class_list: str | None) -> None:
    if class_list is None:
        raise LabError(
            'A hub is for a class.',
            todo='Write the names of the class into a file, one on each line, and: '
            'sudo python3 -m labkit hub --class robots.txt',
        )
    read_class(Path(class_list))
    if os.geteuid() != 0:
        raise LabError(
            'A hub starts the server of each learner in an account of their own, which only root '
            'may do.',
            todo='sudo python3 -m labkit hub --class ' + class_list,
        )
    text = ' '.join(arguments)
    address = re.search(r'(?:--ip|--JupyterHub\.ip)[= ](\S*)|bind_url[= ]\S*?//([^:/\s]*)', text)
    open_to = (address[1] or address[2] or '*') if address else '127.0.0.1'
    encrypted = re.search(r'ssl[-_]cert', text)
    if open_to not in ('127.0.0.1', 'localhost', '[::1]', '::1') and not encrypted:
        raise LabError(
            f'At {open_to}, passwords and all that is typed would cross the network unencrypted.',
            todo='Give --ssl-key and --ssl-cert too (docs/hub.md tells how they are made), or '
            'leave out --ip, and let a web server with TLS of this machine lead here.',
        )
