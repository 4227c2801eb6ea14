"""How long an answer may take: longer on a busy machine, and longer in a long session."""

from __future__ import annotations

import os

from labkit.background.nodes import made

__all__ = ['answer_sec', 'busyness']

# So many times as long, at most, however busy the machine is.
MOST_BUSY = 3.0
# Fast DDS tells a process that has just been started of each publisher and subscription that this
# one ever had, also of those that are gone. Until then its answers do not arrive. Measured for
# nodes with the usual 14 of them: 7 ms each.
NODE_SEC = 0.01
MOST_SEC = 20.0


def busyness() -> float:
    """Return how many times as long something takes as on a calm machine, about."""
    load = os.getloadavg()[0] / (os.cpu_count() or 1)
    return min(max(load, 1.0), MOST_BUSY)


def answer_sec(calm_sec: float) -> float:
    """Return how long a node of another process may take to answer, s.

    Args:
        calm_sec: How long on a calm machine, and in a session that has just begun, s.
    """
    return min(calm_sec * busyness() + NODE_SEC * made.count, MOST_SEC)
