"""Buttons under a verdict in the browser: hints, the check once more, the solution."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.accessibility import violations
from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

SETUP = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import Int16
lesson = lab.lesson('odds')
"""
STARTER = """
node = lab.spin(Node('ones'))
publisher = node.create_publisher(Int16, 'ones', 10)
timer = node.create_timer(0.1, lambda: publisher.publish(Int16(data={value})))
"""
WAITING = """
from pathlib import Path
from time import sleep
while not Path('go_on').exists():
    sleep(0.05)
"""


@pytest.fixture
def notebook(open_cells: Callable[..., Notebook]) -> Notebook:
    """A notebook with a wrong answer, and the check that says so."""
    notebook = open_cells(
        setup=SETUP,
        starter=STARTER.format(value=2),
        check='lesson.ones.check()',
        waiting=WAITING,
        after='print(sum(range(1000)))',
    )
    for cell_id in ('setup', 'starter', 'check'):
        notebook.run_cell(cell_id)
        assert notebook.error_of(cell_id) == ''
    expect(place(notebook, 'FAIL')).to_be_visible()
    return notebook


def place(notebook: Notebook, word: str) -> Locator:
    """Return the card with a word, as it is to be seen."""
    cards = notebook.output('check').locator('.widget-output [role=status]')
    return cards.filter(has_text=re.compile(rf'{word}.*: ones'))


def button(notebook: Notebook, name: str) -> Locator:
    return notebook.output('check').get_by_role('button', name=name)


def told(notebook: Notebook) -> Locator:
    return notebook.output('check').locator('.labkit-help [aria-live]')


def test_hints_the_solution_and_a_pass_by_keys_alone(notebook: Notebook) -> None:
    count, keyboard = len(notebook.cells()), notebook.page.keyboard
    # The keyboard stays where it was; what is stored stays behind what lives.
    expect(notebook.output('check').locator(':focus')).to_have_count(0)
    expect(notebook.output('check').locator('.labkit-kept')).to_be_hidden()
    sizes = (
        place(notebook, 'FAIL')
        .locator('dd, strong')
        .evaluate_all(
            'parts => parts.map((part) => Number.parseFloat(getComputedStyle(part).fontSize))'
        )
    )
    assert sizes[-1] > max(sizes[:-1])  # what to do next
    expect(button(notebook, 'Solution')).to_be_hidden()
    button(notebook, 'Hint (1 of 3)').focus()
    for number in (1, 2, 3):
        keyboard.press('Enter')
        expect(place(notebook, f'HINT {number} of 3')).to_be_visible()
        expect(told(notebook)).to_have_text(f'Hint {number} of 3 is above.')
    # The button has gone. Another press of Enter shows no solution by mistake.
    expect(button(notebook, 'Check again')).to_be_focused()
    assert violations(notebook, 'check') == []
    keyboard.press('Enter')
    expect(told(notebook)).to_have_text('FAIL, as before.')
    expect(button(notebook, 'Check again')).to_be_focused()
    keyboard.press('Tab')
    expect(button(notebook, 'Solution')).to_be_focused()
    keyboard.press('Space')
    expect(place(notebook, 'SOLUTION')).to_be_visible()
    expect(button(notebook, 'Copy')).to_be_visible()
    notebook.replace_cell('starter', STARTER.format(value=1))
    notebook.run_cell('starter')
    button(notebook, 'Check again').focus()
    keyboard.press('Enter')
    expect(place(notebook, 'PASS')).to_be_visible()
    expect(place(notebook, 'FAIL')).to_have_count(0)
    expect(place(notebook, 'HINT')).to_have_count(0)
    expect(button(notebook, 'Check again')).to_be_hidden()
    # The cell has the keyboard then.
    expect(notebook.output('check').locator(':focus')).to_have_count(0)
    assert notebook.page.evaluate("document.activeElement.matches('.jp-Cell')")
    assert len(notebook.cells()) == count


def test_while_a_cell_runs_a_check_is_refused_in_words_and_later_it_is_made(
    notebook: Notebook, jupyter
) -> None:
    signal = jupyter.work / 'go_on'
    notebook.start_cell('waiting')
    button(notebook, 'Check again').click()
    expect(told(notebook)).to_have_text('A cell is running. Check again when it has ended.')
    button(notebook, 'Hint (1 of 3)').click()
    expect(place(notebook, 'HINT 1 of 3')).to_be_visible()
    signal.touch()
    try:
        notebook.wait_for_end('waiting')
    finally:
        signal.unlink()
    button(notebook, 'Check again').click()
    expect(told(notebook)).to_have_text('FAIL, as before.')
    assert notebook.run_cell('after') == '499500'


def test_loaded_again_the_buttons_live_and_after_a_restart_they_are_gone(
    notebook: Notebook,
) -> None:
    button(notebook, 'Hint (1 of 3)').click()
    expect(place(notebook, 'HINT 1 of 3')).to_be_visible()
    notebook.reload()
    expect(place(notebook, 'HINT 1 of 3')).to_be_visible()
    button(notebook, 'Hint (2 of 3)').click()
    expect(place(notebook, 'HINT 2 of 3')).to_be_visible()
    notebook.restart_kernel()
    note = notebook.output('check').locator('.labkit-live-note')
    expect(note).to_contain_text('run the setup cell at the top, then this one.')
    expect(button(notebook, 'Check again')).to_be_hidden()


def test_the_next_day_the_card_is_there(notebook: Notebook, jupyter) -> None:
    button(notebook, 'Hint (1 of 3)').click()
    expect(place(notebook, 'HINT 1 of 3')).to_be_visible()
    notebook.execute('docmanager:save')
    name = notebook.page.evaluate('window.jupyterapp.shell.currentWidget.context.path')
    notebook.leave()
    jupyter.end_kernels()
    notebook.open_beside(name.removesuffix('.ipynb'))
    kept = notebook.output('check').locator('.labkit-kept')
    expect(kept).to_be_visible()
    expect(kept).to_contain_text('FAIL: ones')
    expect(kept).to_contain_text('HINT 1 of 3')
    expect(notebook.output('check').get_by_text('Error displaying widget')).to_be_hidden()
    # One button runs the setup cell and this one; what was checked is not there any more.
    kept.get_by_role('button', name='Bring it back').focus()
    notebook.page.keyboard.press('Enter')
    expect(place(notebook, 'NOT ATTEMPTED')).to_be_visible()
    assert [notebook.error_of(cell_id) for cell_id in ('setup', 'check')] == ['', '']
    assert notebook.output_text('starter') == ''
