"""`ros2 run tf2_ros static_transform_publisher`: say where a frame is that does not move.

It does what the real one does (ros2/geometry2, branch jazzy, tf2_ros/src:
static_transform_broadcaster_program.cpp and _node.cpp), for machines where that is not installed.
"""

from __future__ import annotations

import random
import string
import sys
from dataclasses import dataclass, field
from typing import Any

import rclpy
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from labkit.errors import LabError
from labkit.programs.program import spin_until_interrupted
from labkit.transforms.rotations import from_rpy
from labkit.transforms.static_transform_broadcaster import StaticTransformBroadcaster

__all__ = ['StaticTransform', 'main', 'read']

USAGE = """\
usage: static_transform_publisher [--x X] [--y Y] [--z Z] [--qx QX] [--qy QY] [--qz QZ] [--qw QW] \
[--roll ROLL] [--pitch PITCH] [--yaw YAW] --frame-id FRAME_ID --child-frame-id CHILD_FRAME_ID

A command line utility for manually sending a static transform.

If no translation or orientation is provided, the identity transform will be published.

The translation offsets are in meters.

The rotation may be provided with roll, pitch, yaw euler angles in radians, or as a quaternion.

required arguments:
  --frame-id FRAME_ID parent frame
  --child-frame-id CHILD_FRAME_ID child frame id

optional arguments:
  --x X                 x component of translation
  --y Y                 y component of translation
  --z Z                 z component of translation
  --qx QX               x component of quaternion rotation
  --qy QY               y component of quaternion rotation
  --qz QZ               z component of quaternion rotation
  --qw QW               w component of quaternion rotation
  --roll ROLL           roll component Euler rotation
  --pitch PITCH         pitch component Euler rotation
  --yaw YAW             yaw component Euler rotation"""
SHIFT, TURN, ANGLES = ('x', 'y', 'z'), ('qx', 'qy', 'qz', 'qw'), ('roll', 'pitch', 'yaw')
FRAMES = ('frame-id', 'child-frame-id')
# Without flags; the angles are in the other order.
OLD: tuple[tuple[str, ...], ...] = (
    (*SHIFT, 'yaw', 'pitch', 'roll', *FRAMES),
    (*SHIFT, *TURN, *FRAMES),
)


@dataclass
class StaticTransform:
    """What the command line says.

    Attributes:
        numbers: Numbers, by their names; those that are not given are missing.
        frames: The names of the frame and of its child.
    """

    numbers: dict[str, float] = field(default_factory=dict)
    frames: dict[str, str] = field(default_factory=dict)

    @property
    def shift(self) -> tuple[float, ...]:
        """The place, m."""
        return tuple(self.numbers.get(name, 0.0) for name in SHIFT)

    @property
    def turn(self) -> tuple[float, ...]:
        """The quaternion."""
        if any(name in self.numbers for name in ANGLES):
            return from_rpy(*(self.numbers.get(name, 0.0) for name in ANGLES))
        return tuple(self.numbers.get(name, float(name == 'qw')) for name in TURN)

    def set(self, name: str, text: str, shown: str) -> None:
        """Note one argument; `shown` is how an error names it."""
        if name in FRAMES:
            self.frames[name] = text
            return
        try:
            self.numbers[name] = float(text)
        except ValueError:
            raise LabError(f'Failed to parse {shown} argument as float') from None


def read(words: list[str]) -> StaticTransform:
    """Return what the words of the command line say.

    Raises:
        LabError: They make no sense; in the words of the real one.
    """
    found, plain = StaticTransform(), []
    left = list(words)
    while left:
        word = left.pop(0)
        name = word.removeprefix('--')
        if not word.startswith('--') or name not in (*SHIFT, *TURN, *ANGLES, *FRAMES):
            plain.append(word)
            continue
        if not left:
            raise LabError(f'Not enough arguments for {word}')
        found.set(name, left.pop(0), word)
    if any(name in found.numbers for name in ANGLES) and any(n in found.numbers for n in TURN):
        raise LabError('Cannot specify both quaternion and Euler rotations')
    names = next((names for names in OLD if len(names) == len(plain)), ())
    if names:
        get_logger('static_transform_publisher').warning(  # type: ignore[no-untyped-call]
            'Old-style arguments are deprecated; see --help for new-style arguments'
        )
        if found.frames or any(name in found.numbers for name in (*SHIFT, *TURN)):
            raise LabError('Cannot specify both new-style (flags) and old-style (arguments)')
        for name, text in zip(names, plain, strict=True):
            found.set(name, text, name)
    elif plain:
        raise LabError('Extra unparsed arguments on command-line')
    for name, shown in zip(FRAMES, ('Frame', 'Child frame'), strict=True):
        if not found.frames.get(name):
            raise LabError(f'{shown} id must not be empty')
    return found


class StaticTransformPublisher(Node):
    """Publishes one static transform, and has its parts as parameters."""

    def __init__(self, wanted: StaticTransform) -> None:
        letters = random.choices(string.ascii_letters + string.digits, k=16)
        super().__init__(f'static_transform_publisher_{"".join(letters)}')
        parent, child = (wanted.frames[name] for name in FRAMES)
        found = TransformStamped()
        found.header.stamp = self.get_clock().now().to_msg()
        found.header.frame_id, found.child_frame_id = parent, child
        shift, turn = found.transform.translation, found.transform.rotation
        shift.x, shift.y, shift.z = wanted.shift
        turn.x, turn.y, turn.z, turn.w = wanted.turn
        read_only = ParameterDescriptor(read_only=True)
        for kind, part in (('translation', shift), ('rotation', turn)):
            for axis in part.get_fields_and_field_types():
                self.declare_parameter(f'{kind}.{axis}', getattr(part, axis), read_only)
        self.declare_parameter('frame_id', parent, read_only)
        self.declare_parameter('child_frame_id', child, read_only)
        log: Any = self.get_logger()  # type: ignore[no-untyped-call]
        if parent == child:
            log.error(f"cannot publish static transform from '{parent}' to '{child}', exiting")
            raise LabError('child_frame_id cannot equal frame_id')
        StaticTransformBroadcaster(self).sendTransform(found)
        log.info(
            'Spinning until stopped - publishing transform\n'
            f'translation: ({_quoted(wanted.shift)})\nrotation: ({_quoted(wanted.turn)})\n'
            f"from '{parent}' to '{child}'"
        )


def _quoted(numbers: tuple[float, ...]) -> str:
    return ', '.join(f"'{number:f}'" for number in numbers)


def main() -> None:
    """Publish until it is interrupted."""
    words = remove_ros_args(sys.argv)[1:]
    if {'-h', '--help'} & {*words}:
        print(USAGE)
        return
    rclpy.init(args=sys.argv)
    try:
        wanted = read(words)
    except LabError as error:
        get_logger('static_transform_publisher').error(
            f'error parsing command line arguments: {error}'
        )  # type: ignore[no-untyped-call]
        print(USAGE)
        rclpy.shutdown()
        sys.exit(1)
    try:
        node = StaticTransformPublisher(wanted)
    except LabError as error:
        rclpy.shutdown()
        sys.exit(str(error))
    spin_until_interrupted(node)


if __name__ == '__main__':
    main()
