"""What the tests of the simulation share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy
from hypothesis import settings

from tests.stage import Stage

# No deadline, because machines under test are busy. The same examples each time, so that a run
# tells about the code and not about luck; for a search with new examples:
#   pytest tests/sim --hypothesis-profile=search
settings.register_profile('repeatable', deadline=None, derandomize=True, database=None)
settings.register_profile('search', deadline=None, max_examples=2000)
settings.load_profile('repeatable')


@pytest.fixture
def stage() -> Iterator[Stage]:
    """Give a stage for robots, with ROS started as any script starts it."""
    rclpy.init()
    stage = Stage()
    yield stage
    stage.close()
    rclpy.shutdown()
