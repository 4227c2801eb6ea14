"""A full /dev/shm: ROS goes on where it can, and no process ends without a word."""

from __future__ import annotations

import subprocess
import sys

import pytest
from background import crowd
from background.talker import LOCALHOST

PROGRAM = """
import fcntl, socket, struct
import labkit as lab
from labkit import settings
from labkit.packages import imports
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
    fcntl.ioctl(any_socket, 0x8914, struct.pack('16sh', b'lo', 1))  # loopback up
settings.in_kernel = lambda: True  # as in a notebook, follow the import of rclpy
imports.register()
settings.in_kernel = lambda: False
from rclpy.node import Node
from std_msgs.msg import String
lab.start(domain_id=7)
node, heard = Node('talker'), []
publisher = node.create_publisher(String, 'chatter', 10)
node.create_subscription(String, 'chatter', lambda msg: heard.append(msg.data), 10)
lab.spin(node)
publisher.publish(String(data='hello'))
lab.wait_until(lambda: heard, timeout_sec=60)
print(heard)
lab.stop()
"""


@pytest.mark.parametrize(
    ('kilobytes', 'code', 'words'),
    [
        (0, 1, 'LabError: /dev/shm is full, and loading ROS would end this process.'),
        (4, 1, 'LabError: /dev/shm is full, and loading ROS would end this process.'),
        (8, 0, '/dev/shm has 0.00 MB free, too little for shared memory.'),
        (300, 0, '/dev/shm has 0.30 MB free, too little for shared memory.'),
        (4000, 0, "['hello']"),
    ],
)
def test_a_full_dev_shm(kilobytes: int, code: int, words: str, lab_env: dict[str, str]) -> None:
    unshare = crowd.unshare()
    if not unshare:
        pytest.skip('this system does not allow namespaces (net, mount, pid)')
    script = (
        'mount -t tmpfs -o size=4000k tmpfs /dev/shm\n'
        f'[ {kilobytes} = 4000 ] || head -c {4000 - kilobytes}k /dev/zero > /dev/shm/fill\n'
        f'exec {sys.executable} -c "$0"'
    )
    done = subprocess.run(
        [*unshare, 'sh', '-c', script, PROGRAM],
        env={**lab_env, **LOCALHOST},
        capture_output=True,
        text=True,
    )
    assert done.returncode == code, done
    said = done.stdout + done.stderr
    assert words in said
    assert ("['hello']" in said) == (code == 0)
    assert ('too little' in said) == ('RTPS_TRANSPORT_SHM' in said)
