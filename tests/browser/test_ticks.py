"""The live plot and its picture have the same marks on their axes: `ticks` is written twice."""

from __future__ import annotations

import math
import random

import pytest

from labkit.views.plot_picture import ticks
from labkit.views.widget import page_files

pytestmark = pytest.mark.slow('a page in the browser')

RANGES = 2000


def test_the_page_and_the_picture_have_the_same_ticks(browser):
    draw = random.Random(1)
    ranges: list[tuple[float, float, int]] = [
        (low, low + 10 ** draw.uniform(-6, 9), most)
        for low, most in (
            (draw.choice((0.0, 1.0, -1.0)) * 10 ** draw.uniform(-6, 9), draw.randint(2, 12))
            for _ in range(RANGES)
        )
    ]
    ranges += [(0.0, step * power, 5) for step in (1, 2, 5, 10) for power in (0.001, 1.0, 1e6)]
    page = browser.new_page()
    page.add_script_tag(
        content=page_files('plot')[0].partition('export default')[0] + '\nwindow.ticks = ticks;'
    )
    shown = page.evaluate('(ranges) => ranges.map((each) => ticks(...each))', ranges)
    assert sum(map(len, shown)) > 2 * RANGES
    for (low, high, most), marks in zip(ranges, shown, strict=True):
        near = 1e-9 * max(abs(low), abs(high))
        here = ticks(low, high, most)
        assert len(here) == len(marks), (low, high, most)
        assert all(
            math.isclose(one, other, abs_tol=near) for one, other in zip(here, marks, strict=True)
        )
