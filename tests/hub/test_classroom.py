"""A class on a hub that shares its progress: who can write what, who can read it, who is named."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator

import pytest
from hub.machine import Hub, Machine
from hub.person import Notebook, Person, at_once

from labkit.exercises.record.class_sheet import FILE_NAME

pytestmark = pytest.mark.slow('a hub, with servers and kernels')

NAMES = ('anna', 'ben', 'maria')
TRY = (
    'from labkit.exercises.record.progress_store import progress_store\n'
    'from labkit.exercises.record.membership import wait_until_sent\n'
    'progress_store.note_check("talker_listener", "every_two_seconds", {!r})\n'
    'print(wait_until_sent(60))'
)


@pytest.fixture(scope='module')
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    made = Machine(tmp_path_factory.mktemp('machine'))
    yield made
    made.end()


@pytest.fixture(scope='module')
def hub(machine: Machine, tmp_path_factory: pytest.TempPathFactory) -> Hub:
    return Hub(machine, tmp_path_factory.mktemp('hub'), 'anna\nben\nmaria teacher\n')


@pytest.fixture(scope='module')
def notebooks(hub: Hub) -> dict[str, Notebook]:
    """Everybody's notebook, open, and labkit loaded in it."""

    def come_in(person: Person) -> Notebook:
        person.log_in()
        person.get_token()
        person.start_server()
        notebook = person.open_notebook('02_talker_listener.ipynb')
        said = notebook.run('import labkit as lab\nlesson = lab.lesson("talker_listener")')
        assert 'raised' not in said, said
        return notebook

    return at_once([Person(hub, name) for name in NAMES], come_in)


def place(hub: Hub, name: str) -> str:
    return f'{hub.state}-class/{name}'


def test_a_class_joins_and_its_teacher_sees_it(notebooks: dict[str, Notebook], hub: Hub) -> None:
    board = 'print(lab.classroom(names=True))'
    assert 'Nobody shares' in notebooks['maria'].run(board)
    for name, outcome in (('anna', 'PASS'), ('ben', 'FAIL')):
        said = notebooks[name].run('print(lab.join_class())')
        assert f'SHARED: your progress, as {name}' in said and 'your teachers' in said, said
        assert 'True' in notebooks[name].run(TRY.format(outcome))
    shown = notebooks['maria'].run(board)
    assert 'Class: 2 share their progress, 2 at work, 0 stuck.' in shown, shown
    assert 'every_two_seconds 1 passed 1 trying' in shown
    assert '1 more of the class share nothing.' in shown
    assert 'The names are those of their accounts.' in shown
    assert 'can not be used' not in shown and 'others can write' not in shown
    seen = notebooks['anna'].run(board)
    assert 'Permission denied. On a hub its teachers alone can.' in seen, seen


@pytest.mark.parametrize(
    'command',
    [
        'ls {folder}',
        'ls {ben}',
        'cat {ben}/{file}',
        'touch {ben}/{file}',
        'touch {folder}/zoe',
        'mkdir {folder}/zoe',
        'rm -rf {ben}',
        'mv -f {anna} {folder}/zoe',
        'ln {ben}/{file} {anna}/more',
    ],
)
def test_a_learner_neither_reads_nor_forges_what_is_anothers(
    command: str, notebooks: dict[str, Notebook], hub: Hub
) -> None:
    words = {name: place(hub, name) for name in NAMES}
    text = command.format(folder=f'{hub.state}-class', file=FILE_NAME, **words)
    said = notebooks['anna'].run(f'!{text}')
    assert 'Permission denied' in said or 'Operation not permitted' in said, said
    assert hub.machine.run('test', '-s', f'{words["ben"]}/{FILE_NAME}').returncode == 0
    assert hub.machine.run('test', '-e', f'{hub.state}-class/zoe').returncode != 0


def test_what_a_learner_lays_into_their_own_folder_harms_nobody(
    notebooks: dict[str, Notebook], hub: Hub
) -> None:
    mine = f'{place(hub, "anna")}/{FILE_NAME}'
    for command, trouble in (
        (f'rm {mine}; mkfifo -m 644 {mine}', 'no ordinary file'),
        (f'rm {mine}; ln -s {place(hub, "ben")}/{FILE_NAME} {mine}', 'a link'),
        (f'rm {mine}; truncate -s 1G {mine}; chmod 644 {mine}', 'too large'),
        (f'chmod 000 {mine}', 'Permission denied'),
        (f'chmod 000 {place(hub, "anna")}', 'Permission denied'),
    ):
        assert notebooks['anna'].run(f'!{command}').strip() == '', command
        shown = notebooks['maria'].run('print(lab.classroom(names=True))')
        (line,) = [line for line in shown.splitlines() if line.strip().startswith('anna')]
        assert f'can not be used: {trouble}' in line, shown
        assert any(line.strip().startswith('ben') for line in shown.splitlines()), shown
    notebooks['anna'].run(f'!chmod 750 {place(hub, "anna")}')
    # The next check puts it right.
    assert 'True' in notebooks['anna'].run(TRY.format('FAIL'))
    assert 'can not be used' not in notebooks['maria'].run('print(lab.classroom())')


