"""Install packages with uv or pip, with progress shown, and explain it when that fails."""

from __future__ import annotations

import ast
import os
import re
import shutil
import ssl
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Any

from labkit.errors import SetupError
from labkit.setup.machine import clean_environment, run

__all__ = ['Progress', 'explain', 'install']

# How often progress is looked at, s.
TICK_SEC = 0.2
_NO_NETWORK = re.compile(
    r'NewConnectionError|NameResolutionError|Temporary failure in name resolution|'
    r'Name or service not known|dns error|Network is unreachable|Connection (refused|reset)|'
    r'ConnectTimeout|ReadTimeout|timed out|ProxyError|error sending request|Could not connect',
    re.IGNORECASE,
)
# pip names each package once, uv the large ones.
_FETCHED = re.compile(
    r' *(?:Collecting|Requirement already satisfied:|Obtaining|Downloaded) (\S+)'
)
_NO_SPACE = re.compile(r'No space left on device|Disk quota exceeded', re.IGNORECASE)
_UNTRUSTED = re.compile(r'invalid peer certificate|certificate.verify.failed', re.IGNORECASE)
_WRONG_HASH = re.compile(r'hash mismatch|DO NOT MATCH THE HASHES', re.IGNORECASE)
# The same versions as in the file of the requirements, with the hashes of the packages' files.
LOCKED = 'environment.txt'
LOCK = 'labkit/setup/environment.lock'
_LOCKED_UV = re.compile(r'^uv==(?:.*\\\n)*.*\n', re.MULTILINE)
# Distributions may keep the wheels of `ensurepip` in a folder of their own.
_FIND_PIP = """
import ensurepip, pathlib, sysconfig
own = pathlib.Path(ensurepip.__file__).parent / '_bundled'
folders = [own, pathlib.Path(sysconfig.get_config_var('WHEEL_PKG_DIR') or own)]
print(next((path for folder in folders for path in folder.glob('pip-*.whl')), ''))
"""
_RUN_PIP = """
import runpy, sys
sys.path.insert(0, sys.argv.pop(1))
sys.argv[0] = 'pip'
runpy.run_module('pip', run_name='__main__', alter_sys=True)
"""
_READ_ONLY = re.compile(r'Read-only file system', re.IGNORECASE)
# Settings of pip that say where packages come from, and the variables that tell uv the same:
# a school's mirror and its certificate are often known to pip alone.
_OF_UV = {
    'index-url': 'UV_DEFAULT_INDEX',
    'extra-index-url': 'UV_INDEX',
    'find-links': 'UV_FIND_LINKS',
    'no-index': 'UV_NO_INDEX',
    'trusted-host': 'UV_INSECURE_HOST',
    'cert': 'SSL_CERT_FILE',
    'proxy': 'ALL_PROXY',
}
# pip lists a setting as `group.name='value'`; of two groups the later one here counts.
_SETTING = re.compile(r"^(global|install|:env:)\.([\w-]+)=('.*'|\".*\")$", re.MULTILINE)
# What is done with the packages in the second half of the way, when they have been fetched.
_SECOND_HALF = ('Installing', 'Installed')


class Progress:
    """Show how many of so many packages have come, in place or, in a log, line by line.

    Args:
        total: Number of packages to come.
    """

    def __init__(self, total: int) -> None:
        self.total = total
        self._start = time.monotonic()
        self._in_place = sys.stdout.isatty()
        self._shown = ''

    def show(self, what: str, count: int) -> None:
        """Show that `count` packages have come, if that is news.

        Args:
            what: What is done with them, in one word.
            count: Number of packages.
        """
        count = min(count, self.total)
        if not self._in_place:
            count -= count % 50 if count < self.total else 0  # a log needs no line a package
        line = f'{what:<10} {count:>3} of {self.total} packages'
        if self._in_place:
            behind = count + (self.total if what in _SECOND_HALF else 0)
            done = 15 * behind // max(self.total, 1)
            bar = '#' * done + '.' * (30 - done)
            seconds = time.monotonic() - self._start
            print(f'\r  [{bar}] {line}, {seconds:.0f} s ', end='', flush=True)
        elif line != self._shown and (count > 0 or not self._shown):
            print(f'  {line}', flush=True)
        self._shown = line

    def close(self) -> None:
        """Leave the line in which progress was shown."""
        if self._in_place and self._shown:
            print(flush=True)
        self._shown = ''


