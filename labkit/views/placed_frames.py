"""Where tf2 says that things are, and its reason where it does not say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labkit.errors import did_you_mean
from labkit.transforms.cache import NANOSECONDS
from labkit.transforms.exceptions import TransformException
from labkit.transforms.tree import Place
from labkit.views.frames_heard import HeardFrames

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['PlacedFrames', 'nanoseconds']


class PlacedFrames:
    """Places of frames, for a view that draws by them.

    Args:
        node: See `HeardFrames`.

    Attributes:
        heard: What is heard of frames.
        why: What can't be drawn -> why, in the words of tf2.
    """

    def __init__(self, node: Node) -> None:
        self.heard = HeardFrames(node)
        self.why: dict[str, str] = {}

    @property
    def told(self) -> list[str]:
        """What can't be drawn, with the reason: once, if several things have the same."""
        things: dict[str, list[str]] = {}
        for what, words in self.why.items():
            things.setdefault(words.removeprefix(what), []).append(what)
        return [f'{_in_words(names)}{reason}' for reason, names in things.items()]

    def place(
        self, what: str, target: str, source: str, time: int = 0
    ) -> tuple[int, Place] | None:
        """Return the time that was found, and where a frame is in another; None if unknown.

        Args:
            what: What is drawn by it, for `why`.
            target: The other frame.
            source: The frame.
            time: When, ns; 0 for the latest time.
        """
        try:
            found = self.heard.tree.look(target, source, time)
        except TransformException as error:
            known = self.heard.tree.names()
            unknown = [name for name in (target, source) if name not in known]
            guess = did_you_mean(unknown[0], known) if unknown and known else ''
            words = f"{what} can't be drawn in {target}: {str(error).strip()} {guess}"
            self.why[what] = words.strip()
            return None
        self.why.pop(what, None)
        return found

    def is_late(self, target: str, source: str, time: int) -> bool:
        """Return whether the transforms of a time, ns, are still to come; see `place`."""
        tree = self.heard.tree
        if target not in tree or source not in tree:
            return False
        try:
            newest = tree.latest_common_time(target, source)
        except TransformException:
            return False
        return 0 < newest < time


def _in_words(names: list[str]) -> str:
    *others, last = names
    return f'{", ".join(others)} and {last}' if others else last


def nanoseconds(stamp: Any) -> int:
    """Return the time of a stamp, ns."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)
