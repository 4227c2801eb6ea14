"""When a node's rounds are due: how much time has passed, and what is to be done in this round."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rclpy.clock import ROSClock

__all__ = ['Beat', 'Stopwatch']


class Beat:
    """Something that is done again and again in simulated time.

    Args:
        period: So often, s.
        early: What comes so much early is on time, s: real rounds are a little shorter or longer.
    """

    def __init__(self, period: float, early: float) -> None:
        self._period, self._early = period, early
        self._due = 0.0

    def restart(self, time: float) -> None:
        """Be due at this time, s."""
        self._due = time

    def is_due(self, time: float) -> bool:
        """Tell whether it is to be done at this time, s; then it is due a period later."""
        if time <= self._due - self._early:
            return False
        self._due += self._period
        if self._due < time:
            self._due = time + self._period
        return True


class Stopwatch:
    """How much time of a node's clock passes.

    ROS time may be switched on or off at any moment (the parameter `use_sim_time`). What lies
    between the times of two sources has not passed.
    """

    def __init__(self, clock: ROSClock) -> None:
        self._clock = clock
        self.restart()

    def restart(self) -> None:
        """Count from now."""
        self._source, self._last = self._look()

    def passed(self) -> float:
        """Return the time since this was asked last, s.

        0 if the time comes from another source now, or was set back.
        """
        source, last = self._source, self._last
        self.restart()
        return max(0, self._last - last) * 1e-9 if self._source == source else 0.0

    def _look(self) -> tuple[tuple[bool, bool], int]:
        """Return what the time comes from, and the time, ns."""
        while True:
            active, now = self._clock.ros_time_is_active, self._clock.now().nanoseconds
            # Another thread may switch the source between the two.
            if active == self._clock.ros_time_is_active:
                # ROS time is 0 until somebody tells it.
                return (active, now == 0), now
