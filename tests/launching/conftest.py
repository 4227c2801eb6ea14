from pathlib import Path

import pytest

from labkit.rosgraph import interfaces
from tests.launching.stage import make_toys

assert interfaces  # sets AMENT_PREFIX_PATH


@pytest.fixture(scope='session')
def toys_prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_toys(tmp_path_factory.mktemp('toys'))


@pytest.fixture
def toys(toys_prefix: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which the package `toys` is installed."""
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(toys_prefix), prepend=':')
    return toys_prefix
