"""A hub on which one account is hostile; and somebody without one, while the hub is down."""

from __future__ import annotations

import json
import socket
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from hub.machine import ROOT, Hub, Machine
from hub.person import Notebook, Person

from labkit.domain_ids import PORT_BETWEEN, ports

# Everybody's server has this port, at an address of its own: the attacker need not guess it.
PORT = 18_888
# As the account that runs it, on all that it may have.
TAKE = """
import os, socket, sys
for port in sys.argv[1:]:
    try:
        socket.create_server(('127.0.0.1', int(port)))
        print(port, 'taken')
    except OSError as error:
        print(port, os.strerror(error.errno))
"""
# A server with a certificate of the hub, but of another account.
FORGE = """
import os, socket, ssl, sys
folder, address, port = sys.argv[1:]
context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
context.load_cert_chain(f'{folder}/user-ben.crt', f'{folder}/user-ben.key')
listener = socket.create_server((address, int(port)))
print('listening:', os.getpid(), flush=True)
while True:
    connection, _ = listener.accept()
    try:
        with context.wrap_socket(connection, server_side=True) as encrypted:
            print('asked:', encrypted.recv(4096), flush=True)
            encrypted.sendall(b'HTTP/1.1 200 OK\\r\\nContent-Length: 6\\r\\n\\r\\nforged')
    except OSError as error:
        print('refused:', error, flush=True)
"""
# Files in a home that say so if a server, or what starts it, reads them.
PLANT = r"""
import sys
from pathlib import Path
home = Path.home()
version = f'python{sys.version_info[0]}.{sys.version_info[1]}'
code = 'import sys; open("/home/anna/read", "a").write(__file__)'
modules = 'jupyter_server_config', 'jupyterhub', 'labkit', 'pathlib', 'runpy', 'usercustomize'
site = home / '.local' / 'lib' / version / 'site-packages'
for folder in (home, home / 'work', home / '.jupyter', site):
    folder.mkdir(parents=True, exist_ok=True)
    for module in modules:
        (folder / f'{module}.py').write_text(code)
for name in ('.profile', '.bashrc', '.bash_profile'):
    (home / name).write_text('echo shell >> ~/read; export PYTHONPATH=$HOME\n')
for folder in (home / 'bin', home / '.local' / 'bin'):
    folder.mkdir(parents=True, exist_ok=True)
    for program in ('python', 'python3', 'jupyterhub-singleuser', 'env'):
        (folder / program).write_text('#!/bin/sh\necho program >> ~/read\n')
        (folder / program).chmod(0o755)
print('planted')
"""
# A stranger who asks a server without the hub or its proxy.
ASK = """
import socket, ssl, sys
context = ssl._create_unverified_context()
try:
    with socket.create_connection((sys.argv[1], int(sys.argv[2])), 20) as connection:
        with context.wrap_socket(connection) as encrypted:
            encrypted.sendall(b'GET / HTTP/1.1\\r\\nHost: x\\r\\n\\r\\n')
            print('answered:', encrypted.recv(4096))
except OSError as error:
    print('refused:', error)
"""
# All that takes TCP connections or UDP datagrams: account, kind, address, port, what reads it.
LISTEN = """
import json, psutil
print(json.dumps([
    (p.username(), c.type.name, c.laddr.ip, c.laddr.port)
    for p in psutil.process_iter() for c in p.net_connections('inet')
    if c.status in ('LISTEN', 'NONE') and c.laddr != c.raddr
]))
"""


@pytest.fixture(scope='module')
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    made = Machine(tmp_path_factory.mktemp('machine'))
    yield made
    made.end()


@pytest.fixture(scope='module')
def hub(machine: Machine, tmp_path_factory: pytest.TempPathFactory) -> Hub:
    options = f'--Spawner.port={PORT}', '--Spawner.http_timeout=60'
    return Hub(machine, tmp_path_factory.mktemp('hub'), 'anna\nben\n', *options)


def come_in(hub: Hub, name: str) -> Person:
    person = Person(hub, name)
    assert '/hub/login' not in person.log_in().address
    person.get_token()
    person.start_server()
    return person


@pytest.fixture(scope='module')
def notebooks(hub: Hub) -> dict[str, Notebook]:
    return {
        name: come_in(hub, name).open_notebook('02_talker_listener.ipynb')
        for name in ('anna', 'ben')
    }


def as_account(hub: Hub, name: str, code: str, *words: object) -> list[str]:
    """Return a command that runs a script in an account."""
    return ['runuser', '-u', name, '--', sys.executable, '-c', code, *map(str, words)]


