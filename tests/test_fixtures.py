"""The fixtures that other tests stand on: a kernel, a script, and no skip that hides a failure."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).with_name('conftest.py')


def test_a_kernel_shows_what_a_cell_brings(kernel):
    result = kernel.run('print("one")\nprint("two")\n6 * 7')
    assert (result.text, result.error) == ('one\ntwo\n42\n', '')
    assert [out['output_type'] for out in result.outputs] == ['stream', 'execute_result']
    result = kernel.run('x = 1\nx / 0')
    assert result.error == 'ZeroDivisionError: division by zero'
    assert '----> 2 x / 0' in result.traceback and '\x1b' not in result.traceback


def test_output_that_comes_late_is_found_under_its_cell(kernel):
    older = kernel.run("""
        import threading
        event, parent = threading.Event(), get_ipython().get_parent()
        def speak():
            event.wait()
            get_ipython().set_parent(parent)
            print('late')
        thread = threading.Thread(target=speak)
        thread.start()
    """)
    assert kernel.run('event.set(); thread.join(); print("now")').text == 'now\n'
    assert kernel.wait_for_output(older.msg_id, 'late') == 'late\n'


def test_a_cell_is_interrupted_and_the_kernel_restarted(kernel):
    cell = kernel.start('import time as t\nprint("started", flush=True)\nt.sleep(1000)')
    kernel.wait_for_output(cell, 'started')
    kernel.interrupt()
    assert kernel.finish(cell).error.startswith('KeyboardInterrupt')
    kernel.restart()
    assert kernel.run('t').error == "NameError: name 't' is not defined"
    assert kernel.shutdown() == 0


def test_a_wait_in_vain_tells_what_there_was(start_kernel):
    kernel = start_kernel(LABKIT_HEADLESS='1')
    cell = kernel.start('import time\nprint("half way", flush=True)\ntime.sleep(1000)')
    kernel.wait_for_output(cell, 'half way')
    with pytest.raises(pytest.fail.Exception, match=r'(?s)not within 1 s.*half way'):
        kernel.finish(cell, timeout=1)
    kernel.restart()
    with pytest.raises(pytest.fail.Exception, match='the kernel ended with code 7'):
        kernel.run('import os\nos._exit(7)')


def test_a_script_and_a_kernel_have_settings_of_their_own(kernel, script):
    code = """
        import os
        names = 'LABKIT_HOME', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'LABKIT_HEADLESS', 'ROS_DOMAIN_ID'
        print([os.path.basename(os.environ.get(name, '')) for name in names])
    """
    expected = "['labkit_home', 'OFF', '', '']\n"
    assert kernel.run(code).text == expected
    lines = '\n'.join(line.strip() for line in code.splitlines())
    result = script(f'{lines}\nimport sys\nsys.exit(3)')
    assert (result.exit_code, result.stdout, result.stderr) == (3, expected, '')
    assert script(lines, ROS_DOMAIN_ID='4').stdout == "['labkit_home', 'OFF', '', '4']\n"


SKIPS = """
import pytest

def test_skipped():
    pytest.skip('no browser here')

@pytest.mark.xfail
def test_expected_to_fail():
    assert False
"""


@pytest.mark.slow('runs pytest')
@pytest.mark.parametrize(('required', 'exit_code'), [('', 0), ('0', 0), ('1', 1)])
def test_a_skip_is_a_failure_where_all_is_required(
    tmp_path: Path, lab_env: dict[str, str], required: str, exit_code: int
):
    shutil.copy(CONFTEST, tmp_path)
    (tmp_path / 'test_one.py').write_text(SKIPS)
    (tmp_path / 'test_module.py').write_text(
        "import pytest\npytest.importorskip('nothing_such')\n"
    )
    options = ['-p', 'no:cacheprovider', '--continue-on-collection-errors']
    done = subprocess.run(
        [sys.executable, '-m', 'pytest', *options, str(tmp_path)],
        env={**lab_env, 'LABKIT_REQUIRE_ALL': required},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode != 0) == exit_code, done.stdout
    assert 'no browser here' in done.stdout and 'nothing_such' in done.stdout
    assert ('LABKIT_REQUIRE_ALL is set' in done.stdout) == bool(exit_code)
    assert ('\n1 skipped in test_one.py: no browser here\n' in done.stdout) != bool(exit_code)
    assert ('\n1 skipped in test_module.py: could not' in done.stdout) != bool(exit_code)
