"""The tree of frames in the browser: rates live in it, keys tell more; and axes on the map."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.accessibility import violations
from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': """
import labkit as lab
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster

def put(child, parent):
    node = lab.spin(Node(f'puts_{child}'))
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    message.transform.rotation.w = 1.0
    StaticTransformBroadcaster(node).sendTransform(message)
""",
    'frames': 'lab.frames()',
    'robot': 'robot = lab.spin(lab.Turtlebot())',
    'shelf': "put('shelf', 'map')",
    'chain': "lab.frames('odom', 'base_scan')",
    'place': 'robot.place(x=1.0)',
    'arena': "lab.arena(frames=['odom', 'base_scna'], fixed_frame='base_link')",
    'dock': 'lab.dock(lab.frames())',
}
# How many pixels have the colour of an x axis.
RED = """canvas => {
  const context = canvas.getContext('2d');
  const one = new OffscreenCanvas(1, 1).getContext('2d');
  one.fillStyle = getComputedStyle(canvas).getPropertyValue('--labkit-axis-x').trim();
  one.fillRect(0, 0, 1, 1);
  const [r, g, b] = one.getImageData(0, 0, 1, 1).data;
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] === r && data[i + 1] === g && data[i + 2] === b) count += 1;
  }
  return count;
}"""


@pytest.fixture
def notebook(open_cells: Callable[..., Notebook]) -> Notebook:
    notebook = open_cells(**CELLS)
    notebook.run_cell('setup')
    return notebook


def view_of(notebook: Notebook, cell: str) -> Locator:
    return notebook.output(cell).locator('.labkit-frames')


def part(view: Locator, name: str) -> Locator:
    return view.locator(f'[data-part][aria-label^="{name}"]')


def test_the_tree_grows_tells_rates_and_what_is_cut(notebook: Notebook) -> None:
    notebook.run_cell('frames')
    view = view_of(notebook, 'frames')
    expect(view.locator('.labkit-graph-empty')).to_contain_text('lab.spin(lab.Turtlebot())')
    notebook.run_cell('robot')
    moving = part(view, 'Frame base_footprint')
    expect(moving.locator('.small').first).to_have_text(re.compile(r'^\d+ Hz, \d\.\d+ s old$'))
    expect(view.locator('.labkit-graph-empty')).to_be_hidden()
    # Keys: into the drawing, to its last part, and what that is.
    part(view, 'Frame odom').focus()
    notebook.page.keyboard.press('ArrowRight')
    details = view.locator('.labkit-graph-details')
    expect(details).not_to_contain_text('Point at a frame')
    part(view, 'Frame base_scan').focus()
    expect(details).to_contain_text('In base_link, static · Published by /turtlebot on /tf_static')
    notebook.run_cell('shelf')
    expect(view.locator('.caption.wrong').first).to_contain_text(
        "✗ Could not find a connection between 'odom' and 'map' because they are not part of"
    )
    expect(view.locator('.labkit-graph-told')).to_contain_text('Tf has two or more unconnected')
    assert violations(notebook, 'frames') == []


def test_numbers_of_the_way_between_two_frames_follow_the_robot(notebook: Notebook) -> None:
    notebook.run_cell('robot')
    notebook.run_cell('chain')
    view = view_of(notebook, 'chain')
    expect(view.locator('.caption').first).to_contain_text('base_scan in odom: x = -0.032 m')
    notebook.run_cell('place')
    expect(view.locator('.caption').first).to_contain_text('base_scan in odom: x = 0.968 m')
    expect(part(view, 'Frame base_footprint')).to_contain_text('x = 1.000 m')


def test_what_is_too_wide_to_be_read_scrolls(notebook: Notebook) -> None:
    notebook.page.set_viewport_size({'width': 800, 'height': 900})
    notebook.run_cell('robot')
    notebook.run_cell('frames')
    view = view_of(notebook, 'frames')
    expect(part(view, 'Frame base_scan')).to_have_count(1)
    place = view.locator('.labkit-graph-drawing')
    scrolls = 'place => place.scrollWidth > place.clientWidth + 1'
    assert place.evaluate(scrolls)
    expect(part(view, 'Frame odom')).to_be_in_viewport()
    # What is wrong is read wherever it is scrolled to.
    notebook.run_cell('shelf')
    caption = view.locator('.caption').first
    for left in (0, 300):
        place.evaluate('(place, left) => { place.scrollLeft = left; }', left)
        begins = 'caption => caption.getBoundingClientRect().left'
        expect(caption).to_contain_text('✗ Could not find')
        notebook.page.wait_for_function(
            f'([caption, place]) => ({begins})(caption) > ({begins})(place)'
            f' && ({begins})(caption) < ({begins})(place) + 60',
            arg=[caption.element_handle(), place.element_handle()],
        )
    view.get_by_role('button', name='Fit all of it').click()
    assert not place.evaluate(scrolls)
    notebook.page.set_viewport_size({'width': 1280, 'height': 900})


def test_it_is_docked_under_its_name(notebook: Notebook) -> None:
    notebook.run_cell('robot')
    assert 'The tree of frames is in its panel' in notebook.run_cell('dock')
    panel = notebook.page.locator('.jupyterlab-sidecar .labkit-frames')
    expect(part(panel, 'Frame base_scan')).to_have_count(1)


def test_axes_are_on_the_map_and_what_is_not_known_is_named(notebook: Notebook) -> None:
    notebook.run_cell('robot')
    notebook.run_cell('arena')
    view = notebook.output('arena').locator('.labkit-arena')
    canvas, words = view.locator('canvas'), view.locator('.labkit-arena-words')
    expect(words).to_contain_text('All is told in the frame base_link')
    expect(view.locator('.labkit-live-note')).to_contain_text("Did you mean 'base_scan'?")
    notebook.page.wait_for_function(f'canvas => ({RED})(canvas) > 50', arg=canvas.element_handle())
    # The robot stays in the middle, wherever it is put.
    notebook.run_cell('place')
    expect(words).to_contain_text('Frame odom at x = -1.00 m')
    expect(words).to_contain_text('Robot at x = 0.00 m, y = 0.00 m')
    assert violations(notebook, 'arena') == []
