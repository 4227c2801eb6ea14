"""What a buffer remembers of one frame: where it was in its parent, at which times.

The rules are those of tf2: ros2/geometry2, tf2/src/cache.cpp and static_cache.cpp.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import NamedTuple

from labkit.transforms.exceptions import ExtrapolationException
from labkit.transforms.rotations import Quaternion, Vector, interpolated, slerp

__all__ = ['MovingCache', 'Sample', 'StaticCache', 'shown_time']

NANOSECONDS = 1_000_000_000


class Sample(NamedTuple):
    """Where a frame is.

    Attributes:
        parent: The frame in which it is given.
        translation: Its origin, m.
        rotation: Its orientation.
    """

    parent: str
    translation: Vector
    rotation: Quaternion


class StaticCache:
    """A frame that does not move in its parent."""

    oldest = latest = 0
    """Times of what is remembered, ns; 0 for always."""

    def __init__(self, sample: Sample) -> None:
        self.sample = sample

    def __len__(self) -> int:
        return 1

    @property
    def latest_parent(self) -> str:
        """The parent now."""
        return self.sample.parent

    def at(self, time: int) -> Sample:
        """Return where the frame is, at any time."""
        return self.sample

    def insert(self, time: int, sample: Sample) -> bool:
        """Note where the frame is; what was noted before is forgotten."""
        self.sample = sample
        return True

    def clear(self) -> None:
        """Keep what is remembered: it does not depend on time."""


class MovingCache:
    """A frame that moves, for as long as it is remembered.

    Args:
        limit: Time from the newest sample to the oldest one that is kept, ns.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        # Oldest first. Of two with the same time, the one that came later is the later one.
        self._times: list[int] = []
        self._samples: list[Sample] = []

    def __len__(self) -> int:
        return len(self._times)

    @property
    def latest(self) -> int:
        """Time of the newest sample, ns; 0 if there is none."""
        return self._times[-1] if self._times else 0

    @property
    def oldest(self) -> int:
        """Time of the oldest sample, ns; 0 if there is none."""
        return self._times[0] if self._times else 0

    @property
    def latest_parent(self) -> str:
        """The parent in the newest sample, '' if there is none."""
        return self._samples[-1].parent if self._samples else ''

    def at(self, time: int) -> Sample:
        """Return where the frame was, between two samples by interpolation.

        Args:
            time: The time, ns; 0 for the newest sample.

        Raises:
            ExtrapolationException: There is nothing on one side of that time.
        """
        times = self._times
        if not times:
            raise ExtrapolationException('')
        if time == 0 or time == times[-1]:
            return self._samples[-1]
        if len(times) == 1:
            if time != times[0]:
                raise ExtrapolationException(
                    f'Lookup would require extrapolation at time {shown_time(time)}, but only '
                    f'time {shown_time(times[0])} is in the buffer'
                )
            return self._samples[0]
        if time == times[0]:
            return self._samples[0]
        if time > times[-1]:
            raise ExtrapolationException(
                'Lookup would require extrapolation into the future.  Requested time '
                f'{shown_time(time)} but the latest data is at time {shown_time(times[-1])}'
            )
        if time < times[0]:
            raise ExtrapolationException(
                'Lookup would require extrapolation into the past.  Requested time '
                f'{shown_time(time)} but the earliest data is at time {shown_time(times[0])}'
            )
        newer = bisect_right(times, time)
        before, after = self._samples[newer - 1], self._samples[newer]
        if before.parent != after.parent:
            return before
        start = times[newer - 1]
        ratio = (time - start) / (times[newer] - start)
        return Sample(
            before.parent,
            interpolated(before.translation, after.translation, ratio),
            slerp(before.rotation, after.rotation, ratio),
        )

    def insert(self, time: int, sample: Sample) -> bool:
        """Note where the frame was.

        Args:
            time: When, ns.
            sample: Where.

        Returns:
            Whether it is new enough to be remembered.
        """
        times = self._times
        if times:
            newest = times[-1]
            earliest = newest - self._limit
            if times[0] < earliest:
                gone = bisect_left(times, earliest)
                del times[:gone], self._samples[:gone]
            if time < earliest:
                return False
            if time > newest:  # as nearly all are
                times.append(time)
                self._samples.append(sample)
                return True
        place = same = bisect_right(times, time)
        while same and times[same - 1] == time:
            same -= 1
            if self._samples[same] == sample:
                return True
        times.insert(place, time)
        self._samples.insert(place, sample)
        return True

    def clear(self) -> None:
        """Forget all samples."""
        self._times.clear()
        self._samples.clear()


def shown_time(time: int) -> str:
    """Return a time in ns as tf2 writes it: in s, with six digits."""
    sec, nanosec = divmod(time, NANOSECONDS)
    return f'{sec + 1e-9 * nanosec:.6f}'
