"""How long a set-up takes, a lesson's test, and JupyterLab to answer."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

from table import Row

__all__ = ['lessons', 'setup', 'tables']

ROOT = Path(__file__).resolve().parents[2]
TOKEN = 'benchmark'
TIMEOUT_SEC = 120


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure how long JupyterLab takes to answer, and give title and rows of the table."""
    rounds = 1 if quick else 3
    rows = [_lab(ROOT, f'JupyterLab answers, start {number + 2}') for number in range(rounds)]
    if not quick:
        rows.append(_fast_tests())
    yield "The course's own commands", rows


def lessons(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure how long the test of each lesson takes, and give title and rows of the table."""
    paths = sorted((ROOT / 'notebooks').glob('[0-9]*.ipynb'))
    rows = [_lesson(path) for path in (paths[:1] if quick else paths)]
    yield 'Testing a lesson (pytest --nbval)', rows


def setup(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure the first start in an empty clone beside `python3 -m venv` and pip."""
    if quick:
        return
    with tempfile.TemporaryDirectory() as folder:
        clone, conventional = Path(folder, 'clone'), Path(folder, 'conventional')
        for path in (clone, conventional):
            subprocess.run(['git', 'clone', '-q', str(ROOT), str(path)], check=True)
        ours = _lab(clone, 'python3 -m labkit lab, JupyterLab answers', first=True)
        begin = time.perf_counter()
        python = conventional / '.venv' / 'bin' / 'python'
        for command in (
            [_base_python(), '-m', 'venv', '.venv'],
            [str(python), '-m', 'pip', 'install', '-q', '-r', 'environment.txt'],
        ):
            subprocess.run(command, cwd=conventional, env=_environment(), check=True)
        theirs = time.perf_counter() - begin
    ratio = ours.figure / theirs if ours.figure is not None else None
    yield (
        'The first start',
        [
            ours,
            Row('venv, and pip install -r environment.txt', theirs, 's'),
            Row('labkit lab / pip', ratio, ours.unit if ratio is None else '', at_most=0.25),
        ],
    )


def _fast_tests() -> Row:
    begin = time.perf_counter()
    command = [_base_python(), '-m', 'labkit', 'test', '--fast']
    done = subprocess.run(command, cwd=ROOT, env=_environment(), capture_output=True)
    seconds = time.perf_counter() - begin
    unit = 's' if done.returncode == 0 else 's (failed)'
    return Row('labkit test --fast', seconds, unit, at_most=45)


def _lesson(path: Path) -> Row:
    begin = time.perf_counter()
    options = ['-q', '-p', 'no:cacheprovider', '--nbval']
    command = [sys.executable, '-m', 'pytest', *options, str(path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    seconds = time.perf_counter() - begin
    return Row(path.stem, seconds, 's' if done.returncode == 0 else 's (failed)')


def _lab(root: Path, what: str, *, first: bool = False) -> Row:
    if not (first or (root / '.venv' / 'labkit.json').is_file()):
        return Row(what, None, 'no .venv: run python3 -m labkit lab first', at_most=2.5)
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        port = probe.getsockname()[1]
    options = ['--no-browser', f'--port={port}', f'--IdentityProvider.token={TOKEN}']
    begin = time.perf_counter()
    process = subprocess.Popen(
        [_base_python(), '-m', 'labkit', 'lab', *options],
        cwd=root,
        env=_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        answered = _wait_for(f'http://127.0.0.1:{port}/lab?token={TOKEN}', process)
        seconds = time.perf_counter() - begin
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(TIMEOUT_SEC)
    limit = None if first else 2.5
    return Row(what, seconds if answered else None, 's' if answered else 'ended', at_most=limit)


def _base_python() -> str:
    """Return the Python that the environment of this one was made with."""
    return os.path.realpath(sys.executable)


def _environment() -> dict[str, str]:
    """Return the variables of a terminal without an environment, and so without its uv."""
    here = str(Path(sys.executable).parent)
    paths = [path for path in os.environ['PATH'].split(os.pathsep) if path != here]
    gone = ('PYTHONPATH', 'VIRTUAL_ENV')
    variables = {name: value for name, value in os.environ.items() if name not in gone}
    return {**variables, 'PATH': os.pathsep.join(paths)}


def _wait_for(url: str, process: subprocess.Popen[bytes]) -> bool:
    """Wait until a page is there; return whether it came before the process ended."""
    while process.poll() is None:
        try:
            with urllib.request.urlopen(url, timeout=TIMEOUT_SEC) as page:
                return b'jupyter-config-data' in page.read()
        except (OSError, urllib.error.URLError):
            time.sleep(0.01)
    return False
