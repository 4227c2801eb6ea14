"""What a scene can show: displays, one a topic, as RViz has them.

A display keeps the last message of its topic, and makes shapes of it when it is asked for them.
"""

from __future__ import annotations

from typing import Any, ClassVar

from labkit.views.feed import Feed, checked_type
from labkit.views.live import helper
from labkit.views.placed_frames import PlacedFrames
from labkit.views.scene_things import Thing, is_same

__all__ = ['Display', 'Things', 'TopicDisplay', 'counted']

Things = dict[str, Thing]


class Display:
    """A part of the scene that can be switched on and off; by itself one that a page draws.

    Args:
        name: What it is called, which is also what it is known by.
        is_on: Whether it is shown.

    Attributes:
        name: See above.
        is_on: See above.
    """

    def __init__(self, name: str, *, is_on: bool = True) -> None:
        self.name, self.is_on = name, is_on

    def things(self, frames: PlacedFrames, fixed: str) -> Things:
        """Return its shapes by name. One that has not changed is the same object.

        Args:
            frames: Where frames are.
            fixed: The fixed frame.
        """
        return self._things_in(frames, fixed) if self.is_on else {}

    def words(self) -> str:
        """Return what it shows, in a sentence; '' for nothing."""
        return self._words() if self.is_on else ''

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        return {}

    def _words(self) -> str:
        return ''


class TopicDisplay(Display):
    """What a topic tells.

    Args:
        topic: Its name.
        is_on: Whether it is shown.

    Attributes:
        feed: Its messages.
    """

    msg_type: ClassVar[str]
    # Whether it is on before anybody says.
    at_first: ClassVar[bool] = True
    # Whether only its newest message is of use, and there will be more.
    is_sensor: ClassVar[bool] = False
    # Whether it takes messages as bytes.
    is_raw: ClassVar[bool] = False

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self.feed = self._new_feed(topic)
        self._message: Any = None
        self._things: Things = {}
        self._drawn: object = None

    def _new_feed(self, topic: str) -> Feed:
        from rclpy.qos import QoSProfile, ReliabilityPolicy

        # Of a sensor the newest message is of use, and best effort matches every publisher. What
        # is published once has to come, also if that was before.
        best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
        qos = best_effort if self.is_sensor else None
        kind = checked_type(self.msg_type)
        node = helper()
        return Feed(topic, node, self.take, msg_type=kind, qos_profile=qos, raw=self.is_raw)

    @property
    def is_heard(self) -> bool:
        """Whether there is a message to show."""
        return self._message is not None

    @property
    def is_awaited(self) -> bool:
        """Whether a picture waits for its first message."""
        return self.is_sensor and bool(self.feed.publishers)

    def forget(self) -> None:
        """Forget what was heard."""
        self._message, self._things, self._drawn = None, {}, None

    def take(self, message: Any) -> None:
        """Take a message."""
        self._message = message

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        message = self._message
        if message is not None and message is not self._drawn:
            self._show(self._made_of(message))
            self._drawn = message
        return self._things if self._is_placed(frames, fixed) else {}

    def _show(self, made: Things) -> None:
        """Show shapes; one that is as it was stays the same object, so that it is not sent."""
        for name, before in self._things.items():
            if name in made and is_same(made[name], before):
                made[name] = before
        self._things = made

    def _made_of(self, message: Any) -> Things:
        """Return shapes of a message, in its frame."""
        raise NotImplementedError

    def _is_placed(self, frames: PlacedFrames, fixed: str) -> bool:
        """Return whether it is known where the frame of its message is; else note the reason."""
        message = self._message
        return message is None or bool(frames.place(self.name, fixed, message.header.frame_id))


def counted(number: int, what: str) -> str:
    """Return how many there are, in words."""
    return f'{number} {what}' if number == 1 else f'{number} {what}s'
