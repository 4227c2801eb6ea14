"""What is asked by the learner's node, and takes a moment before it answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.exercises.clauses.base import SOON_SEC

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['take_time']

# Some tests come sooner after the one before: so who drops what comes while it waits is found, s.
TAKES_SEC = 4 * SOON_SEC


async def take_time(node: Node) -> None:
    """Wait for a moment of the node's time, while everything else goes on."""
    from functools import partial

    from rclpy.callback_groups import ReentrantCallbackGroup
    from rclpy.task import Future

    done: Future = Future()  # type: ignore[no-untyped-call]
    group = ReentrantCallbackGroup()
    timer = node.create_timer(TAKES_SEC, partial(done.set_result, None), callback_group=group)
    try:
        await done
    finally:
        node.destroy_timer(timer)
