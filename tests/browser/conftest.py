"""JupyterLab and Chromium for the tests that drive the lessons as a learner does."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.browser.jupyter import JupyterLab
from tests.browser.page import Notebook, chromium_path, open_browser, open_notebook
from tests.browser.robot_stage import CELLS, Stage

_numbers = itertools.count()


@pytest.fixture(scope='session')
def jupyter(tmp_path_factory: pytest.TempPathFactory) -> Iterator[JupyterLab]:
    """Give a running JupyterLab."""
    with JupyterLab(tmp_path_factory.mktemp('jupyter')) as lab:
        yield lab


# Not for the session: while it lives, Playwright's event loop counts as running in this thread,
# and other tests of this process start loops of their own.
@pytest.fixture(scope='module')
def browser() -> Iterator[Any]:
    """Give a headless Chromium."""
    if chromium_path() is None:
        pytest.skip('Chromium is not installed (for example: sudo apt install chromium)')
    with open_browser() as context:
        yield context


@pytest.fixture(scope='module')
def free_tabs() -> list[Any]:
    """Tabs in which JupyterLab is loaded and no notebook is open: loading takes seconds."""
    return []


@pytest.fixture
def open_lesson(
    jupyter: JupyterLab, browser: Any, free_tabs: list[Any]
) -> Iterator[Callable[[str], Notebook]]:
    """Give a function that opens a lesson by its name in a tab of its own."""
    opened: list[Notebook] = []

    def open_(name: str) -> Notebook:
        if free_tabs:
            opened.append(Notebook(free_tabs.pop()).open_beside(name))
        else:
            opened.append(open_notebook(jupyter, browser, name))
        return opened[-1]

    yield open_
    for notebook in opened:
        if notebook.has_dialog or notebook.was_reloaded:
            notebook.close()
        else:
            notebook.leave()
            free_tabs.append(notebook.page)
    jupyter.end_kernels()


@pytest.fixture
def open_cells(
    jupyter: JupyterLab, open_lesson: Callable[[str], Notebook]
) -> Callable[..., Notebook]:
    """Give a function that opens a notebook with these cells: ids and their code."""

    def open_(**cells: str) -> Notebook:
        name = f'cells_{next(_numbers)}'
        jupyter.write_notebook(name, cells)
        return open_lesson(name)

    return open_


@pytest.fixture
def stage(open_cells: Callable[..., Notebook]) -> Stage:
    """Return a notebook in which a robot, its map and its keys run."""
    return Stage(open_cells(**CELLS))
