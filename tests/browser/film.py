"""Film the first five minutes of the course, in twenty seconds: the README's picture that moves.

    python -m tests.browser.film --out docs/pictures/first_minutes.gif

opens lesson 00 in JupyterLab, runs its first cells, solves its exercise, and drives the robot.
What takes longer than a moment is shortened.
"""

from __future__ import annotations

import argparse
import io
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image
from playwright.sync_api import expect

from tests.browser.jupyter import JupyterLab
from tests.browser.page import Notebook, open_browser, open_notebook
from tests.browser.screenshot import SETTINGS

WIDTH, HEIGHT = 1280, 720
# Of the film; smaller than the page, so that the file is small.
SIZE = (960, 540)
# Between two pictures, and for how long one stands at most, s.
EVERY_SEC, LONGEST_SEC = 0.25, 0.4
COLOURS = 96
SOLUTION = "from rclpy.node import Node\n\nrobot = lab.spin(Node('hello_robot'))"


class Film:
    """The pictures of a page, and for how long each is shown."""

    def __init__(self, notebook: Notebook) -> None:
        self._notebook = notebook
        self._pictures: list[Image.Image] = []
        self._times: list[float] = []

    def take(self, seconds: float) -> None:
        """Film the page for a while."""
        end = time.monotonic() + seconds
        while True:
            began = time.monotonic()
            picture = Image.open(io.BytesIO(self._notebook.page.screenshot()))
            self._pictures.append(picture.convert('RGB').resize(SIZE, Image.Resampling.LANCZOS))
            self._times.append(began)
            if began >= end:
                return
            time.sleep(max(0.0, EVERY_SEC - (time.monotonic() - began)))

    def save(self, path: Path) -> float:
        """Save it; return how long it is, s."""
        # One palette for all, so that what stands still is the same in each.
        sheet = Image.new('RGB', (SIZE[0], SIZE[1] * 3))
        for place, number in enumerate((0, len(self._pictures) // 2, -1)):
            sheet.paste(self._pictures[number], (0, place * SIZE[1]))
        palette = sheet.quantize(COLOURS)
        frames = [
            one.quantize(palette=palette, dither=Image.Dither.NONE) for one in self._pictures
        ]
        gaps = [later - time for time, later in zip(self._times, self._times[1:], strict=False)]
        shown = [min(gap, LONGEST_SEC) for gap in gaps] + [2.0]
        frames[0].save(
            path,
            save_all=True,
            append_images=frames[1:],
            duration=[round(1000 * one) for one in shown],
            loop=0,
            optimize=False,
        )
        return sum(shown)


def act(notebook: Notebook, film: Film) -> None:
    """Do what a learner does first."""
    page = notebook.page
    notebook.run_cell('setup')
    notebook.scroll_to_top('first-node')
    film.take(0.5)
    notebook.run_cell('first-node')
    film.take(4.0)

    notebook.scroll_to_top('first-node-task')
    film.take(1.0)
    notebook.replace_cell('first-node-starter', SOLUTION)
    film.take(0.8)
    notebook.run_cell('first-node-starter')
    notebook.run_cell('first-node-check')
    notebook.scroll_to_top('first-node-starter')
    film.take(3.0)

    notebook.run_cell('robot')
    notebook.scroll_to_top('robot-read')
    keys = page.locator('.jupyterlab-sidecar .labkit-teleop')
    expect(keys).to_be_visible()
    keys.click(position={'x': 4, 'y': 4})
    for key, seconds in (('w', 3.0), ('a', 1.0), ('w', 3.0), ('d', 1.0), ('w', 2.0)):
        page.keyboard.down(key)
        film.take(seconds)
        page.keyboard.up(key)


def main(argv: list[str] | None = None) -> int:
    """Make the film."""
    parser = argparse.ArgumentParser(prog='python -m tests.browser.film')
    parser.add_argument('--out', type=Path, required=True, help='the file, a .gif')
    options = parser.parse_args(argv)
    with (
        tempfile.TemporaryDirectory(prefix='labkit-', ignore_cleanup_errors=True) as folder,
        JupyterLab(Path(folder), SETTINGS) as lab,
        open_browser(WIDTH, HEIGHT) as browser,
    ):
        notebook = open_notebook(lab, browser, '00_start_here')
        film = Film(notebook)
        act(notebook, film)
        seconds = film.save(options.out)
    print(f'{options.out}: {seconds:.0f} s, {options.out.stat().st_size / 1e6:.1f} MB')
    return 0


if __name__ == '__main__':
    sys.exit(main())
