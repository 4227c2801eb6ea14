"""The robot is driven in the browser: keys and mouse; whoever leaves stops it."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from tests.browser.page import open_notebook

pytestmark = pytest.mark.slow('a page in the browser')


def test_keys_drive_the_robot_and_leave_the_notebook_alone(stage):
    count = len(stage.notebook.cells())
    stage.hold('w', 'linear.x = 0.22 m/s  angular.z = 0.00 rad/s')
    stage.page.wait_for_function(
        'canvas => parseFloat(canvas.dataset.pose) > 0.1', arg=stage.canvas.element_handle()
    )
    stage.page.keyboard.down('ArrowLeft')
    expect(stage.published).to_contain_text('linear.x = 0.22 m/s  angular.z = 1.42 rad/s')
    stage.page.keyboard.press('-')
    stage.page.keyboard.press('-')
    expect(stage.published).to_contain_text('angular.z = 0.71 rad/s')
    stage.page.keyboard.up('w')
    expect(stage.published).to_contain_text('linear.x = 0.00 m/s  angular.z = 0.71 rad/s')
    stage.page.keyboard.up('ArrowLeft')
    stage.expect_stop()
    assert stage.pose()[0] > 0.1
    for key, shown in (('ArrowDown', '= -0.11 m/s'), ('d', '= -0.71 rad/s'), ('x', '= -0.11')):
        stage.hold(key, shown)
        stage.page.keyboard.press(' ')
        stage.expect_stop()
        stage.page.keyboard.up(key)
    for press_in in (stage.focus, stage.canvas.click):
        press_in()
        # In JupyterLab's command mode these insert, cut and delete cells, and change their type.
        for key in ('a', 'b', 'x', 'd', 'd', 'm', 'y', 'ArrowUp', 'Enter'):
            stage.page.keyboard.press(key)
        cells = stage.notebook.cells()
        assert len(cells) == count and {cell['cell_type'] for cell in cells} == {'code'}


def test_what_is_under_the_mouse_stays_there(stage):
    def places():
        controls = stage.teleop.locator('button, .labkit-teleop-pad').all()
        return [control.bounding_box() for control in controls]

    def click(title):
        stage.teleop.get_by_title(title).click()

    words = stage.teleop.locator('output')
    expect(words).to_have_text('100 %: 0.22 m/s, 1.42 rad/s')
    before = places()
    assert len(before) == 8
    click('slower (key -)')
    expect(words).to_have_text('75 %: 0.17 m/s, 1.06 rad/s')
    assert places() == before
    click('faster (key +)')
    # So it is before the kernel has told the speeds.
    words.evaluate("words => { words.textContent = ''; }")
    assert places() == before


def test_mouse_drives_the_robot(stage):
    box = stage.page.locator('.labkit-teleop-pad').bounding_box()
    x, y = box['x'] + box['width'] / 2, box['y'] + box['height'] / 2
    stage.page.mouse.move(x, y)
    stage.page.mouse.down()
    stage.page.mouse.move(x, y - 200)
    expect(stage.published).to_contain_text('linear.x = 0.22 m/s  angular.z = 0.00 rad/s')
    stage.page.mouse.up()
    stage.expect_stop()
    button = stage.page.locator('.labkit-teleop-keys [data-action=right]')
    button.hover()
    stage.page.mouse.down()
    expect(stage.published).to_contain_text('linear.x = 0.00 m/s  angular.z = -1.42 rad/s')
    # Let go beside the button.
    stage.page.mouse.move(x, y)
    stage.page.mouse.up()
    stage.expect_stop()


LEAVING = {
    'click elsewhere': lambda stage: stage.page.locator('.labkit-arena-words').click(),
    'focus moves': lambda stage: stage.canvas.focus(),
    'window loses focus': lambda stage: stage.page.evaluate(
        "window.dispatchEvent(new Event('blur'))"
    ),
    'tab is hidden': lambda stage: stage.page.evaluate(
        """Object.defineProperty(document, 'hidden', { value: true, configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
        delete document.hidden"""
    ),
}


def test_whoever_leaves_stops_the_robot(stage):
    for name, leave in LEAVING.items():
        stage.hold('w', 'linear.x = 0.22')
        leave(stage)
        stage.expect_stop()
        stage.page.keyboard.up('w')
        assert stage.notebook.error_of('teleop') == '', name


def test_closing_the_tab_stops_the_robot_and_leaves_no_subscription(stage, jupyter, browser):
    stage.hold('w', 'linear.x = 0.22')
    name = stage.page.evaluate('window.jupyterapp.shell.currentWidget.context.path')
    # It goes without a word, like one that has crashed: the kernel finds out.
    stage.page.close(run_before_unload=False)
    other = open_notebook(jupyter, browser, name.removesuffix('.ipynb'))
    assert other.run_cell('standing') == 'standing (0.0, 0.0)'
    assert other.run_cell('no-ears') == 'nobody listens'
    # The fixture goes on with this tab.
    stage.notebook.page = other.page


def test_drives_while_a_cell_is_running(stage):
    stage.notebook.start_cell('busy')
    stage.notebook.wait_output('busy', 'busy')
    stage.hold('w', 'linear.x = 0.22')
    stage.notebook.wait_for_end('busy')
    # A line that says that the cell waits may have been between them.
    assert stage.notebook.output_text('busy').split() == ['busy', 'drove']
    stage.focus()
    stage.page.keyboard.up('w')
    stage.expect_stop()
