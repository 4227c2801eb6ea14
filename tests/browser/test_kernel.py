"""The stop button, the restart button, and two notebooks at once."""

from __future__ import annotations

import pytest

from tests.browser.samples import LISTENER, SETUP, TALKER

pytestmark = pytest.mark.slow('a page in the browser')

# Cells that block: each prints "inside" when it does.
BLOCKING = {
    'wait_until': "lab.wait_until(lambda: print('inside'), timeout_sec=None)",
    'wait_for_message': """
print('inside', flush=True)
lab.wait_for_message('/nobody', String, timeout_sec=None)
""",
    'pasted spin': """
import rclpy
rclpy.init()
node = Node('pasted')
node.create_timer(0.1, lambda: print('inside'))
rclpy.spin(node)
node.destroy_node()
rclpy.shutdown()
print('the rest of the cell')
""",
    'service call': """
from rclpy.task import Future
from std_srvs.srv import Trigger

async def never_answer(request, response):
    print('inside')
    await Future()

node = lab.spin(Node('server'))
server = node.create_service(Trigger, 'slow', never_answer)
client = node.create_client(Trigger, 'slow')
client.call(Trigger.Request())
""",
}
# One line tells what was interrupted, and the lines after spin() are not run.
SHOWN = {'pasted spin': 'rclpy.spin() was interrupted. No longer spun: /pasted.'}


@pytest.mark.parametrize('what', BLOCKING)
def test_stop_button_ends_the_cell_and_ros_goes_on(open_cells, what):
    notebook = open_cells(
        setup=f'{SETUP}lab.start()',
        blocking=BLOCKING[what],
        talker=TALKER,
        after="print(lab.wait_for_message('/chatter', String).data)",
    )
    notebook.run_cell('setup')
    notebook.start_cell('blocking')
    notebook.wait_output('blocking', 'inside')
    assert notebook.is_running('blocking')
    notebook.press_stop()
    shown = notebook.wait_for_end('blocking')
    assert SHOWN.get(what, 'KeyboardInterrupt') in shown
    assert 'the rest of the cell' not in shown
    notebook.run_cell('talker')
    assert 'Hello World' in notebook.run_cell('after')
    assert notebook.error_of('after') == ''


def test_restart_with_a_live_node(jupyter, open_cells):
    notebook = open_cells(
        # What is registered first is called last, so after labkit has ended ROS.
        setup="""
import atexit, os
from pathlib import Path
atexit.register(Path('ended').touch)
print(os.getpid())
"""
        + SETUP,
        talker=TALKER,
        listener=LISTENER,
        again='import os\nprint(os.getpid())',
    )
    before = len(jupyter.log)
    old = notebook.run_cell('setup')
    notebook.run_cell('listener')
    notebook.run_cell('talker')
    notebook.wait_output('talker', 'Hello World: 3')
    notebook.restart_kernel()
    assert notebook.run_cell('again') != old
    assert (jupyter.work / 'ended').exists()
    # What a process that aborts, or is killed because it hangs, leaves behind.
    log = jupyter.log[before:]
    for word in ('terminate called', 'Aborted', 'Traceback', 'Forcing', 'killed'):
        assert word not in log, log
    notebook.run_cell('setup')
    notebook.run_cell('talker')
    notebook.wait_output('talker', 'Hello World: 3')


def test_two_notebooks_do_not_hear_each_other(open_cells):
    talking = open_cells(setup=SETUP, talker=TALKER)
    quiet = open_cells(
        setup=SETUP,
        listener=LISTENER,
        hear="lab.wait_for_message('/chatter', String, timeout_sec=2)",
        domain='from labkit.background.runtime import runtime\nprint(runtime.domain_id)',
        join='lab.stop()\nlab.start(domain_id=DOMAIN)',
    )
    for notebook in (talking, quiet):
        notebook.run_cell('setup')
    talking.run_cell('talker')
    quiet.run_cell('listener')
    talking.wait_output('talker', 'Hello World: 3')
    heard = quiet.run_cell('hear')
    assert 'LabTimeout' in heard and 'Nobody publishes on /chatter' in heard
    # The same two hear each other when one joins the other's domain: so it was not by accident.
    talking.replace_cell(
        'talker',
        'from labkit.background.runtime import runtime\nprint(runtime.domain_id)',
    )
    domain = talking.run_cell('talker')
    assert domain != quiet.run_cell('domain')
    quiet.replace_cell('join', f'lab.stop()\nlab.start(domain_id={domain})')
    quiet.run_cell('join')
    quiet.replace_cell('hear', "print(lab.wait_for_message('/chatter', String, timeout_sec=20))")
    assert 'Hello World' in quiet.run_cell('hear')
