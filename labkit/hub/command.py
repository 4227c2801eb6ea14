"""The command `labkit hub`: install a hub, and become JupyterHub.

This part runs in a bare Python. `labkit.hub.start` continues in the environment.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import urlsplit

from labkit.errors import LabError
from labkit.hub.class_list import read_class
from labkit.hub.proxy import install_proxy
from labkit.setup.environment import environment_variables, make_environment

__all__ = ['FOLDER', 'PORT', 'REQUIREMENTS', 'run_hub']

REQUIREMENTS = ('environment.txt', 'labkit/hub/requirements.txt')
FOLDER = Path('/var/lib/labkit-hub')
"""State of the hub: sessions, password hashes, first passwords."""
PORT = 800
"""Of the hub's pages. The two after it are the hub's and its proxy's own."""
_THIS_MACHINE = ('127.0.0.1', 'localhost', '::1', '[::1]')
# JupyterHub takes the last of several values, and each must be one that may be.
_REACHED = {
    'ip': ('--ip', '--JupyterHub.ip'),
    'port': ('--port', '--JupyterHub.port'),
    'url': ('--url', '--JupyterHub.bind_url'),
    'certificate': ('--ssl-cert', '--JupyterHub.ssl_cert'),
    'config': ('-f', '--config', '--JupyterHub.config_file'),
}
_FIRST_FOR_ALL = Path('/proc/sys/net/ipv4/ip_unprivileged_port_start')


def run_hub(
    arguments: Sequence[str],
    *,
    class_list: str | None,
    folder: str | None = None,
    image: str | None = None,
    new_password: str | None = None,
    prepare: bool = False,
) -> int:
    """Install the environment and the proxy, then become the hub of a class.

    Args:
        arguments: Options for JupyterHub.
        class_list: The file with the class.
        folder: The hub's folder, `FOLDER` if None.
        image: Docker image for learners' servers. Processes on this machine if None.
        new_password: A member who gets a new password; then no hub is started.
        prepare: Whether to stop after the installation, as while building an image.

    Returns:
        The exit code, if it returns.

    Raises:
        LabError: This machine, the list, or an option does not allow it.
    """
    if not prepare:
        _check(arguments, class_list, image)
    os.umask(0o022)  # learners use the environment, too
    python = make_environment(REQUIREMENTS)
    install_proxy()
    # In the environment's Python, because it needs its packages.
    command = [str(python), '-m', 'labkit.hub.start']
    if class_list is not None and not prepare:
        command += ['--class', os.path.abspath(class_list)]
        command += ['--folder', os.path.abspath(folder or FOLDER)]
        command += ['--image', image] if image else []
        command += ['--new-password', new_password] if new_password else []
        command += ['--port', str(_port(arguments))]
        command += ['--', *arguments]
    os.execve(python, command, environment_variables())


def _check(arguments: Sequence[str], class_list: str | None, image: str | None) -> None:
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
    given = _given(arguments)
    if given.config:
        raise LabError(
            'A configuration file of its own would take the place of the one that keeps learners '
            'apart.',
            todo='Leave out --config, and give single settings: --Spawner.mem_limit=4G',
        )
    if not image:
        _check_port(_port(arguments))
    hosts = [*given.ip, *(urlsplit(url).hostname or '' for url in given.url)]
    open_to = [host or '*' for host in hosts if host not in _THIS_MACHINE]
    if open_to and not all(given.certificate or ['']):
        raise LabError(
            f'At {open_to[0]}, passwords and all that is typed would cross the network '
            'unencrypted.',
            todo='Give --ssl-key and --ssl-cert too (docs/hub.md tells how they are made), or '
            'leave out --ip, and let a web server with TLS of this machine lead here.',
        )


def _given(arguments: Sequence[str]) -> argparse.Namespace:
    """Return all values of the options for JupyterHub that say where it can be reached."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    for name, words in _REACHED.items():
        parser.add_argument(*words, dest=name, action='append', nargs='?', const='', default=[])
    return parser.parse_known_args(arguments)[0]


def _port(arguments: Sequence[str]) -> int:
    """Return the port of the hub's pages."""
    given = _given(arguments)
    try:
        ports = [*map(int, given.port), *(urlsplit(url).port or PORT for url in given.url)]
    except ValueError as error:
        raise LabError(f'That is no port: {error}.', todo='Such as --port=900') from error
    if len(set(ports)) > 1:
        raise LabError(f'Two ports are given, {ports[0]} and {ports[-1]}.', todo='Give one.')
    return ports[0] if ports else PORT


def _check_port(port: int) -> None:
    """Refuse ports that learners' accounts could take while the hub is down."""
    first = int(_FIRST_FOR_ALL.read_text())
    if port + 2 < first:
        return
    if first <= PORT + 2:
        todo = 'Keep ports for root: sudo sysctl net.ipv4.ip_unprivileged_port_start=1024'
    else:
        todo = f'Choose one up to {first - 3}: --port {PORT}. The two after it are used, too.'
    raise LabError(
        f'While the hub is down, any account of this machine could take port {port}, show a page '
        'that looks like the hub, and be told passwords.',
        todo=todo,
    )
