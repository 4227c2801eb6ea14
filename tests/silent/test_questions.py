"""What others have asked about in public is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from labkit.silent.catalogue import KINDS
from tests.conftest import Kernel
from tests.silent.questions import QUESTIONS

PRELUDE = Path(__file__).parent / 'cases' / 'prelude.py'


def test_each_thread_is_named_once() -> None:
    threads = [one.thread for one in QUESTIONS]
    assert len(set(threads)) == len(threads) >= 40
    assert {one.told for one in QUESTIONS} <= KINDS.keys()


def test_what_was_wrong_is_told(start_kernel: Callable[..., Kernel]) -> None:
    kernel = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    assert not kernel.run(PRELUDE.read_text(encoding='utf-8')).error
    wrong = []
    for one in QUESTIONS:
        made = kernel.run(one.cell)
        seen = kernel.run('look()')
        told = [line.split()[1:] for line in seen.text.splitlines() if line.startswith('TOLD')]
        if made.error or not told or one.told not in told[-1]:
            wrong.append(f'{one.thread}: {made.traceback}\n{seen.text}')
        kernel.run('clean()')
    assert not wrong, '\n\n'.join(wrong)
