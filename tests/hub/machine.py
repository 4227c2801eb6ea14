"""A machine for a hub: accounts, homes and processes of its own, all gone with the test.

It is this machine with other namespaces of mounts and processes. `/etc` is a copy, so that new
accounts are in no other place, and what other people may not read is laid where they may: a course
or a Python in root's home is of no use to learners.
"""

from __future__ import annotations

import itertools
import os
import random
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
START_SEC = 180.0
_FOREIGN = ('COVERAGE', 'JPY_', 'JUPYTER', 'LABKIT_', 'PYTEST_', 'ROS_', 'XDG_')
# The first process of the machine: it lets the machine's orphans end.
_INIT = """
import signal
signal.signal(signal.SIGCHLD, signal.SIG_IGN)
print('ready', flush=True)
while True:
    signal.pause()
"""


class Machine:
    """A machine on which a test is root.

    Args:
        folder: An empty folder for what it needs.
    """

    def __init__(self, folder: Path) -> None:
        if os.geteuid() != 0:
            pytest.skip('only root can make accounts and namespaces')
        for command in ('unshare', 'nsenter', 'useradd'):
            if shutil.which(command) is None:
                pytest.skip(f'the command {command} is missing (Debian: util-linux, passwd)')
        self._open_folders: list[Path] = []
        self._env = {k: v for k, v in os.environ.items() if not k.startswith(_FOREIGN)}
        self._init = subprocess.Popen(
            [
                *('unshare', '--mount', '--pid', '--fork', '--kill-child', '--mount-proc'),
                *('sh', '-ec', self._script(folder)),
            ],
            env=self._env,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        if self._init.stdout.readline() != 'ready\n':
            reason = self._init.communicate()[1].strip()
            pytest.skip(f'namespaces are not allowed here: {reason}')
        children = Path(f'/proc/{self._init.pid}/task/{self._init.pid}/children')
        self._pid = children.read_text().split()[0]

    def _script(self, folder: Path) -> str:
        etc = folder / 'etc'
        shutil.copytree('/etc', etc, symlinks=True, ignore_dangling_symlinks=True)
        # Numbers that no other run on this machine has: limits count per number.
        first = random.randrange(20_000, 50_000, 100)
        with (etc / 'login.defs').open('a') as file:
            file.write(f'\nUID_MIN {first}\nGID_MIN {first}\n')
        lines = [f'mount --bind {etc} /etc']
        for place, mode in (('/home', '755'), ('/dev/shm', '1777'), ('/var/log', '755')):
            lines.append(f'mount -t tmpfs -o mode={mode} tmpfs {place}')
        # A systemd of this machine knows nothing of these accounts.
        lines.append('[ ! -d /run/systemd ] || mount -t tmpfs tmpfs /run/systemd')
        lines += _laid_open(folder)
        return '\n'.join([*lines, f'exec {shlex.quote(sys.executable)} -c {shlex.quote(_INIT)}'])

    def command(self, *words: str) -> list[str]:
        """Return a command line that runs a command on the machine, as root."""
        inside = ['nsenter', '--mount', '--pid', '--target', self._pid, '--wd=/', '--']
        return [*inside, *words]

    def start(self, *words: str, log: Path) -> subprocess.Popen[bytes]:
        """Start a command; what it writes goes into a file."""
        with log.open('ab') as file:
            return subprocess.Popen(
                self.command(*words),
                env=self._env,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def run(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run a command to its end."""
        return subprocess.run(
            self.command(*words),
            env=self._env,
            capture_output=True,
            text=True,
            timeout=START_SEC,
            stdin=subprocess.DEVNULL,
        )

    def open_folder(self) -> Path:
        """Return a new folder that everybody can pass through, as through /var/lib."""
        folder = Path(tempfile.mkdtemp(prefix='labkit-hub-', dir='/var/tmp'))
        folder.chmod(0o711)
        self._open_folders.append(folder)
        return folder

    def end(self) -> None:
        """End all that runs on the machine, and take it away."""
        self._init.kill()
        self._init.communicate()
        for folder in self._open_folders:
            shutil.rmtree(folder)


def _laid_open(folder: Path) -> list[str]:
    """Return commands that let everybody reach the course, the environment and its Python."""
    needed = {Path(os.path.realpath(path)) for path in (ROOT, sys.prefix, sys.base_prefix)}
    hidden: dict[Path, list[Path]] = {}
    for path in sorted(needed):
        for above in reversed(path.parents):
            if not above.stat().st_mode & 0o001:
                hidden.setdefault(above, []).append(path)
                break
    lines = []
    numbers = itertools.count()
    for above, paths in hidden.items():
        kept = [folder / f'kept-{next(numbers)}' for _ in paths]
        for path, place in zip(paths, kept, strict=True):
            lines += [f'mkdir {place}', f'mount --bind {path} {place}']
        lines.append(f'mount -t tmpfs -o mode=755 tmpfs {above}')
        for path, place in zip(paths, kept, strict=True):
            lines += [f'mkdir -p {path}', f'mount --move {place} {path}']
    return lines


def _free_port_of_root() -> int:
    """Return a port below 1024 that nobody uses, nor the two after it."""
    while True:
        port = random.randrange(600, 1000)
        with ExitStack() as probes:
            try:
                for number in range(port, port + 3):
                    probes.enter_context(socket.socket()).bind(('127.0.0.1', number))
            except OSError:
                continue
        return port


class Hub:
    """A hub on such a machine, started by labkit's own command.

    Args:
        machine: The machine.
        folder: A folder for its list and log.
        names: The class.
        options: Further options of the command.

    Attributes:
        port: Where it answers.
    """

    def __init__(self, machine: Machine, folder: Path, class_list: str, *options: str) -> None:
        self.machine = machine
        self.port = _free_port_of_root()
        self.state = machine.open_folder() / 'hub'
        self.log_file = folder / 'hub.log'
        self._pid_file = folder / 'hub.pid'
        folder.mkdir(parents=True, exist_ok=True)
        self.list = folder / 'robots.txt'
        self.list.write_text(class_list)
        self._words = [
            *(sys.executable, '-m', 'labkit', 'hub', f'--class={self.list}'),
            *(f'--folder={self.state}', f'--port={self.port}'),
            f'--JupyterHub.pid_file={self._pid_file}',
            *options,
        ]
        self.start()

    def start(self) -> None:
        """Start it, as a teacher does, and wait until it answers."""
        before = len(self.log)
        course = ['env', '-C', str(ROOT), *self._words]
        self._process = self.machine.start(*course, log=self.log_file)

        def up() -> bool:
            assert self._process.poll() is None, f'the hub ended:\n{self.log}'
            return 'JupyterHub is now running' in self.log[before:]

        self.wait(up, 'the hub to start')

    def end(self, signal: str) -> None:
        """Send the hub a signal, such as `TERM`, and wait for its end."""
        assert self.machine.run('kill', f'-{signal}', self._pid_file.read_text()).returncode == 0
        self._process.wait(START_SEC)

    def wait(self, happened: Callable[[], bool], what: str) -> None:
        """Wait until something has happened; fail the test when it does not."""
        end = time.monotonic() + START_SEC
        while not happened():
            assert time.monotonic() < end, f'waited for {what} in vain:\n{self.log}'
            time.sleep(0.1)

    @property
    def log(self) -> str:
        """What the hub, its proxy and learners' servers have written."""
        there = self.log_file.exists()
        return self.log_file.read_text(errors='replace') if there else ''

    def command(self, *words: str) -> tuple[int, str]:
        """Run `labkit hub` to its end, for this hub; return its code and what it says."""
        start = ['env', '-C', str(ROOT), sys.executable, '-m', 'labkit', 'hub']
        done = self.machine.run(*start, f'--folder={self.state}', *words)
        return done.returncode, done.stdout + done.stderr

    def password(self, name: str) -> str:
        """Return somebody's first password, as the teacher finds it."""
        lines = (self.state / 'first-passwords.txt').read_text().splitlines()
        return dict(line.split() for line in lines)[name]
