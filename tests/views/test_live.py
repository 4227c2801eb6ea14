"""One life for all live views: who looks on, what ends them, and that nothing is left behind."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.conftest import Kernel
from tests.views.test_monitor import STAGE as COMMON_STAGE

STAGE = f"""{COMMON_STAGE}
import asyncio

views = {{}}

def load():
    # What the hidden node has to do: subscriptions to topics, timers.
    node = runtime.helper
    topics = sorted(s.topic_name for s in node.subscriptions)
    return topics, len(list(node.timers))

async def wait_for_load(wanted):
    # Not in one go: only between cells, or while one awaits, does the kernel hear pages.
    while load() != wanted:
        await asyncio.sleep(0.02)
"""
# Each view, and the topics that it hears while a page shows it.
VIEWS = {
    'monitor': ('lab.monitor("/odds")', ['/odds']),
    'plot': ('lab.plot("/odds.data")', ['/odds']),
    'arena': ('lab.arena()', ['/odom', '/scan']),
    'teleop': ('lab.teleop()', []),
    'graph': ('lab.graph()', []),
}
# They share one life: the gate has two of them.
SLOW = pytest.mark.slow('the same for one more view')
each_view = pytest.mark.parametrize(
    ('code', 'topics'),
    [
        pytest.param(*case, id=name, marks=() if name in ('monitor', 'arena') else SLOW)
        for name, case in VIEWS.items()
    ],
)


@pytest.fixture
def run_cell(kernel: Kernel, run: Callable[[str], str]) -> Callable[[str, str], str]:
    """Give a function that runs a cell as a front end does that names its cells."""

    def run_cell(cell_id: str, code: str) -> str:
        content = {'code': code, 'silent': False, 'store_history': True, 'allow_stdin': False}
        message = kernel._client.session.msg('execute_request', content)
        message['metadata']['cellId'] = cell_id
        kernel._client.shell_channel.send(message)
        result = kernel.finish(message['header']['msg_id'])
        assert not result.error, result.traceback
        return result.text.strip()

    return run_cell


@each_view
def test_listens_while_a_page_shows_it(run, code, topics):
    run(f'lab.spin(Talker())\nlab.start()\nbefore = load()\nview = {code}')
    assert run('print(load() == before)') == 'True'
    run('page = Page(view)')
    assert run('print(load())') == f'({topics}, {int(run("print(before[1])")) + 1})'
    # Once, however often it says so.
    run('page.say("there")\npage.say("seen")')
    assert run('print(load()[0])') == f'{topics}'
    for leave in ('page.say("gone")', 'view.close()'):
        run(leave)
        assert run('print(load() == before)') == 'True'
        run('page.say("there")')
        assert run('print(load() == before)') == str('close' in leave)


@pytest.mark.slow('waits in real time')
@each_view
def test_page_that_has_crashed_leaves_nothing(run, code, topics):
    run('live_page.GONE_SEC = live_page.CATCH_UP_SEC = 0.2')
    run(f'lab.spin(Talker())\nlab.start()\nbefore = load()\npage = Page({code})')
    # It says nothing more, not even that it goes.
    run('await wait_for_load(before)')
    # Unless it was asleep. In one cell: between two it may be given up again.
    assert run('page.say("there")\nprint(load()[0])') == f'{topics}'


def test_view_that_no_page_ever_shows_leaves_nothing(run):
    # An arena listens before its page has said a word.
    run('live_page.GONE_SEC = live_page.CATCH_UP_SEC = 0.2')
    run('lab.start()\nbefore = load()\nview = lab.arena()\ndisplay(view)')
    run('await wait_for_load(before)')


@pytest.mark.slow('waits in real time')
@each_view
def test_page_hears_that_the_kernel_is_there(run, code, topics):
    # Though there is nothing to say of a topic without messages.
    run(f'lab.start()\npage = Page({code})')
    run('count = len(page.sent)')
    run('lab.wait_until(lambda: len(page.sent) > count + 1)')


@each_view
def test_cell_that_is_run_again_ends_the_earlier_one(run, run_cell, code, topics):
    run('lab.spin(Talker())\npages = []')
    cell = f'pages.append(Page({code}))\nprint(load())'
    first = run_cell('one', cell)
    assert [run_cell('one', cell) for _ in range(2)] == [first] * 2
    # Two views of one cell, as in lab.arena() and lab.teleop() side by side.
    other = code.replace('teleop()', 'teleop(name="other")')
    run_cell('two', f'pages += [Page({code}), Page({other})]')
    assert run('print(["ended" in page.known for page in pages[-2:]])') == '[False, False]'
    run_cell('two', 'pass')
    run_cell('two', 'lab.monitor("/odds")')
    assert run('print(["ended" in page.known for page in pages])').endswith('True, True]')


@each_view
def test_end_of_ros_is_told_at_once_and_to_pages_that_open_later(run, code, topics):
    run(f'lab.spin(Talker())\npage = Page({code})\nlab.stop()')
    assert 'ROS was stopped. Run this cell' in run('print(page.known["ended"])')
    # A page does not start ROS again, and nothing comes back when somebody else does.
    run('page.known.clear()\npage.say("there")')
    assert run('print(runtime.started)') == 'False'
    assert 'ROS was stopped' in run('print(page.known["ended"])')
    run('lab.start()\nbefore = load()\npage.say("seen")')
    assert run('print(load() == before, "stopped" in page.known["ended"])') == 'True True'


@each_view
def test_end_of_the_kernel_is_quiet(kernel, run, code, topics):
    run(f'lab.spin(Talker())\nview = {code}')
    run('view._widget._handle_custom_msg({"view": "seen"}, [])')
    assert kernel.shutdown() == 0
    assert 'Traceback' not in kernel.log


@each_view
def test_shown_again_after_its_end_it_listens_no_more(run, code, topics):
    run(f'lab.spin(Talker())\nlab.start()\nbefore = load()\nview = {code}\nview.close()')
    run('display(view)\npage = Page(view)')
    assert run('print(load() == before, "has ended" in page.known["ended"])') == 'True True'