def install(
    python: Path,
    root: Path,
    requirements: Sequence[str],
    progress: Progress,
    count_installed: Callable[[], int],
    options: Sequence[str] = (),
) -> None:
    """Install what the files ask for: with uv, which takes seconds, or else with pip.

    A uv that is on PATH is used. Otherwise pip fetches the one of the course into the environment.

    Args:
        python: Interpreter of the environment.
        root: Folder that the files and the paths in them are relative to.
        requirements: Names of the files.
        progress: Where to show how far it is.
        count_installed: Tells how many packages are installed.
        options: Further ones that uv and pip both know, such as `--no-deps`.

    Raises:
        SetupError: It did not work, with the reason and what to do.
    """
    variables = clean_environment()
    # Settings of the user's own that would install somewhere else.
    for name in ('PIP_TARGET', 'PIP_PREFIX', 'PIP_ROOT', 'UV_SYSTEM_PYTHON'):
        variables.pop(name, None)
    variables.update(PIP_USER='0', PIP_NO_INPUT='1', UV_NO_PROGRESS='1')
    progress.show('Preparing', 0)
    pip = _pip(python)
    variables = {**_sources(pip, root, variables), **variables}

    def follow(command: Sequence[str], stdin: IO[str] | None = None) -> tuple[int, list[str]]:
        return _follow(command, root, variables, progress, count_installed, stdin)

    uv = shutil.which('uv') or (_fetch_uv(pip, python, root, follow) if pip else None)
    # pip does the last by itself. uv looks at the version and at pyproject.toml, not at the files
    # that are copied into the environment.
    own = ['--python', str(python), '--reinstall-package', 'labkit']
    installers = [[uv, 'pip', 'install', *own]] if uv else []
    # What uv has begun and not finished looks installed to pip.
    installers += [[*pip, 'install', *(['--force-reinstall'] if uv else [])]] if pip else []
    output: list[str] = []
    for installer in installers:
        try:
            for step in _steps(root, requirements):
                code, output = follow([*installer, *options, *step])
                if code != 0:
                    break
            else:
                progress.show('Installed', progress.total)
                return
        finally:
            progress.close()
        text = '\n'.join(output)
        if _NO_SPACE.search(text) or _READ_ONLY.search(text) or _WRONG_HASH.search(text):
            break  # pip would find the same
        if installer is not installers[-1]:
            print(
                f'uv could not install the packages: {_last_error(output)!r}. '
                'Trying pip, which takes longer.',
                flush=True,
            )
    raise explain(output, root)


def _pip(python: Path) -> list[str]:
    """Return a command that runs pip in the environment; [] if there is none.

    One that is not installed is run out of the wheel that comes with Python: to install it from
    there first would take longer than uv takes for everything.
    """
    options = ['--disable-pip-version-check']
    if (python.parent / 'pip').exists():
        return [str(python), '-I', '-m', 'pip', *options]
    wheel = run([str(python), '-I', '-c', _FIND_PIP]).stdout.strip()
    return [str(python), '-I', '-c', _RUN_PIP, wheel, *options] if wheel else []


def _fetch_uv(
    pip: Sequence[str], python: Path, root: Path, follow: Callable[..., tuple[int, list[str]]]
) -> str | None:
    """Let pip install the course's uv.

    Returns:
        Its path, None if the course names none.

    Raises:
        SetupError: It did not work. pip could not install the others either.
    """
    lock = root / LOCK
    found = _LOCKED_UV.search(lock.read_text(encoding='utf-8')) if lock.is_file() else None
    if found is None:
        return None
    command = [*pip, 'install', '--quiet', '--no-deps', '--require-hashes', '-r', '/dev/stdin']
    with tempfile.TemporaryFile('w+') as wanted:
        wanted.write(found[0])
        wanted.seek(0)
        code, output = follow(command, wanted)
    if code != 0:
        raise explain(output, root)
    return str(python.parent / 'uv')


def _sources(pip: Sequence[str], root: Path, variables: dict[str, str]) -> dict[str, str]:
    """Return the variables that let uv take packages from where pip takes them.

    Both trust the certificates that pip is told to, or else those of the system: a school's proxy
    has one of its own, which the lists that come with uv and with an older pip do not know.
    """
    # One that is installed answers at once, one that is run out of its wheel after a second.
    installed = [sys.executable, '-I', '-m', 'pip']
    output = ''
    for command in [pip] if '-m' in pip else [installed, pip]:
        if command:
            listed = run([*command, 'config', 'list'], cwd=root, env=variables)
            output = listed.stdout
            if listed.returncode == 0:
                break
    # pip takes the best file of all places, uv would look no further than the first.
    found = {'UV_INDEX_STRATEGY': 'unsafe-best-match'}
    for group in ('global', 'install', ':env:'):
        for of, name, value in _SETTING.findall(output):
            if of == group and name in _OF_UV:
                # uv wants several paths with commas between, several addresses with spaces.
                between = ',' if name == 'find-links' else ' '
                found[_OF_UV[name]] = between.join(ast.literal_eval(value).split())
    if 'SSL_CERT_FILE' not in found and (trusted := _system_certificates()):
        found.update(UV_SYSTEM_CERTS='1', PIP_CERT=trusted)
    return found


