"""Remember what happens once: messages that are sent before a check is there to hear them."""

from __future__ import annotations

import contextlib
import itertools
import os
from collections.abc import Mapping
from typing import Any

from labkit.errors import LabError
from labkit.exercises.watch import Sample, Watch

__all__ = ['Recorder']

_numbers = itertools.count()


class Recorder:
    """A hidden node that listens to some topics for as long as the lesson is used.

    It is seen by publishers, as any subscription is. So only exercises that need it have it.

    Args:
        topics: Names of the topics, with their types.
    """

    def __init__(self, topics: Mapping[str, str]) -> None:
        self._topics = dict(topics)
        self._node: Any = None
        self._watches: dict[str, Watch] = {}
        self._kept: dict[str, list[Sample]] = {}

    def keep(self) -> None:
        """Take what has come; start, or start again after `lab.stop()`, if ROS is up."""
        from labkit.background.runtime import runtime

        if not runtime.started:
            return
        from labkit.background.nodes import node_exists

        if self._node is None or not node_exists(self._node):
            self._open()
        self._listen()
        for watch in self._watches.values():
            watch.pump()

    def watches(self) -> dict[str, Watch]:
        """Return what has come on each topic so far."""
        self.keep()
        return self._watches

    def forget(self) -> None:
        """Forget what has come."""
        self.keep()
        for watch in self._watches.values():
            watch.samples.clear()

    def _open(self) -> None:
        from labkit.background.nodes import helper_node

        self._kept = {topic: watch.samples for topic, watch in self._watches.items()}
        self._watches = {}
        # Each has a name of its own: in a kernel a second node of a name replaces the first.
        self._node = helper_node(f'_recorder_{os.getpid()}_{next(_numbers)}')

    def _listen(self) -> None:
        for topic in self._topics.keys() - self._watches.keys():
            # As long as a topic has another type in this process, ROS refuses this one.
            with contextlib.suppress(RuntimeError, LabError):  # RCLError has no public name
                watch = Watch(self._node, topic, self._topics[topic], reliable=False)
                watch.samples = self._kept.get(topic, [])
                self._watches[topic] = watch
