"""The second half of `labkit hub`, in the environment's Python: accounts, passwords, the hub."""

from __future__ import annotations

import argparse
import os
import re
import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy

from labkit.errors import LabError
from labkit.hub.accounts import make_accounts, make_class_folder, make_private_folder
from labkit.hub.class_list import read_class
from labkit.hub.containers import HUB_IP, make_class_volumes
from labkit.hub.passwords import FIRST_PASSWORDS, make_passwords, names_with_password
from labkit.hub.sessions import end_all, note_hub, noted_hub
from labkit.setup.compiler import fix_exported_paths
from labkit.setup.environment import ROOT, environment_variables

__all__ = ['main']

_CONFIG = Path(__file__).with_name('jupyterhub_config.py')


def main(words: Sequence[str]) -> int:
    """Make accounts and passwords, and become JupyterHub.

    Args:
        words: The options from `labkit.hub.command`.

    Returns:
        The exit code, if no hub is started.
    """
    options = _parser().parse_args(words)
    # Learners can't write to the environment, so lesson 12 relies on this.
    fix_exported_paths(Path(sys.prefix), numpy.get_include())
    if options.class_list is None:
        print('All that a hub needs is installed.')
        return 0
    members = read_class(options.class_list)
    names = [member.name for member in members]
    os.umask(0o077)
    if options.new_password is not None:
        return _renew(options, names)
    options.folder.mkdir(parents=True, exist_ok=True)
    options.folder.chmod(0o700)
    if options.image is None:
        for name in make_accounts(names):
            print(f'{name} has an account now.')
        _check_access(names[0])
        # Beside the hub's folder, which learners can't read.
        class_folder = options.folder.with_name(f'{options.folder.name}-class')
        make_class_folder(class_folder, members)
        private = class_folder.with_name(f'{class_folder.name}-private')
        if left := make_private_folder(private, names):
            print(left)
    else:
        class_folder = options.folder / 'class'
        make_class_volumes(class_folder, members)
    _tell(options.folder, make_passwords(options.folder, names))
    _check_free(options.port + 1)
    address = _address(options)
    if noted_hub(options.folder) not in ('', address):
        print(
            'The hub was at another port or address. A server that still runs from then can not '
            'be opened: "Stop All" in the admin page ends all of them.'
        )
    variables = environment_variables() | {
        'LABKIT_HUB_TOKEN': note_hub(options.folder, address),
        'LABKIT_PORT': str(options.port),
        'LABKIT_CLASS': str(options.class_list),
        'LABKIT_CLASS_FOLDER': str(class_folder),
    }
    if options.image is not None:
        variables['LABKIT_IMAGE'] = options.image
    print(f'Starting JupyterHub for {len(names)}. To stop it, press Ctrl+C here.', flush=True)
    os.chdir(options.folder)
    command = [sys.executable, '-m', 'jupyterhub', '-f', str(_CONFIG), *options.arguments]
    os.execve(sys.executable, command, variables)


def _renew(options: argparse.Namespace, names: Sequence[str]) -> int:
    """Give somebody another password, and end what was begun with the old one."""
    name = options.new_password
    if name not in names:
        raise LabError(f'{name!r} is not in {options.class_list.name}.')
    if name not in names_with_password(options.folder):
        raise LabError(
            f'{name!r} has no password in the hub of {str(options.folder)!r}.',
            todo='If the hub of this class was started with --folder, give it here, too. Who is '
            'new in the list gets a password when the hub is started.',
        )
    _tell(options.folder, make_passwords(options.folder, [name], anew=[name]))
    end_all(options.folder, name, account=options.image is None)
    print(f'Sessions, tokens and processes of {name} are ended.')
    return 0


def _tell(folder: Path, new: Sequence[str]) -> None:
    if new:
        print(f'New passwords, for {", ".join(new)}: {folder / FIRST_PASSWORDS}')


def _address(options: argparse.Namespace) -> str:
    """Return where the hub itself will be reached, see `jupyterhub_config`."""
    given = re.search(r'hub_ip[= ](\S+)', ' '.join(options.arguments))
    ip = given[1] if given else HUB_IP if options.image else '127.0.0.1'
    return f'http{"" if options.image else "s"}://{ip}:{options.port + 1}'


def _check_free(port: int) -> None:
    """Check that the hub can have its port: otherwise it would end when its proxy runs."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(('127.0.0.1', port))
        except OSError as error:
            raise LabError(
                f'The hub can not have port {port}: {error}.',
                todo='End the program that has it (sudo ss -lntp), or give another --port: the '
                "hub's is the one after it.",
            ) from error


def _check_access(name: str) -> None:
    """Check that learners can read the course and run its Python."""
    try:
        done = subprocess.run(
            [sys.executable, '-c', 'import rclpy, labkit'],
            cwd='/',
            env=environment_variables(),
            user=name,
            group=name,
            extra_groups=[],
            capture_output=True,
            text=True,
        )
        last = (done.stderr.strip().splitlines() or ['no output'])[-1] if done.returncode else ''
    except OSError as error:  # the Python itself
        last = str(error)
    if last:
        raise LabError(
            f'{name} can not use the course in {str(ROOT)!r}: {last}',
            todo='Put the course, and the Python that it is made with, where everybody may read: '
            'a clone in /srv, and a Python of the system. Then delete .venv and repeat.',
        )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog='labkit hub', allow_abbrev=False)
    parser.add_argument('--class', dest='class_list', type=Path)
    parser.add_argument('--folder', type=Path)
    parser.add_argument('--image')
    parser.add_argument('--new-password')
    parser.add_argument('--port', type=int)
    parser.add_argument('arguments', nargs='*')
    return parser


if __name__ == '__main__':
    try:
        sys.exit(main(sys.argv[1:]))
    except LabError as error:
        print(f'labkit: {error}', file=sys.stderr)
        sys.exit(2)
