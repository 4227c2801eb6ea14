"""The robot in the browser: the arena is drawn, keys and mouse drive, whoever leaves stops it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook, open_notebook

CELLS = {
    'setup': 'import labkit as lab\nrobot = lab.spin(lab.Turtlebot())',
    'arena': 'view = lab.arena(goals=[(1.0, 0.5)])\nview',
    'teleop': 'pilot = lab.teleop()\npilot',
    'place': 'robot.place()',
    'busy': """
print('busy')
try:
    lab.wait_until(lambda: robot.pose.x > 0.1, timeout_sec=10)
    print('drove')
except lab.LabTimeout:
    print('stood')
""",
    'standing': """
lab.wait_until(lambda: robot.twist == (0, 0), timeout_sec=50)
print('standing', pilot.published)
""",
    'no-ears': """
import asyncio
from labkit.background.runtime import runtime

def ears():
    return {s.topic_name for s in runtime.helper.subscriptions}

while {'/odom', '/scan'} & ears():
    await asyncio.sleep(0.02)
print('nobody listens')
""",
    'close': 'view.close()\npilot.close()',
    'stop': 'lab.stop()',
}
STANDS = 'linear.x = 0.00 m/s  angular.z = 0.00 rad/s'
# What is drawn, by the colours of the pixels: what is but a few of them is not the ground.
COLOURS = """canvas => {
  const { width, height } = canvas;
  const pixels = canvas.getContext('2d').getImageData(0, 0, width, height).data;
  const counts = {};
  for (let i = 0; i < pixels.length; i += 4) {
    const colour = `${pixels[i]},${pixels[i + 1]},${pixels[i + 2]}`;
    counts[colour] = (counts[colour] ?? 0) + 1;
  }
  return counts;
}"""


class Stage:
    """A notebook in which a robot, its arena and its teleop run."""

    def __init__(self, notebook: Notebook) -> None:
        self.notebook, self.page = notebook, notebook.page
        for cell_id in ('setup', 'arena', 'teleop'):
            notebook.run_cell(cell_id)
        self.look()

    def look(self) -> None:
        """Find the views in the page."""
        self.canvas: Locator = self.page.locator('.labkit-arena canvas')
        self.teleop: Locator = self.page.locator('.labkit-teleop')
        self.published: Locator = self.page.locator('.labkit-teleop-published')
        expect(self.canvas).to_have_attribute('data-pose', '0.000 0.000 0.000 0.000 0.000')

    def focus(self) -> None:
        self.teleop.click(position={'x': 4, 'y': 4})

    def hold(self, key: str, shown: str) -> None:
        self.focus()
        self.page.keyboard.down(key)
        expect(self.published).to_contain_text(shown)

    def expect_stop(self) -> None:
        expect(self.published).to_contain_text(STANDS)
        self.page.wait_for_function(
            "canvas => canvas.dataset.pose.endsWith('0.000 0.000')",
            arg=self.canvas.element_handle(),
        )

    def pose(self) -> list[float]:
        return [float(number) for number in (self.canvas.get_attribute('data-pose')).split()]


@pytest.fixture
def stage(open_cells: Callable[..., Notebook]) -> Stage:
    return Stage(open_cells(**CELLS))


def test_arena_is_drawn_and_follows_the_theme(stage):
    words = stage.page.locator('.labkit-arena-words')
    expect(words).to_contain_text('It stands. Nearest obstacle 1.81 m away')
    expect(words).to_have_attribute('aria-live', 'polite')
    light = stage.canvas.evaluate(COLOURS)
    ground = max(light, key=light.get)
    assert ground == '255,255,255' and len(light) > 20
    # Whoever looks for coordinates finds them by mouse and by keyboard.
    before = sum(light.values()) - light[ground]
    stage.canvas.focus()
    stage.page.keyboard.press('ArrowUp')
    stage.notebook.wait_for_pictures()
    with_cross = stage.canvas.evaluate(COLOURS)
    assert sum(with_cross.values()) - with_cross[ground] > before
    stage.notebook.execute('apputils:change-theme', theme='JupyterLab Dark')
    try:
        stage.page.wait_for_function(
            f'canvas => !(({COLOURS})(canvas)["{ground}"] > 10000)',
            arg=stage.canvas.element_handle(),
        )
    finally:
        stage.notebook.execute('apputils:change-theme', theme='JupyterLab Light')


def test_keys_drive_the_robot_and_leave_the_notebook_alone(stage):
    count = len(stage.notebook.cells())
    stage.hold('w', 'linear.x = 0.11 m/s  angular.z = 0.00 rad/s')
    stage.page.wait_for_function(
        'canvas => parseFloat(canvas.dataset.pose) > 0.1', arg=stage.canvas.element_handle()
    )
    stage.page.keyboard.down('ArrowLeft')
    expect(stage.published).to_contain_text('linear.x = 0.11 m/s  angular.z = 1.42 rad/s')
    stage.page.keyboard.press('+')
    expect(stage.published).to_contain_text('angular.z = 2.13 rad/s')
    stage.page.keyboard.up('w')
    expect(stage.published).to_contain_text('linear.x = 0.00 m/s  angular.z = 2.13 rad/s')
    stage.page.keyboard.up('ArrowLeft')
    stage.expect_stop()
    assert stage.pose()[0] > 0.1
    for key, shown in (('ArrowDown', '= -0.17 m/s'), ('d', '= -2.13 rad/s'), ('x', '= -0.17')):
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


def test_mouse_drives_the_robot(stage):
    box = stage.page.locator('.labkit-teleop-pad').bounding_box()
    x, y = box['x'] + box['width'] / 2, box['y'] + box['height'] / 2
    stage.page.mouse.move(x, y)
    stage.page.mouse.down()
    stage.page.mouse.move(x, y - 200)
    expect(stage.published).to_contain_text('linear.x = 0.11 m/s  angular.z = 0.00 rad/s')
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
        stage.hold('w', 'linear.x = 0.11')
        leave(stage)
        stage.expect_stop()
        stage.page.keyboard.up('w')
        assert stage.notebook.error_of('teleop') == '', name


def test_closing_the_tab_stops_the_robot_and_leaves_no_subscription(stage, jupyter, browser):
    stage.hold('w', 'linear.x = 0.11')
    name = stage.page.evaluate('window.jupyterapp.shell.currentWidget.context.path')
    # It goes without a word, like one that has crashed: the kernel finds out.
    stage.page.close(run_before_unload=False)
    other = open_notebook(jupyter, browser, name.removesuffix('.ipynb'))
    assert other.run_cell('standing') == 'standing (0.0, 0.0)'
    assert other.run_cell('no-ears') == 'nobody listens'
    # The fixture goes on with this tab.
    stage.notebook.page = other.page


def test_drives_while_a_cell_is_running(stage):
    # JupyterLab lets widgets speak in a thread of the kernel's own, but not from the first moment:
    # what they say before that waits for the end of the running cell.
    for _ in range(6):
        stage.notebook.start_cell('busy')
        stage.notebook.wait_output('busy', 'busy')
        stage.hold('w', 'linear.x = 0.11')
        stage.notebook.wait_for_end('busy')
        stage.focus()
        stage.page.keyboard.up('w')
        stage.expect_stop()
        if 'drove' in stage.notebook.output_text('busy'):
            return
        stage.notebook.run_cell('place')
    pytest.fail('The robot did not drive while a cell was running.')


def test_closed_views_say_so(stage):
    stage.notebook.run_cell('close')
    arena_note = stage.page.locator('.labkit-arena .labkit-live-note')
    teleop_note = stage.teleop.locator('.labkit-live-note')
    expect(arena_note).to_contain_text('This arena has ended')
    expect(teleop_note).to_contain_text('This teleop has ended')
    # Running the cells again gives new ones.
    stage.notebook.run_cell('arena')
    stage.notebook.run_cell('teleop')
    stage.look()
    stage.hold('ArrowUp', 'linear.x = 0.11')
    stage.page.keyboard.up('ArrowUp')
    stage.expect_stop()
    stage.notebook.run_cell('stop')
    for note in (arena_note, teleop_note):
        expect(note).to_contain_text('ROS was stopped. Run this cell')
