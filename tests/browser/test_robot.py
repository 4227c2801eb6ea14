"""The robot in the browser: its map, its camera, and two of them at once."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.browser.robot_stage import STANDS

pytestmark = pytest.mark.slow('a page in the browser')

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
    # All of the map is the map's, also where JupyterLab has its switch for scrolled outputs.
    stage.notebook.scroll_to_top('both')
    assert beside()
    assert arena.evaluate("""map => {
      const { left, top } = map.getBoundingClientRect();
      return map.contains(document.elementFromPoint(left + 20, top + 60));
    }""")
    # With the map, its keys go to the full screen.
    area.get_by_role('button', name='Full screen').click()
    stage.page.wait_for_function('document.fullscreenElement')
    assert stage.page.evaluate("document.fullscreenElement.querySelector('.labkit-teleop')")
    # The room fills the picture, and the keys are at its right.
    assert beside()
    expect(arena.locator('canvas')).to_have_attribute('data-view', 'all')
    assert arena.bounding_box()['width'] > 0.6 * stage.page.viewport_size['width']
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
    # The wall ahead is yellow. To the left of it stands a red one. A picture that is just being
    # replaced has no size, and no colour.
    stage.page.wait_for_function(
        f'p => p.naturalWidth === 320 && p.naturalHeight === 240 && '
        f'(([r, g, b]) => g - b > 60)(({MIDDLE})(p))',
        arg=picture.element_handle(),
    )
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


def test_several_robots_share_a_map_and_keys_drive_one(stage):
    # The map that was there before shows them, too.
    stage.notebook.run_cell('robots')
    area = stage.notebook.output('robots')
    still = '0.000 {} 0.000 0.000 0.000'
    poses = ', '.join(still.format(y) for y in ('0.000', '1.000', '-1.000'))
    for canvas in (stage.canvas.first, area.locator('canvas')):
        expect(canvas).to_have_attribute('data-pose', poses)
    expect(area.locator('.labkit-arena-words')).to_contain_text('robot2 at x = 0.00 m')
    area.locator('.labkit-teleop').click(position={'x': 4, 'y': 4})
    stage.page.keyboard.down('w')
    expect(area.locator('canvas')).to_have_attribute(
        'data-pose', re.compile(rf'^{re.escape(poses[: poses.rindex(",")])}, 0\.[1-9]')
    )
    stage.page.keyboard.up('w')
    # One after the other is followed, then none.
    follow = area.get_by_role('button', name='Follow the robot')
    for text, pressed in (
        *(('Follow', 'true'), ('Follow robot1', 'true'), ('Follow robot2', 'true')),
        ('Follow', 'false'),
    ):
        follow.click()
        expect(follow).to_have_text(text)
        expect(follow).to_have_attribute('aria-pressed', pressed)


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
