"""Exercises on services and parameters: in this process, another one, other executors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from labkit.background.domains import claim_domain
from labkit.exercises.what_is_asked import Scope
from labkit.rosgraph.servers import Server

SERVES = {'/switch': 'std_srvs/srv/SetBool'}
SETUP = """
import subprocess
import sys
import labkit as lab
import rclpy
from labkit.exercises import Exercise, Lesson, Solution, expect
from labkit.exercises.clauses import Call, Responds, Serves
from labkit.exercises.setup_cell import begin
from labkit.rosgraph.snapshot import node_names
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

def judge(calls):
    for call in calls:
        expect.that(call.response.message == str(call.request['data']),
                    expected='echo', seen=call.response.message)

exercise = Exercise(
    name='echo', task='Serve /switch.', serves={'/switch': 'std_srvs/srv/SetBool'},
    clauses=[
        Serves('/switch', 'std_srvs/srv/SetBool'),
        Responds('/switch', 'echo', lambda: [[{'data': True}], [{'data': True}, {'data': False}]],
                 judge),
    ],
    hints=['.'], answer=Solution('', '', ''))
later = Exercise(name='later', task='Serve /other.', serves={'/other': 'std_srvs/srv/Trigger'},
    clauses=[Serves('/other', 'std_srvs/srv/Trigger')], hints=['.'], answer=Solution('', '', ''))
begin(Lesson('odds', '04_odds.ipynb', exercises=[exercise, later]))

def echo(request, response):
    response.message = str(request.data)
    return response

def sees(name):
    return name in node_names(runtime.helper)

lab.start()
"""
# The service comes half a second after the node.
PROGRAM = """
import time
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool

def echo(request, response):
    response.message = str(request.data)
    return response

rclpy.init()
node = Node('elsewhere')
time.sleep(0.5)
node.create_service(SetBool, 'switch', echo)
rclpy.spin(node)
"""


def attempt(**asked: Any) -> Callable[[str, str], frozenset[str]]:
    scope = Scope(**asked, known=frozenset(asked.get('serves', ())))
    return lambda service, srv_type: scope.attempt(
        [], [], ['/lamp'], [Server('/lamp', service, srv_type)]
    )


@pytest.mark.parametrize(
    ('service', 'srv_type'),
    [
        ('/switch', 'std_srvs/srv/Trigger'),
        ('/swich', 'std_srvs/srv/Trigger'),
        ('/lamp/on', 'std_srvs/srv/SetBool'),
    ],
)
def test_service_of_the_name_or_a_near_one_or_of_the_type_shows_an_attempt(
    service: str, srv_type: str
) -> None:
    assert attempt(serves=SERVES)(service, srv_type) == {'/lamp'}


def test_any_other_service_shows_none() -> None:
    assert attempt(serves=SERVES)('/ring_bell', 'std_srvs/srv/Trigger') == frozenset()


@pytest.mark.slow('another process, in real time')
def test_service_of_another_process_may_come_after_its_node(
    start_kernel: Callable[..., Any],
) -> None:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    kernel = start_kernel(**env)
    kernel.run(SETUP)
    kernel.run(f'process = subprocess.Popen([sys.executable, "-c", {PROGRAM!r}])')
    kernel.run('lab.wait_until(lambda: sees("/elsewhere"), timeout_sec=30)')
    found = kernel.run('exercise.check()')
    later = kernel.run('later.check()')
    kernel.run('process.kill()\nprocess.wait()')
    claim.close()
    assert 'PASS: echo' in found.text, found.text + found.error
    assert 'has answered 3 calls' in found.text
    # A node of an earlier exercise is no attempt at a later one.
    assert 'NOT ATTEMPTED: later' in later.text, later.text


@pytest.mark.slow('waits in real time')
def test_service_of_an_executor_of_ones_own_is_called(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(
        'import threading\n'
        'from rclpy.executors import MultiThreadedExecutor\n'
        'node = Node("own")\n'
        'node.create_service(SetBool, "switch", echo)\n'
        'executor = MultiThreadedExecutor(2)\n'
        'executor.add_node(node)\n'
        'thread = threading.Thread(target=executor.spin, daemon=True)\n'
        'thread.start()'
    )
    assert 'PASS: echo' in kernel.run('exercise.check()').text
    kernel.run('executor.shutdown()\nthread.join()')


@pytest.mark.slow('several checks')
def test_second_server_and_wrong_response_are_refused(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(
        'node = lab.spin(Node("one"))\n'
        'service = node.create_service(SetBool, "switch", lambda request, response: response)'
    )
    assert 'FAIL: echo' in kernel.run('exercise.check()').text
    kernel.run('node.destroy_service(service)\nnode.create_service(SetBool, "switch", echo)')
    assert 'PASS: echo' in kernel.run('exercise.check()').text
    kernel.run('lab.spin(Node("two")).create_service(SetBool, "switch", echo)')
    assert '2 servers: /one, /two' in ' '.join(kernel.run('exercise.check()').text.split())


def test_node_whose_service_nobody_asks_for_is_named(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run('lab.spin(Node("bell")).create_service(Trigger, "ring_bell", print)')
    text = ' '.join(kernel.run('exercise.check()').text.split())
    assert 'the node /bell, which serves /ring_bell (std_srvs/srv/Trigger)' in text
