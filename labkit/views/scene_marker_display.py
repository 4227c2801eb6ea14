"""The display of markers: those of a topic that are there, and until when."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from labkit.errors import printable
from labkit.views.placed_frames import PlacedFrames, nanoseconds
from labkit.views.scene_displays import Things, TopicDisplay, counted
from labkit.views.scene_markers import DELETE, DELETE_ALL, marker_things
from labkit.views.scene_things import HERE, Thing, is_same

if TYPE_CHECKING:
    from labkit.transforms.tree import Place

__all__ = ['MarkerDisplay', 'MarkersDisplay']

# So many markers of a topic are kept.
MOST_MARKERS = 2000


class MarkerDisplay(TopicDisplay):
    """Markers of `visualization_msgs`, by name space and number, as long as they live."""

    msg_type = 'visualization_msgs/msg/Marker'

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self._markers: dict[str, _Kept] = {}
        self._is_over = False  # whether there were more than are kept

    def forget(self) -> None:
        """Forget all of them."""
        super().forget()
        self._markers.clear()
        self._is_over = False

    def take(self, message: Any) -> None:
        """Take markers that are new, changed or gone."""
        super().take(message)
        for marker in getattr(message, 'markers', (message,)):
            name = f'{marker.ns} {marker.id}'
            if marker.action == DELETE_ALL:
                self._markers.clear()
                self._is_over = False
            elif marker.action == DELETE:
                self._markers.pop(name, None)
            elif name in self._markers or len(self._markers) < MOST_MARKERS:
                self._markers[name] = _Kept(marker, before=self._markers.get(name))
            else:
                self._is_over = True

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        now = time.monotonic()
        self._markers = {n: kept for n, kept in self._markers.items() if kept.ends_at > now}
        found: Things = {}
        # There may be as many reasons as markers: the first one is told.
        reasons: list[str] = []
        for name, kept in self._markers.items():
            called = f'{self.name}, marker {printable(name.strip())}'
            things = kept.things(called, frames, fixed)
            lost = frames.why.pop(called, '')
            if lost or kept.why:
                reasons.append(lost or f'{called}: {kept.why}.')
            for number, thing in enumerate(things):
                found[f'{name} {number}'] = thing
        told = reasons[:1]
        if len(reasons) > 1:
            told.append(f'Not drawn either: {counted(len(reasons) - 1, "more marker")}.')
        if self._is_over:
            told.append(f'{self.name}: only the first {MOST_MARKERS} markers are drawn.')
        if told:
            frames.why[self.name] = ' '.join(told)
        return found

    def _words(self) -> str:
        return f'Markers {self.name}: {len(self._markers)}.' if self.is_heard else ''


class MarkersDisplay(MarkerDisplay):
    """The same, of messages with many markers."""

    msg_type = 'visualization_msgs/msg/MarkerArray'


class _Kept:
    """A marker, until it ends or another one takes its place.

    Args:
        marker: The message.
        before: The one whose place it takes.

    Attributes:
        ends_at: `time.monotonic()` at which its lifetime is over.
        why: Why nothing is drawn of it, '' if something is.
    """

    def __init__(self, marker: Any, before: _Kept | None) -> None:
        self.marker = marker
        seconds = marker.lifetime.sec + marker.lifetime.nanosec * 1e-9
        self.ends_at = time.monotonic() + seconds if seconds > 0 else math.inf
        self.why = ''
        self._fixed = ''
        self._things: list[Thing] = before._things if before is not None else []
        self._is_made = False

    def things(self, name: str, frames: PlacedFrames, fixed: str) -> list[Thing]:
        """Return its shapes; see `Display.things`."""
        header = self.marker.header
        at = nanoseconds(header.stamp)
        moves = self.marker.frame_locked or at == 0
        if moves:
            if frames.place(name, fixed, header.frame_id) is None:
                return []
            if not self._is_made:
                self._make(header.frame_id, HERE)
        elif not self._is_made or fixed != self._fixed:
            # It stays where its frame was at that time.
            if frames.is_late(fixed, header.frame_id, at):
                return self._things
            found = frames.place(name, fixed, header.frame_id, at)
            if found is None:
                return []
            self._make('', found[1])
            self._fixed = fixed
        return self._things

    def _make(self, frame: str, base: Place) -> None:
        before, self._is_made = self._things, True
        made, self.why = marker_things(self.marker, frame, base)
        if len(made) == len(before):
            made = [
                old if is_same(new, old) else new for new, old in zip(made, before, strict=True)
            ]
        self._things = made
