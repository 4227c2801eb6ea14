"""A quiz in the browser, answered with the keyboard alone."""

from __future__ import annotations

from playwright.sync_api import expect


def test_quiz_is_answered_by_keyboard_and_leaves_the_notebook_alone(open_cells):
    notebook = open_cells(
        setup="import labkit as lab\nlesson = lab.lesson('talker_listener')",
        quiz='lesson.quiz()',
    )
    for cell_id in ('setup', 'quiz'):
        notebook.run_cell(cell_id)
        assert notebook.error_of(cell_id) == ''
    count, keyboard = len(notebook.cells()), notebook.page.keyboard
    question = notebook.output('quiz').locator('form').first
    told = question.locator('[aria-live]')
    options = question.get_by_role('radio')
    options.first.focus()
    # In JupyterLab's command mode these keys insert and cut cells.
    for key in ('a', 'b', 'x', 'Enter'):
        keyboard.press(key)
    expect(told).to_have_text('Choose or write an answer first.')
    keyboard.press('Space')
    expect(options.first).to_be_checked()
    keyboard.press('ArrowUp')  # from the first option to the last
    expect(question.get_by_label('It sends ten messages to /chatter.')).to_be_checked()
    keyboard.press('Enter')
    expect(told).to_contain_text('It sends none. The 10 is the depth of the queue')
    keyboard.press('ArrowUp')
    keyboard.press('Tab')
    expect(question.get_by_role('button')).to_be_focused()
    keyboard.press('Space')
    expect(told).to_contain_text('It sends nothing yet: publish() does.')
    # Each question is a group with a name, for screen readers.
    expect(question.get_by_role('group', name='What is create_publisher')).to_be_visible()
    assert len(notebook.cells()) == count
