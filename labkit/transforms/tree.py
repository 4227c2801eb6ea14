"""The tree of frames in time: where each one is in its parent, and the way between any two.

The rules, and the words of its errors, are those of tf2: ros2/geometry2, branch jazzy,
tf2/src/buffer_core.cpp. Nothing here needs ROS: times are whole nanoseconds, 0 is the latest.
"""

from __future__ import annotations

import threading
import time as clocks
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from operator import mul
from typing import cast

from labkit.transforms.cache import NANOSECONDS, MovingCache, Sample, StaticCache, shown_time
from labkit.transforms.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from labkit.transforms.rotations import (
    Matrix,
    Quaternion,
    Vector,
    inverse,
    matrix,
    normalized,
    product,
    rotated,
)

__all__ = ['Edge', 'Place', 'Tree']

# A longer way is a loop.
MAX_DEPTH = 1000
# Changes of a frame's parent that are remembered.
_MOVES = 4
NO_PARENT = 'NO_PARENT'
Place = tuple[Vector, Quaternion]
"""Where a frame is in another one, and how it is turned."""
_HERE: Place = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Edge:
    """What is known of a frame in its parent.

    Attributes:
        child: The frame.
        parent: Its parent in the newest sample.
        authority: Who says so.
        rate: Samples in a second, Hz; 10,000 for a single one, as tf2 counts.
        latest: Time of the newest sample, ns; 0 for a static frame.
        oldest: Time of the oldest sample, ns.
        heard: `time.monotonic()` when the last sample came.
    """

    child: str
    parent: str
    authority: str
    rate: float
    latest: int
    oldest: int
    heard: float = 0.0


