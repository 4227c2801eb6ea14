"""A real hub with five learners: real logins, servers, kernels and lessons, all at once."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat
import pytest
from hub.machine import Hub, Machine
from hub.person import Notebook, Person, at_once

from labkit.exercises.found_lessons import load

pytestmark = pytest.mark.slow('a hub, with servers and kernels')

ROOT = Path(__file__).resolve().parents[2]
LESSON = ROOT / 'notebooks' / '02_talker_listener.ipynb'
CLASS = ('anna', 'ben', 'carl', 'dora', 'emil')
TEACHER = 'maria'
CELLS = [cell for cell in nbformat.read(LESSON, 4).cells if cell.cell_type == 'code']
EXERCISE = load('talker_listener').ears
# Cells whose words do not depend on how quick the machine is.
SAME_FOR_ALL = ('talker-run', 'listener-class', 'two-mistakes', 'not-spun', 'too-early')
# What one learner may have in this test, so that the machine of the test has enough for all.
MEMORY, PROCESSES = 1_000_000_000, 150


@pytest.fixture(scope='module')
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    made = Machine(tmp_path_factory.mktemp('machine'))
    yield made
    made.end()


@pytest.fixture(scope='module')
def hub(machine: Machine, tmp_path_factory: pytest.TempPathFactory) -> Hub:
    limits = f'--Spawner.mem_limit={MEMORY}', f'--LimitedSpawner.process_limit={PROCESSES}'
    names = '\n'.join([*CLASS, f'{TEACHER} teacher'])
    return Hub(machine, tmp_path_factory.mktemp('hub'), names, *limits)


class Class:
    """All learners, each with a server, a token and the lesson, which all work through at once.

    Attributes:
        people: The learners.
        notebooks: Name -> the notebook with the lesson.
        shown: Name -> id of each cell -> what it has shown.
    """

    def __init__(self, hub: Hub) -> None:
        self.people = [Person(hub, name) for name in CLASS]
        self.notebooks: dict[str, Notebook] = at_once(self.people, self._come_in)
        self.shown: dict[str, dict[str, str]] = at_once(self.people, self._work)

    def _come_in(self, person: Person) -> Notebook:
        assert '/hub/login' not in person.log_in().address
        person.get_token()
        person.start_server()
        return person.open_notebook(LESSON.name)

    def _work(self, person: Person) -> dict[str, str]:
        solved = {EXERCISE.starter_id: EXERCISE.answer.code}
        notebook = self.notebooks[person.name]
        return {
            cell.id: notebook.run(solved.get(cell.id, cell.source), words_of(cell))
            for cell in CELLS
        }

    def all_run(self, code: str) -> dict[str, str]:
        """Let everybody run a cell; return what each sees."""
        return at_once(self.people, lambda person: self.notebooks[person.name].run(code))


def words_of(cell: Any) -> set[str]:
    """Return the lines of a lesson's stored outputs that everybody reads."""
    words = [output.text for output in cell.outputs if output.output_type == 'stream']
    return set(''.join(words).splitlines()) if cell.id in SAME_FOR_ALL else set()


@pytest.fixture(scope='module')
def learners(hub: Hub) -> Class:
    return Class(hub)


def evaluated(notebook: Notebook, expression: str) -> Any:
    """Return what an expression is in a kernel, by way of JSON."""
    shown = notebook.run(f'import json; print("<<" + json.dumps({expression}) + ">>")')
    found = re.search('<<(.*)>>', shown)
    assert found, shown
    return json.loads(found[1])


# --- A lesson ------------------------------------------------------------------------------------


def test_five_work_through_a_lesson_at_once(learners: Class) -> None:
    for name, shown in learners.shown.items():
        for cell in CELLS:
            assert 'raised ' not in shown[cell.id], (name, cell.id, shown[cell.id])
            assert words_of(cell) <= set(shown[cell.id].splitlines()), (name, cell.id)
        assert 'PASS: ears' in shown[EXERCISE.check_id], (name, shown)


@pytest.fixture
def own_nodes(learners: Class) -> None:
    """Let each notebook have its own domain, and in it one node, `mine`, with one topic."""
    at_once(
        learners.people,
        lambda person: learners.notebooks[person.name].run(
            # What they have started in terminals runs on, in the domain of the notebook.
            '!pkill -f nodes/ear.py\n'
            'import os; lab.stop(); os.environ.pop("ROS_DOMAIN_ID", None); '
            'from rclpy.node import Node; '
            f'mine = lab.spin(Node("of_{person.name}")); '
            f'mine.create_publisher(String, "said_by_{person.name}", 10)'
        ),
    )


