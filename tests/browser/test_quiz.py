"""A quiz in the browser, answered with the keyboard alone."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')


@pytest.fixture
def open_quiz(open_cells):
    """Give a function that opens the quiz of a lesson; answers are kept from test to test."""

    def open_(lesson: str) -> Notebook:
        setup = f'import labkit as lab\nlesson = lab.lesson({lesson!r})'
        notebook = open_cells(setup=setup, quiz='lesson.quiz()')
        for cell_id in ('setup', 'quiz'):
            notebook.run_cell(cell_id)
            assert notebook.error_of(cell_id) == ''
        return notebook

    return open_


def quiz_of(notebook: Notebook) -> Locator:
    return notebook.output('quiz').locator('.labkit-quiz')


def test_enter_answers_and_goes_on_and_leaves_the_notebook_alone(open_quiz):
    notebook = open_quiz('talker_listener')
    count, keyboard = len(notebook.cells()), notebook.page.keyboard
    quiz = quiz_of(notebook)
    # One question is to be seen, as a group with a name, for screen readers.
    expect(quiz.get_by_role('group', name='1 of 6 What is create_publisher')).to_be_visible()
    expect(quiz.locator('form')).to_have_count(1)
    told, options = quiz.locator('[aria-live]'), quiz.get_by_role('radio')
    options.first.focus()
    # In JupyterLab's command mode these keys insert and cut cells.
    for key in ('a', 'b', 'x', 'Enter'):
        keyboard.press(key)
    expect(told).to_have_text('Choose or write an answer first.')
    keyboard.press('Space')
    expect(options.first).to_be_checked()
    keyboard.press('ArrowUp')  # from the first option to the last
    expect(quiz.get_by_label('It sends ten messages to /chatter.')).to_be_checked()
    keyboard.press('Enter')
    expect(told).to_contain_text('NOT YET')
    expect(told).to_contain_text('It sends none. The 10 is the depth of the queue')
    # The reason stands under its option, too.
    expect(quiz.locator('.labkit-quiz-why')).to_have_text(re.compile('It sends none'))
    keyboard.press('ArrowUp')
    keyboard.press('Enter')
    expect(told).to_contain_text('It sends nothing yet: publish() does.')
    expect(quiz.locator('.labkit-quiz-why')).to_have_count(3)
    keyboard.press('Enter')
    second = quiz.get_by_role('group', name='2 of 6')
    expect(second).to_be_visible()
    expect(second.get_by_role('radio').first).to_be_focused()
    expect(quiz.get_by_role('button', name='Question 1: right')).to_be_visible()
    assert len(notebook.cells()) == count


def test_quiz_has_the_keyboard_when_its_cell_was_run_and_not_when_the_page_is_loaded(open_quiz):
    notebook = open_quiz('chat')
    quiz, keyboard = quiz_of(notebook), notebook.page.keyboard
    expect(quiz.locator('form input').first).to_be_focused()
    keyboard.press('Enter')
    expect(quiz.locator('[aria-live]')).to_have_text('Choose or write an answer first.')
    notebook.reload()
    expect(quiz_of(notebook).locator('form')).to_be_visible()
    expect(quiz_of(notebook).locator(':focus')).to_have_count(0)
    # Whoever runs the cell once more answers next.
    notebook.run_cell('quiz')
    expect(quiz_of(notebook).locator('form input').first).to_be_focused()


def test_a_wrong_answer_is_tried_again(open_quiz):
    notebook = open_quiz('bags')
    quiz, keyboard = quiz_of(notebook), notebook.page.keyboard
    told, again = quiz.locator('[aria-live]'), quiz.get_by_role('button', name='Try again')
    expect(again).to_be_hidden()
    wrong = quiz.get_by_label('The nodes, with their code.')
    for _ in range(2):  # the same answer is judged once more
        wrong.check()
        keyboard.press('Enter')
        expect(told).to_contain_text('NOT YET')
        keyboard.press('Tab')
        keyboard.press('Tab')
        expect(again).to_be_focused()
        keyboard.press('Enter')
        expect(told).to_be_empty()
        expect(quiz.locator(':checked, .labkit-quiz-why')).to_have_count(0)
        expect(quiz.get_by_role('radio').first).to_be_focused()
        expect(again).to_be_hidden()


def test_esc_leaves_the_quiz(open_quiz):
    notebook = open_quiz('theory')
    quiz = quiz_of(notebook)
    quiz.get_by_role('radio').first.focus()
    notebook.page.keyboard.press('Escape')
    expect(quiz.locator(':focus')).to_have_count(0)
    # The keys are JupyterLab's again: b makes a cell.
    count = len(notebook.cells())
    notebook.page.keyboard.press('b')
    notebook.page.wait_for_function(
        'n => window.jupyterapp.shell.currentWidget.content.widgets.length === n', arg=count + 1
    )


def test_results_lead_to_what_is_missing_and_outlive_the_kernel(open_quiz):
    notebook = open_quiz('odds')
    keyboard, quiz = notebook.page.keyboard, quiz_of(notebook)
    quiz.get_by_label('An error: a message is not a number.').check()
    keyboard.press('Enter')
    expect(quiz.locator('[aria-live]')).to_contain_text('RIGHT')
    quiz.get_by_role('button', name='Results', exact=True).click()
    title = quiz.get_by_text('Results: 1 of 6 right')
    expect(title).to_be_focused()
    quiz.get_by_role('button', name='Try the 5 that are missing').click()
    expect(quiz.get_by_role('group', name='2 of 6')).to_be_visible()
    notebook.restart_kernel()
    for cell_id in ('setup', 'quiz'):
        notebook.run_cell(cell_id)
    # The first one that is not right yet.
    expect(quiz.get_by_role('group', name='2 of 6')).to_be_visible()
    quiz.get_by_role('button', name='Question 1: right').click()
    answered = quiz.get_by_label('An error: a message is not a number.')
    expect(answered).to_be_checked()
    expect(quiz.locator('[aria-live]')).to_have_text(re.compile('when you answered it before'))


def test_kernel_that_does_not_answer_is_said(open_quiz):
    notebook = open_quiz('theory')
    quiz = quiz_of(notebook)
    notebook.page.evaluate(
        'async () => { await window.jupyterapp.serviceManager.sessions.shutdownAll() }'
    )
    quiz.get_by_role('radio').first.check()
    notebook.page.keyboard.press('Enter')
    expect(quiz).to_contain_text('The kernel is silent.')
