"""What stands in a world with physics, besides walls and posts. Units: m, rad, kg."""

from __future__ import annotations

import math
from typing import NamedTuple

__all__ = ['CRATE_FRICTION', 'ICE_FRICTION', 'Crate', 'Ice', 'Ramp']

# Coefficients of friction. Wood on wood: 0.2 to 0.6; rubber on wet ice: 0.02 to 0.1. Source:
# Engineering ToolBox, "Friction - Coefficients for Common Materials".
CRATE_FRICTION = 0.4
ICE_FRICTION = 0.03


class Crate(NamedTuple):
    """A box that can be pushed.

    Attributes:
        x: Its middle.
        y: Its middle.
        yaw: Its turn.
        size: Length of its edges.
        mass: kg.
        friction: Its coefficient of friction on the floor.
    """

    x: float
    y: float
    yaw: float = 0.0
    size: float = 0.2
    mass: float = 0.3
    friction: float = CRATE_FRICTION


class Ice(NamedTuple):
    """A slippery part of the floor, a rectangle along x and y.

    Attributes:
        x: Its middle.
        y: Its middle.
        width: Its size along x.
        height: Its size along y.
        friction: The coefficient of friction of all that is on it.
    """

    x: float
    y: float
    width: float
    height: float
    friction: float = ICE_FRICTION


class Ramp(NamedTuple):
    """A slope that ends in a drop.

    Attributes:
        x: The middle of its lower edge.
        y: The middle of its lower edge.
        yaw: The direction in which it rises.
        length: How far it reaches, on the floor.
        width: How wide it is.
        rise: How high its end is.
    """

    x: float
    y: float
    yaw: float = 0.0
    length: float = 0.6
    width: float = 0.4
    rise: float = 0.1

    @property
    def slope(self) -> float:
        """Its angle with the floor, rad."""
        return math.atan2(self.rise, self.length)
