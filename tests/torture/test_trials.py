"""Each trial in its short form; with TORTURE=long for an hour or so, figures by `pytest -rP`."""

from __future__ import annotations

import os
import random
from collections.abc import Callable

import pytest
from torture.bench import Bench
from torture.trials import TRIALS

from tests.conftest import Kernel

LONG = os.environ.get('TORTURE') == 'long'
SEED = int(os.environ.get('TORTURE_SEED', '7'))
SLOW = pytest.mark.slow('a trial has many kernels, or a whole lesson several times')


@pytest.mark.timeout(7200 if LONG else 600)
@pytest.mark.parametrize(
    'name', [pytest.param(name, marks=() if name == 'large' else SLOW) for name in TRIALS]
)
def test_is_stood(name: str, start_kernel: Callable[..., Kernel]) -> None:
    print(TRIALS[name](Bench(start_kernel, random.Random(SEED), large=LONG)))
