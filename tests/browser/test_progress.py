"""What leads a learner on: PASS to the next exercise, progress to any lesson, without a kernel."""

from __future__ import annotations

import os

import pytest
from playwright.sync_api import expect

from labkit.exercises.found_lessons import all_lessons
from labkit.views.course_map import WIDTH
from tests.browser.samples import SETUP, TALKER

pytestmark = pytest.mark.slow('a page in the browser')

OPEN = "() => window.jupyterapp.shell.currentWidget?.context?.path ?? ''"


def test_pass_leads_to_the_next_exercise_and_progress_to_any_lesson(open_lesson):
    notebook = open_lesson('04_odds')
    page = notebook.page
    notebook.run_cell('setup')
    notebook.replace_cell('ones-starter', 'exec(lesson.ones.answer.code)')
    notebook.run_cell('ones-starter')
    notebook.replace_cell('ones-help', 'lab.progress()')
    notebook.run_cell('ones-help')
    notebook.run_cell('ones-check')
    card = notebook.output('ones-check')
    expect(card).to_contain_text('✔ the number is always 1')
    expect(card.get_by_role('link', name='exercise ones: done')).to_be_visible()
    turns = 'robot => getComputedStyle(robot).animationName'
    robot = card.locator('svg.labkit-turn')
    assert robot.evaluate(turns) == 'labkit-turn'
    page.emulate_media(reduced_motion='reduce')
    assert robot.evaluate(turns) == 'none'
    page.emulate_media(reduced_motion='no-preference')
    # What was shown before follows.
    shown = notebook.output('ones-help')
    expect(shown.get_by_role('link', name='exercise ones: done')).to_be_visible()
    next_task = page.get_by_role('heading', name='Exercise 2: odd numbers')
    page.keyboard.press('Escape')
    onward = card.get_by_role('link', name='Next: count_up')
    onward.focus()
    notebook.page.keyboard.press('Enter')
    expect(next_task).to_be_in_viewport()
    expect(shown.get_by_role('rowheader')).to_have_count(len(all_lessons()))
    expect(shown.get_by_role('link', name='exercise first_node: open')).to_be_visible()
    shown.get_by_role('rowheader').get_by_role('link', name='05 My name is').click()
    page.wait_for_function(f"({OPEN})() === '05_my_name_is.ipynb'")
    page.evaluate('() => window.jupyterapp.shell.currentWidget.close()')
    notebook.execute('docmanager:open', path='04_odds.ipynb')


def test_home_has_a_road_that_mouse_and_keys_follow(open_cells):
    notebook = open_cells(setup='pass')
    page = notebook.page
    notebook.execute('docmanager:open', path='Home.md', factory='Markdown Preview')
    home = page.locator('.jp-MarkdownViewer')
    stations = home.locator('a:has(img)')
    expect(stations).to_have_count(len(all_lessons()))
    # Its names can be read, and none lies over another one.
    boxes = [stations.nth(number).locator('img').bounding_box() for number in range(3)]
    assert boxes[0]['width'] >= WIDTH
    assert boxes[0]['x'] + boxes[0]['width'] <= boxes[1]['x'] + 1
    if folder := os.environ.get('LABKIT_SCREENSHOTS'):
        page.screenshot(path=f'{folder}/home.png')
    for number, name, opens in ((1, '01 What ROS is', 'click'), (5, '05 My name is', 'keys')):
        notebook.execute('docmanager:open', path='Home.md', factory='Markdown Preview')
        station = home.get_by_role('link', name=f'{name}: 0 %')
        if opens == 'click':
            station.click()
        else:
            station.focus()
            page.keyboard.press('Enter')
        page.wait_for_function(f"({OPEN})().startsWith('0{number}_')")
        page.evaluate('() => window.jupyterapp.shell.currentWidget.close()')


def test_solution_is_copied_without_a_kernel(open_cells, browser):
    browser.grant_permissions(['clipboard-read', 'clipboard-write'])
    setup = "import labkit as lab\nlesson = lab.lesson('odds')"
    notebook = open_cells(setup=setup, solution='lesson.ones.solution()')
    for cell_id in ('setup', 'solution'):
        notebook.run_cell(cell_id)
    page = notebook.page
    page.evaluate('() => window.jupyterapp.serviceManager.sessions.shutdownAll()')
    output = notebook.output('solution')
    output.get_by_role('button', name='Copy').focus()
    page.keyboard.press('Enter')
    expect(output.get_by_text('Copied.')).to_be_visible()
    copied = page.evaluate('() => navigator.clipboard.readText()')
    assert copied == output.locator('pre').text_content()
    assert 'class Ones(Node):' in copied


def test_node_is_shown_as_a_card(open_cells):
    notebook = open_cells(setup=SETUP, talker=TALKER, shown='lab.spin(Talker())')
    for cell_id in ('setup', 'talker', 'shown'):
        notebook.run_cell(cell_id)
    # A screen reader says what comes: the card is a status.
    card = notebook.output('shown').get_by_role('status')
    expect(card).to_contain_text('NODE: /talker')
    expect(card).to_contain_text('/chatter [std_msgs/msg/String]')
    assert ' at 0x' not in notebook.output_text('shown')
