"""Note what publishers of this process say on /tf and /tf_static: each message counts.

A message has the frames that it has; what a node says of another frame is in another message. So
all are looked at, the numbers in them only now and then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labkit.silent.message_faults import NO_STAMP, SLASH_FRAME, checks_of
from labkit.silent.scene import Broadcast

if TYPE_CHECKING:
    from labkit.asking.traffic import Sent

__all__ = ['MOVING', 'STATIC', 'note_transforms']

MOVING, STATIC = '/tf', '/tf_static'
# Frames of one publisher that are noted.
MOST = 200
# Time from one look at the numbers of a frame to the next, and how long they count, s.
LOOK_SEC, COUNTS_SEC = 0.5, 3.0


def note_transforms(sent: Sent, transforms: list[Any], topic: str, *, looks: bool = True) -> None:
    """Note the transforms of a message that was published just now, and look at their numbers."""
    sent.each = True
    is_static, now, known = topic == STATIC, sent.last, sent.parts
    looked = False
    for transform in transforms:
        key = (transform.header.frame_id, transform.child_frame_id)
        noted = known.get(key)
        if noted is None:
            if len(known) >= MOST:
                continue
            parent, child = (name.removeprefix('/') for name in key)
            noted = known[key] = Broadcast(parent, child, first=now)
        noted.count += 1
        noted.last = now
        if looks and (is_static or now - noted.looked_at >= LOOK_SEC):
            noted.looked_at, looked = now, True
            _look_into(noted, transform, is_static=is_static)
    if looked:
        counts = [each for each in known.values() if _counts(each, now, is_static=is_static)]
        sent.found = {
            id: f'in the transform of {each.child or "a frame without a name"}, {words}'
            for each in counts
            for id, words in each.found.items()
        }
        sent.stamp = None if is_static else max((each.stamp for each in counts), default=None)


def _look_into(noted: Broadcast, transform: Any, *, is_static: bool) -> None:
    stamp = transform.header.stamp
    shift, turn = transform.transform.translation, transform.transform.rotation
    place = shift.x, shift.y, shift.z, turn.x, turn.y, turn.z, turn.w
    noted.stamp = stamp.sec * 10**9 + stamp.nanosec
    noted.changes += bool(noted.place) and place != noted.place
    noted.place = place
    msg_type: type = type(transform)
    noted.found = {
        kind.id: words
        for check in checks_of(msg_type)
        for kind, words in check(transform)
        # tf2 leaves a slash away; what does not move has no time.
        if kind is not SLASH_FRAME and not (is_static and kind is NO_STAMP)
    }


def _counts(noted: Broadcast, now: float, *, is_static: bool) -> bool:
    return noted.last == now if is_static else now - noted.last < COUNTS_SEC
