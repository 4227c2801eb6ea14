"""`lab.launch` and `%ros2 launch` in a cell."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from labkit.background.domains import claim_domain
from tests.launching.stage import write

TWO = """\
<launch>
  <arg name="who" default="b"/>
  <node pkg="demo_nodes_py" exec="talker" namespace="a" output="screen"/>
  <node pkg="demo_nodes_py" exec="listener" namespace="$(var who)" output="screen"/>
</launch>
"""
SLEEP = '<launch><arg name="n" default="1000"/><executable cmd="sleep $(var n)"/></launch>'


@pytest.fixture
def kernel(start_kernel) -> Iterator:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    yield start_kernel(**env)
    claim.close()


@pytest.fixture
def file(tmp_path: Path) -> str:
    return str(write(tmp_path, {'two.launch.xml': TWO}))


def test_a_launch_runs_its_nodes_and_a_second_run_replaces_it(kernel, file):
    first = kernel.run('import labkit as lab')
    code = f'launch = lab.launch({file!r}, who="a")\nlaunch'
    first = kernel.run(code, cell_id='one')
    assert not first.error, first
    assert 'two.launch.xml: running\n' in first.text
    assert '  talker-1: running\n  listener-2: running\n' in first.text
    *_, card = [out['data']['text/html'] for out in first.outputs if 'data' in out]
    assert 'LAUNCH' in card and '<dt' in card and 'talker-1' in card
    assert '/a/talker' in kernel.run('%ros2 node list').text
    kernel.run(f'old = launch\n{code}'.replace('"a"', '"c"'), cell_id='one')
    result = kernel.run('print(old.running, old.exit_code, launch.running)\n%ros2 node list')
    assert 'False 0 True' in result.text
    assert '/c/listener' in result.text and '/a/listener' not in result.text
    result = kernel.run('launch.stop()\nprint(launch)')
    assert 'ended (exit code 0)' in result.text
    assert '/a/talker' not in kernel.run('%ros2 node list').text


def test_the_magic_runs_in_the_background(kernel, tmp_path):
    path = write(tmp_path, {'sleep.launch.xml': SLEEP})
    kernel.run('import labkit as lab')
    shown = kernel.run(f'%ros2 launch {path} n:=999').text
    assert 'runs in the background, with sleep-1. lab.processes() lists and stops it.' in shown
    assert 'sleep-1: running' in kernel.run('lab.processes()').text
    ended = kernel.run('lab.processes().stop()\nlab.processes()').text
    assert 'sleep-1: ended (exit code -2)' in ended


def test_a_fault_is_an_error_of_the_cell(kernel, tmp_path):
    path = write(tmp_path, {'bad.launch.xml': '<launch>\n<nod/>\n</launch>'})
    kernel.run('import labkit as lab')
    result = kernel.run(f'lab.launch({str(path)!r})')
    assert 'bad.launch.xml, line 2: <nod> is no action.' in result.error
    assert 'Did you mean node?' in result.error
    shown = kernel.run(f'%ros2 launch {path}').text
    assert 'bad.launch.xml, line 2: <nod> is no action.' in shown
    assert 'launch' not in kernel.run('import sys\nprint("launch" in sys.modules)').text


@pytest.mark.slow('waits for what does not end')
def test_a_file_that_never_comes_to_its_end_is_ended(kernel, tmp_path):
    path = write(tmp_path, {'long.launch.py': 'while True:\n    pass\n'})
    kernel.run('import labkit as lab\nfrom labkit.launching import launched')
    result = kernel.run(f'launched.BEGIN_SEC = 1\nlab.launch({str(path)!r})')
    assert 'was ended: it has begun nothing in 1 s.' in result.error
    assert 'running' not in kernel.run('lab.processes()').text


@pytest.mark.slow('programs that are killed')
def test_a_killed_program_leaves_the_graph_and_comes_again_if_it_is_to(kernel, tmp_path):
    node = '<node pkg="demo_nodes_py" exec="{}"/>'
    body = node.format('talker" respawn="true') + node.format('listener')
    path = write(tmp_path, {'two.launch.xml': f'<launch>{body}</launch>'})
    kernel.run('import labkit as lab\nimport os')
    kernel.run(f'talker, listener = (launch := lab.launch({str(path)!r})).processes')
    kernel.run('for one in launch.processes: os.kill(one.pid, 9)')
    ends = 'lambda: talker.starts == 2 and listener.exit_code'
    shown = kernel.run(f'lab.wait_until({ends}, timeout_sec=60)\nprint(talker, listener)').text
    assert 'talker-1: running, started 2 times listener-2: ended (exit code -9)' in shown
    code = (
        'from labkit.background.runtime import runtime\n'
        'from labkit.rosgraph.snapshot import node_names\n'
        "lab.wait_until(lambda: '/talker' in node_names(runtime.helper), timeout_sec=60)\n"
        '%ros2 node list'
    )
    listed = kernel.run(code).text
    assert '/talker' in listed and '/listener' not in listed
    kernel.run('launch.stop()')
    assert kernel.run('%ros2 node list').text.strip() == ''
