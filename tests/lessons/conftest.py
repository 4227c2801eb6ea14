"""What the tests of the lessons share: the harness beside this file."""

from __future__ import annotations

import statistics
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
# With pytest's importlib mode a test can't import the file beside it by itself.
sys.path.insert(0, str(HERE))
# Neither a test nor, for nbval, a lesson.
collect_ignore = ['demo']


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how long the checks took: figures for people, no test asserts them."""
    times = {
        report.nodeid.partition('[')[2].rstrip(']'): value
        for reports in terminalreporter.stats.values()
        for report in reports
        for name, value in getattr(report, 'user_properties', ())
        if name == 'check_sec' and report.when == 'call'
    }
    if times:
        longest = max(times, key=lambda name: times[name])
        terminalreporter.write_line(
            f'{len(times)} checks: median {statistics.median(times.values()):.2f} s, '
            f'longest {times[longest]:.2f} s ({longest})'
        )
