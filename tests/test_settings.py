"""Variables, switches, and who looks at what is shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from labkit import domain_ids, settings
from labkit.errors import LabError


@pytest.mark.parametrize('value', ['seven', '-1', '233', '7.0', ' 7', '1e2', '9' * 5000])
def test_bad_domain_in_the_environment(monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', value)
    with pytest.raises(LabError) as caught:
        domain_ids.read_domain_id()
    assert repr(value) in str(caught.value)
    assert 'a number from 0 to 101' in str(caught.value)
    assert 'unset it' in caught.value.todo


@pytest.mark.parametrize('value', [-1, 102, 7.0, '7', float(domain_ids.BETWEEN[0])])
def test_bad_domain_as_an_argument(value: object) -> None:
    with pytest.raises(LabError, match='must be a whole number from 0 to 101'):
        domain_ids.check_domain_id(value)


def test_good_domains(monkeypatch: pytest.MonkeyPatch) -> None:
    for value, expected in (('', None), ('0', 0), ('101', 101)):
        monkeypatch.setenv('ROS_DOMAIN_ID', value)
        assert domain_ids.read_domain_id() == expected
    for domain_id in (None, 0, 101, domain_ids.BETWEEN[0]):
        domain_ids.check_domain_id(domain_id)
    # All computers know those up to 232, and only this machine those between.
    for domain_id in (None, 0, 101, 102, 232):
        domain_ids.check_shared_domain_id(domain_id)


def test_a_domain_between_is_not_shared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', str(domain_ids.BETWEEN[0]))
    monkeypatch.setenv('LABKIT_SHARED_DOMAIN_ID', str(domain_ids.BETWEEN[0]))
    assert domain_ids.read_domain_id() == domain_ids.BETWEEN[0]
    with pytest.raises(LabError, match='LABKIT_SHARED_DOMAIN_ID must be a number from 0 to 101'):
        domain_ids.read_shared_domain_id()
    for bad in (domain_ids.BETWEEN[0], 233, -1, 7.0):
        with pytest.raises(LabError, match='must be a whole number from 0 to 101, but it is'):
            domain_ids.check_shared_domain_id(bad)


WHO = 'import labkit as lab; from labkit import settings; print(settings.audience())'


@pytest.mark.parametrize(
    ('value', 'expected'),
    [('', settings.TERMINAL), ('0', settings.TERMINAL), ('1', settings.RECORDING)],
)
def test_audience_of_a_script(
    script: Callable[..., Any], value: str, expected: settings.Audience
) -> None:
    assert script(WHO, LABKIT_HEADLESS=value).stdout == f'{expected}\n'


def test_audience_of_a_kernel_is_chosen_once(start_kernel: Callable[..., Any]) -> None:
    kernel = start_kernel()
    assert kernel.run(WHO).text == f'{settings.LEARNER}\n'
    kernel.run('import os; os.environ["LABKIT_HEADLESS"] = "1"')
    assert kernel.run(WHO).text == f'{settings.LEARNER}\n'
    assert start_kernel(LABKIT_HEADLESS='1').run(WHO).text == f'{settings.RECORDING}\n'


def test_state_dir(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('LABKIT_HOME', '/a')
    monkeypatch.setenv('XDG_DATA_HOME', '/b')
    monkeypatch.setenv('HOME', '/c')
    assert str(settings.state_dir()) == '/a'
    monkeypatch.setenv('LABKIT_HOME', '')
    assert str(settings.state_dir()) == '/b/labkit'
    monkeypatch.delenv('XDG_DATA_HOME')
    assert str(settings.state_dir()) == '/c/.local/share/labkit'


def test_what_is_set_already_wins(script: Callable[..., object]) -> None:
    show = (
        'import os, labkit\n'
        'names = "PYTHON_CHECK_FIELDS", "AUTOMATIC_DISCOVERY_RANGE", "DISTRO"\n'
        'print(*(os.environ["ROS_" + name] for name in names))'
    )
    assert script(show).stdout == '1 OFF jazzy\n'
    own = {'ROS_PYTHON_CHECK_FIELDS': '0', 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}
    assert script(show, **own, ROS_DISTRO='x').stdout == '0 SUBNET x\n'


def test_middleware_that_is_not_there_does_not_end_the_kernel(
    start_kernel: Callable[..., object],
) -> None:
    kernel = start_kernel(RMW_IMPLEMENTATION='rmw_cyclonedds_cpp')
    result = kernel.run('import labkit as lab\nlab.start()\nimport rclpy\nprint(rclpy.ok())')
    assert (result.error, result.text) == ('', 'True\n')


def test_what_a_cell_starts_shows_the_same_errors_with_every_python(
    start_kernel: Callable[..., Any],
) -> None:
    fails = 'import os; print(os.environ["PYTHON_COLORS"]); x'
    cell = f"import labkit, sys\n!{{sys.executable}} -c '{fails}'"
    told = start_kernel().run(cell).text
    assert told.startswith('0\r\n') and '\x1b' not in told
    assert "NameError: name 'x' is not defined" in told
    # Who wants them sets it.
    assert start_kernel(PYTHON_COLORS='1').run(cell).text.startswith('1\r\n')


def test_programs_start_where_nothing_can_be_written_to_the_home(start_kernel):
    result = start_kernel(HOME='/proc', ROS_LOG_DIR='').run(
        'import labkit, subprocess, sys\n'
        'code = "import rclpy; rclpy.init(); print(1)"\n'
        'print(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True))'
    )
    assert "stdout='1\\n'" in result.text, result


def test_the_environment_is_given_back_but_for_what_was_set_since(script):
    done = script("""
import os, sys
for name in ('ROS_DISTRO', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_PYTHON_CHECK_FIELDS'):
    os.environ.pop(name, None)
os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = ''
before = dict(os.environ), list(sys.path)
import labkit
from labkit.settings import give_environment_back
assert (os.environ, sys.path) != before
os.environ['ROS_DISTRO'], os.environ['OWN'] = 'mine', 'new'
give_environment_back()
assert os.environ.pop('ROS_DISTRO') == 'mine' and os.environ.pop('OWN') == 'new'
assert (dict(os.environ), sys.path) == before
""")
    assert done.exit_code == 0, done.stderr