def _system_certificates() -> str:
    """Return the file or folder with the certificates that the system trusts, '' if it has none.

    In a small container it may have none. uv would then refuse to start.
    """
    paths = ssl.get_default_verify_paths()
    hashed = Path(paths.capath or os.devnull).glob('*.0')  # as OpenSSL looks for them in a folder
    return paths.cafile or (str(paths.capath) if any(hashed) else '')


def _steps(root: Path, requirements: Sequence[str]) -> list[list[str]]:
    """Return what to install one after the other, as options of uv and of pip."""
    if LOCKED not in requirements or not (root / LOCK).is_file():
        return [[option for name in requirements for option in ('-r', name)]]
    # A lock that lies beside its file has all that comes on top of the environment.
    locks = {name: Path(name).with_suffix('.lock') for name in requirements if name != LOCKED}
    locked = [str(lock) for lock in locks.values() if (root / lock).is_file()]
    others = [
        option
        for name, lock in locks.items()
        if str(lock) not in locked
        for option in ('-r', name)
    ]
    return [
        ['--no-deps', '--require-hashes', '-r', LOCK],
        # The package of the folder itself has no hash. What builds it is there by now.
        ['--no-deps', '--no-build-isolation', '-e', '.'],
        *(['--no-deps', '--require-hashes', '-r', lock] for lock in locked),
        *([others] if others else []),
    ]


def _follow(
    command: Sequence[str],
    root: Path,
    variables: dict[str, str],
    progress: Progress,
    count_installed: Callable[[], int],
    stdin: IO[str] | None,
) -> tuple[int, list[str]]:
    """Run the installer and show its progress. Return its exit code and its last lines."""
    process = subprocess.Popen(
        command,
        cwd=root,
        env=variables,
        stdin=stdin or subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors='replace',
        close_fds=False,  # it keeps the lock: see environment
    )
    output: deque[str] = deque(maxlen=400)
    fetched: set[str] = set()

    def read() -> None:
        for line in process.stdout or ():
            output.append(line.rstrip())
            found = _FETCHED.match(line)
            if found:
                fetched.add(found[1])

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    installed_before = count_installed()
    installing = False
    try:
        while process.poll() is None:
            installed = count_installed()
            installing = installing or installed != installed_before
            if installing:
                progress.show('Installing', installed)
            else:
                progress.show('Fetching', len(fetched))
            try:
                process.wait(timeout=TICK_SEC)
            except subprocess.TimeoutExpired:
                pass
        reader.join()
    finally:
        _end(process)
    return process.returncode, list(output)


def _end(process: subprocess.Popen[Any]) -> None:
    """End a process that still runs, because waiting for it was interrupted."""
    if process.poll() is None:
        process.terminate()
        process.wait()


def explain(output: Sequence[str], root: Path) -> SetupError:
    """Return the error that says why the installer failed and what to do.

    Args:
        output: What it printed, line by line.
        root: Folder of the course.
    """
    text = '\n'.join(output)
    if _NO_SPACE.search(text):
        place = os.environ.get('TMPDIR', '/tmp')
        return SetupError(
            f'There is no disk space left in {str(root)!r}, in {place!r} or in your home folder.',
            todo='Free some space, and repeat the command.',
        )
    if _READ_ONLY.search(text):
        return SetupError(
            f'The folder {str(root)!r}, or the one for temporary files, can not be written to.',
            todo='Copy the course to a folder of your own, and repeat the command there.',
        )
    if _WRONG_HASH.search(text):
        return SetupError(
            'A package that was fetched is not the one that the course was tested with: its hash '
            'differs.',
            todo='Repeat the command: a download may have been damaged. If it stays, ask who runs '
            'the package index or proxy of this network.\nThe last lines of the installer:\n  '
            + '\n  '.join(output[-15:]),
        )
    last = _last_error(output)
    if _UNTRUSTED.search(text):
        return SetupError(
            'The package index, or a proxy on the way to it, shows a certificate that is not '
            'trusted here.',
            todo="Ask who runs this network for its certificate, and add it to the system's, or "
            'name its file in SSL_CERT_FILE. Then repeat the command. The installer said: '
            f'{last}',
        )
    if _NO_NETWORK.search(text):
        return SetupError(
            'Packages could not be fetched: the network, or the package index, does not answer.',
            todo='Connect to the internet (behind a proxy, set HTTPS_PROXY), and repeat the '
            f'command. The installer said: {last}',
        )
    return SetupError(
        f'Packages could not be installed: {last!r}',
        todo='The last lines of the installer:\n  ' + '\n  '.join(output[-15:]),
    )


def _last_error(output: Sequence[str]) -> str:
    """Return what of an installer's output says most likely why it failed."""
    lines = [line.strip() for line in output if line.strip()] or ['no output']
    errors = [line for line in lines if re.match(r'ERROR|error|×', line)]
    # uv goes on with the cause of the error, the cause of that, and so on.
    causes = [line for line in lines if re.match(r'cause:|[├╰]─▶', line)]
    return ', '.join([*(errors or lines)[-1:], *causes[-1:]])
