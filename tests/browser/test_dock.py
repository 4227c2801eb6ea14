"""The panel of `lab.dock()`: views that stay in sight while the notebook scrolls."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': """
import labkit as lab
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
robot = lab.spin(lab.Turtlebot())
heard = []
listener = lab.spin(Node('listener'))
goals = listener.create_subscription(PoseStamped, 'goal_pose', heard.append, 10)
""",
    'dock': 'lab.dock(lab.arena(), lab.teleop())',
    'wait0': 'print(1)',
    'arena': 'lab.arena()',
    'wait': """
lab.wait_until(lambda: robot.pose.x > 0.05 and robot.twist == (0, 0), timeout_sec=50)
print('drove')
""",
    'goal': """
lab.wait_until(lambda: heard, timeout_sec=50)
place, turn = heard[-1].pose.position, heard[-1].pose.orientation
print(heard[-1].header.frame_id, place.x > 0.5, place.y > 0.5, 0.3 < turn.z < 0.5)
""",
    **{f'text{number}': '# text\n' * 60 for number in range(3)},
}
TABS = '.jp-SideBar.jp-mod-right .lm-TabBar-tab'
DOCKED = 'is in its panel'


class Panel:
    """What the panel shows, and what of it the notebook shows."""

    def __init__(self, notebook: Notebook) -> None:
        page = notebook.page
        self.notebook, self.page = notebook, page
        self.views: Locator = page.locator('.jupyterlab-sidecar .labkit-view')
        self.map: Locator = page.locator('.jupyterlab-sidecar .labkit-arena canvas')
        self.in_cells: Locator = page.locator('.jp-Notebook .labkit-view').locator('visible=true')
        self.tab: Locator = page.locator(TABS, has_text='Robot')

    def expect_in_panel(self) -> None:
        expect(self.views).to_have_count(2)
        expect(self.in_cells).to_have_count(0)
        expect(self.tab).to_have_count(1)

    def expect_in_cell(self) -> None:
        expect(self.in_cells).to_have_count(2)
        expect(self.tab).to_have_count(0)

    def close(self) -> None:
        # The icon is drawn with what the panel's extension says; the tab lies over its edges.
        self.tab.locator('.lm-TabBar-tabCloseIcon').click(force=True)


@pytest.fixture
def panel(open_cells) -> Panel:
    notebook = open_cells(**CELLS)
    notebook.run_cell('setup')
    assert DOCKED in notebook.run_cell('dock')
    made = Panel(notebook)
    made.expect_in_panel()
    return made


def test_a_robot_is_driven_while_the_notebook_scrolls(panel):
    panel.notebook.cell('text2')
    expect(panel.map).to_be_in_viewport()
    panel.page.locator('.jupyterlab-sidecar .labkit-teleop').click(position={'x': 4, 'y': 4})
    panel.page.keyboard.down('w')
    panel.page.wait_for_function(
        'canvas => parseFloat(canvas.dataset.pose) > 0.05', arg=panel.map.element_handle()
    )
    panel.page.keyboard.up('w')
    assert panel.notebook.run_cell('wait') == 'drove'
    # Escape gives the keys back.
    panel.map.click(position={'x': 4, 'y': 4})
    panel.page.keyboard.press('Escape')
    expect(panel.map).not_to_be_focused()


def has_the_keys(panel: Panel, cell_id: str) -> bool:
    return panel.notebook.cell(cell_id).evaluate(
        'cell => document.activeElement === cell && cell.classList.contains("jp-mod-active")'
    )


def test_keys_go_from_a_cell_to_the_panel_and_back(panel):
    keyboard = panel.page.keyboard
    keys = panel.page.locator('.jupyterlab-sidecar .labkit-teleop')
    # From the keys to the cell that has docked them, though it was another one that ran last.
    panel.notebook.run_cell('wait0')
    keys.click(position={'x': 4, 'y': 4})
    keyboard.press('Escape')
    expect(keys).not_to_be_focused()
    assert has_the_keys(panel, 'dock')
    # From a cell in which somebody types, and back to it.
    panel.notebook.cell('wait0').locator('.cm-content').click()
    keyboard.press('F6')
    expect(keys).to_be_focused()
    expect(keys).to_contain_text('Esc goes back to the cell, and F6 comes here from one.')
    keyboard.press('F6')
    assert has_the_keys(panel, 'wait0')


def test_a_closed_panel_gives_its_views_back(panel):
    panel.close()
    panel.expect_in_cell()
    panel.page.locator('.jp-Notebook .labkit-arena canvas').focus()
    panel.page.keyboard.press('k')
    panel.expect_in_panel()


def test_there_is_one_panel_whatever_is_run_again(panel):
    panel.notebook.run_cell('dock')
    panel.expect_in_panel()
    panel.notebook.reload()
    panel.expect_in_panel()
    panel.notebook.restart_kernel()
    panel.expect_in_cell()
    panel.notebook.run_cell('setup')
    panel.notebook.run_cell('dock')
    panel.expect_in_panel()


def test_a_goal_is_published_where_one_clicks_and_looks_to_where_one_drags(panel):
    panel.page.get_by_role('button', name='key g').last.click()
    box = panel.map.bounding_box()
    at_x, at_y = box['x'] + 0.7 * box['width'], box['y'] + 0.3 * box['height']
    panel.page.mouse.move(at_x, at_y)
    panel.page.mouse.down()
    panel.page.mouse.move(at_x + 20, at_y - 20)
    panel.page.mouse.up()
    assert panel.notebook.run_cell('goal') == 'odom True True True'
    # The next click is none.
    expect(panel.page.get_by_role('button', name='key g').last).to_have_attribute(
        'aria-pressed', 'false'
    )


@pytest.mark.parametrize(('width', 'folds', 'under'), [(1280, 0, 0), (1000, 1, 0), (720, 1, 1)])
def test_a_narrow_page_leaves_room_for_the_notebook(open_cells, width, folds, under):
    notebook = open_cells(**CELLS)
    page = notebook.page
    notebook.run_cell('setup')
    before = page.viewport_size
    page.set_viewport_size({'width': width, 'height': 450 if under else 800})
    notebook.run_cell('dock')
    panel = page.locator('.jupyterlab-sidecar')
    expect(panel.locator('.labkit-view')).to_have_count(2)
    expect(page.locator('#jp-main-dock-panel .jupyterlab-sidecar')).to_have_count(under)
    expect(page.locator('#jp-left-stack').locator('visible=true')).to_have_count(1 - folds)
    # Code has room, and what the panel shows can be reached.
    assert page.locator('.jp-Notebook').bounding_box()['width'] > 480
    canvas = panel.locator('canvas').first
    canvas.scroll_into_view_if_needed()
    expect(canvas).to_be_in_viewport()
    # Where somebody opens the list of files again, it stays.
    if folds:
        notebook.execute('application:toggle-left-area')
        notebook.run_cell('arena')
        expect(page.locator('#jp-left-stack').locator('visible=true')).to_have_count(1)
    page.set_viewport_size(before)
