"""Fixtures for the tests of exercises: a separate state folder, and ROS that is stopped."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import labkit
from labkit import settings
from labkit.exercises.time import learner_time

# With pytest's importlib mode a test can't import the file beside it by itself.
sys.path.insert(0, str(Path(__file__).resolve().parent))


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Labkit's state folder."""
    folder = tmp_path / 'home'
    monkeypatch.setenv('LABKIT_HOME', str(folder))
    return folder


@pytest.fixture
def lab() -> Iterator[ModuleType]:
    """Labkit, with ROS stopped afterwards."""
    labkit.start()
    yield labkit
    labkit.stop()
    learner_time.uninstall()
    # Exercises of this test must not follow what the next one starts.
    settings.after_start.clear()
