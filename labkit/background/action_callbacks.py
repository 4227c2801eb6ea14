"""The callback that executes a goal: what it raises is shown as that of any other callback.

rclpy catches it, logs one line, prints the traceback with its own frames, and aborts the goal.
Here the lines of the learner are shown, once a run of the cell; the goal is aborted all the same.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from labkit.background import compat

if TYPE_CHECKING:
    from labkit.background.console import Console

__all__ = ['guarded']


def guarded(callback: Callable[..., Any], server: Any, console: Console) -> Callable[..., Any]:
    """Return a callback that shows what the given one raises, and lets the goal be aborted.

    Args:
        callback: The callback of an action server that executes goals.
        server: The action server.
        console: Shows the error.
    """
    name = getattr(callback, '__name__', type(callback).__name__)

    def aborted(handle: Any, error: BaseException) -> Any:
        node = compat.node_of_action(server)
        console.show_error(node.get_fully_qualified_name(), name, error)
        return server.action_type.Result()

    if inspect.iscoroutinefunction(callback):

        @functools.wraps(callback)
        async def execute_async(handle: Any) -> Any:
            try:
                return await callback(handle)
            except GeneratorExit:
                raise  # the node has ended meanwhile
            except BaseException as error:
                return aborted(handle, error)

        return execute_async

    @functools.wraps(callback, updated=())
    def execute(handle: Any) -> Any:
        try:
            return callback(handle)
        except BaseException as error:
            return aborted(handle, error)

    return execute
