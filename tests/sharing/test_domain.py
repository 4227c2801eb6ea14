"""`lab.domain`: the line with which a terminal joins the domain of a notebook."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import pytest

from labkit.background.domains import DomainClaim
from labkit.domain_ids import BETWEEN, PROFILE

TALK = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
talker = lab.spin(Node('talker'))
publisher = talker.create_publisher(String, 'chatter', 10)
timer = talker.create_timer(0.1, lambda: publisher.publish(String(data='from the notebook')))
lab.domain()
"""
# Any program, which knows nothing of labkit.
EAR = """
import rclpy
from std_msgs.msg import String
rclpy.init()
ear, heard = rclpy.create_node('ear'), []
ear.create_subscription(String, 'chatter', lambda msg: heard.append(msg.data), 10)
while not heard:
    rclpy.spin_once(ear)
print(heard[0])
"""


def claimed(numbers: Sequence[int]) -> DomainClaim:
    """Return a claim of the first of some domains that is free."""
    for number in numbers:
        try:
            return DomainClaim(number)
        except BlockingIOError:
            continue
    raise AssertionError('no domain is free')


@pytest.mark.parametrize('numbers', [range(1, 101), BETWEEN], ids=['usual', 'between'])
def test_python_after_that_line_hears_the_notebook(start_kernel, lab_env, tmp_path, numbers):
    (tmp_path / 'ear.py').write_text(EAR)
    here = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    with closing(claimed(numbers)) as claim:
        told = start_kernel(**here, ROS_DOMAIN_ID=str(claim.domain_id)).run(TALK)
        line = f'export ROS_DOMAIN_ID={claim.domain_id}'
        if numbers is BETWEEN:
            line += f' FASTRTPS_DEFAULT_PROFILES_FILE={PROFILE}'
        assert told.text.strip() == line
        typed = f'{line}\n{sys.executable} ear.py'
        said = subprocess.check_output(
            ['bash', '-c', typed], cwd=tmp_path, env={**lab_env, **here}, text=True, timeout=60
        )
        assert said == 'from the notebook\n'


def test_what_is_stored_is_of_no_machine(start_kernel, tmp_path: Path):
    told = start_kernel(ROS_DOMAIN_ID='7', LABKIT_HEADLESS='1').run(TALK)
    assert told.text.strip() == 'export ROS_DOMAIN_ID=...'
