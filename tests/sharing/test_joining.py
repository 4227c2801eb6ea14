"""`join` shares one topic with others, and nothing else."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String

import labkit
from labkit.background.domains import DomainClaim, claim_domain
from labkit.background.nodes import existing_nodes
from labkit.background.runtime import runtime
from labkit.errors import LabError, LabTimeout
from labkit.programs.child_processes import start_process
from labkit.rosgraph.snapshot import node_names
from labkit.sharing.joining import _Side, join

Start = Callable[..., Any]

SETUP = """
import labkit as lab
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String

heard = []
chat = lab.spin(Node('chat'))
publisher = chat.create_publisher(String, 'shared_chatter', 10)
chat.create_publisher(String, 'secret', 10)
chat.create_subscription(String, 'shared_chatter', lambda msg: heard.append(msg.data), 10)


def say(*texts):
    for text in texts:
        publisher.publish(String(data=text))
"""
JOIN = """
room = lab.join(
    'shared_chatter', String, domain_id={}, discovery_range='LOCALHOST', name={!r}
)
"""


@pytest.fixture
def shared() -> Iterator[int]:
    """Return a free domain, other than that of this process, which has claimed none."""
    own = int(os.environ.get('ROS_DOMAIN_ID') or 0)
    claim = claim_domain(shared=True, other_than=own)
    yield claim.domain_id
    claim.close()


@pytest.fixture
def started() -> Iterator[None]:
    labkit.start()
    yield
    labkit.stop()


def test_each_message_comes_once_and_nothing_else_is_seen(
    start_kernel: Start, shared: int
) -> None:
    ada, bo = start_kernel(), start_kernel()
    for kernel, name in ((ada, 'ada'), (bo, 'bo')):
        kernel.run(SETUP)
        kernel.run(JOIN.format(shared, name))
    for kernel in (ada, bo):
        kernel.run('room.wait_for_others(timeout_sec=60)')
    ada.run('say("one", "same", "same")')
    bo.run('say("two", "same")')
    for kernel in (ada, bo):
        kernel.run('lab.wait_until(lambda: len(heard) >= 5, timeout_sec=60)')
    # Messages keep their order, so a duplicate would have arrived by now.
    ada.run('say("end of ada")')
    bo.run('say("end of bo")')
    for kernel in (ada, bo):
        kernel.run('lab.wait_until(lambda: sum("end" in text for text in heard) == 2)')
        said = ['one', 'two', *3 * ['same'], 'end of ada', 'end of bo']
        assert eval(kernel.run('print(sorted(heard))').text) == sorted(said)
    assert ada.run('print(room.sent, room.received)').text.split() == ['4', '3']
    seen = ada.run('print(room._guest.get_topic_names_and_types())').text
    assert 'shared_chatter' in seen and 'secret' not in seen and 'rosout' not in seen
    assert ada.run('print(sorted(room._guest.get_node_names()))').text == "['ada', 'bo']\n"
    assert ada.run('print(room._guest.get_service_names_and_types())').text == '[]\n'
    assert 'There now: /bo' in ada.run('print(room)').text
    # After leaving, the node is not seen any more.
    bo.run('room.leave()')
    ada.run('lab.wait_until(lambda: not room.others, timeout_sec=60)')
    assert bo.run('print(room)').text == 'Left: /shared_chatter is not shared any more.\n'


@pytest.mark.slow('starts other processes')
def test_others_that_do_not_hear_yet_are_waited_for(start_kernel: Start, shared: int) -> None:
    ada = start_kernel()
    bo = start_kernel(ROS_DOMAIN_ID=str(shared), ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST')
    for code in (SETUP, JOIN.format(shared, 'ada')):
        assert not ada.run(code).error
    bo.run('import labkit as lab; from rclpy.node import Node; from std_msgs.msg import String')
    bo.run("bo = lab.spin(Node('bo')); bo.create_publisher(String, 'shared_chatter', 10)")
    assert not ada.run("lab.wait_until(lambda: '/bo' in room.others, timeout_sec=60)").error
    assert 'LabTimeout' in ada.run('room.wait_for_others(timeout_sec=0)').error
    bo.run("bo.create_subscription(String, 'shared_chatter', print, 10)")
    assert not ada.run('room.wait_for_others(timeout_sec=60)').error


@pytest.mark.slow('starts other processes')
def test_running_the_cell_again_joins_once(start_kernel: Start, shared: int) -> None:
    ada, bo = start_kernel(), start_kernel()
    for kernel, name in ((ada, 'ada'), (bo, 'bo')):
        kernel.run(SETUP)
        for _ in range(3):
            kernel.run(JOIN.format(shared, name), cell_id='join')
    for kernel in (ada, bo):
        kernel.run('room.wait_for_others(timeout_sec=60)')
    bo.run('say("hello", "and that is all")')
    ada.run('lab.wait_until(lambda: len(heard) >= 2, timeout_sec=60)')
    assert ada.run('print(heard)').text == "['hello', 'and that is all']\n"
    ada.run('lab.wait_until(lambda: room._guest.get_node_names().count("bo") == 1)')


def test_what_comes_back_is_known_however_much_it_is(started: None) -> None:
    node, came = Node('bridge'), list[bytes]()
    profile = QoSProfile(depth=1000)  # type: ignore[no-untyped-call]
    side = _Side(node, '/flood', String, profile, came.append)
    texts = [serialize_message(String(data=str(number % 7))) for number in range(500)]
    for text in texts:
        side.publish(text)
    # All of them are in the queue. They are taken now, and a message of another node after them.
    other = Node('other').create_publisher(String, '/flood', 1000)
    other.publish(String(data='of another'))
    labkit.spin(node)
    labkit.wait_until(lambda: came, timeout_sec=60)
    assert came == [serialize_message(String(data='of another'))]


def test_what_can_not_be_made_leaves_nobody_behind(started: None, shared: int) -> None:
    class NoType:
        """Looks like the class of a message, and is none."""

        @staticmethod
        def get_fields_and_field_types() -> dict[str, str]:
            return {}

    assert runtime.helper is not None
    before = node_names(runtime.helper)
    with pytest.raises(Exception, match='_TYPE_SUPPORT'):
        join('a', NoType, domain_id=shared, discovery_range='OFF', name='nobody')
    assert node_names(runtime.helper) == before
    assert 'nobody' not in {node.get_name() for node in existing_nodes()}


def test_variables_are_as_before(started: None, shared: int) -> None:
    before = dict(os.environ)
    with join('a', String, domain_id=shared, discovery_range='OFF', static_peers=['10.0.0.1']):
        assert dict(os.environ) == before


def test_it_ends_with_its_block_with_stop_and_with_its_node(shared: int) -> None:
    labkit.start()
    with join('a', String, domain_id=shared, discovery_range='OFF') as first:
        assert not first.done
    assert first.done and first.others == []
    second = join('a', String, domain_id=shared, discovery_range='OFF')
    labkit.remove('domain_bridge')
    assert second.done
    third = join('a', String, domain_id=shared, discovery_range='OFF')
    labkit.stop()
    assert third.done
    third.leave()  # without effect


def test_programs_in_the_domain_end_before_it_is_free(started: None) -> None:
    room = join('chatter', String, discovery_range='LOCALHOST')
    command = [sys.executable, '-c', 'import time; time.sleep(1000)']
    room.programs.append(start_process('guest', command, dict(os.environ)))
    assert room.programs[0].running
    room.leave()
    assert not room.programs[0].running


def test_a_domain_is_taken_and_given_back(started: None) -> None:
    room = join('a', String, discovery_range='OFF')
    assert room.domain_id != runtime.domain_id
    with pytest.raises(BlockingIOError):
        DomainClaim(room.domain_id)
    room.leave()
    DomainClaim(room.domain_id).close()


def test_the_own_domain_is_never_the_shared_one(monkeypatch: pytest.MonkeyPatch) -> None:
    free = claim_domain(shared=True)
    free.close()
    # A script of a domain that the search would come to first.
    monkeypatch.setenv('ROS_DOMAIN_ID', str(free.domain_id))
    labkit.start()
    with join('a', String, discovery_range='OFF') as room:
        assert room.domain_id != runtime.domain_id == free.domain_id
    labkit.stop()


def test_a_teacher_sets_the_domain(
    started: None, shared: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv('LABKIT_SHARED_DOMAIN_ID', str(shared))
    with join('a', String, discovery_range='OFF') as room:
        assert room.domain_id == shared
    monkeypatch.setenv('LABKIT_SHARED_DOMAIN_ID', 'ours')
    with pytest.raises(LabError, match='LABKIT_SHARED_DOMAIN_ID must be a number'):
        join('a', String)


@pytest.mark.parametrize(
    ('words', 'expected'),
    [
        ({'discovery_range': 'SUBNETS'}, "Did you mean 'SUBNET'"),
        ({'static_peers': '10.0.0.1'}, r"static_peers=\['10.0.0.1'\]"),
        ({'domain_id': 1000}, 'domain_id must be a whole number'),
        ({'msg_type': 'String'}, 'msg_type must be a class of messages'),
        ({'topic': 'a b'}, 'a b'),
        ({'name': 'no name'}, 'no name'),
    ],
)
def test_what_is_wrong_is_said(
    started: None, shared: int, words: dict[str, Any], expected: str
) -> None:
    assert runtime.helper is not None
    before = node_names(runtime.helper)
    arguments: dict[str, Any] = {'topic': 'a', 'msg_type': String, 'domain_id': shared, **words}
    with pytest.raises(Exception, match=expected) as raised:
        join(**arguments)
    assert isinstance(raised.value, LabError)
    assert node_names(runtime.helper) == before


def test_the_domain_of_the_notebook_itself_and_the_same_twice(started: None, shared: int) -> None:
    with pytest.raises(LabError, match='itself, so there is nothing to join'):
        join('a', String, domain_id=runtime.domain_id)
    with join('a', String, domain_id=shared, discovery_range='OFF'):
        with pytest.raises(LabError, match='is shared in domain'):
            join('/a', String, domain_id=shared)
        with join('b', String, domain_id=shared, discovery_range='OFF'):
            pass


@pytest.mark.slow('starts other processes')
def test_waiting_in_vain_says_what_to_look_at(
    start_kernel: Start, started: None, shared: int
) -> None:
    with join('a', String, domain_id=shared, discovery_range='LOCALHOST') as room:
        with pytest.raises(LabTimeout, match=r'found nobody.\nDo the others use the same domain'):
            room.wait_for_others(timeout_sec=0.1)
        other = start_kernel()
        other.run('import labkit as lab\nfrom std_msgs.msg import Int16')
        other.run(f'lab.join("a", Int16, domain_id={shared}, name="bo")')
        labkit.wait_until(lambda: room.others == ['/bo'], timeout_sec=60)
        with pytest.raises(LabTimeout, match='/bo has the type std_msgs/msg/Int16 there'):
            room.wait_for_others(timeout_sec=0.1)
