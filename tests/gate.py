"""What belongs to the gate, what is in quarantine, and what is told at the end of a run.

A plugin of pytest, loaded by `python3 -m labkit test`. The gate is what has neither the marker
`slow` nor `quarantined`. The first stands in the code, on a test or a file, with a word on why.
The second comes from `tests/quarantine.txt`: tests that flake, and that nobody could mend yet.
They run with `--all`, decide nothing, and are told with their result.
"""

from __future__ import annotations

import json
import re
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import pytest

QUARANTINE = Path(__file__).with_name('quarantine.txt')
# What takes longer on a calm machine should be marked, so that the gate stays small.
SLOW_SEC = 3.0
_TOLD = 60

_failures = pytest.StashKey[dict[str, str]]()
_seconds = pytest.StashKey[dict[str, float]]()


class Quarantined(NamedTuple):
    """A line of the list: a test, since when it is there, what is seen, what is suspected."""

    test: str
    since: str
    seen: str
    suspected: str


def quarantine(text: str | None = None) -> list[Quarantined]:
    """Read the list. Its lines have four parts, with ` | ` between them.

    Raises:
        ValueError: A line has another form.
    """
    lines = (QUARANTINE.read_text(encoding='utf-8') if text is None else text).splitlines()
    found = []
    for line in lines:
        if not line.strip() or line.startswith('#'):
            continue
        parts = [part.strip() for part in line.split(' | ')]
        if len(parts) != 4 or not all(parts) or not re.fullmatch(r'\d{4}-\d\d-\d\d', parts[1]):
            raise ValueError(f'Not `test | YYYY-MM-DD | seen | suspected`: {line}')
        found.append(Quarantined(*parts))
    return found


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--failures`: where a run notes what has failed, for a second try."""
    parser.addoption('--failures', metavar='FILE', help='note failed tests there, as JSON')


def pytest_configure(config: pytest.Config) -> None:
    """Begin a run."""
    config.stash[_failures] = {}
    config.stash[_seconds] = defaultdict(float)
    config.pluginmanager.register(_Notes(config), 'labkit-notes')


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what is in quarantine, before `-m` is looked at; refuse `slow` without a reason."""
    listed = {one.test: one for one in quarantine()}
    for item in items:
        one = listed.get(item.nodeid)
        if one:
            item.add_marker('quarantined')
            # Not strict: it may pass as well. `--runxfail` shows such a test as any other.
            item.add_marker(pytest.mark.xfail(reason=f'since {one.since}: {one.seen}'))
        if any(not marker.args for marker in item.iter_markers('slow')):
            raise pytest.UsageError(f'{item.nodeid} is marked as slow: say why, in its brackets.')


class _Notes:
    """Notes the outcome of each test, and tells at the end what a reader has to know."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            crash = getattr(report.longrepr, 'reprcrash', None)
            text = crash.message if crash else report.longreprtext
            line = next(iter(text.strip().splitlines()), 'failed')
            self._config.stash[_failures].setdefault(report.nodeid, line[:200])
        if 'slow' not in report.keywords and '.ipynb::' not in report.nodeid:
            self._config.stash[_seconds][report.nodeid] += report.duration

    def pytest_sessionfinish(self) -> None:
        path = self._config.getoption('failures')
        if path and not hasattr(self._config, 'workerinput'):
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_text(json.dumps(self._config.stash[_failures]), encoding='utf-8')

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        line = terminalreporter.line
        longer = [
            (seconds, test)
            for test, seconds in self._config.stash[_seconds].items()
            if seconds > SLOW_SEC
        ]
        if longer:
            line(f'{len(longer)} tests took over {SLOW_SEC:g} s, and are not marked as slow:')
        for seconds, test in sorted(longer, reverse=True)[:_TOLD]:
            line(f'  {seconds:6.1f} s  {test}')
        results = {
            report.nodeid: 'failed' if outcome == 'xfailed' else 'passed'
            for outcome in ('xfailed', 'xpassed')
            for report in terminalreporter.getreports(outcome)
        }
        for one in quarantine():
            result = results.get(one.test, 'not run')
            line(f'in quarantine, decides nothing: {one.test}: {result} (since {one.since})')
