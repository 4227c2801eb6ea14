"""The buffer that does not wait: the tree of frames, with the types and the names of ROS.

What it accepts, and the words in which it says what it does not, are those of tf2:
ros2/geometry2, branch jazzy, tf2/src/buffer_core.cpp and tf2_py/src/tf2_py.cpp.
"""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.time import Time

from labkit.transforms.cache import NANOSECONDS, Sample, shown_time
from labkit.transforms.exceptions import TransformException
from labkit.transforms.rotations import Quaternion, Vector, matrix, normalized
from labkit.transforms.tree import Place, Tree

__all__ = ['BufferCore']

# How long a moving frame is remembered, ns.
CACHE_TIME = 10 * NANOSECONDS
# How far the square of a quaternion's length may be from 1.
TOLERANCE = 10e-3


class BufferCore:
    """A tree of frames in time.

    Args:
        cache_time: How long moving frames are remembered, from the newest transform back;
            10 s by default.
    """

    def __init__(self, cache_time: Duration | None = None) -> None:
        self.tree = Tree(CACHE_TIME if cache_time is None else _ns(cache_time, 'duration'))

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Note where a frame is in its parent.

        What is no transform is ignored, and an error is logged: a frame in itself, no name, NaN,
        a quaternion of length 0, a time before all that is remembered.

        Args:
            transform: From `header.frame_id`, the parent, to `child_frame_id`.
            authority: Who says so.
        """
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Note where a frame is in its parent at any time; otherwise as `set_transform`."""
        self._set(transform, authority, is_static=True)

    def clear(self) -> None:
        """Forget where moving frames were; their names stay, and static frames, too."""
        self.tree.clear()

    def _set(self, transform: TransformStamped, authority: str, *, is_static: bool) -> None:
        header, place = transform.header, transform.transform
        parent = header.frame_id.removeprefix('/')
        child = transform.child_frame_id.removeprefix('/')
        time = header.stamp.sec * NANOSECONDS + header.stamp.nanosec
        shift, turn = place.translation, place.rotation
        translation = (shift.x, shift.y, shift.z)
        # tf2 makes a matrix of it, which is that of the quaternion with length 1.
        rotation = normalized(matrix((turn.x, turn.y, turn.z, turn.w)))
        wrong = _problems(parent, child, translation, rotation, authority)
        for words in wrong:
            self._refuse(words)
        if wrong:
            return
        sample = Sample(parent, translation, rotation)
        if not self.tree.insert(child, time, sample, authority=authority, is_static=is_static):
            self._warn(
                f'TF_OLD_DATA ignoring data from the past for frame {child} at time '
                f'{shown_time(time)} according to authority {authority}\nPossible reasons are '
                'listed at http://wiki.ros.org/tf/Errors%20explained'
            )

    def in_vain(self) -> dict[tuple[str, str], float]:
        """Return the pairs of frames between which callbacks look in vain: not noted here."""
        return {}

    def _refuse(self, words: str) -> None:
        get_logger('tf2').error(words)  # type: ignore[no-untyped-call]

    def _warn(self, words: str) -> None:
        get_logger('tf2').warning(words)  # type: ignore[no-untyped-call]

    # -- looking --------------------------------------------------------------------------------

    def lookup_transform_core(
        self, target_frame: str, source_frame: str, time: Any
    ) -> TransformStamped:
        """Return the transform that takes what is given in one frame to another, without waiting.

        Args:
            target_frame: The frame to which it leads.
            source_frame: The frame in which something is given.
            time: When; 0 for the latest time for which all is known.

        Raises:
            LookupException: A frame is not known.
            ConnectivityException: The frames are not connected.
            ExtrapolationException: Nothing is known for that time.
            InvalidArgumentException: A name is empty or begins with a slash.
        """
        found, place = self.tree.look(target_frame, source_frame, _ns(time))
        return _message(target_frame, source_frame, found, place)

    def lookup_transform_full_core(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> TransformStamped:
        """Return the transform from a frame at one time to another one at another time.

        Args:
            target_frame: The frame to which it leads.
            target_time: When it is looked at; 0 for the latest time.
            source_frame: The frame in which something is given.
            source_time: When that was; 0 for the latest time.
            fixed_frame: A frame that does not move meanwhile.

        Raises:
            TransformException: As `lookup_transform_core`.
        """
        found, place = self.tree.look_full(
            target_frame, _ns(target_time), source_frame, _ns(source_time), fixed_frame
        )
        return _message(target_frame, source_frame, found, place)

    def can_transform_core(
        self, target_frame: str, source_frame: str, time: Any
    ) -> tuple[bool, str]:
        """Return whether a transform is known, without waiting, and if not, why.

        Args:
            target_frame: The frame to which it leads.
            source_frame: The frame in which something is given.
            time: When; 0 for the latest time for which all is known.
        """
        asked = target_frame, source_frame, _ns(time)
        if target_frame == source_frame:
            return True, ''
        why = self.tree.why_unknown(target_frame=target_frame, source_frame=source_frame)
        return _answer(why or self.tree.why_not(*asked))

    def can_transform_full_core(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> tuple[bool, str]:
        """Return whether a transform between two times is known, and if not, why.

        Args:
            target_frame: The frame to which it leads.
            target_time: When it is looked at; 0 for the latest time.
            source_frame: The frame in which something is given.
            source_time: When that was; 0 for the latest time.
            fixed_frame: A frame that does not move meanwhile.
        """
        second = target_frame, fixed_frame, _ns(target_time)
        first = fixed_frame, source_frame, _ns(source_time)
        why = self.tree.why_unknown(
            target_frame=target_frame, source_frame=source_frame, fixed_frame=fixed_frame
        )
        return _answer(why or self.tree.why_not(*second) or self.tree.why_not(*first))

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Time:
        """Return the latest time for which the way between two frames is known.

        Args:
            target_frame: One frame.
            source_frame: The other one.

        Raises:
            TransformException: A frame is not known, or they are not connected.
        """
        for frame in (target_frame, source_frame):
            self.tree.check_frame('get_latest_common_time', frame)
        try:
            found = self.tree.latest_common_time(target_frame, source_frame)
        except TransformException as error:
            raise TransformException(str(error)) from None
        return Time(nanoseconds=found)

    # -- names ----------------------------------------------------------------------------------

    def all_frames_as_string(self) -> str:
        """Return a sentence for each frame that has a parent."""
        return self.tree.as_string()

    def all_frames_as_yaml(self) -> str:
        """Return what is known of each frame: its parent, who says so, how often, since when."""
        return self.tree.as_yaml()

    # These names of the real one are used by programs, too.

    def _frameExists(self, frame_id: str) -> bool:
        return frame_id in self.tree

    def _getFrameStrings(self) -> list[str]:
        return self.tree.names()


def _ns(time: Any, what: str = 'time') -> int:
    """Return a time or a duration in ns: of rclpy, or a message of one."""
    if hasattr(time, 'sec') and hasattr(time, 'nanosec'):
        return int(time.sec) * NANOSECONDS + int(time.nanosec)
    if hasattr(time, 'nanoseconds'):
        return int(time.nanoseconds)
    raise TypeError(f'{what} must have sec and nanosec, or nanoseconds.')


def _answer(why: str) -> tuple[bool, str]:
    return not why, why


def _problems(
    parent: str, child: str, translation: Vector, rotation: Quaternion, authority: str
) -> list[str]:
    """Return why a transform can't be used, in the words of tf2."""
    squares = sum([part * part for part in rotation])
    is_unit = abs(squares - 1.0) < TOLERANCE
    if is_unit and child != parent and child and parent and not math.isnan(sum(translation)):
        return []  # as nearly all are
    found = []
    if child == parent:
        found.append(
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id '
            f'and  child_frame_id "{child}" because they are the same'
        )
    if not child:
        found.append(
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because '
            'child_frame_id not set '
        )
    if not parent:
        found.append(
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority '
            f'"{authority}" because frame_id not set'
        )
    if any(part != part for part in (*translation, *rotation)):
        shift, turn = (
            ' '.join(f'{part:f}' for part in parts) for parts in (translation, rotation)
        )
        found.append(
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" from authority '
            f'"{authority}" because of a nan value in the transform ({shift}) ({turn})'
        )
    if not is_unit:
        turn = ' '.join(f'{part:f}' for part in rotation)
        found.append(
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" from '
            f'authority "{authority}" because of an invalid quaternion in the transform ({turn})'
        )
    return found


def _message(target: str, source: str, time: int, place: Place) -> TransformStamped:
    found = TransformStamped()
    found.header.frame_id, found.child_frame_id = target, source
    stamp = found.header.stamp
    stamp.sec, stamp.nanosec = divmod(time, NANOSECONDS)
    shift, turn = found.transform.translation, found.transform.rotation
    (shift.x, shift.y, shift.z), (turn.x, turn.y, turn.z, turn.w) = place
    return found
