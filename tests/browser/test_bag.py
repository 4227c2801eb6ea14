"""The picture of a bag in the browser: slider, play, plot, map, keyboard, themes, other's text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.accessibility import violations
from tests.browser.page import VIEWPORT, Notebook
from tests.browser.test_views import CONTRAST
from tests.views.bags import make_camera, make_drive, make_foreign

pytestmark = pytest.mark.slow('a page in the browser')


class Stage:
    """A notebook that shows a bag of a drive, and one with a foreign type."""

    def __init__(self, notebook: Notebook) -> None:
        self.notebook, self.page = notebook, notebook.page
        notebook.run_cell('setup')

    def show(self, cell_id: str) -> Locator:
        self.notebook.run_cell(cell_id)
        assert self.notebook.error_of(cell_id) == ''
        view = self.notebook.output(cell_id).locator('.labkit-live')
        expect(view.locator('tbody tr').first).to_be_visible()
        return view

    def wait(self, condition: str, place: Locator) -> None:
        self.page.wait_for_function(condition, arg=place.element_handle())


@pytest.fixture
def stage(open_cells: Callable[..., Notebook], tmp_path: Path) -> Stage:
    drive, arm = make_drive(tmp_path / 'drive'), make_foreign(tmp_path / '<img src=x>')
    camera = make_camera(tmp_path / 'camera', 'rgb8', 'mono7')
    cells = {
        'setup': 'import labkit as lab',
        'drive': f"lab.bag({str(drive)!r}, '/odom.pose.pose.position.x', '/cmd_vel.linear.x')",
        'arm': f'lab.bag({str(arm)!r})',
        'camera': f'lab.bag({str(camera)!r})',
        'missing': f'lab.bag({str(drive)[:-1]!r})',
    }
    return Stage(open_cells(**cells))


def test_slider_goes_through_plot_and_map_by_keyboard(stage):
    view = stage.show('drive')
    expect(view.locator('.labkit-live-header').first).to_contain_text(
        'drive10.0 s from 2023-11-14 22:13:20'
    )
    expect(view.locator('.labkit-bag-topics').locator('tbody th button')).to_have_text(
        ['/cmd_vel', '/never', '/odom', '/scan']
    )
    strips = view.locator('.labkit-bag-strip canvas')
    expect(strips.nth(2)).to_have_attribute(
        'aria-label',
        '101 messages of /odom from 0.0 s to 10.0 s, longest pause 0.1 s, from 0.0 s on',
    )
    words = view.locator('.labkit-arena-words')
    expect(words).to_have_text(
        'Robot at x = 0.00 m, y = 0.00 m, heading 0°, 0.20 m/s, 0.00 rad/s.'
    )
    floor = view.locator('.labkit-arena canvas')
    stage.wait('v => v.dataset.time === "0.000"', view)
    seen = floor.evaluate('c => c.toDataURL()')
    slider = view.get_by_role('slider', name='Time in the bag')
    slider.focus()
    count = len(stage.notebook.cells())
    stage.page.keyboard.press('End')
    expect(words).to_contain_text('x = 2.00 m, y = 0.00 m, heading 57°')
    expect(slider).to_have_attribute('aria-valuetext', '10.00 s of 10.00 s')
    numbers = view.locator('.labkit-plot tbody tr').first.locator('td')
    expect(numbers.first).to_have_text('2')
    assert floor.evaluate('c => c.toDataURL()') != seen
    # In JupyterLab's command mode these move to other cells, insert and cut them.
    for key in ('Home', 'ArrowRight', 'a', 'b', 'x'):
        stage.page.keyboard.press(key)
    stage.wait('v => v.dataset.time === "0.010"', view)
    assert len(stage.notebook.cells()) == count


def test_play_moves_on_and_stops_at_the_end(stage):
    view = stage.show('drive')
    view.get_by_label('Rate').select_option('10')
    view.get_by_role('button', name='Play').focus()
    stage.page.keyboard.press('Enter')
    stage.wait('v => Number(v.dataset.time) > 0.5', view)
    stage.wait('v => v.dataset.time === "10.000"', view)
    expect(view.get_by_role('button', name='Play')).to_be_focused()
    # From the end it begins anew, and can be paused.
    view.get_by_label('Rate').select_option('0.1')
    stage.page.keyboard.press('Enter')
    stage.wait('v => Number(v.dataset.time) > 0 && Number(v.dataset.time) < 9', view)
    stage.page.keyboard.press('Enter')
    expect(view.get_by_role('button', name='Play')).to_be_focused()
    time = view.get_attribute('data-time')
    stage.page.keyboard.press('Tab')
    assert view.get_attribute('data-time') == time


def test_topic_shows_its_messages_and_its_numbers_can_be_plotted(stage):
    view = stage.show('arm')
    expect(view.locator('.labkit-live-header').first).to_contain_text('<img src=x>')
    expect(view.locator('.labkit-plot')).to_be_hidden()
    expect(view.locator('.labkit-arena')).to_be_hidden()
    button = view.get_by_role('button', name='/arm')
    button.focus()
    stage.page.keyboard.press('Enter')
    expect(button).to_have_attribute('aria-pressed', 'true')
    message = view.locator('.labkit-bag-message')
    expect(message).to_contain_text("state: '<img src=x onerror=alert(1)>'")
    expect(message.locator('img')).to_have_count(0)
    expect(view).to_contain_text('Came at 0.00 s')
    field = view.get_by_label('Number to plot')
    expect(field.locator('option').first).to_have_text('angles[0]')
    field.select_option('first.position')
    view.get_by_role('button', name='Plot', exact=True).click()
    expect(view.locator('.labkit-plot tbody th')).to_have_text(' /arm.first.position')
    view.get_by_role('slider').focus()
    stage.page.keyboard.press('End')
    expect(view).to_contain_text('Came at 4.00 s')
    expect(message).to_contain_text('position: 8.0')
    expect(view.locator('.labkit-plot tbody td').first).to_have_text('8')
    view.get_by_role('button', name='Clear plot').click()
    expect(view.locator('.labkit-plot')).to_be_hidden()


def test_the_time_is_grabbed_in_any_strip_and_in_the_plot(stage):
    view = stage.show('drive')
    view.get_by_role('button', name='/scan').click()
    for place in (
        view.locator('.labkit-bag-strip canvas').last,
        view.locator('.labkit-plot canvas'),
    ):
        place.scroll_into_view_if_needed()
        box = place.bounding_box()
        middle = box['y'] + box['height'] / 2
        stage.page.mouse.move(box['x'] + box['width'] * 0.3, middle)
        stage.page.mouse.down()
        stage.wait('v => Number(v.dataset.time) > 1 && Number(v.dataset.time) < 4', view)
        stage.page.mouse.move(box['x'] + box['width'] * 2, middle, steps=3)
        stage.wait('v => v.dataset.time === "10.000"', view)
        stage.page.mouse.up()
        stage.page.mouse.move(box['x'], middle)
    expect(view).to_contain_text('Came at 10.00 s')
    assert view.get_attribute('data-time') == '10.000'


def test_topic_of_a_camera_shows_its_pictures(stage):
    view = stage.show('camera')
    view.get_by_role('button', name='/camera').click()
    picture = view.get_by_role('img', name='Picture of /camera')
    stage.wait('p => p.naturalWidth === 2', picture)
    slider = view.get_by_role('slider', name='Time in the bag')
    slider.focus()
    stage.page.keyboard.press('End')
    expect(view).to_contain_text("Pictures with the encoding 'mono7' can not be shown.")
    expect(picture).to_be_hidden()
    assert violations(stage.notebook, 'camera') == []


def test_it_can_be_read_in_both_themes_and_fits_into_800_pixels(stage):
    stage.page.set_viewport_size({'width': 800, 'height': 900})
    stage.show('drive')
    try:
        for theme in ('JupyterLab Light', 'JupyterLab Dark'):
            stage.notebook.execute('apputils:change-theme', theme=theme)
            stage.page.wait_for_function(
                'dark => document.body.dataset.jpThemeLight === String(!dark)',
                arg=theme.endswith('Dark'),
            )
            view = stage.show('drive')
            view.get_by_role('button', name='/odom').click()
            expect(view.locator('.labkit-bag-message')).to_contain_text('frame_id')
            places = view.locator('span, th, td, button, select, output, .labkit-bag-row')
            ratios = [place.evaluate(CONTRAST) for place in places.all()[:60]]
            assert len(ratios) > 20 and min(ratios) >= 4.5, (theme, ratios)
            wide = view.evaluate('v => [v.scrollWidth, v.clientWidth]')
            assert wide[0] <= wide[1] < 800, wide
    finally:
        stage.notebook.execute('apputils:change-theme', theme='JupyterLab Light')
        stage.page.set_viewport_size({'width': 1280, 'height': 900})


def test_no_bag_is_a_sentence(stage):
    stage.notebook.run_cell('missing')
    assert 'There is no bag' in stage.notebook.error_of('missing')


def test_play_and_map_are_in_sight_together(stage):
    view = stage.show('drive')
    expect(view.locator('.labkit-arena canvas')).to_be_visible()
    for width in (1400, 1024, 700):
        stage.page.set_viewport_size({'width': width, 'height': 700})
        stage.notebook.scroll_to_top('drive')
        for place in ('.labkit-bag-controls button', '.labkit-arena canvas'):
            expect(view.locator(place).first).to_be_in_viewport(ratio=1)
    stage.page.set_viewport_size(VIEWPORT)
