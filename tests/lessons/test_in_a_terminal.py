"""A program in a terminal: whether it is in the domain of the notebook."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator

import psutil
import pytest

from labkit.background.wait import wait_for
from labkit.domain_ids import BETWEEN, PROFILE, PROFILES_FILE, THIS_MACHINE
from labkit.lessons._terminal import InATerminal, _how_to_join

Start = Callable[..., psutil.Process]


@pytest.fixture
def start() -> Iterator[Start]:
    """Give a function that starts a program with these variables and no others."""
    started: list[subprocess.Popen[bytes]] = []

    def run(**variables: str) -> psutil.Process:
        started.append(subprocess.Popen(['/bin/sleep', '1000'], env=variables))
        process = psutil.Process(started[-1].pid)
        # It is told of before the system has copied its arguments and variables.
        assert wait_for(process.cmdline, 30.0)
        return process

    yield run
    for each in started:
        each.kill()
        each.wait()


def program(*, joins: bool = False) -> InATerminal:
    return InATerminal(
        '/ear', 'python3 ear.py', '', '', 'ear.py', lambda _: True, lambda: 0.0, joins=joins
    )


def test_a_domain_between_is_told_by_number_and_profile(start: Start, monkeypatch):
    number = BETWEEN[0]
    monkeypatch.setenv('ROS_DOMAIN_ID', str(number))
    monkeypatch.setenv(PROFILES_FILE, str(PROFILE))
    number_alone = start(ROS_DOMAIN_ID=str(number))
    said = program().elsewhere(number_alone)
    assert said == f'it runs with {PROFILES_FILE}=nothing'
    line = f'export ROS_DOMAIN_ID={number} {PROFILES_FILE}={PROFILE}'
    assert _how_to_join([number_alone]) == line
    # `ros2` sets the profile itself.
    assert program(joins=True).elsewhere(number_alone) == ''
    both = start(**{'ROS_DOMAIN_ID': str(number), PROFILES_FILE: str(PROFILE)})
    assert program().elsewhere(both) == ''


def test_a_profile_that_was_left_in_a_terminal_is_another_domain(start: Start, monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', '7')
    monkeypatch.setenv(PROFILES_FILE, str(THIS_MACHINE))
    left = start(**{'ROS_DOMAIN_ID': '7', PROFILES_FILE: str(PROFILE)})
    assert program().elsewhere(left) == f'it runs with {PROFILES_FILE}={PROFILE}'
    line = f'export ROS_DOMAIN_ID=7 {PROFILES_FILE}={THIS_MACHINE}'
    assert _how_to_join([left]) == line
    for right in ({}, {PROFILES_FILE: str(THIS_MACHINE)}):
        assert program().elsewhere(start(ROS_DOMAIN_ID='7', **right)) == ''


def test_another_number_and_none_are_told(start: Start, monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', '7')
    assert program().elsewhere(start(ROS_DOMAIN_ID='8')) == 'it runs with ROS_DOMAIN_ID=8'
    nothing = start()
    assert program().elsewhere(nothing) == 'it has none: domain 0'
    assert program(joins=True).elsewhere(nothing) == ''
    assert _how_to_join([nothing]) == 'export ROS_DOMAIN_ID=7'
