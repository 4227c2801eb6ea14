"""Learners on computers of their own, who join each other on purpose; and who is not seen."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence

import pytest
from network.hosts import Network

pytestmark = pytest.mark.slow('two and more hosts')

# It does what is written to it, line by line, and says so.
LEARNER = """
import sys

import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String

heard = []
chat = lab.spin(Node('chat'))
publisher = chat.create_publisher(String, 'shared_chatter', 10)
chat.create_publisher(String, 'secret', 10)
chat.create_subscription(String, 'shared_chatter', lambda msg: heard.append(msg.data), 10)
for line in sys.stdin:
    try:
        exec(line)
    except lab.LabTimeout as error:
        print(error)
    print('done', flush=True)
"""
# Who is not of the course, and looks into a domain with all that ROS has.
SPY = """
import sys
import time

import rclpy
from rclpy.node import Node

rclpy.init(domain_id=int(sys.argv[1]))
spy = Node('spy', enable_rosout=False, start_parameter_services=False)
end = time.monotonic() + float(sys.argv[2])
while time.monotonic() < end and (
    len(spy.get_node_names()) < int(sys.argv[3])
    or not {*sys.argv[4:]} <= {name for name, _ in spy.get_topic_names_and_types()}
):
    rclpy.spin_once(spy, timeout_sec=0.1)
print(sorted(spy.get_node_names()))
print(sorted(name for name, _ in spy.get_topic_names_and_types()))
print(sorted(name for name, _ in spy.get_service_names_and_types()))
"""
SHARED, OTHER = 42, 43
# The domains of the notebooks themselves.
FIRST = 50
# Long enough for those who can find each other; a busy machine may need most of it.
MEET_SEC, IN_VAIN_SEC = 60, 8
PORT = 11811
# 127.0.0.1 in /proc/net/udp
LOOPBACK = '0100007F'


class Learner:
    """A learner on a host."""

    def __init__(self, network: Network, host: int, name: str) -> None:
        self.name, self.domain_id = name, FIRST + host
        self._process = network.python(host, LEARNER, ROS_DOMAIN_ID=str(self.domain_id))

    def do(self, line: str) -> str:
        """Run a line, and return what it has printed."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(f'{line}\n')
        self._process.stdin.flush()
        said: list[str] = []
        while not said or said[-1] != 'done':
            said.append(self._process.stdout.readline().rstrip('\n'))
            assert self._process.poll() is None or said[-1], 'the learner has ended'
        return '\n'.join(said[:-1])

    def join(self, **options: object) -> None:
        words = ''.join(f', {name}={value!r}' for name, value in options.items())
        self.do(f'room = lab.join("/shared_chatter", String, name={self.name!r}{words})')


def learners(network: Network, names: Sequence[str]) -> list[Learner]:
    network.build(len(names))
    return [Learner(network, host, name) for host, name in enumerate(names, start=1)]


def talk(those: Sequence[Learner]) -> None:
    """Let each meet all others, say its name, and hear everybody once."""
    for learner in those:
        learner.do(f'room.wait_for_others({len(those) - 1}, timeout_sec={MEET_SEC})')
    for learner in those:
        learner.do(f'publisher.publish(String(data={learner.name!r}))')
    for learner in those:
        learner.do(f'lab.wait_until(lambda: len(heard) >= {len(those)}, timeout_sec={MEET_SEC})')
        assert learner.do('print(sorted(heard))') == str(sorted(each.name for each in those))


ALL = ('ada', 'bo', 'chidi', 'dilek', 'eva')


@pytest.mark.parametrize('count', [2, 5])
def test_by_multicast(network: Network, count: int) -> None:
    those = learners(network, ALL[:count])
    for learner in those:
        learner.join(domain_id=SHARED)
    talk(those)


@pytest.mark.parametrize('count', [2, 5])
def test_without_multicast_by_static_peers(network: Network, count: int) -> None:
    those = learners(network, ALL[:count])
    network.without_multicast()
    addresses = [f'10.77.0.{host}' for host in range(1, count + 1)]
    for learner, own in zip(those, addresses, strict=True):
        others = [address for address in addresses if address != own]
        learner.join(domain_id=SHARED, static_peers=others)
    talk(those)


