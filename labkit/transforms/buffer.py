"""The buffer that programs use: it waits for transforms, and forgets them when time goes back.

A wait ends as soon as a transform comes, not 20 ms later as the real one's may. Its time is the
computer's, as the real one's is. In a callback of the thread that would hear the transform the
real one waits in vain; this one does not wait there, and says so.
"""

from __future__ import annotations

import time as clocks
from collections.abc import Callable
from typing import Any, cast

from geometry_msgs.msg import TransformStamped
from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.task import Future

from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import quoted
from labkit.transforms.buffer_core import BufferCore
from labkit.transforms.buffer_interface import BufferInterface
from labkit.transforms.cache import NANOSECONDS
from labkit.transforms.exceptions import TransformException

__all__ = ['Buffer']

_NO_TIME = Duration()
_Answer = tuple[bool, str]
_Pair = tuple[str, str]
# A future, the pairs of frames between which it waits, and since when.
_Wanted = tuple[Future, tuple[_Pair, ...], float]
# Pairs of frames that are remembered of those that were asked for in vain.
_MOST_PAIRS = 50
# What was asked for in vain, and not again for so long, is not wanted any more, s.
WANTED_SEC = 3.0
IN_VAIN = (
    'It was not waited for: a callback asked, and no transform is heard until it returns. Ask '
    'again in the next callback, or in one that is `async def`: '
    'await buffer.lookup_transform_async(...).'
)


