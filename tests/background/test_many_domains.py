"""More notebooks than ROS has domains: they stay apart, and only their own users find them."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from types import SimpleNamespace
from typing import Any

import pytest
from background import crowd
from background.talker import LOCALHOST, TALKER

from labkit import domain_ids, settings
from labkit.background import domains
from labkit.background.domains import DomainClaim
from labkit.domain_ids import BETWEEN, first_port
from labkit.errors import LabError

Start = Callable[..., Any]
EVERYBODYS = (*range(102), *range(215, 233))


@pytest.fixture
def between() -> Iterator[int]:
    """Return a free domain between two others."""
    for domain_id in BETWEEN:
        try:
            claim = DomainClaim(domain_id)
        except BlockingIOError:
            continue
        break
    yield claim.domain_id
    claim.close()


@pytest.fixture
def namespace() -> None:
    if not crowd.unshare():
        pytest.skip('this system does not allow namespaces (net, mount, pid)')


def looked_for(domain_id: int) -> list[int]:
    """Return the discovery ports of a domain."""
    return [first_port(domain_id) + 10 + 2 * number for number in range(32)]


def test_no_two_domains_meet() -> None:
    everywhere = [port for number in (*EVERYBODYS, *BETWEEN) for port in looked_for(number)]
    assert len(everywhere) == len(set(everywhere))
    # As DDS says it, and as the profile says it.
    assert first_port(7) == 7400 + 250 * 7
    assert all(first_port(number) == 7000 + number for number in BETWEEN)
    assert len(set(BETWEEN)) + 101 >= 400


def test_a_program_without_the_profile_is_in_no_domain_at_all(
    lab_env: dict[str, str], between: int
) -> None:
    # Nor in a wrong one: there is no port above 65535.
    assert all(7400 + 250 * number > 65535 for number in BETWEEN)
    program = 'import rclpy; rclpy.init(); rclpy.create_node("one"); print("made")'
    env = {**lab_env, **LOCALHOST, 'ROS_DOMAIN_ID': str(between)}
    ended = subprocess.run(
        [sys.executable, '-c', program], env=env, capture_output=True, text=True
    )
    assert ended.returncode != 0 and 'made' not in ended.stdout
    assert 'Probably the domainId is over 232' in ended.stdout + ended.stderr


def test_ports_between_are_not_handed_out_by_the_system() -> None:
    # Linux, ip_local_port_range, where nobody has changed it.
    handed_out = range(32768, 61000)
    for number in BETWEEN:
        ports = range(looked_for(number)[0], looked_for(number)[-1] + 2)
        assert ports[-1] < handed_out[0] or (handed_out[-1] < ports[0] and ports[-1] <= 65535)


def test_a_notebook_of_very_many_processes_does_not_reach_the_next_but_one() -> None:
    # Its processes go on from port to port, sixty times, and a second context begins one further.
    profile = domain_ids.PROFILE.read_text()
    assert '<mutation_tries>60</mutation_tries>' in profile
    everybodys = {port for number in EVERYBODYS for port in looked_for(number)}
    others = {port: number for number in BETWEEN for port in looked_for(number)}
    for number in BETWEEN:
        mine = {first_port(number) + 10 + 2 * more for more in range(62)}
        assert {others.get(port, number) for port in mine} == {number}
        # Those of a whole number lie on even ports, as every second one between does.
        assert not mine & everybodys


@pytest.mark.slow('several kernels, one after another')
@pytest.mark.usefixtures('namespace')
def test_four_hundred_notebooks_of_two_users_have_domains_of_their_own(
    lab_env: dict[str, str],
) -> None:
    found = crowd.run('claims', 400, env=lab_env)
    claimed = found['claimed']
    assert len(set(claimed)) == 400
    # The first hundred have those that every program can join.
    assert set(range(1, 102)) < set(claimed) <= {*range(1, 102), *BETWEEN}
    # A terminal is told those of its own user.
    assert sorted(found['own']) == sorted(found['of_this_user'])
    # The domains of killed kernels are free.
    assert sorted(found['again']) == sorted(found['freed'])
    *rest, (error, text) = found['rest']
    assert sorted([*claimed, *rest]) == sorted([*range(1, 102), *BETWEEN])
    count = 101 + len(BETWEEN)
    assert error == 'LabError'
    assert text.startswith(f'All {count} ROS domains of this machine are in use')
    assert 'Shut down kernels that are not needed any more' in text


@pytest.mark.usefixtures('namespace')
@pytest.mark.parametrize('how', ['127.0.0.1', '0.0.0.0', '::', 'to 127.0.0.1'])
def test_an_account_that_takes_all_domains_stops_nobody(how: str, lab_env: dict[str, str]) -> None:
    found = crowd.run('greed', *how.split(), env=lab_env)
    if not found:
        pytest.skip('this namespace has no other users')
    *taken, refused = found['taken']
    numbers = [number for number, _ in taken]
    assert len(set(numbers)) == 5
    for number, said in taken:
        assert f'{crowd.OTHER_USER}. This notebook takes domain {number} nevertheless' in said
    # The account that has them all gets no more of them.
    assert refused[0] == 'LabError' and 'are in use by other notebooks' in refused[1]
    # A terminal is told of one's own notebooks, and the claims last when the thief is gone.
    assert found['own'] == sorted(numbers[:3])
    assert found['later'][0] not in numbers


@pytest.mark.usefixtures('namespace')
def test_neighbours_do_not_hear_each_other(lab_env: dict[str, str]) -> None:
    """Test every kind of neighbour. `crowd.py talk 130` does so with 130 notebooks."""
    near = [number for number in BETWEEN if first_port(7) < first_port(number) < first_port(8)]
    found = crowd.run('neighbours', 7, *near, 8, env=lab_env)
    assert len(found['reports']) == 2 * 5
    for number, heard, nodes in found['reports']:
        assert heard == [f'one of {number}', f'other of {number}']
        assert nodes == [number]


@pytest.mark.slow('starts several processes')
def test_a_notebook_between_and_what_it_starts(
    start_kernel: Start, between: int, lab_env: dict[str, str]
) -> None:
    kernel = start_kernel(**LOCALHOST, ROS_DOMAIN_ID=str(between))
    assert not kernel.run(f'WORD = "one"\n{TALKER}\ntalker = lab.spin(Talker())').error
    assert kernel.run('print(runtime.domain_id)').text == f'{between}\n'
    assert kernel.run('%ros2 topic list').text.count('/chatter') == 1
    # A process that it starts, and a terminal that knows nothing but the number.
    env = {**lab_env, **LOCALHOST, 'ROS_DOMAIN_ID': str(between)}
    command = [sys.executable, '-m', 'labkit', 'ros2', 'topic', 'list']
    assert '/chatter' in kernel.run(f'import subprocess\n{run_there(command)}').text
    assert '/chatter' in subprocess.run(command, env=env, capture_output=True, text=True).stdout
    # And the domain of another notebook, if given explicitly.
    elsewhere = f'os.environ["ROS_DOMAIN_ID"] = "220"\n{run_there(command)}'
    assert '/chatter' not in kernel.run(f'import os\n{elsewhere}').text


def run_there(command: list[str]) -> str:
    return f'print(subprocess.run({command!r}, capture_output=True, text=True).stdout)'


@pytest.mark.slow('several kernels, one after another')
def test_who_joins_from_between_is_found_by_everybody(start_kernel: Start, between: int) -> None:
    shared = domains.claim_domain(shared=True)
    ada = start_kernel(**LOCALHOST, ROS_DOMAIN_ID=str(between))
    bo = start_kernel(**LOCALHOST, ROS_DOMAIN_ID=str(shared.domain_id))
    for kernel, word in ((ada, 'ada'), (bo, 'bo')):
        cell = f'WORD = "{word}"\n{TALKER}\nlistener = lab.spin(Listener("listener_" + WORD))\n'
        assert not kernel.run(f'{cell}talker = lab.spin(Talker("t_{word}"))').error
    room = (
        f'lab.join("chatter", String, domain_id={shared.domain_id}, discovery_range="LOCALHOST")'
    )
    assert not ada.run(f'room = {room}\nroom.wait_for_others(2, timeout_sec=60)').error
    for kernel in (ada, bo):
        heard = kernel.run(
            'lab.wait_until(lambda: len(listener.heard) == 2, timeout_sec=60)\n'
            'print(sorted(listener.heard))'
        )
        assert (heard.error, heard.text) == ('', "['ada', 'bo']\n")
    # The whole notebook can move there, too, and what it starts then.
    moved = ada.run(
        f'lab.stop()\nlab.start(domain_id={shared.domain_id})\n'
        'listener = lab.spin(Listener("listener_" + WORD))\n'
        'lab.wait_until(lambda: "bo" in listener.heard, timeout_sec=60)\n'
        'import os\nprint(runtime.domain_id, os.environ["ROS_DOMAIN_ID"])\n'
        'print(os.environ.get("FASTRTPS_DEFAULT_PROFILES_FILE"))'
    )
    assert moved.error == ''
    profile = domain_ids.THIS_MACHINE
    assert moved.text == f'{shared.domain_id} {shared.domain_id}\n{profile}\n'
    # And a context of the learner's own.
    own = ada.run(
        'import rclpy\ncontext = rclpy.context.Context()\nrclpy.init(context=context)\n'
        'guest = Node("guest", context=context)\n'
        'lab.wait_until(lambda: guest.count_publishers("chatter") == 1, timeout_sec=60)\n'
        'guest.destroy_node()\nrclpy.shutdown(context=context)'
    )
    assert own.error == ''
    shared.close()


def test_the_next_notebook_goes_between(start_kernel: Start) -> None:
    kernel = start_kernel()
    # As if there were no more of every program's domains than this one, which is taken. It is held
    # here: another notebook that had it could end meanwhile.
    taken = domains.claim_domain()
    assert taken.domain_id <= domain_ids.LAST_DOMAIN_ID
    kernel.run(
        'from labkit.background import domains\n'
        f'domains._KNOWN = range({taken.domain_id}, {taken.domain_id + 1})'
    )
    started = kernel.run(
        'import labkit as lab\nlab.start()\nfrom labkit.background.runtime import runtime\n'
        'from labkit.domain_ids import BETWEEN\n'
        'print(runtime.domain_id in BETWEEN, runtime.own_domain)'
    )
    assert (started.error, started.text) == ('', 'True True\n')
    again = kernel.run('lab.stop()\nlab.start()\nprint(runtime.domain_id in BETWEEN)')
    assert (again.error, again.text) == ('', 'True\n')
    report = kernel.run('print(lab.doctor())').text
    line = next(line for line in report.splitlines() if ' Domain ' in line)
    assert "this notebook's own" in line and 'good' in line
    # It shares a domain number that other computers can use.
    shared = kernel.run('held = domains.claim_domain(shared=True)\nprint(held.domain_id)').text
    assert int(shared) <= 232
    taken.close()


def test_a_notebook_can_go_between_later(start_kernel: Start, between: int) -> None:
    kernel = start_kernel()
    kernel.run('import labkit as lab\nlab.start()')
    moved = kernel.run(
        f'lab.start(domain_id={between})\nfrom labkit.background.runtime import runtime\n'
        'print(runtime.domain_id, runtime.helper.context.get_domain_id())'
    )
    assert (moved.error, moved.text) == ('', f'{between} {first_port(between) - 7000}\n')
    back = kernel.run('lab.start(domain_id=7)\nprint(runtime.helper.context.get_domain_id())')
    assert (back.error, back.text) == ('', '7\n')
    # A context of the learner's own has the profile that the notebook has.
    own = kernel.run(
        'import rclpy\ncontext = rclpy.context.Context()\n'
        f'rclpy.init(context=context, domain_id={between})'
    )
    assert f'Domain {between} is one that only the whole notebook can be in' in own.error


def test_own_profile_of_a_learner_stays(monkeypatch: pytest.MonkeyPatch, between: int) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', '')
    monkeypatch.setenv(domain_ids.PROFILES_FILE, '/home/me/my_profile.xml')
    with pytest.raises(LabError, match=r'=/home/me/my_profile\.xml'):
        domain_ids.set_domain(between)
    assert os.environ['ROS_DOMAIN_ID'] == ''
    domain_ids.set_domain(7)
    assert os.environ[domain_ids.PROFILES_FILE] == '/home/me/my_profile.xml'
    # Such a notebook is not given one either.
    monkeypatch.setattr(domains, '_KNOWN', range(1, 2))
    with pytest.raises(LabError, match='All 1 ROS domains'):
        domains.claim_domain(other_than=1)


def test_profile_comes_and_goes_with_the_number(
    monkeypatch: pytest.MonkeyPatch, between: int
) -> None:
    monkeypatch.setenv('ROS_DOMAIN_ID', str(between))
    monkeypatch.setenv(domain_ids.PROFILES_FILE, '')
    settings.prepare_environment()
    assert os.environ[domain_ids.PROFILES_FILE] == str(domain_ids.PROFILE)
    monkeypatch.setenv('ROS_DOMAIN_ID', '7')
    settings.prepare_environment()
    assert domain_ids.PROFILES_FILE not in os.environ
    domain_ids.set_domain(between)
    assert domain_ids.counts_ports()
    domain_ids.set_domain(7)
    assert not domain_ids.counts_ports()


@pytest.mark.parametrize(
    ('variables', 'closed'),
    [
        ({}, True),
        ({'ROS_AUTOMATIC_DISCOVERY_RANGE': ''}, True),
        ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}, True),
        ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}, False),
        ({'ROS_STATIC_PEERS': '10.0.0.7'}, False),
        ({'ROS_DISCOVERY_SERVER': '10.0.0.7:11811'}, False),
    ],
)
def test_who_names_others_is_open_to_them(
    monkeypatch: pytest.MonkeyPatch, between: int, variables: dict[str, str], closed: bool
) -> None:
    monkeypatch.setenv(domain_ids.PROFILES_FILE, '')
    monkeypatch.setenv('ROS_DOMAIN_ID', '7')
    monkeypatch.delenv('ROS_AUTOMATIC_DISCOVERY_RANGE')
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    settings.prepare_environment()
    profile = os.environ.get(domain_ids.PROFILES_FILE)
    assert profile == (str(domain_ids.THIS_MACHINE) if closed else None)
    if closed:
        domain_ids.set_domain(between)
    else:
        with pytest.raises(LabError, match='nobody from outside'):
            domain_ids.set_domain(between)


def test_a_notebook_says_that_it_is_open(start_kernel: Start) -> None:
    kernel = start_kernel(ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST', ROS_DOMAIN_ID='94')
    assert kernel.run('import labkit as lab\nlab.start()').text == ''
    opened = kernel.run('lab.stop()\n%env ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET\nlab.start()')
    assert 'other computers can take part' in opened.text
    assert 'in domain 94' in opened.text


def test_what_is_shared_leaves_the_last_domains_for_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    claimed: list[int] = []

    def claim(domain_id: int, **_: object) -> SimpleNamespace:
        if domain_id in claimed:
            raise BlockingIOError
        claimed.append(domain_id)
        return SimpleNamespace(domain_id=domain_id)

    # Of real ones, others may have some, and let go of them at any moment.
    monkeypatch.setattr(domains, 'DomainClaim', claim)
    monkeypatch.setattr(domains, '_udp_sockets', list)
    monkeypatch.setattr(domains, '_KNOWN', range(1, 2))
    for _ in range(20):
        domains.claim_domain(shared=True, other_than=1)
    assert claimed == [*range(215, 233), 102, 103]


def test_what_is_shared_is_not_listed_as_the_domain_of_a_notebook() -> None:
    with closing(domains.claim_domain(shared=True)) as claim:
        assert claim.domain_id not in domains.claimed_domains()
    with closing(domains.claim_domain()) as claim:
        assert claim.domain_id in domains.claimed_domains()