def test_who_leaves_is_gone(notebooks: dict[str, Notebook], hub: Hub) -> None:
    assert 'LEFT' in notebooks['ben'].run('print(lab.leave_class())')
    notebooks['ben'].run(TRY.format('PASS'))
    assert hub.machine.run('ls', '-A', place(hub, 'ben')).stdout == ''
    shown = notebooks['maria'].run('print(lab.classroom(names=True))')
    assert 'Class: 1 share' in shown and 'ben' not in shown


def test_a_teacher_ends_users_and_servers_and_changes_nobody(
    notebooks: dict[str, Notebook], hub: Hub
) -> None:
    maria = Person(hub, 'maria')
    maria.log_in()
    assert maria.ask('/hub/admin').status == 200
    maria.get_token()
    # As "Edit User" in the admin page sends it: a hub whose user has no name can't start again.
    change = {'name': 'anna', 'admin': True}
    assert maria.ask('/hub/api/users/anna', 'PATCH', change).status == 403
    assert maria.ask('/user/ben/api/contents').status == 200
    assert maria.ask('/hub/api/users/ben/server', 'DELETE').status in (202, 204)
    hub.wait(
        lambda: maria.ask('/hub/api/users/ben', 'DELETE').status in (204, 404), 'the end of ben'
    )
    users = json.loads(maria.ask('/hub/api/users').text)
    assert {user['name'] for user in users} == {'anna', 'maria'}


def test_who_is_taken_out_has_nothing_any_more(notebooks: dict[str, Notebook], hub: Hub) -> None:
    def runs(name: str) -> list[str]:
        states = hub.machine.run('ps', '-u', name, '-o', 'stat=').stdout.split()
        return [state for state in states if state[0] != 'Z']

    page, script = Person(hub, 'ben'), Person(hub, 'ben')
    for person in (page, script):
        assert '/hub/login' not in person.log_in().address
    script.get_token()
    # His server has been ended.
    script.start_server()
    notebook = script.open_notebook('02_talker_listener.ipynb')
    notebook.run(f'!setsid nohup {sys.executable} -c "while True: pass" &')
    annas = len(runs('anna'))
    hub.list.write_text('anna\nmaria teacher\n')
    hub.end('TERM')
    assert runs('ben')
    before = len(hub.log)
    hub.start()
    assert runs('ben') == [] and len(runs('anna')) == annas
    for person in (page, script):
        for path in ('/hub/home', '/user/ben/lab', '/hub/api/user', '/user/ben/api/kernels'):
            answer = person.ask(path)
            assert answer.status == 403 or '/hub/login' in answer.address, (path, answer)
    assert Person(hub, 'ben').log_in().status == 403
    maria = Person(hub, 'maria')
    maria.log_in()
    maria.get_token()
    users = {user['name']: user for user in json.loads(maria.ask('/hub/api/users').text)}
    assert users['ben']['servers'] == {} and users['anna']['servers']
    assert maria.ask('/hub/api/users/ben', 'DELETE').status == 204
    assert notebooks['anna'].run('print(6 * 7)').strip() == '42'
    assert 'Traceback' not in hub.log[before:]


def test_who_is_taken_out_and_who_teaches_no_more(
    notebooks: dict[str, Notebook], hub: Hub
) -> None:
    maria = Person(hub, 'maria')
    maria.log_in()
    maria.get_token()
    # The hub forgets her with her old password.
    assert hub.command(f'--class={hub.list}', '--new-password=maria')[0] == 0
    assert maria.ask('/hub/api/users').status == 403
    maria = Person(hub, 'maria')
    maria.log_in()
    maria.get_token()
    assert maria.ask('/hub/admin').status == 200
    hub.list.write_text('anna\nmaria\n')
    hub.end('TERM')
    hub.start()
    # (A server asks the hub again after five minutes: she was not in this one before.)
    for path in ('/hub/admin', '/hub/api/users', '/user/anna/api/contents'):
        assert maria.ask(path).status == 403, path
    # Another account may get ben's number.
    owner = hub.machine.run('stat', '--format=%U %a', place(hub, 'ben')).stdout.strip()
    assert owner == 'root 750'
    kept = hub.machine.run('ls', f'{hub.state}-class-private').stdout.split()
    assert 'ben' not in kept and 'anna' in kept
    # The account of another class, whose hub has another folder.
    other = hub.list.with_name('others.txt')
    other.write_text('zoe\n')
    code, said = hub.command(f'--class={other}', '--new-password=zoe')
    assert code == 2 and "'zoe' has no password in the hub of" in said, said
    assert hub.machine.run('id', 'zoe').returncode != 0
