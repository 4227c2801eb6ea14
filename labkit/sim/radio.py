"""The way of messages from a robot to those who listen: some come late, and some never."""

from __future__ import annotations

import heapq
import itertools
import math
import zlib
from typing import Any

import numpy as np

from labkit.errors import LabError

__all__ = ['Radio']


class Radio:
    """Messages on their way. Time passes only in `deliver`.

    Which messages are lost, and how late the others are, is drawn for each topic by itself: it
    does not depend on what else is published.

    Args:
        latency: Delay, s: each message takes between half and one and a half of it, uniformly
            distributed. None overtakes another one of its topic.
        loss: Probability that a message is lost.
        seed: Seed of both.
        early: Tolerance, s: a message that is due so soon is delivered now.

    Raises:
        LabError: An argument is invalid.
    """

    def __init__(self, latency: float, loss: float, seed: int, early: float) -> None:
        if not 0 <= latency < math.inf:
            raise LabError(f'latency must be a time in seconds, 0 or more, but it is {latency!r}.')
        if not 0 <= loss <= 1:
            raise LabError(f'loss must be a probability from 0 to 1, but it is {loss!r}.')
        self._latency, self._loss, self._seed, self._early = latency, loss, seed, early
        self.restart()

    @property
    def is_perfect(self) -> bool:
        """Whether every message arrives at once."""
        return not self._latency and not self._loss

    def restart(self) -> None:
        """Forget the messages on their way, and draw the same numbers again."""
        self._random: dict[str, np.random.Generator] = {}
        # When the last message of a topic arrives, s.
        self._last: dict[str, float] = {}
        self._count = itertools.count()
        self._on_way: list[tuple[float, int, Any, Any]] = []

    def send(self, publisher: Any, message: Any, time: float) -> None:
        """Publish a message: at once, later, or never.

        Args:
            publisher: Its publisher.
            message: The message.
            time: Now, s.
        """
        if self.is_perfect:
            publisher.publish(message)
            return
        topic = publisher.topic_name
        random = self._random.get(topic)
        if random is None:
            key = 1, zlib.crc32(topic.encode())
            source = np.random.SeedSequence(self._seed, spawn_key=key)
            random = self._random[topic] = np.random.default_rng(source)
        # Always both: the same messages are lost whatever the latency is.
        fate, share = random.random(2)
        if fate < self._loss:
            return
        due = max(time + self._latency * (0.5 + share), self._last.get(topic, -math.inf))
        self._last[topic] = due
        heapq.heappush(self._on_way, (due, next(self._count), publisher, message))

    def deliver(self, time: float) -> None:
        """Publish what arrives until a time, s."""
        while self._on_way and self._on_way[0][0] <= time + self._early:
            _, _, publisher, message = heapq.heappop(self._on_way)
            publisher.publish(message)
