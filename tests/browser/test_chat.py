"""What strangers say in a chat: nothing of it runs, nothing breaks, and it can be read."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Dialog, expect

from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

# From another process, by way of the shared domain, byte by byte: no client checks what it sends.
STRANGER = r"""
import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

TEXTS = [
    b'<script>window.labkitHacked = true</script>',
    b'<img src=x onerror="window.labkitHacked = true">',
    b'<svg onload="window.labkitHacked = true"><b>bold</b></svg>',
    b'<a href="javascript:window.labkitHacked = true" id="bait">press here</a>',
    b'</pre></div><style>* { display: none }</style>',
    b'{{constructor.constructor("window.labkitHacked = true")()}}',
    b'[press here](javascript:window.labkitHacked=true) ![](x)',
    b'\x1b[2J\x1b[31mred\x1b]0;title\x07\x1b[8mhidden',
    '\u202eright to left\u202c \u2066isolated'.encode(),
    'a\u0300\u0301\u0302\u0303'.encode() * 30,
    b'before\x00after',
    b'broken \xff\xfe\xc3\x28 letters',
    b'\r\n\r\n\x08\x08\x7f\x0b\x0c',
    b'x' * 1_000_000,
    b'',
    b'the last one',
]

rclpy.init()
node = Node('stranger', start_parameter_services=False)
publisher = node.create_publisher(String, 'shared_chatter', 100)
while publisher.get_subscription_count() < 1:
    rclpy.spin_once(node, timeout_sec=0.05)
for text in TEXTS:
    said = b'Mallory: ' + text + b'\x00'
    publisher.publish(b'\x00\x01\x00\x00' + len(said).to_bytes(4, 'little') + said)
sys.stdin.read()
"""
CHAT = """
import os
import subprocess
import sys

import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String


class Chat(Node):
    def __init__(self):
        super().__init__('chat')
        self.heard = []
        self.create_subscription(String, 'shared_chatter', self.on_message, 100)

    def on_message(self, msg):
        self.heard.append(msg.data)
        print('printed', msg.data)
        self.get_logger().info(f'logged {msg.data}')


chat = lab.spin(Chat())
room = lab.join(
    '/shared_chatter', String, discovery_range='LOCALHOST', name='ada', qos_profile=100
)
"""
HEAR = f"""
variables = {{
    **os.environ,
    'ROS_DOMAIN_ID': str(room.domain_id),
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
}}
stranger = subprocess.Popen(
    [sys.executable, '-c', {STRANGER!r}], env=variables, stdin=subprocess.PIPE
)
lab.wait_until(lambda: len(chat.heard) == 16, timeout_sec=60)
"""
# Again, one by one, in the notebook's own domain: for what shows the newest message only.
AGAIN = """
import asyncio

publisher = chat.create_publisher(String, 'shared_chatter', 100)
for text in [*chat.heard]:
    publisher.publish(String(data=text))
    await asyncio.sleep(0.2)
"""
BAIT = "document.querySelectorAll('.jp-OutputArea #bait, .jp-OutputArea svg[onload]').length"


def test_hostile_text_is_only_text(open_cells: Callable[..., Notebook]) -> None:
    cells = {
        'chat': CHAT,
        'monitor': "lab.monitor('/shared_chatter')",
        'hear': HEAR,
        'again': AGAIN,
        'values': '[text[:200] for text in chat.heard]',
        'shown': 'print(*[text[:200] for text in chat.heard])',
        'message': 'String(data=chat.heard[0])',
        'names': 'room.others',
        'error': 'lab.join(chat.heard[0], String)',
        'alive': "stranger.kill()\nstranger.wait()\nprint('the notebook is alive')",
    }
    notebook = open_cells(**cells)
    dialogs: list[str] = []

    def refuse(dialog: Dialog) -> None:
        dialogs.append(dialog.message)
        dialog.dismiss()

    notebook.page.on('dialog', refuse)
    for cell_id in cells:
        notebook.run_cell(cell_id)
    for cell_id in set(cells) - {'error'}:
        assert notebook.error_of(cell_id) == '', cell_id
    assert notebook.output_text('alive') == 'the notebook is alive'

    # It can be read, as the characters that it is made of.
    said = notebook.wait_output('chat', 'printed Mallory: the last one')
    for text in ('<script>window.labkitHacked = true</script>', '<b>bold</b>', '</pre></div>'):
        assert f'printed Mallory: {text}' in said or text in said
        notebook.wait_output('values', text)
        notebook.wait_output('shown', text)
    assert 'broken' in said and 'before' in said
    value = notebook.output('monitor').locator('.labkit-monitor-value')
    expect(value).to_have_text("'Mallory: the last one'")

    # Nothing of it has become a part of the page, or has run.
    for cell_id in cells:
        found = notebook.output(cell_id).locator('img, b, script, style:not([class]), a#bait')
        expect(found).to_have_count(0)
    assert notebook.page.evaluate(BAIT) == 0
    assert not notebook.page.evaluate('window.labkitHacked')
    assert dialogs == []
    # The page still follows: one that has swallowed a megabyte in a line would not.
    expect(notebook.output('alive')).to_be_visible()


def test_what_is_typed_is_published(open_lesson: Callable[[str], Notebook]) -> None:
    notebook = open_lesson('06_chat')
    for cell_id in ('setup', 'chat'):
        notebook.run_cell(cell_id)
    notebook.start_cell('input')
    line = notebook.page.locator('input.jp-Stdin-input')
    line.fill('Is this on?')
    line.press('Enter')
    assert "[('Ada', 'Is this on?')]" in notebook.wait_for_end('input')
    notebook.run_cell('box')
    box = notebook.output('box').get_by_role('textbox')
    box.fill('Typed into the box')
    box.press('Enter')
    expect(box).to_have_value('')
    notebook.replace_cell(
        'typed-text-starter',
        "lab.wait_until(lambda: ('Ada', 'Typed into the box') in chat.heard)\nprint(chat.heard)",
    )
    shown = notebook.run_cell('typed-text-starter')
    assert shown.count('Typed into the box') == 1
