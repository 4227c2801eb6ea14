"""What is free around a point of a world: the tests hold the simulator to it."""

from __future__ import annotations

import math

from labkit.sim.world import World

__all__ = ['clearance']


def clearance(world: World, x: float, y: float, *, but: str = '') -> float:
    """Return the distance of (x, y) to the nearest thing, m; infinity if there is none.

    Args:
        world: The world.
        x: m.
        y: m.
        but: Name of a robot to leave out.
    """
    return min((thing.away(x, y)[0] for thing in world.things(but)), default=math.inf)
