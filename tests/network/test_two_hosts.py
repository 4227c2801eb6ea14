"""Two hosts of a network: who hears whom.

The default keeps a class of thirty apart, also from one who names everybody's address; SUBNET, or
LOCALHOST with the other's address as a static peer, joins two computers on purpose.
"""

from __future__ import annotations

import pytest
from network.hosts import Network

SPEAKER = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String

node = lab.spin(Node('speaker'))
publisher = node.create_publisher(String, 'chatter', 10)
node.create_timer(0.05, lambda: publisher.publish(String(data='hello')))
print('speaking', flush=True)
input()
"""

HEARER = """
import labkit as lab
from std_msgs.msg import String

try:
    print(lab.wait_for_message('/chatter', String, timeout_sec={timeout_sec}).data)
except lab.LabTimeout as error:
    print(error)
"""

# Who names the other's address without being named, and looks as far as possible.
INTRUDER = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET', 'ROS_STATIC_PEERS': '10.77.0.1;10.77.0.2'}

# Long enough for hosts that find each other to do so; a busy machine may need most of it.
HEARD_SEC, SILENT_SEC = 60, 8

SLOW = pytest.mark.slow('two hosts')


@pytest.mark.parametrize(
    ('speaker', 'hearer', 'heard'),
    [
        pytest.param({}, {}, False, id='default', marks=SLOW),
        pytest.param({}, INTRUDER, False, id='somebody listens'),
        pytest.param(INTRUDER, {}, False, id='somebody falsifies', marks=SLOW),
        pytest.param(
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': ''},
            INTRUDER,
            False,
            id='an empty variable',
            marks=SLOW,
        ),
        pytest.param(
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'},
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'},
            True,
            id='subnet',
            marks=SLOW,
        ),
        pytest.param(
            {'ROS_STATIC_PEERS': '10.77.0.2'},
            {'ROS_STATIC_PEERS': '10.77.0.1'},
            True,
            id='static peers',
            marks=SLOW,
        ),
        pytest.param(
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET', 'ROS_DOMAIN_ID': '5'},
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET', 'ROS_DOMAIN_ID': '6'},
            False,
            id='other domain',
            marks=SLOW,
        ),
    ],
)
def test_two_hosts(
    network: Network,
    speaker: dict[str, str],
    hearer: dict[str, str],
    heard: bool,
) -> None:
    network.build(2)
    talking = network.python(1, SPEAKER, **speaker)
    assert talking.stdout is not None
    assert talking.stdout.readline() == 'speaking\n'
    timeout_sec = HEARD_SEC if heard else SILENT_SEC
    listening = network.python(2, HEARER.format(timeout_sec=timeout_sec), **hearer)
    said = listening.communicate(timeout=3 * HEARD_SEC)[0]
    if heard:
        assert said == 'hello\n'
    else:
        assert 'Nobody publishes on /chatter' in said


@SLOW
def test_two_processes_of_one_host_hear_each_other_by_default(
    network: Network,
) -> None:
    network.build(1)
    talking = network.python(1, SPEAKER)
    assert talking.stdout is not None
    assert talking.stdout.readline() == 'speaking\n'
    listening = network.python(1, HEARER.format(timeout_sec=HEARD_SEC))
    assert listening.communicate(timeout=3 * HEARD_SEC)[0] == 'hello\n'
