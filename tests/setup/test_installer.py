"""How far the installation is, shown from its first moment."""

from __future__ import annotations

import io
import sys

import pytest

from labkit.setup.installer import Progress


class Terminal(io.StringIO):
    """What a terminal is given."""

    def isatty(self) -> bool:
        return True


def test_log_gets_a_line_at_once_and_then_for_news(capsys: pytest.CaptureFixture[str]) -> None:
    progress = Progress(120)
    for what, count in (('Preparing', 0), ('Preparing', 0), ('Fetching', 3), ('Fetching', 51)):
        progress.show(what, count)
    assert capsys.readouterr().out.splitlines() == [
        '  Preparing    0 of 120 packages',
        '  Fetching    50 of 120 packages',
    ]


def test_terminal_gets_one_line_that_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, 'stdout', terminal)
    progress = Progress(4)
    progress.show('Preparing', 0)
    progress.show('Installing', 2)
    shown = terminal.getvalue()
    assert '\n' not in shown and shown.count('\r') == 2
    assert 'Preparing    0 of 4 packages, 0 s' in shown
    assert '[###############...............] Installing   2 of 4 packages' in shown
