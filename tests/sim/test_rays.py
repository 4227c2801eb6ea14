"""Rays against the sides of a room: the quick way finds what the general one does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labkit.sim.rays import Convex, see_walls

BEAMS = np.linspace(0, math.tau, 360, endpoint=False)
RAYS = np.vstack((np.cos(BEAMS), np.sin(BEAMS)))
# Corners on a circle make a convex room; some way in between so that none are the same.
circles = st.lists(st.integers(0, 35), min_size=3, max_size=8, unique=True).map(sorted)


def corners_of(steps: list[int]) -> list[tuple[float, float]]:
    angles = [step * math.tau / 36 for step in steps]
    return [(2 * math.cos(angle), 3 * math.sin(angle)) for angle in angles]


@given(circles, st.booleans(), st.floats(-3, 3), st.floats(-3, 3))
def test_a_room_is_seen_as_its_walls_are(
    steps: list[int], backwards: bool, x: float, y: float
) -> None:
    corners = corners_of(steps[::-1] if backwards else steps)
    seen = Convex(corners).see(np.array((x, y)), RAYS)
    pairs = zip(corners, corners[1:] + corners[:1], strict=True)
    lines = np.array([(*one, *other) for one, other in pairs])
    walls = see_walls(lines - (x, y, x, y), RAYS)
    if seen is None:
        # Outside, some rays meet nothing; on a wall, some have no way at all.
        assert math.isinf(walls.max()) or walls.min() < 1e-6
    else:
        assert seen == pytest.approx(walls, abs=1e-6)


@pytest.mark.parametrize('backwards', [False, True])
def test_from_outside_it_does_not_answer(backwards: bool) -> None:
    corners = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    convex = Convex(corners[::-1] if backwards else corners)
    assert convex.see(np.array((0.0, 0.5)), RAYS) is not None
    assert convex.see(np.array((0.0, 1.5)), RAYS) is None
    assert convex.see(np.array((1.0, 0.0)), RAYS) is None
