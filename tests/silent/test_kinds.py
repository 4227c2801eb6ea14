"""Each kind of fault is told when it is made, and its innocent neighbour is not."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path

import pytest

from labkit.silent.catalogue import KINDS
from tests.conftest import Kernel

FOLDER = Path(__file__).parent / 'cases'
GROUPS = ('names', 'ends', 'parameters', 'timing', 'life', 'messages', 'frames')
# Told by other means than a cell in one process, or while that runs: see `test_pure.py` and
# `test_told.py`.
PURE = {'types.package', 'types.version', 'types.action', 'life.unspun', 'life.endless-init'}


def cases(group: str) -> dict[str, tuple[str, str]]:
    found: dict[str, tuple[str, str]] = importlib.import_module(
        f'tests.silent.cases.{group}'
    ).CASES
    return found


def test_there_is_a_case_for_each_kind() -> None:
    made = [id for group in GROUPS for id in cases(group)]
    assert sorted({*made, *PURE}) == sorted(KINDS)


@pytest.mark.parametrize('group', GROUPS)
def test_it_is_told_and_its_neighbour_is_not(
    group: str, start_kernel: Callable[..., Kernel]
) -> None:
    # Another participant of the process is found as one of another process is.
    kernel = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    prelude = kernel.run((FOLDER / 'prelude.py').read_text(encoding='utf-8'))
    assert not prelude.error, prelude.traceback
    wrong = []
    for id, (fault, innocent) in cases(group).items():
        for what, code in (('fault', fault), ('innocent', innocent)):
            made = kernel.run(code)
            seen = kernel.run('look()')
            # The last look: a case may have looked before.
            lines = seen.text.splitlines()
            told = next((line.split()[1:] for line in lines if line.startswith('TOLD')), [])
            aloud = next((line.split()[1:] for line in lines if line.startswith('ALOUD')), [])
            right = id in told if what == 'fault' else not aloud and id not in told
            if made.error or seen.error or not right:
                wrong.append(f'{id}, {what}: {made.traceback}{seen.traceback}\n{seen.text}')
            kernel.run('clean()')
    assert not wrong, '\n\n'.join(wrong)


def test_names_that_are_alike_are_a_guess_and_the_advice_says_so() -> None:
    for what in ('case', 'underscore', 'plural', 'spelling', 'service', 'action', 'namespace'):
        assert KINDS[f'names.{what}'].todo.startswith('If the two are meant for each other, ')
