"""`%ros2` as a learner types it in JupyterLab: the Tab key, the stop button, processes."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

SETUP = 'import labkit as lab'
TALKER = """
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.2, lambda: self.publisher.publish(String(data='Hello World')))

lab.spin(Talker())
"""


def test_tab_key(open_cells: Callable[..., Notebook]) -> None:
    notebook = open_cells(setup=SETUP, talker=TALKER, line='%ros2 topic echo /ch')
    notebook.run_cell('setup')
    notebook.run_cell('talker')
    place = notebook.cell('line').locator('.cm-content')
    menu = notebook.page.locator('.jp-Completer')
    place.click()
    notebook.page.keyboard.press('End')
    notebook.page.keyboard.press('Tab')
    expect(menu).to_contain_text('/chatter')
    notebook.page.keyboard.press('Enter')
    expect(place).to_have_text('%ros2 topic echo /chatter')
    notebook.page.keyboard.type(' --onc')
    notebook.page.keyboard.press('Tab')
    expect(menu).to_contain_text('--once')
    notebook.page.keyboard.press('Enter')
    expect(place).to_have_text('%ros2 topic echo /chatter --once')
    assert notebook.run_cell('line') == 'data: Hello World\n---'


def test_stop_button_ends_a_stream(open_cells: Callable[..., Notebook]) -> None:
    notebook = open_cells(
        setup=SETUP, talker=TALKER, echo='%ros2 topic echo /chatter', after='%ros2 node list'
    )
    notebook.run_cell('setup')
    notebook.run_cell('talker')
    notebook.start_cell('echo')
    notebook.wait_output('echo', 'data: Hello World\n---\ndata: Hello World')
    notebook.press_stop()
    assert 'KeyboardInterrupt' not in notebook.wait_for_end('echo')
    assert notebook.error_of('echo') == ''
    assert notebook.run_cell('after') == '/talker'


def test_output_of_a_process_goes_on_under_its_cell(open_cells: Callable[..., Notebook]) -> None:
    notebook = open_cells(
        setup=SETUP,
        run='%ros2 run demo_nodes_py talker',
        list='lab.processes()',
        wrong='%ros2 topic info /chater',
        stop='lab.processes().stop()\nlab.processes()',
    )
    notebook.run_cell('setup')
    notebook.run_cell('run')
    notebook.wait_output('run', 'runs in a process of its own, as node /talker.')
    notebook.wait_output('run', '[INFO] [talker]: Publishing: "Hello World: 2"')
    assert '0  demo_nodes_py talker: running, /talker' in notebook.run_cell('list')
    assert notebook.run_cell('wrong') == "Unknown topic '/chater'\nDid you mean '/chatter'?"
    assert 'ended (exit code 0)' in notebook.run_cell('stop')
