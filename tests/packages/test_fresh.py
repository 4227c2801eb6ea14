"""A module is loaded in a fresh Python: it ends, and its end is told."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import pytest

from labkit.errors import LabError
from labkit.packages import fresh
from labkit.packages.cells import Notebook
from labkit.packages.gather import Gathered


def refusal(text: str) -> str:
    """Return what is said of a module that does not load."""
    with pytest.raises(LabError) as raised:
        fresh.lacking_imports('talk.talker', text, Gathered('Talker'), Notebook({}, []))
    return raised.value.message.partition('Python.\n')[2]


def lacking(text: str) -> set[str]:
    return fresh.lacking_imports('talk.talker', text, Gathered('Talker'), Notebook({}, []))


def test_main_is_not_called():
    assert lacking("if __name__ == '__main__':\n    raise AssertionError\n") == set()


def test_what_never_ends_is_ended(monkeypatch):
    monkeypatch.setattr(fresh, 'LOAD_SEC', 1)
    endless = 'try:\n    while True:\n        pass\nexcept Exception:\n    pass\n'
    assert refusal(endless).endswith('It takes longer than 1 s.')
    monkeypatch.setattr(fresh, 'SPARE_SEC', 0)
    deaf = 'import signal\nsignal.pthread_sigmask(0, [signal.SIGALRM])\nwhile True:\n    pass\n'
    assert refusal(deaf) == 'It does not end.'


def test_a_module_that_ends_python():
    assert refusal('import sys\nsys.exit(3)\n') == 'sys.exit(3)\nSystemExit: 3'
    assert refusal('import os\nos._exit(4)\n') == 'Python ended with exit code 4.'


def test_what_the_module_has_started_ends_with_it(tmp_path):
    """It neither keeps the fresh Python alive, nor outlives it."""
    note = tmp_path / 'pid'
    text = (
        'import pathlib, subprocess, threading, time\n'
        "child = subprocess.Popen(['sleep', '1000'])\n"
        f'pathlib.Path({str(note)!r}).write_text(str(child.pid))\n'
        'threading.Thread(target=time.sleep, args=(1000,)).start()\n'
    )
    assert lacking(text) == set()
    stat = Path(f'/proc/{note.read_text()}/stat')
    with suppress(FileNotFoundError):
        while stat.read_text().rpartition(')')[2].split()[0] not in 'ZX':
            os.sched_yield()
