"""Why a simulated robot stands: its command timeout has stopped it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labkit.sim.command_timeout import TIMED_OUT_TOPIC, timed_out_words
from labkit.views.feed import Feed

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['TimedOut']


class TimedOut(Feed):
    """What a robot says of its command timeout; a real one says nothing.

    Args:
        beside: A topic of the robot.
        node: A node that resolves the name.
    """

    def __init__(self, beside: str, node: Node) -> None:
        from std_msgs.msg import Float64

        topic = f'{beside.rpartition("/")[0]}/{TIMED_OUT_TOPIC}'
        super().__init__(topic, node, self._take, msg_type=Float64, optional=True)
        self._seconds = 0.0

    def open(self, node: Node) -> None:
        """Subscribe: whatever holds now is said anew."""
        self.count, self._seconds = 0, 0.0
        super().open(node)

    @property
    def is_heard(self) -> bool:
        """Whether the robot has said it, or there is none that does."""
        return bool(self.count) or not self.publishers

    @property
    def words(self) -> str:
        """Why the robot stands; '' if its command timeout has not stopped it."""
        stopped = self._seconds > 0 and self.publishers
        return timed_out_words(self._seconds) if stopped else ''

    def _take(self, message: Any) -> None:
        self._seconds = message.data
