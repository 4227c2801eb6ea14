"""Checks of other processes: which notebook or script publishes there."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from labkit.background.domains import claim_domain

NODE = Path(__file__).resolve().with_name('counter_node.py')
SETUP = f"""
import sys
sys.path[len(sys.path):] = [{str(NODE.parent)!r}, {str(NODE.parent.parent)!r}]
import labkit as lab
from by_hand import ByHand
from counter_node import Counter
from labkit.exercises import Exercise, Lesson, Solution
from labkit.exercises import expect
from labkit.exercises.setup_cell import begin
def judge(probe):
    expect.publisher(probe, '/odds')
exercise = Exercise(name='ones', task='', publishes={{'/odds': 'std_msgs/msg/Int16'}},
                    stage=ByHand(judge), hints=['.'], answer=Solution('', '', ''))
begin(Lesson('odds', '04_odds.ipynb', exercises=[exercise]))
lab.start()
"""
SEES = """
from labkit.rosgraph.snapshot import node_names
from labkit.background.runtime import runtime
def sees(name):
    return name in node_names(runtime.helper)
"""
START = f"""
import subprocess
process = subprocess.Popen([sys.executable, {str(NODE)!r}, 'ones'])
"""
LATE = START.replace("'ones'", "'ones', 'late'")
# The process counts as one that was started long ago.
NOT_YOUNG = """
from labkit.programs import children
children.starting_children = lambda *_: (False, False)
"""


@pytest.mark.slow('starts another notebook')
def test_other_notebook_is_named(start_kernel: Callable[..., Any]) -> None:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    mine = start_kernel(JPY_SESSION_NAME='/home/me/04_odds.ipynb', **env)
    other = start_kernel(JPY_SESSION_NAME='/home/me/02_talker_listener.ipynb', **env)
    other.run(f'{SETUP}\nlab.spin(Counter("noise"))')
    mine.run(f'{SETUP}\nlab.spin(Counter("mine"))')
    mine.run(SEES)
    found = mine.run('lab.wait_until(lambda: sees("/noise"), timeout_sec=30)\nexercise.check()')
    claim.close()
    assert found.error == ''
    assert '/noise in another notebook, 02_talker_listener.ipynb' in ' '.join(found.text.split())
    assert '/mine in this notebook' in found.text


@pytest.mark.slow('starts other processes')
def test_script_that_was_just_started_is_waited_for(start_kernel: Callable[..., Any]) -> None:
    claim = claim_domain()
    kernel = start_kernel(
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST', ROS_DOMAIN_ID=str(claim.domain_id)
    )
    kernel.run(SETUP)
    found = kernel.run(START + 'exercise.check()')
    # Slow to start on a busy machine: then the check says so, and the next one sees it.
    while 'run this cell again' in found.text.lower().replace('\n', ' '):
        found = kernel.run('exercise.check()')
    kernel.run('process.terminate(); process.wait()')
    claim.close()
    assert 'PASS: ' in found.text  # a bar may stand before it


@pytest.mark.slow('another process, in real time')
def test_node_that_is_in_the_graph_before_its_publisher_is_waited_for(
    start_kernel: Callable[..., Any],
) -> None:
    claim = claim_domain()
    kernel = start_kernel(
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST', ROS_DOMAIN_ID=str(claim.domain_id)
    )
    kernel.run(f'{SETUP}\n{SEES}\n{NOT_YOUNG}')
    kernel.run(f'{LATE}\nlab.wait_until(lambda: sees("/ones"), timeout_sec=30)')
    found = kernel.run('exercise.check()')
    kernel.run('process.terminate(); process.wait()')
    claim.close()
    assert 'PASS: ' in found.text  # a bar may stand before it


# The process has other things to do for a while, as on a busy machine.
BUSY = """
import os, signal
from labkit.exercises.expect.spinning import runs
def judge(probe):
    source = expect.publisher(probe, '/odds')
    os.kill(process.pid, signal.SIGUSR1)
    expect.that(runs(probe, source.node), expected='an answer', seen='none')
"""


@pytest.mark.slow('another process, in real time')
def test_node_that_takes_long_to_answer_counts_as_spun(start_kernel: Callable[..., Any]) -> None:
    claim = claim_domain()
    kernel = start_kernel(
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST', ROS_DOMAIN_ID=str(claim.domain_id)
    )
    begin, end = SETUP.split('exercise = ')
    kernel.run(f'{begin}{BUSY}exercise = {end}')
    kernel.run(f'{SEES}{START}\nlab.wait_until(lambda: sees("/ones"), timeout_sec=30)')
    found = kernel.run('exercise.check()')
    kernel.run('process.terminate(); process.wait()')
    claim.close()
    assert 'PASS: ' in found.text, found.text


def test_cell_that_raised_is_an_error_and_not_an_attempt_left_out(kernel: Any) -> None:
    kernel.run(SETUP)
    assert 'NOT ATTEMPTED' in kernel.run('exercise.check()').text
    kernel.run('undefined_name + 1')
    for _ in range(2):
        found = kernel.run('exercise.check()')
        assert found.text.startswith('ERROR')
        assert 'Python does not know the name undefined_name' in ' '.join(found.text.split())
        assert 'Cell In[' in found.text
    kernel.run('1 + 1')
    assert 'NOT ATTEMPTED' in kernel.run('exercise.check()').text


def test_check_works_in_a_plain_script(script: Callable[..., Any]) -> None:
    done = script(
        f'{SETUP}\nprint(exercise.check())\nlab.spin(Counter("ones"))\nprint(exercise.check())'
    )
    assert done.exit_code == 0, done.stderr
    assert done.stdout.startswith('NOT ATTEMPTED: ones')
    assert 'PASS: ones' in done.stdout
