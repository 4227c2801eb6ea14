"""Take pictures of a lesson as a learner sees it.

    python -m tests.browser.screenshot 02 --out pictures
    python -m tests.browser.screenshot 02 --out pictures --cell two-talkers --dark

opens the lesson in JupyterLab, runs all of its cells, and saves a picture of each screenful, or of
one that starts at a cell. Cells that ended with an error are named. Those of the README and of
docs/pictures are taken by `tests.browser.pictures`.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from tests.browser.jupyter import ROOT, JupyterLab
from tests.browser.page import VIEWPORT, Notebook, open_browser, open_notebook

# JupyterLab's settings of the course, also where labkit is not installed.
SETTINGS = {'JUPYTER_CONFIG_PATH': str(ROOT / 'labkit' / 'data' / 'etc' / 'jupyter')}


def main(argv: list[str] | None = None) -> int:
    """Take the pictures.

    Returns:
        0, or 1 if a cell ended with an error that is not meant.
    """
    options = _options(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    given = Path(options.lesson)
    found = [given] if given.suffix == '.ipynb' else _published(options.lesson)
    if len(found) != 1:
        names = ', '.join(path.stem for path in found) or 'none'
        print(f'{options.lesson!r} should be one lesson, but is {names}.', file=sys.stderr)
        return 2
    name = found[0].stem
    with (
        tempfile.TemporaryDirectory(prefix='labkit-', ignore_cleanup_errors=True) as folder,
        JupyterLab(Path(folder), SETTINGS) as lab,
        open_browser(options.width, options.height) as browser,
    ):
        if given.suffix == '.ipynb':
            shutil.copy(given, lab.work)
        notebook = open_notebook(lab, browser, name)
        if options.dark:
            notebook.execute('apputils:change-theme', theme='JupyterLab Dark')
        run_until(notebook, options.until)
        _take(notebook, options.out / name, options.cell, '-dark' * options.dark)
        return _report(notebook)


def _options(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m tests.browser.screenshot')
    parser.add_argument('lesson', help='number or name of a lesson, or the path of a notebook')
    parser.add_argument('--out', type=Path, default=Path('.'), help='folder for the pictures')
    parser.add_argument('--cell', default='', help='id of a cell: only one picture, from there on')
    parser.add_argument('--until', default='', help='id of the last cell to run')
    parser.add_argument('--dark', action='store_true', help="JupyterLab's dark theme")
    parser.add_argument('--width', type=int, default=VIEWPORT['width'], help='pixels')
    parser.add_argument('--height', type=int, default=VIEWPORT['height'], help='pixels')
    return parser.parse_args(argv)


def _published(word: str) -> list[Path]:
    notebooks = sorted((ROOT / 'notebooks').glob('*.ipynb'))
    return [path for path in notebooks if path.stem.startswith(word)]


def run_until(notebook: Notebook, last: str) -> None:
    """Run the cells of a notebook one by one, to this one; all at once without its id."""
    if not last:
        notebook.run_all()
        return
    for cell in notebook.cells():
        if cell['cell_type'] == 'code':
            notebook.run_cell(cell['id'])
        if cell['id'] == last:
            return


def _take(notebook: Notebook, path: Path, cell_id: str, ending: str) -> None:
    if cell_id:
        notebook.scroll_to_top(cell_id)
        notebook.screenshot(f'{path}-{cell_id}{ending}.png')
        return
    notebook.scroll_to_top(notebook.cells()[0]['id'])
    for number in range(1, 100):
        notebook.screenshot(f'{path}-{number:02}{ending}.png')
        if not notebook.scroll_on():
            return


def _report(notebook: Notebook) -> int:
    failed = False
    for cell in notebook.cells():
        error = notebook.error_of(cell['id']) if cell['cell_type'] == 'code' else ''
        meant = 'raises-exception' in cell['metadata'].get('tags', ())
        if error:
            print(f'{cell["id"]}: {error}' + ' (meant)' * meant)
        failed = failed or bool(error) != meant
    return int(failed)


if __name__ == '__main__':
    sys.exit(main())
