"""Two hosts, each a network namespace with one end of a cable: who hears whom.

The default, LOCALHOST, keeps a class of thirty apart; SUBNET, or LOCALHOST with the other's
address as a static peer, joins two computers on purpose.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator

import pytest

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

# Long enough for hosts that find each other to do so; a busy machine may need most of it.
HEARD_SEC, SILENT_SEC = 60, 8

Run = Callable[..., subprocess.Popen[str]]


def ip(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(['ip', *words], capture_output=True, text=True)


def wait_for_cable(host: str) -> None:
    """Wait until a host's end of the cable is up and its addresses are its own.

    Fast DDS looks at the network when a node starts, and only then: it never uses a device that
    came up later.
    """
    while True:
        shown = ip('-n', host, 'address', 'show', 'dev', 'cable')
        assert shown.returncode == 0, shown.stderr
        if 'state UP' in shown.stdout and 'tentative' not in shown.stdout:
            return
        time.sleep(0.05)


@pytest.fixture
def hosts(lab_env: dict[str, str]) -> Iterator[Run]:
    """Give a function that starts a script on host 0 or 1, at 10.77.0.1 and 10.77.0.2."""
    if shutil.which('ip') is None:
        pytest.skip('the command ip is missing (Debian: iproute2)')
    names = [f'labkit-{os.getpid()}-{number}' for number in (0, 1)]
    refused = ip('netns', 'add', names[0]).stderr
    if refused:
        pytest.skip(f'network namespaces are not allowed here: {refused.strip()}')
    try:
        ip('netns', 'add', names[1])
        ip(
            '-n',
            names[0],
            'link',
            'add',
            'cable',
            'type',
            'veth',
            'peer',
            'cable',
            'netns',
            names[1],
        )
        for number, name in enumerate(names):
            ip('-n', name, 'address', 'add', f'10.77.0.{number + 1}/24', 'dev', 'cable')
            for device in ('lo', 'cable'):
                made = ip('-n', name, 'link', 'set', device, 'up', 'multicast', 'on')
                assert made.returncode == 0, made.stderr
        for name in names:
            wait_for_cable(name)
        processes: list[subprocess.Popen[str]] = []

        def start(host: int, code: str, **env: str) -> subprocess.Popen[str]:
            processes.append(
                subprocess.Popen(
                    ['ip', 'netns', 'exec', names[host], sys.executable, '-c', code],
                    env={**lab_env, **env},
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    text=True,
                )
            )
            return processes[-1]

        yield start
        for process in processes:
            if process.poll() is None:
                process.communicate('\n')
    finally:
        for name in names:
            ip('netns', 'del', name)


@pytest.mark.parametrize(
    ('speaker', 'hearer', 'heard'),
    [
        pytest.param({}, {}, False, id='default'),
        pytest.param(
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'},
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'},
            True,
            id='subnet',
        ),
        pytest.param(
            {'ROS_STATIC_PEERS': '10.77.0.2'},
            {'ROS_STATIC_PEERS': '10.77.0.1'},
            True,
            id='static peers',
        ),
        pytest.param(
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET', 'ROS_DOMAIN_ID': '5'},
            {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET', 'ROS_DOMAIN_ID': '6'},
            False,
            id='other domain',
        ),
    ],
)
def test_two_hosts(
    hosts: Run,
    lab_env: dict[str, str],
    speaker: dict[str, str],
    hearer: dict[str, str],
    heard: bool,
) -> None:
    del lab_env['ROS_AUTOMATIC_DISCOVERY_RANGE']  # labkit's own default is under test
    talking = hosts(0, SPEAKER, **speaker)
    assert talking.stdout is not None
    assert talking.stdout.readline() == 'speaking\n'
    timeout_sec = HEARD_SEC if heard else SILENT_SEC
    listening = hosts(1, HEARER.format(timeout_sec=timeout_sec), **hearer)
    said = listening.communicate(timeout=3 * HEARD_SEC)[0]
    if heard:
        assert said == 'hello\n'
    else:
        assert 'Nobody publishes on /chatter' in said


def test_two_processes_of_one_host_hear_each_other_by_default(
    hosts: Run, lab_env: dict[str, str]
) -> None:
    del lab_env['ROS_AUTOMATIC_DISCOVERY_RANGE']
    talking = hosts(0, SPEAKER)
    assert talking.stdout is not None
    assert talking.stdout.readline() == 'speaking\n'
    listening = hosts(0, HEARER.format(timeout_sec=HEARD_SEC))
    assert listening.communicate(timeout=3 * HEARD_SEC)[0] == 'hello\n'
