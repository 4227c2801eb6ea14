"""`ros2` with its output in a pipe says what the real one says; to people it explains."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest


@pytest.mark.usefixtures('robot')
def test_it_is_on_the_graph_as_the_real_one(domain, lab_env):
    def run(*words: str) -> str:
        command = [sys.executable, '-m', 'labkit.ros2', *words]
        done = subprocess.run(command, env={**lab_env, **domain}, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    # Scripts leave out the node that asks by its name.
    own = re.compile(r'/_ros2cli_\d+')
    nodes = run('node', 'list', '-a').splitlines()
    assert [name for name in nodes if not own.fullmatch(name)] == [
        *('/_hidden', '/fleet/robot', '/lamp')
    ]
    # Three nodes, and the one that asks.
    counts = re.findall(r'^ \* (/[pr]\S+) \S+ (\d) publishers$', run('topic', 'list', '-v'), re.M)
    assert counts == [('/parameter_events', '4'), ('/rosout', '4')]
