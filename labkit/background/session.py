"""What goes on in a thread, with a node and a cell: a recording, a playing, a shared topic."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, ClassVar, TypeVar

from rclpy.exceptions import InvalidHandle

from labkit.background.nodes import after_destroy, helper_node, node_exists
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.snapshot import node_names

if TYPE_CHECKING:
    from rclpy.node import Node
    from typing_extensions import Self

__all__ = ['Session', 'end_earlier', 'going_on']

Kind = TypeVar('Kind', bound='Session')


class Session:
    """Something that goes on in a thread of its own until it is done, or stopped.

    It ends with `stop()`, with its node (`lab.stop()`, `lab.remove(...)`), with its `with` block,
    and when its cell is run again.

    Attributes:
        error: What has ended it early, None if nothing has.
    """

    _going_on: ClassVar[list[Session]] = []

    def __init__(self, node_name: str) -> None:
        self.error: Exception | None = None
        self._cell = runtime.console.current_cell()
        self._name = node_name
        self._stopping, self._ended = threading.Event(), threading.Event()
        self._node: Node = helper_node(_free_name(node_name))
        runtime.add(self._node)
        self._thread = threading.Thread(target=self._run, name=node_name, daemon=True)

    @property
    def done(self) -> bool:
        """Tell whether it has ended."""
        return self._ended.is_set()

    def stop(self) -> None:
        """End it, and wait until all is put away. Without effect when it has ended."""
        self._stopping.set()
        self._end_node()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # -- for those that are made on it ----------------------------------------------------------

    def _go(self) -> None:
        """Begin. Until then it has no thread."""
        Session._going_on.append(self)
        self._thread.start()

    def _run(self) -> None:
        try:
            self._work()
        except InvalidHandle:
            self._stopping.set()  # its node ends, and its publishers are the first to go
        except Exception as error:  # a thread that raises tells nobody
            # Once ROS is shut down, nothing can be published; that is no news of the disk.
            if isinstance(error, LabError) or node_exists(self._node):
                self._fail(error)
        finally:
            self._end_node()
            self._ended.set()
            Session._going_on.remove(self)

    def _work(self) -> None:
        """Do what is to be done, until `_stopping` is set."""
        raise NotImplementedError

    def _fail(self, error: Exception) -> None:
        """Keep what has ended it, and say so under its cell."""
        self.error = error
        runtime.console.write_under(self._cell, f'{self._name}: {error}\n')

    def _end_node(self) -> None:
        if node_exists(self._node):
            runtime.destroy(self._node)


def going_on(kind: type[Kind]) -> list[Kind]:
    """Return those of a kind that go on, oldest first."""
    return [session for session in tuple(Session._going_on) if isinstance(session, kind)]


def end_earlier(kind: type[Session]) -> None:
    """End what an earlier run of the running cell has begun.

    Args:
        kind: What of it.
    """
    cell = runtime.console.current_cell()
    for session in going_on(kind):
        same = cell.cell_id and session._cell.cell_id == cell.cell_id
        if same and session._cell is not cell:
            session.stop()


def _free_name(name: str) -> str:
    assert runtime.helper is not None
    taken = set(node_names(runtime.helper))
    number, free = 1, name
    while f'/{free}' in taken:
        number += 1
        free = f'{name}_{number}'
    return free


def _end_with_node() -> None:
    """End each one whose node is gone."""
    for session in tuple(Session._going_on):
        if not node_exists(session._node):
            session.stop()


after_destroy.append(_end_with_node)
