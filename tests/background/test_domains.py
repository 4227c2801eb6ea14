"""A domain for each notebook: claimed, released, listed."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

import pytest
from background.talker import LOCALHOST, TALKER

from labkit.background import domains
from labkit.checkup import ros
from labkit.errors import LabError

CLAIMING = """
import sys
from labkit.background.domains import claim_domain
claim = claim_domain()
print(claim.domain_id, flush=True)
sys.stdin.read()
"""


@contextmanager
def claiming(env: dict[str, str]) -> Iterator[tuple[int, subprocess.Popen[str]]]:
    """Run a process that claims a domain; return the domain and the process."""
    pipe = subprocess.PIPE
    command = [sys.executable, '-c', CLAIMING]
    with subprocess.Popen(command, env=env, stdin=pipe, stdout=pipe, text=True) as process:
        try:
            assert process.stdout is not None
            yield int(process.stdout.readline()), process
        finally:
            process.kill()


def test_processes_of_one_name_never_get_the_same_domain(lab_env: dict[str, str]) -> None:
    # The same name leads each of them to the same first choice.
    env = {**lab_env, 'JPY_SESSION_NAME': '/home/me/02_talker_listener.ipynb'}
    with ExitStack() as stack:
        domain_ids = [stack.enter_context(claiming(env))[0] for _ in range(6)]
    assert len(set(domain_ids)) == 6
    assert all(1 <= domain_id <= 101 for domain_id in domain_ids)


def test_processes_that_claim_at_once_never_get_the_same_domain(lab_env: dict[str, str]) -> None:
    env = {**lab_env, 'JPY_SESSION_NAME': '/home/me/same.ipynb'}
    pipe = subprocess.PIPE
    command = [sys.executable, '-c', CLAIMING]
    with ExitStack() as stack:
        processes = []
        for _ in range(6):
            process = subprocess.Popen(command, env=env, stdin=pipe, stdout=pipe, text=True)
            stack.enter_context(process)
            stack.callback(process.kill)
            processes.append(process)
        domain_ids = [int(process.stdout.readline()) for process in processes]
    assert len(set(domain_ids)) == 6


@pytest.mark.parametrize('how', [signal.SIGKILL, signal.SIGTERM])
def test_claim_ends_with_its_process(lab_env: dict[str, str], how: signal.Signals) -> None:
    with claiming(lab_env) as (domain_id, process):
        with pytest.raises(OSError):
            domains.DomainClaim(domain_id)
        process.send_signal(how)
        process.wait(60)
        domains.DomainClaim(domain_id).close()


def test_a_notebook_meets_its_own_domain_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('JPY_SESSION_NAME', '/home/me/again.ipynb')
    first = domains.claim_domain()
    first.close()
    again = domains.claim_domain()
    # Unless another program took it in between, which a test can't forbid.
    assert again.domain_id == first.domain_id or _taken(first.domain_id)
    again.close()


def _taken(domain_id: int) -> bool:
    try:
        domains.DomainClaim(domain_id).close()
    except OSError:
        return True
    return False


def test_bad_domain_is_said_in_the_cell_and_nothing_is_started(
    start_kernel: Callable[..., object],
) -> None:
    kernel = start_kernel(ROS_DOMAIN_ID='seven')
    result = kernel.run('import labkit as lab\nlab.start()')
    assert result.error.startswith(
        'LabError: ROS_DOMAIN_ID must be a number from 0 to 101, but it is'
    )
    assert kernel.run('import os\nos.environ["ROS_DOMAIN_ID"] = ""\nlab.start()').error == ''


@pytest.mark.slow('several kernels')
def test_variable_wins_over_a_domain_of_its_own(
    start_kernel: Callable[..., object], script: Callable[..., object]
) -> None:
    claim = domains.claim_domain()
    kernel = start_kernel(ROS_DOMAIN_ID=str(claim.domain_id))
    show = 'import labkit as lab\nlab.start()\nfrom labkit.background.runtime import runtime\n'
    show += 'print(runtime.domain_id, runtime.own_domain)'
    assert kernel.run(show).text == f'{claim.domain_id} False\n'
    assert script(show, ROS_DOMAIN_ID=str(claim.domain_id)).stdout == f'{claim.domain_id} False\n'
    # A script is in the domain that any ROS program is in.
    assert script(show).stdout == '0 False\n'
    claim.close()


@pytest.mark.slow('two kernels and other programs')
def test_two_notebooks_do_not_hear_each_other_until_they_mean_to(
    start_kernel: Callable[..., object],
) -> None:
    one, other = start_kernel(**LOCALHOST), start_kernel(**LOCALHOST)
    start = 'talker = lab.spin(Talker(NAME))\nlistener = lab.spin(Listener("listener_" + WORD))\n'
    for kernel, word in ((one, 'one'), (other, 'other')):
        names = f'WORD = {word!r}\nNAME = "talker_{word}"\n'
        assert not kernel.run(names + TALKER + start).error
    domain_ids = [kernel.run('print(runtime.domain_id)').text for kernel in (one, other)]
    assert domain_ids[0] != domain_ids[1]
    # A third process, in the domain of the first, shows when discovery has had its time.
    witness = start_kernel(**LOCALHOST, ROS_DOMAIN_ID=domain_ids[0].strip())
    assert not witness.run('WORD = "witness"\n' + TALKER + 'talker = lab.spin(Talker("w"))').error
    heard = one.run(
        'lab.wait_until(lambda: "witness" in listener.heard, timeout_sec=60)\n'
        'print(sorted(listener.heard), sorted(runtime.foreign_nodes()))'
    )
    assert heard.text.startswith("['one', 'witness'] ")
    assert '/talker_other' not in heard.text
    # Processes of the notebook join it.
    children = one.run('import os\nprint(os.environ["ROS_DOMAIN_ID"])').text
    assert children == domain_ids[0]

    refused = other.run(f'lab.start(domain_id={domain_ids[0]})')
    assert 'it can move to domain' in refused.error
    joined = other.run(
        f'lab.stop()\nlab.start(domain_id={domain_ids[0]})\n{start}'
        'lab.wait_until(lambda: "one" in listener.heard, timeout_sec=60)\n'
        'print(runtime.domain_id, runtime.own_domain)'
    )
    assert (joined.error, joined.text) == ('', f'{domain_ids[0].strip()} False\n')
    assert not one.run('lab.wait_until(lambda: "other" in listener.heard, timeout_sec=60)').error


@pytest.mark.slow('starts another process')
def test_second_participant_of_the_same_name_is_reported(
    start_kernel: Callable[..., object],
) -> None:
    claim = domains.claim_domain()
    env = {**LOCALHOST, 'ROS_DOMAIN_ID': str(claim.domain_id)}
    one, other = start_kernel(**env), start_kernel(**env)
    often = 'import labkit.background.runtime as module\nmodule.DUPLICATE_CHECK_SEC = 0.05\n'
    cell = one.run(often + 'WORD = "one"\n' + TALKER + 'talker = lab.spin(Talker())')
    double = other.run(often + 'WORD = "other"\n' + TALKER + 'talker = lab.spin(Talker())')
    said = f'Two nodes are called /talker in domain {claim.domain_id}'
    one.wait_for_output(cell.msg_id, said)
    other.wait_for_output(double.msg_id, said)
    # Once: as many looks at the graph again, and no second report.
    looks = (
        'looks = runtime.entry_of(runtime.helper).callbacks\n'
        'lab.wait_until(\n'
        '    lambda: runtime.entry_of(runtime.helper).callbacks > looks + 2, timeout_sec=50\n)'
    )
    assert not one.run(looks).error
    assert one.wait_for_output(cell.msg_id, said).count('Two nodes are called') == 1
    # When the other is gone and comes back, it is news again.
    assert not other.run('lab.remove(talker)').error
    assert not one.run(
        'lab.wait_until(lambda: "/talker" not in runtime.foreign_nodes(), timeout_sec=60)\n'
        + looks
    ).error
    assert not other.run('talker = lab.spin(Talker())').error
    again = 'lab.wait_until(lambda: "/talker" in runtime.foreign_nodes(), timeout_sec=60)\n'
    assert not one.run(again + looks).error
    assert one.wait_for_output(cell.msg_id, said).count('Two nodes are called') == 2
    claim.close()


def test_an_error_of_the_system_is_not_taken_for_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EMFILE, 'Too many open files')

    monkeypatch.setattr(domains.socket, 'socket', refuse)
    with pytest.raises(LabError, match='Too many open files'):
        domains.claim_domain()


def test_names_are_told_without_escape_codes(lab_env: dict[str, str]) -> None:
    env = {**lab_env, 'JPY_SESSION_NAME': '/me/\x1b[31mred\x1b[0m\nline.ipynb'}
    with claiming(env) as (domain_id, _):
        assert domains.claimed_domains()[domain_id] == '?[31mred?[0m?line.ipynb'
    with claiming(lab_env) as (domain_id, process):
        assert domains.claimed_domains()[domain_id] == f'process {process.pid}'


def test_notebooks_of_other_users_are_not_told(lab_env: dict[str, str]) -> None:
    """Neither their names, nor a domain that pretends to be one of ours."""
    if os.geteuid() != 0:
        pytest.skip('only root can be another account')
    env = {**lab_env, 'JPY_SESSION_NAME': '/me/mine.ipynb'}
    with claiming(env) as (domain_id, process):
        asked = (
            'import os, sys; from labkit.background import domains\n'
            'domains.claimed_domains()  # loads what only root may read here\n'
            'os.setuid(12345)\n'
            'claim = domains.claim_domain()\n'
            'print(claim.domain_id, domains.claimed_domains(), flush=True)\n'
            f'try: open("/proc/{process.pid}/environ")\n'
            'except PermissionError: print("denied", flush=True)\n'
            'sys.stdin.read()'
        )
        command, pipe = [sys.executable, '-c', asked], subprocess.PIPE
        with subprocess.Popen(command, env=lab_env, stdin=pipe, stdout=pipe, text=True) as other:
            assert other.stdout is not None
            forged, _, listed = other.stdout.readline().partition(' ')
            assert listed == f"{{{forged}: 'process {other.pid}'}}\n"
            assert other.stdout.readline() == 'denied\n'
            told = domains.claimed_domains()
            assert told[domain_id] == 'mine.ipynb' and int(forged) not in told
            with pytest.raises(BlockingIOError):
                domains.DomainClaim(int(forged))
            other.kill()


def test_who_else_is_in_a_domain_is_told_by_the_doctor(monkeypatch: pytest.MonkeyPatch) -> None:
    other = os.getuid() + 54321
    opened = [(7, os.getuid()), (7, other), (8, other + 1)]
    monkeypatch.setattr(
        domains,
        '_udp_sockets',
        lambda: [
            domains._UdpSocket(domains.ports_of_participants(domain_id)[0], '', 0, user, 1)
            for domain_id, user in opened
        ],
    )
    assert domains.other_accounts_in(7) == [f'the account with the number {other}']
    assert domains.other_accounts_in(9) == []
    said = f'; programs of the account with the number {other} are in it, too'
    assert ros._elsewhere(7).startswith(said)
