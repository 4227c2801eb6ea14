from collections.abc import Iterator
from pathlib import Path

import pytest

from labkit.rosgraph import interfaces
from tests.launching.stage import Launched, make_toys, write

assert interfaces  # sets AMENT_PREFIX_PATH


@pytest.fixture(scope='session')
def toys_prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_toys(tmp_path_factory.mktemp('toys'))


@pytest.fixture
def toys(toys_prefix: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which the package `toys` is installed."""
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(toys_prefix), prepend=':')
    return toys_prefix


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[type]:
    started: list[Launched] = []

    class Here(Launched):
        def __init__(self, text: str, *arguments: str, **environment: str) -> None:
            name = 'main.launch.xml' if text.startswith('<') else 'main.launch.py'
            super().__init__(write(tmp_path, {name: text}), *arguments, **environment)
            started.append(self)

    yield Here
    for one in started:
        one.popen.kill()
        one.popen.communicate()
        assert one.left == [], one.shown
