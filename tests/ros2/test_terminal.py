"""`ros2` in a terminal: whose domain it joins, whom it steps aside for, how it ends."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from labkit import domain_ids, settings
from labkit.asking import notebook_graph
from labkit.background import domains
from labkit.ros2 import terminal
from labkit.ros2.open_pages import notebooks_in_pages
from tests.ports import free_port


def start(*words: str, env: dict[str, str], **options) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, '-m', 'labkit', 'ros2', *words],
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


@pytest.mark.usefixtures('robot')
def test_one_command_after_the_other(domain, lab_env):
    process = start('topic', 'list', env={**lab_env, **domain})
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, '')
    assert out.splitlines()[:3] == ['/chatter', '/cmd_vel', '/heard']
    process = start('topic', 'info', '/nowhere', env={**lab_env, **domain})
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (1, '')
    assert err.startswith("Unknown topic '/nowhere'\n")


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('robot')
def test_ctrl_c_ends_a_stream(domain, lab_env):
    process = start('topic', 'echo', '/chatter', env={**lab_env, **domain})
    assert process.stdout is not None
    assert process.stdout.readline().startswith('data: Hello ')
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (2, '')


@pytest.mark.slow('starts other processes')
@pytest.mark.usefixtures('robot')
def test_a_pipe_that_ends_early(domain, lab_env):
    process = start('topic', 'echo', '/chatter', env={**lab_env, **domain})
    assert process.stdout is not None and process.stderr is not None
    assert process.stdout.readline()
    process.stdout.close()
    assert process.wait(60) == 1
    assert process.stderr.read() == ''
    process.stderr.close()


@pytest.mark.slow('starts other processes')
def test_run_stays_in_front(domain, lab_env):
    env = {**lab_env, **domain, 'PYTHONUNBUFFERED': '1'}
    process = start('run', 'demo_nodes_py', 'talker', env=env, start_new_session=True)
    assert process.stderr is not None
    for line in process.stderr:
        if 'Publishing: "Hello World: 1"' in line:
            break
    os.killpg(process.pid, signal.SIGINT)  # as Ctrl-C does
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err


def test_a_notebook_tells_its_domain(domain):
    # The fixture holds a domain as a notebook does.
    assert int(domain['ROS_DOMAIN_ID']) in domains.claimed_domains()


def test_domain_of_the_one_running_notebook(monkeypatch):
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    monkeypatch.setattr(domains, 'claimed_domains', lambda: {7: '04_odds.ipynb'})
    terminal.choose_domain()
    assert os.environ.pop('ROS_DOMAIN_ID') == '7'
    one = domain_ids.BETWEEN[0]
    monkeypatch.setattr(domains, 'claimed_domains', lambda: {one: '04_odds.ipynb'})
    terminal.choose_domain()
    assert os.environ.pop('ROS_DOMAIN_ID') == str(one)
    assert os.environ.pop(domain_ids.PROFILES_FILE) == str(domain_ids.PROFILE)
    monkeypatch.setattr(domains, 'claimed_domains', lambda: {})
    terminal.choose_domain()
    assert 'ROS_DOMAIN_ID' not in os.environ
    two = {7: '04_odds.ipynb', 9: '05_my_name_is.ipynb'}
    monkeypatch.setattr(domains, 'claimed_domains', lambda: two)
    pages: dict[str, bool] = {}
    monkeypatch.setattr(terminal, 'notebooks_in_pages', lambda: pages)
    used: dict[int, float] = {}
    monkeypatch.setattr(notebook_graph, 'last_used', lambda number: used.get(number, 0.0))

    def choose() -> tuple[str, str]:
        told = terminal.choose_domain()
        return told, os.environ.pop('ROS_DOMAIN_ID')

    assert choose() == (
        'Domain 7, of the notebook started last: 04_odds.ipynb. Others: 9 (05_my_name_is.ipynb). '
        'To choose: export ROS_DOMAIN_ID=9',
        '7',
    )
    used.update({7: 20.0, 9: 30.0})
    told, taken = choose()
    assert told.startswith('Domain 9, of the notebook used last: 05_my_name_is.ipynb. Others: 7 (')
    assert taken == '9'
    pages.update({'04_odds.ipynb': True, '05_my_name_is.ipynb': False})
    assert choose()[1] == '7'  # no page shows the other
    two[one] = '06_chat.ipynb'
    used[one] = 40.0
    assert choose()[1] == str(one)
    assert os.environ.pop(domain_ids.PROFILES_FILE) == str(domain_ids.PROFILE)
    used.update({7: 50.0, one: 0.0})
    pages.clear()
    del two[9]
    told = f'ROS_DOMAIN_ID={one} {domain_ids.PROFILES_FILE}={domain_ids.PROFILE}'
    assert choose()[0].endswith(f'export {told}')
    monkeypatch.setenv('ROS_DOMAIN_ID', '3')
    terminal.choose_domain()
    assert os.environ['ROS_DOMAIN_ID'] == '3'


def test_notes_of_servers_that_tell_nothing(monkeypatch, tmp_path):
    monkeypatch.setenv('JUPYTER_RUNTIME_DIR', str(tmp_path))
    here = {'pid': os.getpid(), 'port': free_port(), 'base_url': '/', 'token': 'secret'}
    odd = {**here, 'pid': 'me', 'port': [4]}
    notes = ('', '[]', '{}', json.dumps(odd), json.dumps(here), json.dumps({**here, 'pid': 0}))
    for number, note in enumerate(notes):
        (tmp_path / f'jpserver-{number}.json').write_text(note)
    assert notebooks_in_pages() == {}


def test_only_the_process_of_a_note_gets_its_token(monkeypatch, tmp_path):
    monkeypatch.setenv('JUPYTER_RUNTIME_DIR', str(tmp_path))
    asked = []

    class Server(BaseHTTPRequestHandler):
        def do_GET(self):
            asked.append((self.path, self.headers['Authorization']))
            self.send_response(200)
            self.end_headers()
            self.wfile.write(b'[{"path": "a/04.ipynb", "kernel": {"connections": 1}}]')

        def log_message(self, *_):
            pass

    with (
        HTTPServer(('127.0.0.1', 0), Server) as server,
        ThreadPoolExecutor() as pool,
        ExitStack() as stack,
    ):
        pool.submit(server.serve_forever, 0.01)
        stack.callback(server.shutdown)
        note = {'pid': os.getppid(), 'port': server.server_port, 'base_url': '/x/', 'token': 'one'}
        (tmp_path / 'jpserver-1.json').write_text(json.dumps(note))
        assert (notebooks_in_pages(), asked) == ({}, [])
        (tmp_path / 'jpserver-1.json').write_text(json.dumps({**note, 'pid': os.getpid()}))
        assert notebooks_in_pages() == {'04.ipynb': True}
    assert asked == [('/x/api/sessions', 'token one')]


def test_what_reads_files_needs_no_domain(monkeypatch, capsys, tmp_path):
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    monkeypatch.setattr(settings, 'is_ros2_command', False)
    monkeypatch.setattr(terminal, 'real_ros2', lambda: None)
    monkeypatch.setattr(domains, 'claimed_domains', lambda: {7: 'a.ipynb', 9: 'b.ipynb'})
    assert terminal.run(['pkg', 'prefix', 'std_msgs']) == 0
    assert capsys.readouterr().out == f'{sys.prefix}\n'
    (tmp_path / 'a.launch.xml').write_text('<launch><arg name="x" default="1"/></launch>')
    path = str(tmp_path / 'a.launch.xml')
    for words in (
        ['bag', 'list', 'storage'],
        ['launch', '--show-args', path],
        ['launch', path, '-s'],
        ['launch', '--print', path],
    ):
        assert terminal.run(words) == 0, words
        shown = capsys.readouterr()
        assert shown.out and shown.err == ''
    for words in (['bag', 'info', 'no-bag'], ['bag', 'reindex', 'no-bag'], ['launch']):
        assert terminal.run(words) != 0, words
        assert 'ROS_DOMAIN_ID' not in capsys.readouterr().err


def test_the_notebook_used_last_is_taken(start_kernel, monkeypatch):
    monkeypatch.delenv('ROS_DOMAIN_ID', raising=False)
    monkeypatch.setattr(terminal, 'notebooks_in_pages', dict)
    code = (
        'import labkit as lab\nlab.start()\nfrom labkit.background.runtime import runtime\n'
        'print(runtime.domain_id)'
    )
    kernels = [start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST') for _ in range(2)]
    numbers = [int(kernel.run(code).text) for kernel in kernels]
    names = dict(zip(numbers, ('a.ipynb', 'b.ipynb'), strict=True))
    monkeypatch.setattr(domains, 'claimed_domains', lambda: names)  # without those of others
    for number, kernel in zip(numbers, kernels, strict=True):
        kernel.run('1')
        told = f'Domain {number}, of the notebook used last: {names[number]}. Others: '
        assert terminal.choose_domain().startswith(told)
        os.environ.pop(domain_ids.PROFILES_FILE, None)
        assert os.environ.pop('ROS_DOMAIN_ID') == str(number)


def test_a_kernel_claims_its_domain_by_the_name_of_its_notebook(start_kernel):
    kernel = start_kernel(JPY_SESSION_NAME='/some/where/04_odds.ipynb')
    result = kernel.run(
        'import labkit as lab\nlab.start()\nfrom labkit.background.runtime import runtime\n'
        'print(runtime.domain_id)'
    )
    assert domains.claimed_domains()[int(result.text)] == '04_odds.ipynb'
    later = start_kernel(JPY_SESSION_NAME='/some/where/05_my_name_is.ipynb')
    also = later.run(
        'import labkit as lab\nlab.start()\nfrom labkit.background.runtime import runtime\n'
        'print(runtime.domain_id)'
    )
    told = list(domains.claimed_domains())
    assert told.index(int(also.text)) < told.index(int(result.text))


def test_steps_aside_for_a_real_one(tmp_path: Path, lab_env):
    real = tmp_path / 'ros2'
    real.write_text('#!/bin/sh\necho the real one: "$@" "[$LD_LIBRARY_PATH]"\n')
    real.chmod(0o755)
    env = {**lab_env, 'PATH': f'{tmp_path}{os.pathsep}{lab_env["PATH"]}'}
    process = start('topic', 'list', env=env)
    out, err = process.communicate(timeout=60)
    assert (out, err) == ('the real one: topic list []\n', '')


def test_does_not_step_aside_for_itself(tmp_path: Path, monkeypatch):
    own = tmp_path / 'ros2'
    own.write_text('#!/usr/bin/python3\nfrom labkit.ros2 import main\n')
    own.chmod(0o755)
    monkeypatch.setenv('PATH', str(tmp_path))
    assert terminal.real_ros2() is None
