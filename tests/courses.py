"""A course in small: the real command line, in a folder of its own, with tiny packages."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import ssl
import subprocess
import sys
import threading
import zipfile
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from labkit.setup import machine
from labkit.setup.installer import LOCK

ROOT = Path(__file__).resolve().parent.parent
# A hang ends; nothing is judged by it.
TIMEOUT_SEC = 240
BARE_PATH = '/usr/bin:/bin'
START = '00_start_here.ipynb'


class Course:
    """A copy of what sets up a fresh machine. Its `environment.txt` names wheels made here.

    Args:
        folder: Where to put it; made if it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.venv = folder / '.venv'
        self.work = folder / 'work'
        ignored = shutil.ignore_patterns('__pycache__', 'exercises', 'ros2', '*.lock')
        shutil.copytree(ROOT / 'labkit', folder / 'labkit', ignore=ignored)
        (folder / 'notebooks').mkdir()
        for name in ('labkit/hub', 'tests', 'docs'):
            (folder / name).mkdir(exist_ok=True)
            (folder / name / 'requirements.txt').write_text('')
        for name in ('gate.py', 'quarantine.txt'):
            shutil.copy(ROOT / 'tests' / name, folder / 'tests')
        self.require(self.wheel('alpha'))
        self.env = machine.clean_environment()
        # With uv, which is quick; no waiting for a network that isn't there.
        uv = shutil.which('uv', path=f'{Path(sys.executable).parent}:{os.environ["PATH"]}')
        assert uv is not None, 'tests/requirements.txt brings it'
        (folder / 'uv').mkdir()
        (folder / 'uv' / 'uv').symlink_to(uv)
        self.env.update(PATH=f'{folder / "uv"}:{BARE_PATH}', UV_HTTP_RETRIES='0', PIP_RETRIES='0')
        # What measures this test is not to measure the course's own tests.
        measuring = ('COVERAGE_FILE', 'COVERAGE_PROCESS_CONFIG')
        for name in ('PYTHONPATH', 'VIRTUAL_ENV', 'LABKIT_REQUIRE_ALL', *measuring):
            self.env.pop(name, None)

    def wheel(
        self, name: str, version: str = '1.0', size: int = 0, program: str | None = None
    ) -> str:
        """Make a package with one module; return its requirement.

        Args:
            name: Its name.
            version: Its version.
            size: Bytes of a further file.
            program: Text of a program of the package's name, None for no program.
        """
        path = self.folder / f'{name}-{version}-py3-none-any.whl'
        info = f'{name}-{version}.dist-info'
        with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(f'{name}.py', f'version = {version!r}\n')
            archive.writestr(f'{name}.bin', bytes(size))
            metadata = f'Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n'
            archive.writestr(f'{info}/METADATA', metadata)
            kind = 'Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n'
            archive.writestr(f'{info}/WHEEL', kind)
            archive.writestr(f'{info}/RECORD', '')
            if program is not None:
                script = zipfile.ZipInfo(f'{name}-{version}.data/scripts/{name}')
                script.external_attr = 0o100755 << 16  # a file that can be run
                archive.writestr(script, program)
        return f'./{path.name}'

    def require(self, *requirements: str) -> None:
        """Write `environment.txt`."""
        (self.folder / 'environment.txt').write_text('\n'.join(requirements) + '\n')

    def lock(self, *wheels: str, file: str = LOCK) -> None:
        """Write the lock: requirements of `wheel`, with the hashes of their files.

        What the course's own package is built with comes too, from the environment of this test.

        Args:
            wheels: The requirements.
            file: The lock's name.
        """
        lines = []
        for wheel in wheels:
            name, version = Path(wheel).name.split('-')[:2]
            digest = hashlib.sha256((self.folder / wheel).read_bytes()).hexdigest()
            lines.append(f'{name}=={version} \\\n    --hash=sha256:{digest}\n')
        (self.folder / file).write_text(''.join(lines))
        self.env.update(
            PIP_FIND_LINKS=str(self.folder),
            UV_FIND_LINKS=str(self.folder),
            PIP_NO_INDEX='1',
            UV_NO_INDEX='1',
        )

    def make_complete(self) -> None:
        """Make the environment, and give it all that the one of this test has."""
        done = self.make()
        assert done.returncode == 0, done.stderr
        self.lend_packages()
        shutil.copytree(ROOT / 'labkit' / 'data' / 'etc', self.venv / 'etc')
        (self.venv / 'share').symlink_to(Path(sys.prefix) / 'share')

    def lend_packages(self) -> None:
        """Let the environment see all packages of the one of this test."""
        packages = next((self.venv / 'lib').glob('python3.*')) / 'site-packages'
        here = next((Path(sys.prefix) / 'lib').glob('python3.*')) / 'site-packages'
        (packages / 'all.pth').write_text(f'import site; site.addsitedir({str(here)!r})\n')

    def command(self, *words: str) -> list[str]:
        """Return the command line of labkit in a Python without any packages."""
        return [base_python(), '-S', '-m', 'labkit', *words]

    def make(self, **env: str) -> subprocess.CompletedProcess[str]:
        """Make the environment and nothing else, as `lab` does it before it starts JupyterLab."""
        return self.python('labkit.setup.environment.make_environment()', **env)

    def python(self, code: str, **env: str) -> subprocess.CompletedProcess[str]:
        """Run code in a bare Python, as the command line does: errors become a sentence."""
        return subprocess.run(
            self.script(code),
            cwd=self.folder,
            env={**self.env, **env},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_SEC,
            stdin=subprocess.DEVNULL,
        )

    def script(self, code: str) -> list[str]:
        """Return a command line that runs code under labkit's way to report errors."""
        program = (
            'import sys, labkit.__main__, labkit.setup.environment\n'
            f'labkit.__main__._run = lambda words: {code} and 0\n'
            'sys.exit(labkit.__main__.main([]))'
        )
        return [base_python(), '-S', '-c', program]

    def run(self, *words: str, **env: str) -> subprocess.CompletedProcess[str]:
        """Run labkit's command line to its end."""
        return subprocess.run(
            self.command(*words),
            cwd=self.folder,
            env={**self.env, **env},
            capture_output=True,
            text=True,
            timeout=TIMEOUT_SEC,
            stdin=subprocess.DEVNULL,
        )

    def start(self, command: list[str], **env: str) -> subprocess.Popen[str]:
        """Start a process in the course's folder, with a group of its own."""
        return subprocess.Popen(
            command,
            cwd=self.folder,
            env={**self.env, **env},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def installed(self) -> set[str]:
        """Return the tiny packages of the environment, as its own Python finds them."""
        code = (
            'from importlib.metadata import distributions as d; '
            'print(*(f"{i.name}-{i.version}" for i in d()))'
        )
        answer = subprocess.run(
            [self.venv / 'bin' / 'python', '-I', '-c', code],
            env=self.env,
            capture_output=True,
            text=True,
            check=True,
        )
        return {name for name in answer.stdout.split() if not name.startswith(('pip', 'setup'))}


def notebook(text: str) -> str:
    """Return a lesson with one executed code cell."""
    output = {'output_type': 'stream', 'name': 'stdout', 'text': ['heard\n']}
    cell = {
        'cell_type': 'code',
        'execution_count': 7,
        'id': 'talker-class',
        'metadata': {'tags': ['nbval-ignore-output']},
        'outputs': [output],
        'source': [text],
    }
    metadata = {
        'kernelspec': {'display_name': 'Python 3', 'language': 'python', 'name': 'python3'}
    }
    content = {'cells': [cell], 'metadata': metadata, 'nbformat': 4, 'nbformat_minor': 5}
    return json.dumps(content)


def base_python() -> str:
    """Return this Python outside of its environment."""
    return machine.find_interpreter().path


def sentence(done: subprocess.CompletedProcess[str]) -> str:
    """Return the message of a command that was refused in the proper way."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert 'Traceback' not in done.stderr
    assert done.stderr.startswith('labkit: ')
    return done.stderr


def wait_for_line(process: subprocess.Popen[str], text: str) -> str:
    """Read what a process prints until a line has `text` in it; return that line."""
    lines = []
    assert process.stdout is not None
    for line in process.stdout:
        lines.append(line)
        if text in line:
            return line
    raise AssertionError(f'ended without {text!r}:\n{"".join(lines)}')


class Gate:
    """A web server that hands out a course's wheels, but not before it is opened.

    Args:
        folder: Where they are.
        certificate: A file with the key and the certificate of a server of https, None for http.

    Attributes:
        asked: Set when the first one is asked for.
        opened: Set it, and they are handed out.
    """

    def __init__(self, folder: Path, certificate: Path | None = None) -> None:
        self.asked = asked = threading.Event()
        self.opened = opened = threading.Event()

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                asked.set()
                opened.wait(TIMEOUT_SEC)
                content = (folder / os.path.basename(self.path)).read_bytes()
                try:
                    self.send_response(200)
                    self.send_header('Content-Length', str(len(content)))
                    self.end_headers()
                    self.wfile.write(content)
                except ConnectionError:
                    pass  # who asked is gone

            do_HEAD = do_GET

            def log_message(self, *_args: object) -> None:
                pass

        self._server = ThreadingHTTPServer(('127.0.0.1', 0), Handler)
        self.url = f'http{"s" * bool(certificate)}://127.0.0.1:{self._server.server_address[1]}'
        if certificate:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(certificate)
            self._server.socket = context.wrap_socket(self._server.socket, server_side=True)
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        """Let everybody pass, and end."""
        self.opened.set()
        self._server.shutdown()
        self._server.server_close()
