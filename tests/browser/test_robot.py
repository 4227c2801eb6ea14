"""The robot in the browser: the arena is drawn, keys and mouse drive, whoever leaves stops it."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook, open_notebook

CELLS = {
    'setup': 'import labkit as lab\nrobot = lab.spin(lab.Turtlebot())',
    'arena': 'view = lab.arena(goals=[(1.0, 0.5)])\nview',
    'teleop': 'pilot = lab.teleop()\npilot',
    'place': 'robot.place()',
    'before-a-wall': 'robot.place(x=2.2)',
    'both': 'robot.place()\ndisplay(lab.arena(), lab.teleop())',
    'to-a-corner': 'robot.place(x=2.0, y=-2.0)',
    'other-arena': 'lab.arena()',
    'other-teleop': 'lab.teleop()',
    'camera': "display(lab.image('/camera/image_raw'), lab.teleop())",
    'close-camera': 'lab.remove(robot)',
    'busy': """
print('busy')
try:
    lab.wait_until(lambda: robot.pose.x > 0.1, timeout_sec=50)
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
    # Most of it is the floor that the scanner sees; there is much else.
    floor = max(light, key=light.get)
    assert light[floor] > 10000 and len(light) > 20
    # Whoever looks for coordinates finds them by mouse and by keyboard.
    stage.canvas.focus()
    stage.page.keyboard.press('Shift+ArrowUp')
    stage.notebook.wait_for_pictures()
    with_cross = stage.canvas.evaluate(COLOURS)
    assert with_cross != light
    stage.page.keyboard.press('Escape')
    stage.notebook.wait_for_pictures()
    stage.notebook.execute('apputils:change-theme', theme='JupyterLab Dark')
    try:
        stage.page.wait_for_function(
            f'canvas => !(({COLOURS})(canvas)["{floor}"] > 10000)',
            arg=stage.canvas.element_handle(),
        )
    finally:
        stage.notebook.execute('apputils:change-theme', theme='JupyterLab Light')


def test_map_is_moved_by_mouse_keys_and_buttons(stage):
    def view():
        stage.notebook.wait_for_pictures()
        shown = stage.canvas.get_attribute('data-view')
        return shown if shown == 'all' else [float(number) for number in shown.split()]

    def press(key):
        stage.canvas.focus()
        stage.page.keyboard.press(key)
        return view()

    assert view() == 'all'
    whole = stage.canvas.evaluate(COLOURS)
    x, y, scale = press('+')
    assert stage.canvas.evaluate(COLOURS) != whole
    assert press('ArrowLeft')[0] < x and press('ArrowUp')[1] > y and press('-')[2] < scale
    assert press('0') == 'all'
    assert stage.canvas.evaluate(COLOURS) == whole
    box = stage.canvas.bounding_box()
    middle = box['x'] + box['width'] / 2, box['y'] + box['height'] / 2
    stage.page.mouse.move(*middle)
    stage.page.mouse.down()
    stage.page.mouse.move(middle[0] + 50, middle[1])
    stage.page.mouse.up()
    assert view()[0] < x
    stage.page.get_by_role('button', name='Show the whole map').click()
    assert view() == 'all'
    # The wheel scrolls the page, but for a map that was clicked.
    for press_in, zooms in ((stage.teleop.focus, False), (stage.canvas.focus, True)):
        press_in()
        stage.page.mouse.move(*middle)
        stage.page.mouse.wheel(0, -1)
        assert (view() != 'all') == zooms
    follow = stage.page.get_by_role('button', name='Follow the robot')
    follow.click()
    expect(follow).to_have_attribute('aria-pressed', 'true')
    stage.notebook.run_cell('before-a-wall')
    expect(stage.canvas).to_have_attribute('data-view', re.compile(r'^2\.20 0\.00 '))
    press('ArrowLeft')
    expect(follow).to_have_attribute('aria-pressed', 'false')


# How many pixels have the colour of walls that were seen before.
MET = """canvas => {
  const context = canvas.getContext('2d');
  const one = new OffscreenCanvas(1, 1).getContext('2d');
  one.fillStyle = getComputedStyle(canvas).getPropertyValue('--labkit-met').trim();
  one.fillRect(0, 0, 1, 1);
  const wanted = one.getImageData(0, 0, 1, 1).data;
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    count += data[i] === wanted[0] && data[i + 1] === wanted[1] && data[i + 2] === wanted[2];
  }
  return count;
}"""


def test_walls_that_were_seen_stay_on_the_map(stage):
    before = stage.canvas.evaluate(MET)
    # From there the scanner does not reach the walls on the other side.
    stage.notebook.run_cell('to-a-corner')
    stage.page.wait_for_function(
        f'([canvas, before]) => canvas.dataset.pose.startsWith("2.000 -2.000")'
        f' && ({MET})(canvas) > before + 500',
        arg=[stage.canvas.element_handle(), before],
    )


def test_map_comes_into_view_when_its_cell_is_run(stage):
    place = stage.notebook.cell('other-arena')
    stage.notebook.wait_for_pictures()
    # The cell is the last thing that one sees: its map would lie below.
    place.evaluate('cell => cell.scrollIntoView({ block: "end" })')
    place.locator('.cm-content').click()
    stage.page.keyboard.press('Control+Enter')
    canvas = place.locator('.labkit-arena canvas')
    canvas.wait_for()
    stage.page.wait_for_function(
        """canvas => {
          const { top, bottom } = canvas.getBoundingClientRect();
          return canvas.dataset.frames && top >= 0 && bottom <= window.innerHeight;
        }""",
        arg=canvas.element_handle(),
    )


