"""A guess in the browser, by mouse and by keys."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

SETUP = "import labkit as lab\nlesson = lab.lesson('bags')"


@pytest.fixture
def notebook(open_cells) -> Notebook:
    """A notebook with a guess, and with the cell that answers it."""
    notebook = open_cells(setup=SETUP, guess="lesson.guess('pace')", pace="print('0.22 m')")
    for cell_id in ('setup', 'guess'):
        notebook.run_cell(cell_id)
        assert notebook.error_of(cell_id) == ''
    return notebook


def form_of(notebook: Notebook) -> Locator:
    return notebook.output('guess').locator('.labkit-guess')


def test_a_guess_by_keys_stands_beside_what_came(notebook: Notebook) -> None:
    count, keyboard = len(notebook.cells()), notebook.page.keyboard
    form = form_of(notebook)
    group = form.get_by_role('group', name='How far does the robot drive')
    buttons = group.get_by_role('button')
    expect(buttons.first).to_be_focused()
    told = form.locator('[aria-live]')
    expect(told).to_have_text('Guess, then run the cell that comes next.')
    # In JupyterLab's command mode these keys insert a cell.
    keyboard.press('b')
    expect(buttons.nth(1)).to_have_attribute('aria-pressed', 'true')
    expect(told).to_have_text('Now run the cell that comes next.')
    keyboard.press('Shift+Tab')
    keyboard.press('Tab')
    keyboard.press('Enter')
    expect(buttons.first).to_have_attribute('aria-pressed', 'true')
    expect(buttons.nth(1)).to_have_attribute('aria-pressed', 'false')
    keyboard.press('Escape')
    expect(form.locator(':focus')).to_have_count(0)
    notebook.run_cell('pace')
    expect(notebook.output('pace')).to_contain_text('AS YOU GUESSED')
    expect(told).to_contain_text('What came: half as far.')
    assert len(notebook.cells()) == count


def test_a_guess_by_mouse_comes_back_the_next_day(notebook: Notebook) -> None:
    form_of(notebook).get_by_role('button', name='twice as far').click()
    notebook.run_cell('pace')
    expect(notebook.output('pace')).to_contain_text('YOU GUESSED: twice as far')
    expect(notebook.output('pace')).to_contain_text('What came: half as far.')
    notebook.restart_kernel()
    for cell_id in ('setup', 'guess'):
        notebook.run_cell(cell_id)
    guessed = form_of(notebook).get_by_role('button', name='twice as far')
    expect(guessed).to_have_attribute('aria-pressed', 'true')
