"""Every lesson runs from top to bottom in the browser, and all that it shows can be perceived."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator

import pytest

from tests.browser.accessibility import violations
from tests.browser.jupyter import ROOT, JupyterLab
from tests.browser.page import Notebook, open_notebook

pytestmark = pytest.mark.slow('a page in the browser')

LESSONS = sorted(path.stem for path in (ROOT / 'notebooks').glob('*.ipynb'))
# Mostly a lesson waits for what its nodes do, so several run while one is looked at.
AT_ONCE = 3

# What JupyterLab shows in the place of something that it can not show.
BROKEN = (
    'Error displaying widget',
    'Loading widget...',
    'JavaScript Error',
    'Javascript Error',
    'Syntax error in text',  # mermaid
    'Error rendering',
)


class Running:
    """A lesson whose cells have all been started.

    Attributes:
        notebook: The lesson in its tab.
        faults: Exceptions that the page's own code did not catch.
    """

    def __init__(self, lab: JupyterLab, browser: object, name: str) -> None:
        self.faults: list[str] = []
        self.notebook: Notebook = open_notebook(lab, browser, name)
        self.notebook.page.on('pageerror', lambda error: self.faults.append(str(error)))
        self.notebook.start_all()


@pytest.fixture(scope='module')
def run(request, jupyter, browser) -> Iterator[Callable[[str], Running]]:
    """Give a function that returns a lesson in which all cells have ended."""
    here = [item for item in request.session.items if item.path == request.path]
    waiting = deque(item.callspec.params['name'] for item in here if hasattr(item, 'callspec'))
    running: dict[str, Running] = {}

    def finish(name: str) -> Running:
        while waiting and (name in waiting or len(running) < AT_ONCE):
            following = waiting.popleft()
            running[following] = Running(jupyter, browser, following)
        lesson = running.pop(name)
        # A tab behind others is drawn once a second.
        lesson.notebook.page.bring_to_front()
        lesson.notebook.wait_for_all()
        return lesson

    yield finish
    jupyter.end_kernels()


@pytest.mark.parametrize('name', LESSONS)
def test_lesson_runs_from_top_to_bottom(run, name):
    lesson = run(name)
    notebook = lesson.notebook
    wrong = []
    for cell in notebook.cells():
        if cell['cell_type'] == 'code':
            meant = 'raises-exception' in cell['metadata'].get('tags', ())
            error = notebook.error_of(cell['id'])
            if bool(error) != meant:
                wrong.append(f'{cell["id"]}: {error or "should have raised"}')
            if cell['source'].strip() and not cell['execution_count']:
                wrong.append(f'{cell["id"]}: was not run')
    assert not wrong, '\n'.join(wrong)
    for cell in notebook.cells():
        pictures = notebook.broken_pictures(cell['id'])
        wrong += [f'{cell["id"]}: the picture {text!r} is missing' for text in pictures]
        text = notebook.cell(cell['id']).inner_text()
        wrong += [f'{cell["id"]}: {sign}' for sign in BROKEN if sign in text]
    assert not wrong, '\n'.join(wrong)
    for cell in notebook.cells():
        if cell['cell_type'] == 'code':
            wrong += [f'{cell["id"]}: {fault}' for fault in violations(notebook, cell['id'])]
    assert not wrong, '\n'.join(wrong)
    assert lesson.faults == []
    notebook.close()
