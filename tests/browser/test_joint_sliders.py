"""Sliders for joints in the browser: keys move them, and the node publishes it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

URDF = (
    '<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>'
    '<joint name="turn" type="continuous"><parent link="a"/><child link="b"/></joint>'
    '<joint name="far" type="prismatic"><parent link="b"/><child link="c"/>'
    '<limit lower="0.2" upper="0.6" effort="1" velocity="1"/></joint></robot>'
)
CELLS = {
    'setup': 'import labkit as lab',
    'sliders': f'sliders = lab.joint_state_publisher_gui({URDF!r})\nsliders',
    'wait': "lab.wait_until(lambda: sliders.node.positions['far'] == 0.6, timeout_sec=50)\n"
    'print(sliders)',
    'close': 'sliders.close()',
}


def test_keys_move_joints(open_cells: Callable[..., Notebook], tmp_path: Any) -> None:
    notebook = open_cells(**CELLS)
    for cell_id in ('setup', 'sliders'):
        notebook.run_cell(cell_id)
    view = notebook.page.locator('.labkit-joints')
    turn, far = (view.get_by_role('slider', name=name) for name in ('turn', 'far'))
    expect(turn).to_have_attribute('aria-valuetext', '0.000 rad')
    expect(far).to_have_attribute('aria-valuetext', '0.400 m')
    notebook.screenshot(tmp_path / 'sliders.png')
    far.focus()
    notebook.page.keyboard.press('End')
    assert notebook.run_cell('wait').splitlines()[-1].startswith('far      0.600 m')
    turn.focus()
    notebook.page.keyboard.press('Home')
    expect(turn).to_have_attribute('aria-valuetext', '-3.142 rad')
    view.get_by_role('button', name='Centre').click()
    expect(turn).to_have_attribute('aria-valuetext', '0.000 rad')
    expect(far).to_have_attribute('aria-valuetext', '0.400 m')
    notebook.run_cell('close')
    expect(turn).to_be_disabled()
