"""Timing of a node's periodic work: elapsed time, and which work is due."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rclpy.clock import ROSClock

__all__ = ['Beat', 'Stopwatch']


class Beat:
    """Work that is due periodically in simulated time.

    Args:
        period: Period, s.
        early: Tolerance, s: real timer periods are a little shorter or longer.
    """

    def __init__(self, period: float, early: float) -> None:
        self._period, self._early = period, early
        self._due = 0.0

    def restart(self, time: float) -> None:
        """Make the work due at a time, s."""
        self._due = time

    def is_due(self, time: float) -> bool:
        """Return whether the work is due at a time, s; if so, schedule the next one."""
        if time <= self._due - self._early:
            return False
        self._due += self._period
        if self._due < time:
            self._due = time + self._period
        return True


class Stopwatch:
    """Measures elapsed time of a node's clock.

    ROS time may be switched on or off at any moment (the parameter `use_sim_time`). The difference
    between the two clocks does not count as elapsed.
    """

    def __init__(self, clock: ROSClock) -> None:
        self._clock = clock
        self.restart()

    def restart(self) -> None:
        """Measure from now."""
        self._source, self._last = self._read_clock()

    def passed(self) -> float:
        """Return the time since the last call, s.

        0 if the clock was switched or set back.
        """
        source, last = self._source, self._last
        self.restart()
        return max(0, self._last - last) * 1e-9 if self._source == source else 0.0

    def _read_clock(self) -> tuple[tuple[bool, bool], int]:
        """Return the source of the clock, and its time, ns."""
        while True:
            active, now = self._clock.ros_time_is_active, self._clock.now().nanoseconds
            # Another thread may switch the source between the two.
            if active == self._clock.ros_time_is_active:
                # ROS time is 0 until the first message on /clock.
                return (active, now == 0), now
