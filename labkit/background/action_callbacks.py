"""Show errors of a callback that executes a goal, as for any other callback.

rclpy logs one line, prints the traceback with its own frames, and aborts the goal. Here only the
learner's lines are shown, once per run of the cell; the goal is still aborted. What ends a program
leaves the callback, as it does with rclpy.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from labkit.background import compat
from labkit.background.foreground import ENDS

if TYPE_CHECKING:
    from labkit.background.console import Console

__all__ = ['guarded']


def guarded(callback: Callable[..., Any], server: Any, console: Console) -> Callable[..., Any]:
    """Wrap a callback that executes goals of an action server, to show errors and abort."""
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
            except (GeneratorExit, *ENDS):
                raise  # the node has ended meanwhile, or is to end
            except BaseException as error:
                return aborted(handle, error)

        return execute_async

    @functools.wraps(callback, updated=())
    def execute(handle: Any) -> Any:
        try:
            return callback(handle)
        except ENDS:
            raise
        except BaseException as error:
            return aborted(handle, error)

    return execute