class Tree:
    """Frames and what is remembered of them. Any thread may ask, and any may insert.

    Args:
        limit: How long a moving frame is remembered, from its newest sample back, ns.

    Attributes:
        moves: The last changes of the parent, for each frame that has had one: `time.monotonic()`,
            the parent before, and then.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        # Frames in the order in which they were first named; None for one without a parent.
        self._frames: dict[str, MovingCache | StaticCache | None] = {}
        # Who has said where a frame is, and when.
        self._said: dict[str, tuple[str, float]] = {}
        self.moves: dict[str, deque[tuple[float, str, str]]] = {}
        self._lock = threading.RLock()

    def __contains__(self, frame: str) -> bool:
        return frame in self._frames

    def names(self) -> list[str]:
        """Return all frames, in the order in which they were first named."""
        with self._lock:
            return list(self._frames)

    def insert(
        self, child: str, time: int, sample: Sample, *, authority: str, is_static: bool
    ) -> bool:
        """Note where a frame is in its parent.

        Args:
            child: The frame.
            time: When.
            sample: Where.
            authority: Who says so.
            is_static: Whether it is there at any time.

        Returns:
            Whether it is new enough to be remembered.
        """
        with self._lock:
            now = clocks.monotonic()
            cache = self._frames.get(child)
            before = cache.latest_parent if cache is not None else ''
            if before and before != sample.parent:
                moves = self.moves.setdefault(child, deque(maxlen=_MOVES))
                moves.append((now, before, sample.parent))
            if cache is None or isinstance(cache, StaticCache) is not is_static:
                cache = StaticCache(sample) if is_static else MovingCache(self._limit)
                self._frames[child] = cache
            self._frames.setdefault(sample.parent, None)
            is_new = cache.insert(time, sample)
            if is_new:
                self._said[child] = authority, now
            return is_new

    def clear(self) -> None:
        """Forget where moving frames were; their names stay, and static frames, too."""
        with self._lock:
            for cache in self._frames.values():
                if cache is not None:
                    cache.clear()

    # -- looking --------------------------------------------------------------------------------

    def look(self, target: str, source: str, time: int) -> tuple[int, Place]:
        """Return the time that was found, and where `source` is in `target`.

        Raises:
            TransformException: It is not known.
        """
        with self._lock:
            if target == source:
                cache = self._frames.get(target)
                newest = cache.latest if cache is not None else 0
                return time or newest, _HERE
            self._check(target_frame=target, source_frame=source)
            time, up, down = self._way(target, source, time)
        if not down:
            place, turn = _composed(up)
        else:
            origin, forth = _composed(down)
            turn = inverse(forth)
            place = rotated(turn, (-origin[0], -origin[1], -origin[2]))
            if up:
                start, first = _composed(up)
                place = _sum(rotated(turn, start), place)
                turn = product(turn, first)
        # tf2 makes a matrix of it, and a quaternion again.
        return time, (place, normalized(matrix(turn)))

    def look_full(
        self, target: str, target_time: int, source: str, source_time: int, fixed: str
    ) -> tuple[int, Place]:
        """Return where `source` was at its time in `target` at its time; see `look`.

        Args:
            target: A frame.
            target_time: Its time.
            source: Another one.
            source_time: Its time.
            fixed: One that does not move meanwhile.
        """
        with self._lock:
            self._check(target_frame=target, source_frame=source, fixed_frame=fixed)
            _, (start, turn) = self.look(fixed, source, source_time)
            found, (shift, back) = self.look(target, fixed, target_time)
        last = matrix(back)
        x, y, z = (sum(map(mul, row, start)) for row in last)
        return found, (_sum((x, y, z), shift), normalized(_multiplied(last, matrix(turn))))

    def why_unknown(self, **frames: str) -> str:
        """Return what is wrong with the first of some names, '' if they are all known."""
        for argument, frame in frames.items():
            why = _bad_name(frame) or 'frame does not exist' * (frame not in self)
            if why:
                where = f'canTransform argument {argument}'
                return f'Invalid frame ID "{frame}" passed to {where} - {why}'
        return ''

    def why_not(self, target: str, source: str, time: int) -> str:
        """Return why `look` would raise for two known frames, '' if it would not."""
        try:
            with self._lock:
                if target != source:
                    self._way(target, source, time)
        except TransformException as error:
            return str(error)
        return ''

    def check_frame(self, where: str, frame: str) -> None:
        """Raise an exception unless a frame is known.

        Args:
            where: What it was given to.
            frame: Its name.
        """
        if why := _bad_name(frame):
            raise InvalidArgumentException(f'Invalid argument "{frame}" passed to {where} - {why}')
        if frame not in self:
            raise LookupException(f'"{frame}" passed to {where} does not exist. ')

    def latest_common_time(self, target: str, source: str) -> int:
        """Return the latest time for which the way between known frames is known.

        It is 0 if the frames on the way are static.

        Raises:
            TransformException: They are not connected.
        """
        with self._lock:
            if source == target:
                return self._latest(source)[0]
            ways: list[tuple[int, str]] = []
            frame = source
            while (step := self._latest(frame))[1]:
                ways.append(step)
                frame = step[1]
                if frame == target:
                    return _earliest(ways)
                if len(ways) > MAX_DEPTH:
                    raise self._loop()
            parents = [parent for _, parent in ways]
            others: list[tuple[int, str]] = []
            frame = target
            while (step := self._latest(frame))[1]:
                others.append(step)
                frame = step[1]
                if frame in parents:
                    return _earliest([*others, *ways[: parents.index(frame) + 1]])
                if frame == source:
                    return _earliest(others)
                if len(others) > MAX_DEPTH:
                    raise self._loop()
        raise _unconnected(target, source)

    def _latest(self, frame: str) -> tuple[int, str]:
        """Return the time of the newest sample and the parent in it, '' if there is none."""
        cache = self._frames[frame]
        return (cache.latest, cache.latest_parent) if cache is not None else (0, '')

    def _way(self, target: str, source: str, time: int) -> tuple[int, list[Sample], list[Sample]]:
        """Return the time that was found, and the steps up to where two ways meet.

        The first steps lead from `source`, the second ones from `target`.
        """
        if time == 0:
            time = self.latest_common_time(target, source)
        up: list[Sample] = []
        late: ExtrapolationException | None = None
        top = source
        while (cache := self._frames[top]) is not None:
            try:
                sample = cache.at(time)
            except ExtrapolationException as error:
                late = error  # there may still be a way
                break
            if top == target:
                return time, up, []
            up.append(sample)
            top = sample.parent
            if len(up) > MAX_DEPTH:
                raise self._loop()
        down: list[Sample] = []
        frame = target
        while frame != top and (cache := self._frames[frame]) is not None:
            try:
                sample = cache.at(time)
            except ExtrapolationException as error:
                raise _when_looking(error, target, source) from None
            if frame == source:
                return time, [], down
            down.append(sample)
            frame = sample.parent
            if len(down) > MAX_DEPTH:
                raise self._loop()
        if frame == top:
            return time, up, down
        if late is not None:
            raise _when_looking(late, target, source)
        raise _unconnected(target, source)

    def _check(self, **frames: str) -> None:
        for argument, frame in frames.items():
            self.check_frame(f'lookupTransform argument {argument}', frame)

    def _loop(self) -> LookupException:
        return LookupException(
            f'The tf tree is invalid because it contains a loop.\n{self.as_string()}\n'
        )

    # -- all of it ------------------------------------------------------------------------------

    def as_string(self) -> str:
        """Return a sentence for each frame that has, or had, a parent."""
        with self._lock:
            return ''.join(
                f'Frame {name} exists with parent {cache.latest_parent or NO_PARENT}.\n'
                for name, cache in self._frames.items()
                if cache is not None
            )

    def as_yaml(self) -> str:
        """Return what is known of each frame: its parent, who says so, how often, since when."""
        if not self._frames:
            return '[]'
        return ''.join(
            f'{edge.child}: \n'
            f"  parent: '{edge.parent}'\n"
            f"  broadcaster: '{edge.authority}'\n"
            f'  rate: {edge.rate:.3f}\n'
            f'  most_recent_transform: {shown_time(edge.latest)}\n'
            f'  oldest_transform: {shown_time(edge.oldest)}\n'
            f'  buffer_length: {(edge.latest - edge.oldest) / NANOSECONDS:.3f}\n'
            for edge in self.edges()
        )

    def edges(self) -> list[Edge]:
        """Return what is known of each frame that has a parent."""
        with self._lock:
            return [
                Edge(
                    child=name,
                    parent=cache.latest_parent,
                    authority=self._said[name][0],
                    rate=len(cache) * 1e9 / max(cache.latest - cache.oldest, 100_000),
                    latest=cache.latest,
                    oldest=cache.oldest,
                    heard=self._said[name][1],
                )
                for name, cache in self._frames.items()
                if cache  # one without samples is false
            ]

    def chain(self, target: str, source: str) -> list[str]:
        """Return the frames on the way between two, both included, at the latest time.

        Raises:
            TransformException: It is not known.
        """
        with self._lock:
            self._check(target_frame=target, source_frame=source)
            if target == source:
                return [target]
            _, up, down = self._way(target, source, 0)
        ways = [source, *(step.parent for step in up)], [target, *(step.parent for step in down)]
        # Where the way down ends, the way up has been.
        return [*ways[0], *reversed(ways[1][:-1])] if up else ways[1][::-1]


def _bad_name(frame: str) -> str:
    """Return why no frame has this name, '' if one may have it."""
    if not frame:
        return 'in tf2 frame_ids cannot be empty'
    return "in tf2 frame_ids cannot start with a '/'" if frame.startswith('/') else ''


def _when_looking(
    error: ExtrapolationException, target: str, source: str
) -> ExtrapolationException:
    return ExtrapolationException(
        f'{error}, when looking up transform from frame [{source}] to frame [{target}]'
    )


def _unconnected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part "
        'of the same tree.Tf has two or more unconnected trees.'
    )


def _earliest(steps: Iterable[tuple[int, str]]) -> int:
    """Return the earliest time of some steps; one of 0 is that of a static frame."""
    return min((time for time, _ in steps if time), default=0)


def _sum(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _composed(steps: list[Sample]) -> Place:
    """Return where the first frame of a way is in the last one."""
    _, origin, turn = steps[0]
    for _, shift, further in steps[1:]:
        origin = _sum(rotated(further, origin), shift)
        turn = product(further, turn)
    return origin, turn


def _multiplied(a: Matrix, b: Matrix) -> Matrix:
    columns = tuple(zip(*b, strict=True))
    return cast(Matrix, tuple(tuple(sum(map(mul, row, one)) for one in columns) for row in a))
