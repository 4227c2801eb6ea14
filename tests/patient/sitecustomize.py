"""Lets the waits of kernels and scripts under test last, and without a bar below them.

Python imports this at its start where the folder is on its path, see `patiently` in
tests/conftest.py. A test waits for what will come, and on a busy machine that may take longer than
the default of learners; and whether a bar appears depends on the machine, too. A test of the limit
names one, and a test of the bar says when it appears.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from operator import attrgetter
from types import ModuleType

# Less than a test gives a cell, so that it is told what was waited for.
LIMIT_SEC = 50.0
WAITS = {
    'labkit.asking.waiting': (
        'listen',
        'wait_for_message',
        'wait_for_subscribers',
        'wait_until',
    ),
    'labkit.bags.recorder': ('Recording.wait_for', 'record'),
    'labkit.programs.child_processes': ('Process.wait_for_lines',),
}

BARS = 'labkit.progress_bar'


class Patient:
    """Changes the defaults when one of these modules has been loaded."""

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name not in WAITS and name != BARS:
            return None
        spec = PathFinder.find_spec(name, path, target)
        assert spec is not None and spec.loader is not None
        load = spec.loader.exec_module

        def exec_module(module: ModuleType) -> None:
            load(module)
            if name == BARS:
                vars(module)['SHOWN_AFTER_SEC'] = float('inf')
            for function in WAITS.get(name, ()):
                attrgetter(function)(module).__kwdefaults__['timeout_sec'] = LIMIT_SEC

        spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec


sys.meta_path.insert(0, Patient)
