"""What a learner meets first: JupyterLab on the first lesson, ready to run, for them only."""

from __future__ import annotations

import re
import socket
import urllib.error
import urllib.request

import pytest
from nbconvert.exporters import base
from playwright.sync_api import expect

from labkit.course.jupyterlab import HOME
from labkit.course.learner_folder import FIRST
from labkit.exercises.found_lessons import all_lessons
from tests.browser.jupyter import JupyterLab
from tests.browser.page import Notebook, open_notebook


def test_first_lesson_opens_ready_to_run(tmp_path, browser):
    with JupyterLab(tmp_path / 'fresh') as jupyter:
        # The kernel does not wait for the page, and the page takes the one that is there.
        while not (sessions := jupyter.request('api/sessions')):
            pass
        assert [session['path'] for session in sessions] == [FIRST]
        # The address that is opened in the learner's browser, and nothing else.
        notebook = Notebook(browser.new_page()).open(jupyter.url)
        _look_at_first_lesson(notebook)
        kernels = [session['kernel']['id'] for session in jupyter.request('api/sessions')]
        assert kernels == [session['kernel']['id'] for session in sessions]
        notebook.close()
        # The terminal has the address, and no log; nor does each kernel warn there.
        assert not re.search(r'\[[IW] |WARNING', jupyter.log)
        assert len(re.findall('token=', jupyter.log)) == 1


@pytest.mark.slow('a page in the browser')
def test_a_kernel_gets_ready_while_its_page_is_loaded(jupyter, browser):
    code = """
import sys
left = [name for name in globals() if 'lab' in name]
loaded = ('labkit.background.runtime', 'labkit.exercises.setup_cell', 'labkit.views.live_page')
print(all(name in sys.modules for name in loaded), left)
"""
    for name in ('other', 'usual'):
        jupyter.write_notebook(name, {'look': code})
    path = jupyter.work / 'other.ipynb'
    path.write_text(path.read_text().replace('"python3"', '"julia"'))
    for name in ('other', 'usual'):
        # No page is shown, and nothing but the server can start a kernel.
        with urllib.request.urlopen(jupyter.address(f'lab/tree/{name}.ipynb')) as page:
            assert page.status == 200
    while 'usual.ipynb' not in (paths := [s['path'] for s in jupyter.request('api/sessions')]):
        pass
    assert 'other.ipynb' not in paths
    notebook = open_notebook(jupyter, browser, 'usual')
    notebook.run_cell('look')
    expect(notebook.output('look')).to_have_text(re.compile(r'^\s*True \[\]\s*$'))
    notebook.close()
    paths = [session['path'] for session in jupyter.request('api/sessions')]
    assert paths.count('usual.ipynb') == 1


@pytest.mark.slow('a page in the browser')
def test_a_page_asks_for_the_formats_of_export_and_not_for_a_build(jupyter, browser):
    jupyter.write_notebook('formats', {'nothing': ''})
    page, asked = browser.new_page(), []
    page.on('request', lambda request: asked.append(request.url))
    notebook = Notebook(page).open(jupyter.address('lab/tree/formats.ipynb'))
    while not any('/api/nbconvert' in url for url in asked):
        page.wait_for_timeout(100)
    assert [url for url in asked if '/api/build' in url] == []
    notebook.close()
    # It is answered out of what was read when the server started, and says what nbconvert says.
    assert set(jupyter.request('api/nbconvert')) == set(base.get_export_names())


@pytest.mark.slow('a page in the browser')
def test_the_first_page_finds_its_notebook_in_the_workspace(tmp_path, browser):
    workspace, tab = 'lab/api/workspaces/default', f'notebook:{FIRST}'
    with JupyterLab(tmp_path / 'fresh') as jupyter:
        assert jupyter.request(workspace)['data'] == {}
        for name in ('missing.ipynb', 'images', FIRST):
            try:
                urllib.request.urlopen(jupyter.address(f'lab/tree/{name}')).close()
            except urllib.error.HTTPError as error:
                assert name == 'missing.ipynb' and error.code == 404
        given = jupyter.request(workspace)['data']
        assert given[tab] == {'data': {'path': FIRST, 'factory': 'Notebook'}}
        # JupyterLab takes it for what it has written itself.
        notebook = Notebook(browser.new_page()).open(jupyter.url)
        page = notebook.page
        expect(page.locator('#jp-main-dock-panel .lm-TabBar-tab')).to_have_text([FIRST])
        expect(page.locator('.jp-DirListing-item').filter(has_text=FIRST)).to_be_visible()
        while 'docmanager:recents' not in (saved := jupyter.request(workspace)['data']):
            pass
        assert saved[tab] == given[tab]
        before, after = (data['layout-restorer:data'] for data in (given, saved))
        assert before['main'] == after['main']
        assert before['left'].items() <= after['left'].items()
        notebook.close()
        # What is there is left alone.
        urllib.request.urlopen(jupyter.address('lab/tree/01_theory.ipynb')).close()
        assert tab in jupyter.request(workspace)['data']


