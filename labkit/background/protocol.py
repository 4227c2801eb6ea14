"""What the stand-ins for rclpy's functions need of the runtime, which puts them in place."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.background.console import Console
    from labkit.background.executor import BackgroundExecutor
    from labkit.background.nodes import NodeEntry

__all__ = ['Background']


class Background(Protocol):
    """The runtime, as the functions of `notebook_rclpy` see it."""

    helper: Node | None
    console: Console

    @property
    def executor(self) -> BackgroundExecutor:
        """Return the background executor."""

    foreign_threads: set[threading.Thread]

    @property
    def started(self) -> bool:
        """Tell whether ROS is up."""

    def start(self, *, domain_id: int | None = None, args: list[str] | None = None) -> None:
        """Start ROS in the background; without effect when it is up."""

    def stop(self) -> None:
        """Destroy all nodes, and shut ROS down."""

    def end_caller(self) -> bool:
        """End the node whose callback calls this; return False when none does."""

    def add(self, node: Node, *, budget: int | None = None) -> NodeEntry:
        """Run a node in the background."""

    def release(self, entry: NodeEntry) -> None:
        """Run a node no more, and leave it alive."""

    def entry_of(self, node: Node) -> NodeEntry | None:
        """Return the entry of a node, None if it does not run in the background."""

    def make_room(self, name: str) -> None:
        """Destroy the node of a name before another one of that name is made."""

    def wait(self, condition: Callable[[], object], timeout_sec: float | None) -> bool:
        """Wait until a condition is true."""

    def refuse_in_callback(self, what: str, todo: str = '') -> None:
        """Raise a LabError when called by a callback."""
