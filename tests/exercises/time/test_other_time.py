"""Code that goes by a time which a check can't move is named in the verdict."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import pytest
from by_hand import ByHand
from counter_node import Counter

from labkit.exercises import Exercise, Probe, Solution, expect
from labkit.exercises.observation import live
from labkit.exercises.time.other_time import other_times

CODE = """
import asyncio
import select
import time
from datetime import datetime as dt, timedelta
from select import select as wait_for_file

class Clocked:
    def on_timer(self):
        if dt.now() > self.due:
            self.due += timedelta(seconds=1)

def waits():
    select.select([], [], [], 0.1)

def waits_for_files():
    wait_for_file([], [], [], 0.1)

def begin(loop):
    return [lambda: loop.call_later(0.1, print)]

async def limited(event):
    await asyncio.wait_for(event.wait(), 0.1)

async def sleeps(node):
    await asyncio.sleep(0.1)
    now = node.get_clock().now(), time.time(), dt(2026, 1, 1)
"""
WHO = [
    'on_timer (datetime)',
    'waits (select)',
    'waits_for_files (select)',
    'begin (asyncio)',
    'limited (asyncio)',
]


@pytest.fixture
def space() -> dict[str, Any]:
    found: dict[str, Any] = {'__name__': '__main__'}
    exec(CODE, found)
    return found


def test_functions_that_go_by_another_time_are_named(space: dict[str, Any]) -> None:
    assert other_times(space) == WHO
    assert other_times(vars(sys.modules[__name__])) == []


@pytest.mark.slow('several checks')
def test_a_verdict_says_what_it_could_not_see(
    lab: ModuleType, space: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def judge(probe: Probe) -> str:
        source = expect.publisher(probe, '/odds')
        return f'{len(live(probe, {"/odds": source.msg_type}, nodes=[source.node]).on("/odds"))}'

    exercise = Exercise(
        name='odds',
        task='A task.',
        stage=ByHand(judge),
        hints=['A hint.'],
        answer=Solution('', '', 'So.'),
        publishes={'/odds': 'std_msgs/msg/Int16'},
    )
    lab.spin(Counter())
    assert 'asyncio' not in exercise.check().note
    monkeypatch.setattr(sys.modules['__main__'], 'on_timer', space['waits'], raising=False)
    assert 'What waits (select) does by it was seen for' in exercise.check().note
