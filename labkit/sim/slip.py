"""Wheels that slip: they turn more than the floor moves below them, and odometry believes them."""

from __future__ import annotations

import math

import numpy as np

__all__ = ['Slip']

# Way of a wheel on which it slips evenly, m.
PIECE = 0.1


class Slip:
    """The slip of one wheel.

    On each piece of its way, 0.1 m, the wheel turns too far by a random share, which is
    exponentially distributed. So its error grows with the way, and the standard deviation of the
    error with the square root of the way: after s metres they are `share` s and
    `share` sqrt(0.1 s) m. The wheels slip independently. Source: Siegwart, Nourbakhsh and
    Scaramuzza, "Introduction to Autonomous Mobile Robots" (2nd edition, 2011), section 5.2.4,
    where the variance of the way of each wheel is proportional to the way; Thrun, Burgard and Fox,
    "Probabilistic Robotics" (2005), section 5.4, has the same idea for the robot as a whole.

    Args:
        share: By how much it turns too far on average, relative to its way.
        seed: Source of its random numbers.

    Attributes:
        rate: Way that the wheel tells, relative to its true way, here and now.
    """

    def __init__(self, share: float, seed: np.random.SeedSequence) -> None:
        self._share = share
        self._random = np.random.default_rng(seed)
        self._begin_piece()

    def counted(self, way: float) -> float:
        """Move the wheel by a true way, m, and return the way that its encoder counts, m."""
        rest, told = abs(way), 0.0
        while rest > 0:
            part = min(rest, self._left)
            told += part * self.rate
            rest -= part
            self._left -= part
            if self._left <= 0:
                self._begin_piece()
        return math.copysign(told, way)

    def _begin_piece(self) -> None:
        self._left = PIECE
        self.rate = 1 + self._random.exponential(self._share)
