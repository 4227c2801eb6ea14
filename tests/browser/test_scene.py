"""The scene in the browser: drawn when something changes, moved by mouse and keys."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, expect

from tests.browser.accessibility import violations
from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': 'import labkit as lab',
    'scene': 'view = lab.scene()\nview',
    'robot': 'robot = lab.spin(lab.Turtlebot(command_timeout=None))',
    'drive': """
from geometry_msgs.msg import Twist
from rclpy.node import Node
driver = lab.spin(Node('driver'))
publisher = driver.create_publisher(Twist, 'cmd_vel', 10)
lab.wait_for_subscribers(publisher)
twist = Twist()
twist.linear.x = twist.angular.z = 0.2
publisher.publish(twist)
""",
    'halt': 'publisher.publish(Twist())\nlab.wait_until(lambda: robot.twist == (0, 0))',
    'dock': 'lab.dock(lab.scene(world=robot))',
    'close': 'view.close()',
}


@pytest.fixture
def notebook(open_cells: Callable[..., Notebook]) -> Notebook:
    notebook = open_cells(**CELLS)
    for cell in ('setup', 'robot', 'scene'):
        notebook.run_cell(cell)
    return notebook


@pytest.fixture
def view(notebook: Notebook) -> Locator:
    view = notebook.output('scene').locator('.labkit-scene')
    expect(view.locator('canvas')).to_have_attribute('data-things', '21')
    return view


def draws(view: Locator) -> int:
    return int(view.locator('canvas').get_attribute('data-draws') or 0)


def camera(view: Locator) -> list[float]:
    words = view.locator('canvas').get_attribute('data-view') or ''
    return [float(word) for word in words.split()]


def count_of(view: Locator, colour: str) -> int:
    """Return how many pixels of the scene are about as reddish as the laser's, or whatever."""
    wanted = view.evaluate(
        """(view, name) => {
          const one = new OffscreenCanvas(1, 1).getContext('2d');
          one.fillStyle = getComputedStyle(view).getPropertyValue(`--labkit-${name}`).trim();
          one.fillRect(0, 0, 1, 1);
          return [...one.getImageData(0, 0, 1, 1).data.slice(0, 3)];
        }""",
        colour,
    )
    picture = Image.open(io.BytesIO(view.locator('.labkit-scene-space').screenshot()))
    pixels = np.asarray(picture.convert('RGB'), dtype=int)
    return int((abs(pixels - np.array(wanted)) < 8).all(axis=2).sum())


def rest(notebook: Notebook, view: Locator) -> int:
    """Wait until nothing is drawn any more, and return how often it was."""
    before = -1
    while draws(view) != before:
        before = draws(view)
        updates = int(view.get_attribute('data-updates') or 0)
        # A kernel that has nothing new says so once a second.
        notebook.page.wait_for_function(
            '([view, least]) => Number(view.dataset.updates) >= least',
            arg=[view.element_handle(), updates + 2],
        )
    return before


def test_it_is_drawn_while_something_changes_and_then_no_more(
    notebook: Notebook, view: Locator
) -> None:
    assert count_of(view, 'laser') > 50
    at_rest = rest(notebook, view)
    notebook.run_cell('drive')
    notebook.page.wait_for_function(
        '([canvas, least]) => Number(canvas.dataset.draws) >= least',
        arg=[view.locator('canvas').element_handle(), at_rest + 30],
    )
    notebook.run_cell('halt')
    rest(notebook, view)
    expect(view.locator('canvas')).to_have_attribute('data-things', '22')
    expect(view.locator('.labkit-scene-words')).to_contain_text('Laser /scan: ')
    # What is switched off is neither drawn nor heard.
    view.locator('summary').click()
    box = view.get_by_label('/scan')
    box.uncheck()
    expect(view.locator('canvas')).to_have_attribute('data-things', '21')
    expect(view.locator('.labkit-scene-words')).not_to_contain_text('Laser')
    assert count_of(view, 'laser') < 50
    # A camera is heard when it is asked for.
    view.get_by_label('/camera/image_raw').check()
    picture = view.get_by_role('img', name='Picture of /camera/image_raw')
    expect(picture).to_be_visible()
    assert violations(notebook, 'scene') == []
    view.get_by_label('/camera/image_raw').uncheck()
    expect(picture).to_have_count(0)


def test_mouse_wheel_and_keys_move_it(notebook: Notebook, view: Locator) -> None:
    canvas, page = view.locator('canvas'), notebook.page
    azimuth, elevation, distance, *_ = camera(view)
    place = canvas.bounding_box()
    assert place is not None
    x, y = place['x'] + place['width'] / 2, place['y'] + place['height'] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 50, y + 50)
    page.mouse.up()
    expect(canvas).not_to_have_attribute('data-view', ' '.join(map(str, camera(view))))
    turned = camera(view)
    assert turned[0] < azimuth
    assert turned[1] > elevation
    # The wheel is the scene's once it was clicked.
    page.mouse.wheel(0, -100)
    page.wait_for_function(
        '([canvas, most]) => Number(canvas.dataset.view.split(" ")[2]) < most',
        arg=[canvas.element_handle(), distance],
    )
    canvas.focus()
    for key in ('Shift+ArrowRight', 'ArrowLeft', 'f'):
        page.keyboard.press(key)
    follow = view.locator('.labkit-over-buttons button[aria-pressed]')
    expect(follow).to_have_text('Follow base_footprint')
    expect(follow).to_have_attribute('aria-pressed', 'true')
    page.keyboard.press('0')
    expect(follow).to_have_attribute('aria-pressed', 'false')
    page.wait_for_function(
        '([canvas, wanted]) => canvas.dataset.view.startsWith(wanted)',
        arg=[canvas.element_handle(), f'{azimuth:.2f}'],
    )
    page.keyboard.press('d')
    expect(view.locator('details')).to_have_attribute('open', '')
    select = view.get_by_label('Fixed frame')
    select.select_option('base_link')
    expect(view.locator('.labkit-scene-words')).to_contain_text('A scene in the frame base_link.')


def test_in_the_panel_and_after_its_end(notebook: Notebook, view: Locator) -> None:
    notebook.run_cell('close')
    expect(view.locator('.labkit-live-note')).to_contain_text('This scene has ended.')
    notebook.run_cell('dock')
    docked = notebook.page.locator('.jupyterlab-sidecar .labkit-scene')
    # With four walls and three posts.
    expect(docked.locator('canvas')).to_have_attribute('data-things', '28')
    notebook.execute('apputils:change-theme', theme='JupyterLab Dark')
    expect(docked.locator('canvas')).to_be_visible()
    assert count_of(docked, 'wall') + count_of(docked, 'laser') > 20
    notebook.execute('apputils:change-theme', theme='JupyterLab Light')
