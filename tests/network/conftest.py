"""A network for a test, taken away afterwards."""

from __future__ import annotations

import shutil
from collections.abc import Iterator

import pytest
from network.hosts import Network


@pytest.fixture
def network(lab_env: dict[str, str]) -> Iterator[Network]:
    """Give a network without hosts: `network.build(2)`."""
    if shutil.which('ip') is None:
        pytest.skip('the command ip is missing (Debian: iproute2)')
    del lab_env['ROS_AUTOMATIC_DISCOVERY_RANGE']  # labkit's own default is under test
    made = Network(lab_env)
    try:
        yield made
    finally:
        made.end()
