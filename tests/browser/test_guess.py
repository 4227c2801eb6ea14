"""A guess in the browser, by mouse and by keys."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')


@pytest.fixture
def open_guess(open_cells):
    """Give a function that opens a guess of a lesson, with the cell that answers it.

    What was guessed and told is kept from test to test, so each has a guess of its own.
    """

    def open_(lesson: str, name: str, shown_by: str) -> Notebook:
        setup = f'import labkit as lab\nlesson = lab.lesson({lesson!r})'
        cells = {shown_by: "print('so it is')"}
        notebook = open_cells(setup=setup, guess=f'lesson.guess({name!r})', **cells)
        for cell_id in ('setup', 'guess'):
            notebook.run_cell(cell_id)
            assert notebook.error_of(cell_id) == ''
        return notebook

    return open_


def form_of(notebook: Notebook) -> Locator:
    return notebook.output('guess').locator('.labkit-guess')


def test_a_guess_by_keys_stands_beside_what_came(open_guess) -> None:
    notebook = open_guess('bags', 'pace', 'pace')
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


def test_a_guess_by_mouse_comes_back_the_next_day(open_guess) -> None:
    notebook = open_guess('turtlebot', 'no_timeout', 'no-timeout')
    form_of(notebook).get_by_role('button', name='after 0.2 m').click()
    notebook.run_cell('no-timeout')
    expect(notebook.output('no-timeout')).to_contain_text('YOU GUESSED: after 0.2 m')
    expect(notebook.output('no-timeout')).to_contain_text('What came: at the wall.')
    notebook.restart_kernel()
    form_of(notebook).get_by_role('button', name='Bring it back').click()
    expect(form_of(notebook).locator('.labkit-live-note')).to_be_hidden()
    guessed = form_of(notebook).get_by_role('button', name='after 0.2 m')
    expect(guessed).to_have_attribute('aria-pressed', 'true')
