"""Take the pictures of the README and of docs/pictures, from the running course.

    python -m tests.browser.pictures                    all of them
    python -m tests.browser.pictures readme 10_bags     those whose names begin so

The one that moves is made by `tests.browser.film`.
"""

from __future__ import annotations

import argparse
import io
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from PIL import Image
from playwright.sync_api import expect

from tests.browser.film import SOLUTION
from tests.browser.jupyter import ROOT, JupyterLab
from tests.browser.page import Notebook, open_browser, open_notebook
from tests.browser.screenshot import SETTINGS, run_until

# So many colours are enough for pages of text, and make a file a third as large.
COLOURS = 128


class Scene(NamedTuple):
    """What a picture shows.

    Attributes:
        name: Of its file in docs/pictures, without the ending.
        lesson: Name of the lesson.
        act: Does what is to be seen.
        size: Width and height of the page, pixels.
    """

    name: str
    lesson: str
    act: Callable[[Notebook], None]
    size: tuple[int, int] = (1200, 760)


def _cell(cell_id: str) -> Callable[[Notebook], None]:
    """Run all cells down to one, and show it at the top."""

    def act(notebook: Notebook) -> None:
        run_until(notebook, cell_id)
        notebook.scroll_to_top(cell_id)

    return act


def _chat(notebook: Notebook) -> None:
    """Show the window of the chat, in which somebody has answered."""
    for cell_id in ('setup', 'chat', 'box', 'escape', 'window', 'join', 'friend'):
        notebook.run_cell(cell_id)
    notebook.scroll_to_top('window')


def _readme(notebook: Notebook) -> None:
    """Show a verdict, the robot and its keys in the panel, and the graph of two nodes below."""
    page = notebook.page
    notebook.execute('application:toggle-left-area')
    notebook.run_cell('setup')
    notebook.run_cell('first-node')
    # The graph is beside the lesson, as "Create New View for Cell Output" does it.
    page.evaluate("""async () => {
      const app = window.jupyterapp, lesson = app.shell.currentWidget;
      await app.commands.execute('notebook:create-output-view');
      app.shell.activateById(lesson.id);
    }""")
    notebook.replace_cell('first-node-starter', SOLUTION)
    notebook.run_cell('first-node-starter')
    notebook.run_cell('first-node-check')
    notebook.run_cell('robot')
    keys = page.locator('.jupyterlab-sidecar .labkit-teleop')
    expect(keys).to_be_visible()
    keys.click(position={'x': 4, 'y': 4})
    for key, seconds in (('w', 2.5), ('a', 1.0), ('w', 2.5)):
        page.keyboard.down(key)
        page.wait_for_timeout(1000 * seconds)
        page.keyboard.up(key)
    notebook.scroll_to_top('first-node-starter')


SCENES = (
    Scene('readme', '00_start_here', _readme, (1480, 860)),
    Scene('00_start_here-first-node', '00_start_here', _cell('first-node'), (1280, 760)),
    Scene('00_start_here-quiz', '00_start_here', _cell('quiz')),
    Scene('00_start_here-progress', '00_start_here', _cell('progress')),
    Scene('01_theory-visitor', '01_theory', _cell('visitor')),
    Scene('06_chat-window', '06_chat', _chat),
    Scene('07_turtlebot-robot', '07_turtlebot', _cell('robot')),
    Scene('10_bags-trip', '10_bags', _cell('trip')),
)
# Those that are there in JupyterLab's dark theme, too.
DARK = ('readme', '07_turtlebot-robot')


def take(scene: Scene, folder: Path, *, dark: bool) -> Path:
    """Take one picture in a new JupyterLab; return its file."""
    with (
        tempfile.TemporaryDirectory(prefix='labkit-', ignore_cleanup_errors=True) as place,
        JupyterLab(Path(place), SETTINGS) as lab,
        open_browser(*scene.size) as browser,
    ):
        notebook = open_notebook(lab, browser, scene.lesson)
        if dark:
            notebook.execute('apputils:change-theme', theme='JupyterLab Dark')
        scene.act(notebook)
        notebook.page.mouse.move(0, 0)
        notebook.wait_for_pictures()
        picture = Image.open(io.BytesIO(notebook.page.screenshot())).convert('RGB')
    path = folder / f'{scene.name}{"-dark" * dark}.png'
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)
    return path


def main(argv: list[str] | None = None) -> int:
    """Take the pictures."""
    parser = argparse.ArgumentParser(prog='python -m tests.browser.pictures')
    parser.add_argument('names', nargs='*', help='beginnings of names; without any, all')
    parser.add_argument('--out', type=Path, default=ROOT / 'docs' / 'pictures', help='folder')
    options = parser.parse_args(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    chosen = [one for one in SCENES if one.name.startswith(tuple(options.names) or '')]
    for scene in chosen:
        for dark in (False, True)[: 1 + (scene.name in DARK)]:
            print(take(scene, options.out, dark=dark), flush=True)
    return 0 if chosen else 2


if __name__ == '__main__':
    sys.exit(main())
