"""Visits to the doctor: in a terminal and in a notebook, with the table taken apart."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

__all__ = ['NAMES', 'Visit', 'look', 'visit']

NAMES = [
    *('Python', 'ROS 2 packages', 'Middleware', 'Network', 'Shared memory', 'Domain'),
    *('Variables', 'Nodes', 'Topics', 'Callbacks', 'JupyterLab', 'Disk', 'Compiler'),
]
TIMEOUT_SEC = 120


class Visit:
    """What the doctor said: exit code, all of the text, and what each red line says."""

    def __init__(self, exit_code: int, text: str, noise: str = '') -> None:
        self.exit_code = exit_code
        self.text = text
        self.noise = noise
        self.names = re.findall(r'^[✔✘] (?:good|wrong) +(\S+(?: \S+)*)', text, re.MULTILINE)
        entries = re.split(r'^(?=[✔✘] )', text.split('\n\n')[0], flags=re.MULTILINE)
        self.red = {
            name: ' '.join(entry.split())
            for entry in entries
            for name in NAMES
            if re.match(rf'✘ wrong +{name}\b', entry)
        }


def visit(
    env: dict[str, str], *, python: str = sys.executable, before: tuple[str, ...] = ()
) -> Visit:
    """Run `python3 -m labkit doctor`."""
    command = [*before, python, '-m', 'labkit', 'doctor']
    done = subprocess.run(
        command,
        cwd=Path(env['ROS_LOG_DIR']).parent,  # the test's own folder
        env=env,
        capture_output=True,
        encoding='utf-8',
        timeout=TIMEOUT_SEC,
    )
    return Visit(done.returncode, done.stdout, done.stderr)


def look(kernel: Any) -> Visit:
    """Let `lab.doctor()` look at a kernel."""
    result = kernel.run('report = lab.doctor()\nprint(report)\nprint("ok:", report.ok)')
    assert not result.error, result.traceback
    text, _, ok = result.text.rpartition('ok: ')
    return Visit({'True': 0, 'False': 1}[ok.strip()], text)