def test_a_bump_is_shown_and_told(stage):
    stage.notebook.run_cell('before-a-wall')
    stage.hold('w', 'linear.x = 0.22')
    expect(stage.canvas).to_have_attribute('data-bumps', '1')
    words = stage.page.locator('.labkit-arena-words')
    expect(words).to_contain_text('It stands. It bumped into something, ahead.')
    stage.page.keyboard.up('w')
    stage.hold('x', 'linear.x = -0.22')
    expect(words).not_to_contain_text('bumped')
    expect(stage.page.locator('.labkit-arena-bump')).to_be_hidden()
    stage.page.keyboard.up('x')
    stage.expect_stop()
    expect(stage.canvas).to_have_attribute('data-bumps', '1')


def test_map_and_keys_are_beside_each_other_where_there_is_room(stage):
    stage.notebook.run_cell('both')
    area = stage.notebook.output('both')
    arena, teleop = area.locator('.labkit-arena'), area.locator('.labkit-teleop')

    def beside():
        stage.notebook.wait_for_pictures()
        one, other = arena.bounding_box(), teleop.bounding_box()
        assert one['width'] > 300 and other['width'] > 200
        return other['x'] >= one['x'] + one['width']

    size = stage.page.viewport_size
    try:
        for width, expected in ((1400, True), (800, False)):
            stage.page.set_viewport_size({'width': width, 'height': 900})
            assert beside() == expected
            # Nothing is wider than what there is.
            assert area.evaluate('place => place.scrollWidth <= place.clientWidth')
        # A page of 1400 x 900 at 150 %: the cell, its map, keys and stick fit into it.
        stage.page.set_viewport_size({'width': 933, 'height': 600})
        assert not beside()
        assert stage.notebook.cell('both').evaluate("""cell => {
          const { bottom } = cell.querySelector('.labkit-teleop-pad').getBoundingClientRect();
          const { height } = cell.closest('.jp-WindowedPanel-outer').getBoundingClientRect();
          return bottom - cell.getBoundingClientRect().top <= height;
        }""")
    finally:
        stage.page.set_viewport_size(size)
    # With the map, its keys go to the full screen.
    area.get_by_role('button', name='Full screen').click()
    stage.page.wait_for_function('document.fullscreenElement')
    assert stage.page.evaluate("document.fullscreenElement.querySelector('.labkit-teleop')")
    stage.page.evaluate('document.exitFullscreen()')
    stage.page.wait_for_function('!document.fullscreenElement')


# The colour in the middle of a picture.
MIDDLE = """picture => {
  const canvas = Object.assign(document.createElement('canvas'), { width: 1, height: 1 });
  const { naturalWidth: width, naturalHeight: height } = picture;
  const context = canvas.getContext('2d');
  context.drawImage(picture, width / 2, height / 2, 1, 1, 0, 0, 1, 1);
  return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
}"""


def test_one_drives_by_what_the_camera_sees(stage):
    stage.notebook.run_cell('camera')
    area = stage.notebook.output('camera')
    view, picture = area.locator('.labkit-image'), area.locator('.labkit-image img')
    expect(picture).to_have_attribute(
        'alt', 'Picture of /camera/image_raw: 320 x 240 pixels, rgb8.'
    )
    expect(view).to_contain_text('/camera/image_raw')
    assert picture.evaluate('p => [p.naturalWidth, p.naturalHeight]') == [320, 240]
    # The wall ahead is yellow. To the left of it stands a red one.
    _, green, blue = picture.evaluate(MIDDLE)
    assert green - blue > 60
    area.locator('.labkit-teleop').click(position={'x': 4, 'y': 4})
    stage.page.keyboard.down('a')
    stage.page.wait_for_function(
        f'p => {{ const [r, g, b] = ({MIDDLE})(p); return r - g > 50 && g - b < 50; }}',
        arg=picture.element_handle(),
    )
    stage.page.keyboard.up('a')
    stage.notebook.run_cell('close-camera')
    expect(view.locator('.labkit-live-note')).to_contain_text(
        'Nobody publishes on /camera/image_raw'
    )


def test_two_maps_and_two_sets_of_keys_work(stage):
    stage.notebook.run_cell('other-arena')
    stage.notebook.run_cell('other-teleop')
    other = stage.notebook.output('other-teleop').locator('.labkit-teleop')
    published = stage.page.locator('.labkit-teleop-published')
    for teleop, number in ((other, 1), (stage.teleop.first, 0)):
        teleop.click(position={'x': 4, 'y': 4})
        stage.page.keyboard.down('d')
        expect(published.nth(number)).to_contain_text('angular.z = -1.42')
        stage.page.keyboard.up('d')
        expect(published.nth(number)).to_contain_text(STANDS)
    for canvas in stage.canvas.all():
        stage.page.wait_for_function(
            "canvas => !canvas.dataset.pose.startsWith('0.000 0.000 0.000')",
            arg=canvas.element_handle(),
        )
    expect(stage.page.locator('.labkit-live-note:visible')).to_have_count(0)


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
    assert stage.notebook.output_text('busy') == 'busy\ndrove'
    stage.focus()
    stage.page.keyboard.up('w')
    stage.expect_stop()


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
    stage.hold('ArrowUp', 'linear.x = 0.22')
    stage.page.keyboard.up('ArrowUp')
    stage.expect_stop()
    stage.notebook.run_cell('stop')
    for note in (arena_note, teleop_note):
        expect(note).to_contain_text('ROS was stopped. Run this cell')
