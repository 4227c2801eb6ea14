"""How long a lesson's test takes, and how long JupyterLab takes to answer."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

from table import Row

__all__ = ['tables']

ROOT = Path(__file__).resolve().parents[2]
TOKEN = 'benchmark'
TIMEOUT_SEC = 120


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of each table."""
    lessons = sorted((ROOT / 'notebooks').glob('[0-9]*.ipynb'))
    yield (
        'Testing a lesson (pytest --nbval)',
        [_lesson(path) for path in (lessons[:1] if quick else lessons)],
    )
    rounds = 1 if quick else 3
    yield (
        'python3 -m labkit lab, from the start of the process',
        [_lab(number) for number in range(rounds)],
    )


def _lesson(path: Path) -> Row:
    begin = time.perf_counter()
    options = ['-q', '-p', 'no:cacheprovider', '--nbval']
    command = [sys.executable, '-m', 'pytest', *options, str(path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    seconds = time.perf_counter() - begin
    return Row(path.stem, seconds, 's' if done.returncode == 0 else 's (failed)')


def _lab(number: int) -> Row:
    what = f'JupyterLab answers, start {number + 2}'
    if not (ROOT / '.venv' / 'labkit.json').is_file():
        return Row(what, None, 'no .venv: run python3 -m labkit lab first', at_most=5)
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        port = probe.getsockname()[1]
    options = ['--no-browser', f'--port={port}', f'--IdentityProvider.token={TOKEN}']
    begin = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, '-m', 'labkit', 'lab', *options],
        cwd=ROOT,
        env={**os.environ, 'PYTHONPATH': ''},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        answered = _wait_for(f'http://127.0.0.1:{port}/lab?token={TOKEN}', process)
        seconds = time.perf_counter() - begin
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(TIMEOUT_SEC)
    return Row(what, seconds if answered else None, 's' if answered else 'ended', at_most=5)


def _wait_for(url: str, process: subprocess.Popen[bytes]) -> bool:
    """Wait until a page is there; return whether it came before the process ended."""
    while process.poll() is None:
        try:
            with urllib.request.urlopen(url, timeout=TIMEOUT_SEC) as page:
                return b'jupyter-config-data' in page.read()
        except (OSError, urllib.error.URLError):
            time.sleep(0.01)
    return False
