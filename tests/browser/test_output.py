"""Output of callbacks appears under the right cell, live, and as the text that it is."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.browser.samples import LISTENER, SETUP, TALKER

pytestmark = pytest.mark.slow('a page in the browser')

NODES = """
from labkit.background.runtime import runtime
print(runtime.helper.get_node_names())
"""

FRAGILE = """
class Fragile(Node):
    def __init__(self):
        super().__init__('fragile')
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        {}['the key']

fragile = lab.spin(Fragile())
"""

# If the text were taken for HTML, the picture's error would run the script, and the tags would
# not be there to read.
HTML = '<img src=x onerror="window.labkitHacked = true"><b>bold</b><script>alert(1)</script>'

SPEAKER = f"""
from rclpy.qos import QoSProfile
HTML = {HTML!r}

class Speaker(Node):
    def __init__(self):
        super().__init__('speaker')
        self.publisher = self.create_publisher(String, 'html', 10)
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data=HTML))
        self.get_logger().info(HTML)
        print(HTML)
        raise ValueError(HTML)

speaker = lab.spin(Speaker())
"""


def _last_number(text: str) -> int:
    return int(re.findall(r'Hello World: (\d+)', text)[-1])


def test_logs_appear_live_while_another_cell_runs(jupyter, open_cells):
    notebook = open_cells(
        setup=SETUP,
        talker=TALKER,
        other="from pathlib import Path; lab.wait_until(Path('end').exists, timeout_sec=None)",
    )
    notebook.run_cell('setup')
    notebook.run_cell('talker')
    text = notebook.wait_output('talker', '[INFO] [talker]: Publishing: "Hello World: 0"')
    notebook.start_cell('other')
    later = _last_number(text) + 5
    text = notebook.wait_output('talker', f'[INFO] [talker]: Publishing: "Hello World: {later}"')
    assert notebook.is_running('other')
    numbers = [int(number) for number in re.findall(r'Hello World: (\d+)', text)]
    assert numbers == list(range(len(numbers)))
    (jupyter.work / 'end').touch()
    assert notebook.wait_for_end('other') == ''


def test_logs_are_in_a_box_that_shows_the_last_ones(open_cells):
    notebook = open_cells(
        setup=SETUP,
        talker=TALKER.replace('0.1', '0.01'),
        plain='for number in range(40): print(number)',
    )
    for cell_id in ('setup', 'talker', 'plain'):
        notebook.run_cell(cell_id)
    notebook.wait_output('talker', '200 lines are shown')
    output = notebook.output('talker')
    expect(output.locator('.labkit-log')).to_contain_text('lines, the first 200 below.')
    box = output.locator('[data-mime-type="application/vnd.jupyter.stdout"]')
    expect(box).to_have_count(1)
    high, all_of_it = box.evaluate('box => [box.clientHeight, box.scrollHeight]')
    assert high < 300 < 2000 < all_of_it
    # The last line is in sight; the first one is there to be scrolled to, and to be copied.
    expect(box).to_contain_text('Hello World: 0"')
    seen = box.evaluate(
        """box => {
          const range = document.createRange();
          range.selectNodeContents(box);
          const edges = [...range.getClientRects()].map((line) => line.bottom);
          return Math.max(...edges) <= box.getBoundingClientRect().bottom + 10;
        }"""
    )
    assert seen
    # Without a mouse: Tab reaches it, and Home goes to its first line.
    notebook.cell('talker').focus()
    for _ in range(20):
        notebook.page.keyboard.press('Tab')
        if box.evaluate('box => document.activeElement === box'):
            break
    notebook.page.keyboard.press('Home')
    notebook.page.wait_for_function(
        'box => box.scrollTop <= box.clientHeight - box.scrollHeight + 1', arg=box.element_handle()
    )
    # What a cell itself prints is left alone.
    assert notebook.output('plain').evaluate('output => output.clientHeight') > 500


def test_class_cells_run_again_leave_one_node(open_cells):
    notebook = open_cells(
        setup=SETUP,
        talker=TALKER,
        listener=LISTENER,
        nodes=NODES,
        heard='lab.wait_until(lambda: len(listener.heard) >= 5)\nprint(listener.heard[:5])',
    )
    notebook.run_cell('setup')
    for _ in range(4):
        notebook.run_cell('talker')
        assert notebook.error_of('talker') == ''
        assert notebook.run_cell('listener') == ''
    names = notebook.run_cell('nodes')
    assert names.count("'talker'") == names.count("'listener'") == 1
    heard = re.findall(r'Hello World: (\d+)', notebook.run_cell('heard'))
    # Each number once: a second talker or a second subscription would double them.
    assert len(set(heard)) == len(heard) == 5


def test_error_of_a_callback_appears_under_the_cell_of_its_node(open_cells):
    notebook = open_cells(setup=SETUP, talker=TALKER, fragile=FRAGILE, other='print("other")')
    notebook.run_cell('setup')
    notebook.run_cell('talker')
    notebook.run_cell('fragile')
    notebook.run_cell('other')
    text = notebook.wait_output('fragile', "KeyError: 'the key'")
    assert "{}['the key']" in text
    notebook.wait_output('fragile', '10 times by now')
    # Once in full; what comes later is counted.
    assert text.count("KeyError: 'the key'") == 1
    assert notebook.run_cell('other') == 'other'
    assert 'KeyError' not in notebook.output_text('talker')
    assert notebook.error_of('fragile') == ''  # the cell itself is all right


def test_text_of_messages_is_never_html(open_cells):
    notebook = open_cells(
        setup=SETUP,
        speaker=SPEAKER,
        message="message = lab.wait_for_message('/html', String)\nmessage",
        printed='print(message.data, message)',
        data='message.data',
        error='lab.remove(message.data)',
        missing='lab.wait_for_message(HTML, String, timeout_sec=0)',
    )
    cells = ['message', 'printed', 'data', 'error', 'missing']
    notebook.run_cell('setup')
    notebook.run_cell('speaker')
    for cell_id in cells:
        assert '<b>bold</b>' in notebook.run_cell(cell_id), cell_id
    text = notebook.wait_output('speaker', f'ValueError: {HTML}')
    assert f'[INFO] [speaker]: {HTML}' in text
    for cell_id in ('speaker', *cells):
        expect(notebook.output(cell_id).locator('img, b, script')).to_have_count(0)
    assert not notebook.page.evaluate('window.labkitHacked')