@pytest.mark.usefixtures('own_nodes')
def test_nobody_sees_the_nodes_of_others(learners: Class) -> None:
    nodes, topics = learners.all_run('%ros2 node list'), learners.all_run('%ros2 topic list')
    for name in CLASS:
        assert nodes[name].split() == [f'/of_{name}']
        assert [word for word in topics[name].split() if 'said' in word] == [f'/said_by_{name}']
    domains = {evaluated(page, 'mine.context.get_domain_id()') for page in pages(learners)}
    assert len(domains) == len(CLASS)


def pages(learners: Class) -> list[Notebook]:
    return list(learners.notebooks.values())


@pytest.mark.usefixtures('own_nodes')
def test_nobody_hears_others_by_the_number_of_their_domain(learners: Class) -> None:
    anna, ben = learners.notebooks['anna'], learners.notebooks['ben']
    domain = evaluated(ben, 'mine.context.get_domain_id()')
    anna.run(f'lab.stop(); lab.start(domain_id={domain}); mine = lab.spin(Node("of_anna"))')
    assert evaluated(anna, 'mine.context.get_domain_id()') == domain
    # Another process of ben's finds his node, so whoever may has found it by then.
    assert '/of_ben' in ben.run('!ros2 node list --no-daemon').split()
    assert anna.run('%ros2 node list').split() == ['/of_anna']
    assert ben.run('%ros2 node list').split() == ['/of_ben']


# --- What is whose -------------------------------------------------------------------------------


def test_nobody_sees_files_progress_and_kernels_of_others(learners: Class, hub: Hub) -> None:
    anna = learners.people[0]
    for path in ('api/kernels', 'api/sessions', f'api/contents/{LESSON.name}', 'lab'):
        assert anna.ask(f'/user/ben/{path}').status in (403, 404), path
    assert anna.ask('/hub/api/users/ben').status == 404
    assert anna.ask('/hub/api/users').status == 403
    assert anna.ask('/hub/api/users/ben/server', 'DELETE').status == 404
    assert [kernel['id'] for kernel in anna.api('kernels')] == [
        learners.notebooks['anna'].kernel_id
    ]
    notebook = learners.notebooks['anna']
    for place in ('', '/work', '/.local/share/labkit/progress.json', '/.local/share/jupyter'):
        assert 'Permission denied' in notebook.run(f'!cat /home/ben{place}'), place
    assert 'Permission denied' in notebook.run(f'!ls {hub.state}')
    assert 'Permission denied' in notebook.run('!cat /proc/1/environ')
    assert 'anna' in notebook.run('!id -un')
    # A kernel's channels are no ports: there, everybody on the machine could listen.
    assert evaluated(notebook, 'get_ipython().kernel.parent.transport') == 'ipc'


def test_progress_is_ones_own(learners: Class) -> None:
    path = "__import__('pathlib').Path.home() / '.local/share/labkit/progress.json'"
    for page in pages(learners):
        progress = json.loads(evaluated(page, f'({path}).read_text()'))
        assert list(progress['lessons']) == ['talker_listener']
        assert list(progress['lessons']['talker_listener']['exercises']) == ['ears']
    assert len({evaluated(page, f'str({path})') for page in pages(learners)}) == len(CLASS)


def test_nothing_is_reachable_but_by_login(learners: Class, hub: Hub) -> None:
    stranger = Person(hub, 'anna')
    for path in ('/', '/hub/home', '/hub/admin', '/user/anna/lab', '/user/anna/files/x'):
        assert '/hub/login' in stranger.ask(path).address, path
    for path in ('/user/anna/api/kernels', '/hub/api/users', '/hub/api/proxy'):
        assert stranger.ask(path).status == 403, path
    wrong = ('anna', 'annaanna', hub.password('ben'), hub.password('anna')[:-1])
    for password in wrong:
        assert stranger.log_in(password).status == 403
    for name in ('root', 'nobody', 'zoe'):
        # Not the first to come chooses a password.
        assert Person(hub, name).log_in('my-own-password').status == 403
    assert '/hub/login' in stranger.ask('/hub/home').address


def test_all_listens_on_this_machine_alone(learners: Class, hub: Hub) -> None:
    """Look at every open port of the hub, its proxy and the servers."""
    code = (
        'import psutil; print([(p.name(), c.laddr) for p in psutil.process_iter() '
        'for c in p.net_connections("tcp") if c.status == "LISTEN"])'
    )
    done = hub.machine.run(sys.executable, '-c', code)
    found = re.findall(r"ip='([^']*)', port=(\d+)", done.stdout)
    assert all(address.startswith('127.') for address, _ in found), done
    # The proxy's two, the hub's, and one of each server at least.
    assert len(found) >= 3 + len(CLASS)
    assert str(hub.port) in {port for _, port in found}


