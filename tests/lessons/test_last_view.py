"""What is in sight when a lesson has run to its end."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat
import pytest

from tests.lessons.test_claims import NOTEBOOKS

pytestmark = pytest.mark.slow('a whole lesson')

MAP = """
from labkit.views.arena import Arena
from labkit.views.live import live_views

(shown,) = [view for view in live_views() if isinstance(view, Arena)]
robot_scene = lambda: shown.scenes['']
lab.wait_until(lambda: robot_scene().pose and robot_scene().pose.x == robot.pose.x)
scene = robot_scene()
print(scene.bump, scene.twist.v, scene.twist.w, robot.collisions, round(scene.nearest[0], 1))
"""


def cells_of(number: str) -> list[str]:
    """Return the code of a lesson's cells."""
    (path,) = Path(NOTEBOOKS).glob(f'{number}_*.ipynb')
    cells = nbformat.read(path, as_version=4).cells
    return [cell.source for cell in cells if cell.cell_type == 'code']


def test_the_robot_of_lesson_07_stands_far_from_any_wall(kernel: Any) -> None:
    for code in cells_of('07'):
        result = kernel.run(code)
        assert not result.error, result.traceback
    # The cells before have driven it into a wall, twice, to show what happens.
    assert kernel.run(MAP).text.strip() == 'None 0.0 0.0 [] 1.8'
