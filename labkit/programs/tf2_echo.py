"""`ros2 run tf2_ros tf2_echo`: print where one frame is in another one, again and again.

It does what the real one does (ros2/geometry2, branch jazzy, tf2_ros/src/tf2_echo.cpp), for
machines where that is not installed. A time has all its digits: of 1.000000005 s the real one
makes 1.5.
"""

from __future__ import annotations

import math
import re
import sys
from typing import Any

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from rclpy.utilities import remove_ros_args

from labkit.errors import LabError
from labkit.programs.program import spin_until_interrupted
from labkit.transforms.buffer import Buffer
from labkit.transforms.exceptions import TransformException
from labkit.transforms.rotations import matrix, to_rpy
from labkit.transforms.transform_listener import TransformListener

__all__ = ['Echo', 'described', 'main']

USAGE = """Usage: tf2_echo source_frame target_frame [echo_rate]

This will echo the transform from the coordinate frame of the source_frame
to the coordinate frame of the target_frame.
Note: This is the transform to get data from target_frame into the source_frame.
Default echo rate is 1 if echo_rate is not given."""
# What `std::stof` takes, at the beginning of a text.
_NUMBER = re.compile(r'\s*[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?', re.IGNORECASE)


class Echo(Node):
    """Prints a transform.

    Args:
        source: The frame in which data are wanted.
        target: The frame in which they are given.
        rate: How often, Hz.
    """

    def __init__(self, source: str, target: str, rate: float) -> None:
        super().__init__('tf2_echo')
        self._asked = source, target
        self._has_begun = False
        self._buffer = Buffer()
        TransformListener(self._buffer, self)
        self.create_timer(1 / rate, self._on_timer)

    def _on_timer(self) -> None:
        source, target = self._asked
        if not self._has_begun:
            self._has_begun, why = self._buffer.can_transform_core(source, target, Time())
            if not self._has_begun:
                words = f'Waiting for transform {source} ->  {target}: {why}'
                log: Any = self.get_logger()  # type: ignore[no-untyped-call]
                log.info(words, throttle_duration_sec=1.0)
                return
        try:
            print(
                described(self._buffer.lookup_transform_core(source, target, Time())), flush=True
            )
        except TransformException as error:
            now = self.get_clock().now().nanoseconds * 1e-9
            print(
                f'Failure at {now:.3f}\nException thrown:{error}\nThe current list of frames is:'
            )
            print(self._buffer.all_frames_as_string(), flush=True)


def described(found: TransformStamped) -> str:
    """Return a transform in all forms: quaternion, angles, matrix."""
    stamp, shift, turn = found.header.stamp, found.transform.translation, found.transform.rotation
    place = (shift.x, shift.y, shift.z)
    quaternion = (turn.x, turn.y, turn.z, turn.w)
    rows = matrix(quaternion)
    angles = to_rpy(rows)
    in_rows = [(*row, part) for row, part in zip(rows, place, strict=True)]
    lines = [
        f'At time {stamp.sec}.{stamp.nanosec:09}',
        f'- Translation: {_listed(place)}',
        f'- Rotation: in Quaternion {_listed(quaternion)}',
        f'- Rotation: in RPY (radian) {_listed(angles)}',
        f'- Rotation: in RPY (degree) {_listed(tuple(map(math.degrees, angles)))}',
        '- Matrix:',
        *(''.join(f' {part:6.3f}' for part in row) for row in [*in_rows, (0, 0, 0, 1)]),
    ]
    return '\n'.join(lines)


def _listed(numbers: tuple[float, ...]) -> str:
    return f'[{", ".join(f"{number:.3f}" for number in numbers)}]'


def _rate(text: str) -> float:
    """Return a rate, Hz; end the program with the words and the code of the real one."""
    found = _NUMBER.match(text)
    if found is None or found.end() < len(text):
        words = f"Failed to convert rate argument '{text}' to a floating-point number"
        print(words, file=sys.stderr)
        sys.exit(2 if found is None else 3)
    rate = float(text)
    if rate <= 0:
        sys.exit(f'echo_rate is how often it prints in a second, more than 0, but it is {text}.')
    return rate


def main() -> None:
    """Print until it is interrupted."""
    words = remove_ros_args(sys.argv)[1:]
    if len(words) not in (2, 3):
        print(USAGE)
        sys.exit(1)
    rate = _rate(words[2]) if len(words) == 3 else 1.0
    rclpy.init(args=sys.argv)
    try:
        node = Echo(words[0], words[1], rate)
    except LabError as error:
        rclpy.shutdown()
        sys.exit(str(error))
    spin_until_interrupted(node)


if __name__ == '__main__':
    main()
