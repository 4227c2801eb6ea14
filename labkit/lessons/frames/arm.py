"""An arm on the robot that says where its parts are, and is wrong about one of them."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from labkit.lessons.frames.places import TF, Place, on_floor

__all__ = ['NODE', 'SHEET', 'Fault', 'build_arm', 'fault', 'place_of']

NODE = '/arm'
# The data sheet: each frame with its parent, x, y and z in m, and the yaw in degrees.
SHEET: Mapping[str, tuple[str, float, float, float, float]] = {
    'arm_foot': ('base_link', 0.05, 0.0, 0.14, 90.0),
    'arm_upper': ('arm_foot', 0.0, 0.03, 0.06, -35.0),
    'arm_lower': ('arm_upper', 0.11, 0.02, 0.0, 50.0),
    'arm_hand': ('arm_lower', 0.09, 0.01, 0.0, -20.0),
    'arm_finger': ('arm_hand', 0.04, 0.015, 0.0, 15.0),
}
KINDS = ('parent', 'degrees', 'inverted', 'mirrored')


@dataclass(frozen=True)
class Fault:
    """What is wrong about one frame.

    Attributes:
        frame: The frame.
        kind: One of `KINDS`.
        parent: The parent that is sent.
        place: The place that is sent.
    """

    frame: str
    kind: str
    parent: str
    place: Place


def place_of(frame: str) -> Place:
    """Return where a frame is, as the data sheet says."""
    _, x, y, z, yaw = SHEET[frame]
    return on_floor(x, y, math.radians(yaw), z)


_last: list[Fault] = []
_nodes: list[Any] = []


def fault() -> Fault | None:
    """Return the fault of the arm that was built last, None before any."""
    return _last[-1] if _last else None


def build_arm() -> None:
    """Start a node that says where the parts of an arm are, one of them wrongly: drawn anew."""
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile

    from labkit.background.runtime import runtime
    from labkit.rosgraph.interfaces import message_class

    drawn = _draw()
    runtime.start()
    for node in _nodes:
        runtime.destroy(node)
    node = Node(NODE.lstrip('/'))
    profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # type: ignore[no-untyped-call]
    publisher = node.create_publisher(message_class(TF), '/tf_static', profile)
    now = node.get_clock().now().nanoseconds
    transforms = [
        _sent(frame, drawn).stamped(_parent(frame, drawn), frame, now) for frame in SHEET
    ]
    publisher.publish(message_class(TF)(transforms=transforms))
    runtime.add(node)
    _nodes[:], _last[:] = [node], [drawn]
    print(f'The arm is built: {", ".join(SHEET)}. One of them is sent wrongly.')


def _sent(frame: str, drawn: Fault) -> Place:
    return drawn.place if frame == drawn.frame else place_of(frame)


def _parent(frame: str, drawn: Fault) -> str:
    return drawn.parent if frame == drawn.frame else SHEET[frame][0]


def _draw() -> Fault:
    kind = random.choice(KINDS)
    # A wrong parent is the frame before the right one, so that the tree has no loop.
    frames = list(SHEET)[1:] if kind == 'parent' else list(SHEET)
    frame = random.choice([each for each in frames if not _last or each != _last[-1].frame])
    parent, x, y, z, yaw = SHEET[frame]
    place = place_of(frame)
    if kind == 'parent':
        parent = SHEET[parent][0]
    elif kind == 'degrees':
        place = on_floor(x, y, yaw, z)
    elif kind == 'inverted':
        place = place.back
    else:
        place = on_floor(x, y, -math.radians(yaw), z)
    return Fault(frame, kind, parent, place)
