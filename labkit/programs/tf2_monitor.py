"""`ros2 run tf2_ros tf2_monitor`: how late transforms are, and how often they come.

It does what the real one does (ros2/geometry2, branch jazzy, tf2_ros/src/tf2_monitor.cpp), for
machines where that is not installed. As that one, it can't tell who has sent a transform.
"""

from __future__ import annotations

import sys
from collections import deque
from typing import Any

import rclpy
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.time import Time
from rclpy.utilities import remove_ros_args

from labkit.errors import LabError
from labkit.programs.program import spin_until_interrupted
from labkit.transforms.buffer import Buffer
from labkit.transforms.cache import NANOSECONDS
from labkit.transforms.exceptions import TransformException
from labkit.transforms.transform_listener import TransformListener

__all__ = ['Monitor', 'main']

AUTHORITY = '<no authority available>'
# So many of the last delays count.
MOST = 1000
# It looks twice a second, and tells what it has seen after so many looks.
LOOK_SEC, LOOKS = 0.5, 21
# How much a new delay of the chain counts in the mean.
SHARE = 0.01


class Monitor(Node):
    """Prints what it has seen every ten seconds.

    Args:
        chain: Two frames between which the way is looked at; none for all frames.
    """

    def __init__(self, chain: tuple[str, str] | None) -> None:
        super().__init__('tf2_monitor_main')
        self._pair = chain
        self._chain: list[str] = []
        self._delays: dict[str, deque[float]] = {}
        self._means: deque[float] = deque(maxlen=MOST)
        self._times: deque[float] = deque(maxlen=MOST)
        self._chain_mean = self._chain_most = 0.0
        self._looks = 0
        self._has_begun = False
        self._buffer = Buffer()
        listener = TransformListener(self._buffer, self)
        for subscription in (listener.tf_sub, listener.tf_static_sub):
            put = subscription.callback
            subscription.callback = self._noting(put)
        self.create_timer(LOOK_SEC, self._on_timer)

    def _noting(self, put: Any) -> Any:
        def on_message(message: Any) -> None:
            put(message)
            self._note(message)

        return on_message

    def _now(self) -> float:
        return self.get_clock().now().nanoseconds / NANOSECONDS

    def _note(self, message: Any) -> None:
        now, late = self._now(), []
        for transform in message.transforms:
            stamp = transform.header.stamp
            late.append(now - stamp.sec - stamp.nanosec / NANOSECONDS)
            known = self._delays.setdefault(transform.child_frame_id, deque(maxlen=MOST))
            known.append(late[-1])
        self._means.append(sum(late) / max(1, len(late)))
        self._times.append(now)

    def _on_timer(self) -> None:
        if not self._has_begun and not self._begin():
            return
        if self._pair is not None:
            self._look_at_chain(*self._pair)
        self._looks += 1
        if self._looks == LOOKS:
            self._looks = 0
            print('\n'.join(self._results()), flush=True)

    def _begin(self) -> bool:
        """Return whether the frames are there; say so, or what is missing."""
        if self._pair is None:
            print('Gathering data on all frames for 10 seconds...', flush=True)
        else:
            first, second = self._pair
            known, why = self._buffer.can_transform_core(first, second, Time())
            if not known:
                words = f'Waiting for transform {first} ->  {second}: {why}'
                log: Any = self.get_logger()  # type: ignore[no-untyped-call]
                log.info(words, throttle_duration_sec=1.0)
                return False
            self._chain = self._buffer.tree.chain(second, first)
            print(f'Gathering data on {first} -> {second} for 10 seconds...', flush=True)
        self._has_begun = True
        return True

    def _look_at_chain(self, first: str, second: str) -> None:
        try:
            stamp = self._buffer.lookup_transform_core(first, second, Time()).header.stamp
        except TransformException as error:
            self.get_logger().warning(f'Transform Exception {error}')  # type: ignore[no-untyped-call]
            return
        late = self._now() - stamp.sec - stamp.nanosec / NANOSECONDS
        self._chain_mean += SHARE * (late - self._chain_mean)
        self._chain_most = max(self._chain_most, late)

    def _results(self) -> list[str]:
        lines = ['', '', '']
        if self._pair is None:
            lines.append('RESULTS: for all Frames')
        else:
            lines += [
                f'RESULTS: for {" to ".join(self._pair)}',
                f'Chain is: {" -> ".join(self._chain)}',
                f'Net delay     avg = {self._chain_mean:g}: max = {self._chain_most:g}',
            ]
        lines += ['', 'Frames:']
        for frame, delays in sorted(self._delays.items()):
            if self._pair is None or frame in self._chain:
                lines.append(f'Frame: {frame}, published by {AUTHORITY}, {_told(delays, ", ")}')
        lines += ['', 'All Broadcasters:']
        if self._times:
            rate = len(self._times) / max(1e-8, self._times[-1] - self._times[0])
            lines.append(f'Node: {AUTHORITY} {rate:g} Hz, {_told(self._means, " ")}')
        return lines


def _told(delays: deque[float], between: str) -> str:
    mean, most = sum(delays) / len(delays), max(0.0, *delays)
    return f'Average Delay: {mean:g}{between}Max Delay: {most:g}'


def main() -> None:
    """Print until it is interrupted."""
    words = remove_ros_args(sys.argv)[1:]
    rclpy.init(args=sys.argv)
    if len(words) not in (0, 2):
        log: Any = get_logger('tf2_monitor_main')
        log.info('TF_Monitor: usage: tf2_monitor framea frameb')
        rclpy.shutdown()
        sys.exit(255)
    try:
        node = Monitor((words[0], words[1]) if words else None)
    except LabError as error:
        rclpy.shutdown()
        sys.exit(str(error))
    spin_until_interrupted(node)


if __name__ == '__main__':
    main()
