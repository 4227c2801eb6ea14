"""Seconds of a node's life: what is waited for in real time comes to an end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from labkit.exercises.life import _Course


class Endless:
    """A topic on which one more message has come each time that somebody looks."""

    def __init__(self) -> None:
        self.count = 0

    def pump(self) -> None:
        self.count += 1
        assert self.count < 500, 'still waiting'

    def __len__(self) -> int:
        return self.count


def test_a_topic_that_is_never_quiet_is_not_waited_for_without_an_end():
    """A sensor that the lesson gives publishes on, in real time."""
    topic = Endless()
    probe: Any = SimpleNamespace(look=lambda seconds: None)
    passing: Any = SimpleNamespace(seconds=30.0)
    watches: Any = {'/range': topic}
    course = _Course(probe, passing, watches, moments=[], until=None)
    course.wait_for_late_ones()
    assert topic.count
