"""A cell with commands of a shell shows that it lives."""

from __future__ import annotations

import pytest

from labkit.programs.shell_cells import words_of


@pytest.mark.parametrize(
    ('command', 'words'),
    [
        (['/usr/bin/python3', '/x/bin/colcon', 'build', '--packages-select', 'a'], 'colcon build'),
        (['python3.11', 'setup.py', '-q', 'install'], 'setup.py install'),
        (['python3', '-W', 'ignore:x', '-B', 'setup.py', 'install'], 'setup.py install'),
        (['python3', '-m', 'pytest', '-q', 'test'], 'pytest test'),
        (['python3', '-c', 'x = 1'], ''),
        (['sleep', '3'], 'sleep'),
        (['bash', '-c', 'sleep 3'], ''),
        ([], ''),
    ],
)
def test_words(command: list[str], words: str) -> None:
    assert words_of(command) == words


@pytest.mark.slow('waits in real time')
def test_a_line_lives_while_commands_run_and_is_gone_afterwards(start_kernel):
    kernel = start_kernel()
    kernel.run('from labkit import progress_bar\nprogress_bar.SHOWN_AFTER_SEC = 0.0')
    cell = kernel.start('%%bash\nsleep 4 | cat')
    assert 'Running: sleep, ' in kernel.wait_for_output(cell, 'sleep, ')
    result = kernel.finish(cell)
    assert result.error == ''
    quiet = kernel.run('import time\ntime.sleep(2)')
    assert quiet.text == ''
