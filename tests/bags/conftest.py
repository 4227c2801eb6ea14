"""What the tests of bags share: ROS ends after each, and some messages."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import labkit
from tests.bags.made import Stored, int16, string


@pytest.fixture(autouse=True)
def ros_ends() -> Iterator[None]:
    """Stop ROS, which some tests start in this process: others have to start it anew."""
    yield
    labkit.stop()


@pytest.fixture
def messages() -> list[Stored]:
    """Give messages of two topics, a tenth of a second apart."""
    found: list[Stored] = []
    for number in range(100):
        topic, data = ('/count', int16(number)) if number % 4 == 3 else ('/chatter', None)
        found.append((topic, number * 10**8, data or string(f'hello {number}')))
    return found


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Be in a folder of the test's own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