class Buffer(BufferCore, BufferInterface):
    """The frames, and what is known of them.

    Args:
        cache_time: How long moving frames are remembered, from the newest transform back;
            10 s by default.
        node: Serves `tf2_frames` (tf2_msgs/srv/FrameGraph), which tells all frames. When its
            time goes back, the buffer forgets where moving frames were.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._waiting: dict[Callable[[], None], _Wanted] = {}
        # What callbacks have asked for in vain: frames -> since when, and when for the last time.
        self._in_vain: dict[_Pair, tuple[float, float]] = {}
        if node is not None:
            # Built when it is first asked for.
            from tf2_msgs.srv import FrameGraph

            self.srv = node.create_service(FrameGraph, 'tf2_frames', self._on_frames)
        self.clock = node.get_clock() if node is not None else Clock()
        threshold = JumpThreshold(
            min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        self.jump_handle = self.clock.create_jump_callback(
            threshold, post_callback=self.time_jump_callback
        )

    def _on_frames(self, request: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def time_jump_callback(self, time_jump: TimeJump) -> None:
        """Forget where moving frames were, because time has gone back."""
        # A check sets the clock as well, and never back.
        if time_jump.delta.nanoseconds < 0:
            words = 'Detected jump back in time. Clearing tf buffer.'
            get_logger('tf2_buffer').warning(words)  # type: ignore[no-untyped-call]
            self.clear()

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Note where a frame is in its parent, see `BufferCore`."""
        super().set_transform(transform, authority)
        self._tell()

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Note where a frame is in its parent at any time, see `BufferCore`."""
        super().set_transform_static(transform, authority)
        self._tell()

    # -- now, or after a wait -------------------------------------------------------------------

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Duration = _NO_TIME
    ) -> TransformStamped:
        """Return the transform that takes what is given in one frame to another.

        Args:
            target_frame: The frame to which it leads.
            source_frame: The frame in which something is given.
            time: When; `Time()`, 0, for the latest time for which all is known.
            timeout: How long to wait for it. In a callback there is no wait.

        Raises:
            LookupException: A frame is not known.
            ConnectivityException: The frames are not connected.
            ExtrapolationException: Nothing is known for that time.
            InvalidArgumentException: A name is empty or begins with a slash.
        """
        asked = target_frame, source_frame, time
        self._wait(lambda: self.can_transform_core(*asked), timeout)
        pairs = ((target_frame, source_frame),)
        return self._found(lambda: self.lookup_transform_core(*asked), timeout, pairs)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = _NO_TIME,
    ) -> TransformStamped:
        """Return the transform from a frame at one time to another one at another time.

        Args:
            target_frame: The frame to which it leads.
            target_time: When it is looked at; 0 for the latest time.
            source_frame: The frame in which something is given.
            source_time: When that was; 0 for the latest time.
            fixed_frame: A frame that does not move meanwhile.
            timeout: How long to wait for it. In a callback there is no wait.

        Raises:
            TransformException: As `lookup_transform`.
        """
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        self._wait(lambda: self.can_transform_full_core(*asked), timeout)
        pairs = ((target_frame, fixed_frame), (fixed_frame, source_frame))
        return self._found(lambda: self.lookup_transform_full_core(*asked), timeout, pairs)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Duration = _NO_TIME,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether a transform is known.

        Args:
            target_frame: The frame to which it leads.
            source_frame: The frame in which something is given.
            time: When; 0 for the latest time for which all is known.
            timeout: How long to wait for it. In a callback there is no wait.
            return_debug_tuple: Whether to return a pair with the reason.
        """
        asked = target_frame, source_frame, time
        answer = self._wait(lambda: self.can_transform_core(*asked), timeout)
        if not answer[0]:
            self._note((target_frame, source_frame))
        return answer if return_debug_tuple else answer[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = _NO_TIME,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether a transform between two times is known.

        Args:
            target_frame: The frame to which it leads.
            target_time: When it is looked at; 0 for the latest time.
            source_frame: The frame in which something is given.
            source_time: When that was; 0 for the latest time.
            fixed_frame: A frame that does not move meanwhile.
            timeout: How long to wait for it. In a callback there is no wait.
            return_debug_tuple: Whether to return a pair with the reason.
        """
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        answer = self._wait(lambda: self.can_transform_full_core(*asked), timeout)
        if not answer[0]:
            self._note((target_frame, fixed_frame), (fixed_frame, source_frame))
        return answer if return_debug_tuple else answer[0]

    def _wait(self, look: Callable[[], _Answer], timeout: Duration) -> _Answer:
        if not isinstance(timeout, Duration):
            raise TypeError(
                f'timeout is an rclpy.duration.Duration, but it is {quoted(timeout)}. '
                'Write timeout=Duration(seconds=1.0).'
            )
        answer = look()
        if not answer[0] and timeout.nanoseconds > 0 and not runtime.called_by_callback():
            wait = runtime.wait if runtime.started else wait_for
            wait(lambda: look()[0], timeout.nanoseconds / NANOSECONDS)
            answer = look()
        return answer

    def _found(
        self, look: Callable[[], TransformStamped], timeout: Duration, pairs: tuple[_Pair, ...]
    ) -> TransformStamped:
        try:
            return look()
        except TransformException as error:
            self._note(*pairs)
            if timeout.nanoseconds > 0 and runtime.called_by_callback():
                raise type(error)(error.message, todo=IN_VAIN) from None
            raise

    # -- in vain --------------------------------------------------------------------------------

    def _note(self, *pairs: _Pair) -> None:
        """Note what a callback has asked for in vain; a cell is told by the error itself."""
        if not runtime.called_by_callback():
            return
        now = clocks.monotonic()
        for pair in pairs:
            first, last = self._in_vain.get(pair, (now, now))
            if pair in self._in_vain or len(self._in_vain) < _MOST_PAIRS:
                self._in_vain[pair] = (first if now - last < WANTED_SEC else now, now)

    def in_vain(self) -> dict[_Pair, float]:
        """Return the pairs of frames between which callbacks look, or wait, without success.

        Returns:
            For how long, in s; of those who look again and again, since they began.
        """
        now = clocks.monotonic()
        found = {
            pair: last - first
            for pair, (first, last) in tuple(self._in_vain.items())
            if now - last < WANTED_SEC
        }
        for future, pairs, since in tuple(self._waiting.values()):
            if not future.cancelled():  # type: ignore[no-untyped-call]
                found.update(dict.fromkeys(pairs, now - since))
        return found

    # -- in coroutines --------------------------------------------------------------------------

    async def lookup_transform_async(
        self, target_frame: str, source_frame: str, time: Any
    ) -> TransformStamped:
        """Wait in a coroutine for a transform, and return it; see `lookup_transform`."""
        return await self.wait_for_transform_async(target_frame, source_frame, time)

    async def lookup_transform_full_async(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> TransformStamped:
        """Wait in a coroutine for a transform, and return it; see `lookup_transform_full`."""
        return await self.wait_for_transform_full_async(
            target_frame, target_time, source_frame, source_time, fixed_frame
        )

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Future:
        """Return a future that gets the transform when it is known.

        Args:
            target_frame: The frame to which it leads.
            source_frame: The frame in which something is given.
            time: When; 0 for the latest time for which all is known.
        """
        asked = target_frame, source_frame, time
        return self._future(
            lambda: self.can_transform_core(*asked),
            lambda: self.lookup_transform_core(*asked),
            ((target_frame, source_frame),),
        )

    def wait_for_transform_full_async(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Future:
        """Return a future that gets the transform between two times when it is known.

        Args:
            target_frame: The frame to which it leads.
            target_time: When it is looked at; 0 for the latest time.
            source_frame: The frame in which something is given.
            source_time: When that was; 0 for the latest time.
            fixed_frame: A frame that does not move meanwhile.
        """
        asked = target_frame, target_time, source_frame, source_time, fixed_frame
        return self._future(
            lambda: self.can_transform_full_core(*asked),
            lambda: self.lookup_transform_full_core(*asked),
            ((target_frame, fixed_frame), (fixed_frame, source_frame)),
        )

    def _future(
        self,
        look: Callable[[], _Answer],
        find: Callable[[], TransformStamped],
        pairs: tuple[_Pair, ...],
    ) -> Future:
        future: Any = Future()  # type: ignore[no-untyped-call]

        def on_data() -> None:
            try:
                if not future.done() and not future.cancelled() and look()[0]:
                    future.set_result(find())
            except Exception as error:  # to be raised where it is awaited
                future.set_exception(error)
            if future.done() or future.cancelled():
                # Two threads may bring transforms at the same time.
                self._waiting.pop(on_data, None)

        self._waiting[on_data] = future, pairs, clocks.monotonic()
        on_data()
        return cast(Future, future)

    def _tell(self) -> None:
        for on_data in tuple(self._waiting):
            on_data()
