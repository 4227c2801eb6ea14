"""What tests of live views share: cells that must not fail, after the stage of their module."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.conftest import Kernel, Result


@pytest.fixture
def run(request: pytest.FixtureRequest, kernel: Kernel) -> Callable[[str], str]:
    """Give a function that runs a cell, after the module's STAGE, and returns what it printed."""

    def run(code: str) -> str:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result.text.strip()

    run(request.module.STAGE)
    return run


@pytest.fixture
def run_still(
    request: pytest.FixtureRequest, start_kernel: Callable[..., Kernel]
) -> Callable[[str], Result]:
    """Give the same where nothing is shown live; the function returns all of the result."""
    kernel = start_kernel(LABKIT_HEADLESS='1')

    def run(code: str) -> Result:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result

    run(request.module.STAGE)
    return run