def address_of(hub: Hub, name: str) -> str:
    """Return where a server listens."""
    code = (
        f'import psutil; print(*(c.laddr.ip for p in psutil.process_iter() '
        f'if p.username() == {name!r} for c in p.net_connections("tcp") '
        f'if c.status == "LISTEN" and c.laddr.port == {PORT}))'
    )
    return hub.machine.run(sys.executable, '-c', code).stdout.strip()


@pytest.mark.slow('a hub, with servers and kernels')
def test_each_server_has_an_address_and_answers_nobody_but_the_hub(
    hub: Hub, notebooks: dict[str, Notebook]
) -> None:
    address, other = address_of(hub, 'anna'), address_of(hub, 'ben')
    assert len({address, other, '127.0.0.1', ''}) == 4
    said = hub.machine.run(*as_account(hub, 'ben', ASK, address, PORT)).stdout
    assert said.startswith('refused:'), said


@pytest.mark.slow('a hub, with servers and kernels')
def test_all_that_listens_is_known_and_told(hub: Hub, notebooks: dict[str, Notebook]) -> None:
    anna = notebooks['anna']
    shown = anna.run(
        'import labkit as lab; from rclpy.node import Node; from std_msgs.msg import String\n'
        'node = lab.spin(Node("of_anna")); node.create_publisher(String, "chatter", 10)\n'
        'display(lab.monitor("/chatter"), lab.graph())\n'
        'print("domain", node.context.get_domain_id())'
    )
    found: dict[tuple[str, str], set[tuple[str, int]]] = {}
    listed = hub.machine.run(sys.executable, '-c', LISTEN).stdout
    for account, kind, ip, port in json.loads(listed):
        found.setdefault((account, kind), set()).add((ip, port))
    tcp = {account: places for (account, kind), places in found.items() if kind == 'SOCK_STREAM'}
    assert tcp == {
        'root': {('127.0.0.1', hub.port + number) for number in range(3)},
        **{name: {(address_of(hub, name), PORT)} for name in notebooks},
    }
    assert ('root', 'SOCK_DGRAM') not in found
    udp = found['anna', 'SOCK_DGRAM']
    usual = {*ports(int(shown.split()[-1])), *range(PORT_BETWEEN, 7400)}
    ros = {(ip, port) for ip, port in udp if port in usual}
    assert len(ros) >= 3 and {ip for ip, _ in ros} == {'127.0.0.1'}
    # What Fast DDS sends from could receive, too. Nobody takes what comes.
    for place in udp - ros:
        with socket.socket(type=socket.SOCK_DGRAM) as sender:
            sender.sendto(b'hello', place)
    assert anna.run('print(6 * 7)').strip() == '42'
    waiting = {
        int(line.split()[1].partition(':')[2], 16): int(line.split()[4].partition(':')[2], 16)
        for line in Path('/proc/net/udp').read_text().splitlines()[1:]
    }
    assert all(waiting[port] for _, port in udp - ros), (udp, waiting)
    told = (ROOT / 'docs' / 'hub.md').read_text()
    for words in ('pages', 'own port', 'orders', 'server', 'ROS 2 takes', 'ROS 2 sends'):
        assert f'| {words} |' in told, words


def test_nobody_looks_into_the_memory_of_others(hub: Hub, notebooks: dict[str, Notebook]) -> None:
    anna, ben = notebooks['anna'], notebooks['ben']
    said = anna.run(
        'import labkit as lab, os; from rclpy.node import Node; lab.spin(Node("of_anna"))\n'
        'print(sorted(os.listdir("/dev/shm")), os.getpid())'
    )
    assert 'fastrtps_' in said, said
    assert 'fastrtps_' not in ben.run('!ls /dev/shm')
    assert 'Permission denied' in ben.run(f'!ls /proc/{said.split()[-1]}/root/dev/shm')
    assert hub.machine.run('find', '/dev/shm', '-name', 'fastrtps_*').stdout == ''


@pytest.mark.slow('a hub, with servers and kernels')
def test_a_learner_has_temporary_files_of_their_own(machine: Machine, tmp_path: Path) -> None:
    code = (
        'import os; from labkit.hub.spawner import _take_places\n'
        f'_take_places({bytes(tmp_path)!r})\n'
        'open("/tmp/secret", "w").close(); open("/dev/shm/secret", "w").close()\n'
        'print(os.listdir("/tmp"), os.listdir("/dev/shm"))'
    )
    done = machine.run('env', f'PYTHONPATH={ROOT}', sys.executable, '-c', code)
    assert done.stdout == "['secret'] ['secret']\n", done
    assert (tmp_path / 'secret').exists()
    found = machine.run('find', '/tmp/secret', '/dev/shm/secret')
    assert found.stdout == ''