def test_without_multicast_and_without_addresses_nobody_is_found(network: Network) -> None:
    those = learners(network, ALL[:2])
    network.without_multicast()
    for learner in those:
        learner.join(domain_id=SHARED)
    said = those[0].do(f'room.wait_for_others(timeout_sec={IN_VAIN_SEC})')
    assert 'found nobody' in said and 'static_peers=[...]' in said
    # The same network, with addresses: it is the multicast that was missing.
    for learner, other in zip(those, ('10.77.0.2', '10.77.0.1'), strict=True):
        learner.do('room.leave()')
        learner.join(domain_id=SHARED, static_peers=[other])
    talk(those)


@pytest.mark.parametrize('count', [2, 5])
def test_with_a_discovery_server(network: Network, count: int) -> None:
    those = learners(network, ALL[:count])
    network.without_multicast()
    address = '10.77.0.1'
    server = network.start(1, 'fast-discovery-server', '-i', '0', '-l', address, '-p', str(PORT))
    for learner in those:
        learner.join(domain_id=SHARED, discovery_server=f'{address}:{PORT}')
    talk(those)
    assert server.poll() is None


def test_other_domains_stay_apart(network: Network) -> None:
    ada, bo, chidi = learners(network, ALL[:3])
    chidi.join(domain_id=OTHER)
    for learner in (ada, bo):
        learner.join(domain_id=SHARED)
    talk([ada, bo])
    chidi.do('publisher.publish(String(data="chidi"))')
    talk_again = 'publisher.publish(String(data="still two"))'
    ada.do(talk_again)
    for learner in (ada, bo):
        learner.do(f'lab.wait_until(lambda: len(heard) >= 3, timeout_sec={MEET_SEC})')
        assert learner.do('print(heard[2:], room.others)').startswith("['still two']")
    chidi.do(f'lab.wait_until(lambda: heard, timeout_sec={MEET_SEC})')
    assert chidi.do('print(heard, room.others)') == "['chidi'] []"


def test_who_has_not_joined_is_not_seen_and_of_the_others_only_what_they_share(
    network: Network,
) -> None:
    ada, bo, chidi = learners(network, ALL[:3])
    for learner in (ada, bo):
        learner.join(domain_id=SHARED)
    talk([ada, bo])
    known = ('/parameter_events', '/shared_chatter')
    nodes, topics, services = _spy(network, 3, SHARED, MEET_SEC, 3, *known)
    assert nodes == "['ada', 'bo', 'spy']"
    assert topics == str([*known])
    assert 'ada' not in services and 'bo' not in services
    assert chidi.do('print(heard)') == '[]'
    # The domain in which the nodes of a notebook are does not leave its computer, whoever asks.
    for learner in (ada, chidi):
        assert _spy(network, 2, learner.domain_id, IN_VAIN_SEC, 2)[0] == ("['spy']")
    assert "'chat'" in _spy(network, 1, ada.domain_id, MEET_SEC, 3)[0]
    assert [_open_domains(network, host) for host in (1, 2, 3)] == [{SHARED}, {SHARED}, set()]
    # What was opened for sharing is closed with it, and the notebook stays as it is.
    ada.do('room.leave()')
    ada.do('lab.stop(); lab.spin(Node("again"))')
    assert _open_domains(network, 1) == set()


def _open_domains(network: Network, host: int) -> set[int]:
    """Return the domains that a host receives for from others, by its open ports."""
    table = network.start(host, 'cat', '/proc/net/udp').communicate()[0]
    ends = [line.split()[1].split(':') for line in table.splitlines()[1:]]
    ports = [int(port, 16) for address, port in ends if address != LOOPBACK]
    # Below are ports that only name a process, above those from which is sent.
    return {(port - 7400) // 250 for port in ports if 7400 <= port < 32768}


def _spy(
    network: Network, host: int, domain_id: int, seconds: int, count: int, *topics: str
) -> list[str]:
    """Return the nodes, topics and services that are seen on a host.

    It looks until there are so many nodes and these topics, which come after the nodes.
    """
    spy: subprocess.Popen[str] = network.start(
        host,
        *(sys.executable, '-c', SPY, str(domain_id), str(seconds), str(count), *topics),
        ROS_AUTOMATIC_DISCOVERY_RANGE='SUBNET',
        ROS_STATIC_PEERS='10.77.0.1;10.77.0.2;10.77.0.3',
    )
    return spy.communicate(timeout=3 * MEET_SEC)[0].splitlines()