def test_a_teacher_sees_who_is_there(learners: Class, hub: Hub) -> None:
    teacher = Person(hub, TEACHER)
    teacher.log_in()
    teacher.get_token()
    users = json.loads(teacher.ask('/hub/api/users').text)
    assert {user['name'] for user in users if user['servers']} >= set(CLASS)
    assert teacher.ask('/user/ben/api/contents').status == 200
    anna = learners.people[0]
    assert anna.ask('/hub/admin').status == 403


# --- One who does harm ---------------------------------------------------------------------------

LOOP = """
import os, subprocess, sys
for _ in range(2 * os.cpu_count()):
    subprocess.Popen([sys.executable, '-c', 'while True: pass'])
while True:
    pass
"""
FILL = """
kept = []
while True:
    kept.append(bytearray(50_000_000))
"""
# Each one starts two, for ever.
FORK = """
import subprocess
subprocess.Popen(['bash', '-c', 'bomb() { bomb | bomb & }; bomb; while :; do bomb; done'],
                 stderr=subprocess.DEVNULL)
import psutil
lab.wait_until(lambda: sum(p.username() == 'emil' for p in psutil.process_iter()) > 30,
               timeout_sec=60)
"""
HEAR = """
talker, listener = lab.spin(Talker()), lab.spin(Listener())
lab.wait_until(lambda: listener.count >= 3, timeout_sec=100)
print('heard', listener.count >= 3)
"""


def test_who_loops_fills_memory_or_forks_does_not_stop_others(
    learners: Class, hub: Hub, machine: Machine
) -> None:
    def emils_processes(*how: str) -> list[str]:
        return machine.run('ps', '-u', 'emil', *how[:-1], '-o', how[-1]).stdout.split()

    open_pages = learners.notebooks
    looping = open_pages['carl'].start(LOOP)
    open_pages['emil'].start(FORK)
    filled = open_pages['dora'].run(FILL)
    assert 'MemoryError' in filled
    # The one who did it goes on, too.
    assert open_pages['dora'].run('del kept; print("here")').split() == ['here']

    others = [person for person in learners.people if person.name in ('anna', 'ben')]
    heard = at_once(others, lambda person: open_pages[person.name].run(HEAR))
    assert all('heard True' in shown for shown in heard.values()), heard
    # Somebody comes in late.
    late = Person(hub, TEACHER)
    late.log_in()
    late.get_token()
    late.start_server()
    assert late.open_notebook(LESSON.name).run('print(6 * 7)').split() == ['42']
    assert len(emils_processes('-L', 'pid=')) <= PROCESSES
    # They stop the loop with the stop button; the bomb is for the teacher.
    learners.people[2].api(f'kernels/{open_pages["carl"].kernel_id}/interrupt', 'POST')
    assert 'KeyboardInterrupt' in open_pages['carl'].finish(looping)
    # One after the other they would begin anew, and take the time of all further tests.
    machine.run('runuser', '-u', 'emil', '--', 'kill', '-KILL', '--', '-1')
    hub.wait(
        lambda: all(state[0] == 'Z' for state in emils_processes('stat=')),
        "the end of emil's processes",
    )


# --- The hub goes away ---------------------------------------------------------------------------


@pytest.mark.parametrize('signal', ['TERM', 'KILL'])
def test_a_restart_of_the_hub_loses_nothing(learners: Class, hub: Hub, signal: str) -> None:
    people = [person for person in learners.people if person.name != 'emil']
    for person in people:
        learners.notebooks[person.name].run(
            f'kept = "by {person.name}"; from rclpy.node import Node; lab.spin(Node("mine"))'
        )
    hub.end(signal)
    hub.start()
    for person in people:
        kernel_id = learners.notebooks[person.name].kernel_id
        assert [kernel['id'] for kernel in person.api('kernels')] == [kernel_id]
        page = learners.notebooks[person.name]
        assert page.run('print(kept)').strip() == f'by {person.name}'
        assert page.run('%ros2 node list').split() != []
        # Who was logged in still is; who comes anew has the same password.
        assert '/hub/login' not in person.ask('/hub/home').address
    again = Person(hub, 'anna')
    assert '/hub/login' not in again.log_in().address
