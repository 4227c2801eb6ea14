"""Fixtures of all tests of the set-up."""

from __future__ import annotations

from pathlib import Path

import pytest
from courses import Course


@pytest.fixture
def course(tmp_path: Path) -> Course:
    """Give a course in small, in a folder of its own."""
    return Course(tmp_path / 'course')
