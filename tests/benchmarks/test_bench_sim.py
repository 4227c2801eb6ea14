"""The benchmark of the robot runs. What it measures is for people to judge."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def test_bench_sim_prints_its_table(lab_env: dict[str, str]) -> None:
    bench = Path(__file__).with_name('bench_sim.py')
    done = subprocess.run(
        [sys.executable, str(bench), '--quick'],
        env=lab_env,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    rows = (
        'headless with scan, playground',
        'CPU of the robot',
        'CPU of robot and open arena',
        '/odom stamps',
        'lock-step',
    )
    for row in rows:
        assert row in done.stdout