def test_shared_memory_has_a_limit(machine: Machine) -> None:
    code = (
        'import os; from labkit.hub.spawner import _take_places\n'
        '_take_places(None)\n'
        'try:\n'
        '    with open("/dev/shm/full", "wb") as file:\n'
        '        os.posix_fallocate(file.fileno(), 0, 300_000_000)\n'
        'except OSError as error:\n'
        '    print(error.strerror)\n'
        'try:\n'
        '    for number in range(20_000):\n'
        '        open(f"/dev/shm/{number}", "w").close()\n'
        'except OSError as error:\n'
        '    print(error.strerror)\n'
    )
    done = machine.run('env', f'PYTHONPATH={ROOT}', sys.executable, '-c', code)
    assert done.stdout.splitlines() == ['No space left on device'] * 2, done


@pytest.mark.slow('a hub, with servers and kernels')
def test_a_neighbours_certificate_opens_no_place_of_another(
    hub: Hub, notebooks: dict[str, Notebook], machine: Machine
) -> None:
    private = f'{hub.state}-class-private'
    denied = hub.machine.run('runuser', '-u', 'ben', '--', 'ls', f'{private}/anna')
    assert 'Permission denied' in denied.stderr
    anna, address = Person(hub, 'anna'), address_of(hub, 'anna')
    anna.log_in()
    anna.get_token()
    assert anna.ask('/hub/api/users/anna/server', 'DELETE').status in (202, 204)
    hub.wait(lambda: not address_of(hub, 'anna'), "the end of anna's server")
    log = hub.state / 'forger.log'
    command = as_account(hub, 'ben', FORGE, f'{private}/ben', address, PORT)
    forger = machine.start(*command, log=log)
    try:
        hub.wait(lambda: 'listening' in log.read_text(), 'the forger')
        # She presses the button; the hub must not lead her there.
        anna.ask('/hub/api/users/anna/server', 'POST', {})
        hub.wait(lambda: 'refused:' in log.read_text(), 'the hub, which tries the port')
        assert 'forged' not in anna.ask('/user/anna/lab').text
    finally:
        machine.run('kill', '-KILL', log.read_text().split()[1])
        forger.wait()
    hub.wait(lambda: not anna.ask('/hub/api/users/anna').text.count('"pending": "'), 'the end')
    assert 'asked:' not in log.read_text()
    assert come_in(hub, 'anna').ask('/user/anna/api/status').status == 200


@pytest.mark.slow('a hub, with servers and kernels')
def test_nothing_in_a_home_sets_up_the_server(hub: Hub) -> None:
    anna = come_in(hub, 'anna')
    shell = anna.open_notebook('02_talker_listener.ipynb')
    assert shell.run(PLANT).strip() == 'planted'
    prefix = Path(sys.prefix)
    for place in (prefix, prefix / 'bin', prefix / 'etc', ROOT, ROOT / 'labkit'):
        assert 'Permission denied' in shell.run(f'!touch {place}/new'), place
    assert anna.ask('/hub/api/users/anna/server', 'DELETE').status in (202, 204)
    hub.wait(lambda: not address_of(hub, 'anna'), "the end of anna's server")
    assert come_in(hub, 'anna').ask('/user/anna/api/status').status == 200
    read = hub.machine.run('cat', '/home/anna/read')
    assert 'No such file' in read.stderr, read.stdout
    code = 'rm -r /home/anna/*.py /home/anna/work/*.py /home/anna/bin'
    assert hub.machine.run('sh', '-c', code).returncode == 0


@pytest.mark.slow('a hub, with servers and kernels')
def test_an_address_with_a_token_lets_nobody_in(hub: Hub, notebooks: dict[str, Notebook]) -> None:
    anna = come_in(hub, 'anna')
    stranger = Person(hub, 'ben')
    for path in ('/user/anna/lab', '/hub/home', '/user/anna/api/kernels'):
        answer = stranger.ask(f'{path}?token={anna.token}')
        assert answer.status == 403 or '/hub/login' in answer.address, (path, answer)


@pytest.mark.slow('a hub, with servers and kernels')
def test_who_deletes_all_lessons_gets_them_back_by_one_command(hub: Hub) -> None:
    anna = come_in(hub, 'anna')
    name = '02_talker_listener.ipynb'
    lesson = anna.api(f'contents/{name}')['content']
    lesson['cells'].insert(0, {**lesson['cells'][1], 'id': 'mine', 'source': 'my = "own cell"'})
    anna.api(f'contents/{name}', 'PUT', {'type': 'notebook', 'content': lesson})
    notebook = anna.open_notebook(name)
    notebook.run('!rm -rf ~/work')
    assert anna.ask(f'/user/anna/api/contents/{name}').status == 404
    said = notebook.run('!labkit restore')
    assert f'/home/anna/work/{name} is as it was saved at' in said
    assert anna.api(f'contents/{name}')['content']['cells'][0]['source'] == 'my = "own cell"'
    anna.api(f'kernels/{notebook.kernel_id}/restart', 'POST', {})
    assert notebook.run('import os\nprint(os.getcwd())').strip() == '/home/anna/work'
    anna.api('terminals', 'POST', {})
    where = 'readlink -e $(printf "/proc/%s/cwd " $(pgrep -u anna -x bash))'
    hub.wait(
        lambda: hub.machine.run('sh', '-c', where).stdout.split() == ['/home/anna/work'],
        'a terminal beside the lessons',
    )
    assert (
        'Permission denied'
        in hub.machine.run(
            *('runuser', '-u', 'ben', '--', 'ls', '/home/anna/.local/share/labkit/copies')
        ).stderr
    )