SLOW_START = """
import asyncio
from jupyter_client.provisioning import LocalProvisioner

start = LocalProvisioner.launch_kernel

async def start_slowly(self, *arguments, **options):
    print('a kernel starts', flush=True)
    await asyncio.sleep(1)
    return await start(self, *arguments, **options)

LocalProvisioner.launch_kernel = start_slowly
"""


@pytest.mark.slow('a page in the browser')
def test_it_ends_while_a_second_kernel_starts(tmp_path):
    (tmp_path / 'jupyter_server_config.py').write_text(SLOW_START)
    with JupyterLab(tmp_path / 'short', {'JUPYTER_CONFIG_PATH': str(tmp_path)}) as jupyter:
        while not jupyter.request('api/sessions'):
            pass
        urllib.request.urlopen(jupyter.address('lab/tree/01_theory.ipynb')).close()
        while jupyter.log.count('a kernel starts') < 2:
            pass
    assert not jupyter.hangs, jupyter.log


def _look_at_first_lesson(notebook: Notebook) -> None:
    page = notebook.page
    expect(page.locator('.jp-NotebookPanel:visible')).to_have_count(1)
    expect(page.locator('.lm-TabBar-tab.jp-mod-current').first).to_contain_text(FIRST)
    # The question which kernel to use is a dialog, and the offer of news is a notification.
    # JupyterLab asks for the news when it is started, before a kernel can be idle.
    expect(page.locator('.jp-Dialog')).to_have_count(0)
    expect(page.locator('.Toastify__toast')).to_have_count(0)
    # JupyterLab writes the kernel's language into the notebook: it stands there already.
    changed = 'async panel => (await panel.sessionContext.session.kernel.info, panel.model.dirty)'
    assert not page.evaluate(f'({changed})(window.jupyterapp.shell.currentWidget)')
    code = [cell['id'] for cell in notebook.cells() if cell['cell_type'] == 'code']
    first = code[: code.index('first-node') + 1]
    # The second cell has a robot, and drives it.
    assert first[:2] == ['setup', 'robot']
    for cell_id in first:
        notebook.run_cell(cell_id)
        assert notebook.error_of(cell_id) == ''
        if cell_id == 'robot':
            expect(page.locator('.jupyterlab-sidecar .labkit-teleop')).to_be_visible()
            drawn = page.locator('.jupyterlab-sidecar .labkit-arena canvas')
            expect(drawn).not_to_have_attribute('data-pose', re.compile(r'^0(\.0+)?( |,|$)'))
    # Then there is a picture that lives: messages pass, and are counted.
    output = notebook.output('first-node')
    for name in ('/first_node publishes', '/listener subscribes'):
        arrow = output.locator(f'[data-part][aria-label^="{name}"]')
        expect(arrow).to_have_attribute('data-passed', re.compile(r'^[2-9]$|^\d\d'))
    messages = output.locator('.labkit-monitor div', has_text='Messages').locator('dd')
    expect(messages).to_have_text(re.compile(r'^[2-9]$|^\d\d'))
    expect(output).to_contain_text("'Hello from ROS 2'")
    expect(page.locator('.jp-Dialog')).to_have_count(0)
    expect(page.locator('.Toastify__toast')).to_have_count(0)


@pytest.mark.slow('a page in the browser')
def test_page_with_all_lessons_leads_to_each_exercise(jupyter, browser):
    page = browser.new_page()
    page.goto(jupyter.address(f'lab/tree/{HOME}'))
    shown = page.locator('.jp-MarkdownViewer')
    expect(shown.get_by_role('heading', name='Learn ROS 2')).to_be_visible()
    # Shown as a page: a heading of the table, and the lessons.
    expect(shown.get_by_role('row')).to_have_count(1 + len(all_lessons()))
    expect(shown.get_by_role('link', name='04 Odd numbers', exact=True)).to_be_visible()
    shown.get_by_role('link', name='count_up').click()
    expect(page.get_by_role('heading', name='Exercise 2: odd numbers')).to_be_in_viewport()
    page.close()
    jupyter.end_kernels()


def test_listens_on_this_machine_only(jupyter):
    socket.create_connection(('127.0.0.1', jupyter.port)).close()
    # Addresses of this machine too: who listens on all of them is heard there.
    for address in ('127.0.0.2', '::1'):
        with pytest.raises(OSError, match=r'refused|not available|Cannot assign'):
            socket.create_connection((address, jupyter.port))


@pytest.mark.parametrize('path', ['api/contents', 'api/kernels', 'api/sessions'])
def test_without_token_nothing_is_shown(jupyter, path):
    assert jupyter.request(path) is not None
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(jupyter.address(path, token=False))
    assert caught.value.code == 403
    caught.value.close()


def test_token_is_new_and_long(jupyter):
    assert len(jupyter.token) >= 32