@pytest.mark.slow('a hub, with servers and kernels')
def test_a_new_password_ends_what_was_begun_with_a_stolen_one(
    hub: Hub, notebooks: dict[str, Notebook]
) -> None:
    def processes(name: str) -> list[str]:
        return hub.machine.run('pgrep', '-u', name).stdout.split()

    # The thief is in: a page, a token, a kernel, and a program that outlives all of them.
    old = hub.password('anna')
    thief, script = Person(hub, 'anna'), come_in(hub, 'anna')
    assert '/hub/login' not in thief.log_in(old).address
    script.open_notebook('02_talker_listener.ipynb').run(
        f'!setsid nohup {sys.executable} -c "while True: pass" &'
    )
    assert thief.ask('/user/anna/api/kernels').status == 200
    assert script.ask('/hub/api/user').status == 200
    alive = processes('ben')

    code, said = hub.command(f'--class={hub.list}', '--new-password=anna')
    assert code == 0 and str(hub.state) in said, said
    new = hub.password('anna')
    assert new != old and new not in said and old not in said
    assert processes('anna') == []
    for person in (thief, script):
        for path in ('/hub/home', '/user/anna/lab', '/user/anna/api/kernels', '/hub/api/user'):
            answer = person.ask(path)
            assert answer.status == 403 or '/hub/login' in answer.address, (path, answer)
    assert thief.log_in(old).status == 403
    # The owner comes in, and neighbours have noticed nothing.
    assert come_in(hub, 'anna').ask('/user/anna/api/status').status == 200
    assert set(alive) <= set(processes('ben'))
    assert notebooks['ben'].run('print(6 * 7)').strip() == '42'
    code, said = hub.command(f'--class={hub.list}', '--new-password=zoe')
    assert (code, said) == (2, "labkit: 'zoe' is not in robots.txt.\n")


@pytest.mark.slow('a hub, with servers and kernels')
def test_nobody_takes_the_place_of_a_hub_that_is_down(
    hub: Hub, notebooks: dict[str, Notebook]
) -> None:
    hub.end('TERM')
    try:
        code, said = hub.command(f'--class={hub.list}', '--new-password=ben')
        assert code == 2 and 'can not be reached' in said and 'Start it' in said, said
        ports = range(hub.port, hub.port + 3)
        said = hub.machine.run(*as_account(hub, 'nobody', TAKE, *ports)).stdout
        assert said.splitlines() == [f'{port} Permission denied' for port in ports]
    finally:
        hub.start()
    assert notebooks['ben'].run('print(6 * 7)').strip() == '42'


@pytest.mark.slow('a hub, with servers and kernels')
def test_guessed_passwords_wait_and_hold_up_nobody(hub: Hub) -> None:
    anna = Person(hub, 'anna')
    assert '/hub/login' not in anna.log_in().address
    seen: list[int] = []
    over = threading.Event()

    def attack(number: int) -> None:
        thief = Person(hub, 'anna')
        # What anybody may write there makes no other address of it.
        forged = {'X-Forwarded-For': f'192.0.2.{number}', 'X-Real-Ip': f'192.0.2.{number}'}
        while not over.is_set():
            seen.append(thief.log_in('a guess', **forged).status)

    begin = time.monotonic()
    thieves = [threading.Thread(target=attack, args=(number,)) for number in range(8)]
    for thief in thieves:
        thief.start()
    try:
        hub.wait(lambda: 429 in seen, 'a guess that is refused')
        for _ in range(3):
            assert '/hub/login' not in Person(hub, 'ben').log_in().address
        # She herself, in the browser that she has used before.
        assert '/hub/login' not in anna.log_in().address
    finally:
        over.set()
        for thief in thieves:
            thief.join()
    longest = time.monotonic() - begin
    assert set(seen) == {403, 429}
    # Five at once, then after 1, 2, 4 and each further 8 s.
    assert seen.count(403) <= 5 + 3 + longest / 8 + 1, (seen.count(403), longest)
