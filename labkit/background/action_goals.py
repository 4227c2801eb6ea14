"""Sending a goal to an action, from the cell or terminal that waits for the result."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.action.client import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup

from labkit import settings
from labkit.background.compat import RCLError
from labkit.background.runtime import runtime
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.interfaces import type_name

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.background.console import CallbackError

__all__ = ['ActionGoals', 'shown_id']

POLL_SEC = 0.02
# A server that the graph has lost for so long has ended.
GONE_SEC = 1.0
SETTLE_SEC = 0.5
_numbers = itertools.count(1)


class ActionGoals:
    """A client of an action, for as long as a `with` block lasts.

    Args:
        node: The node that sends goals.
        action_type: Class of the action.
        name: Full name of the action.

    Raises:
        LabError: It is no name of an action, or the action has another type here.
    """

    def __init__(self, node: Node, action_type: Any, name: str) -> None:
        self.name = name
        try:
            # In a group of its own: should it be destroyed when an answer waits to be taken, rclpy
            # would keep the group busy for ever.
            group = ReentrantCallbackGroup()
            self._client = ActionClient(node, action_type, name, callback_group=group)  # type: ignore[no-untyped-call]
        except (RCLError, ValueError, TypeError) as error:
            raise LabError(
                f'The action {name!r} can not be used with {type_name(action_type)}: '
                f'{str(error).splitlines()[0]}'
            ) from error

    def __enter__(self) -> ActionGoals:
        return self

    def __exit__(self, *_: object) -> None:
        # What a goal still sends, such as its last status, may wait to be taken at this moment.
        with runtime.executor.between_callbacks():
            self._client.destroy()  # type: ignore[no-untyped-call]

    def wait_until_ready(self, timeout_sec: float | None) -> bool:
        """Wait until goals can be sent.

        Args:
            timeout_sec: Seconds to wait, None for no end.

        Returns:
            Whether they can.
        """
        end = None if timeout_sec is None else time.monotonic() + timeout_sec
        while not self._is_ready():
            if end is not None and time.monotonic() >= end:
                return False
            time.sleep(POLL_SEC)
        return True

    def send(
        self,
        goal: Any,
        timeout_sec: float | None,
        *,
        feedback: Callable[[Any], object] | None = None,
    ) -> Any:
        """Send a goal, and wait until the server has accepted or rejected it.

        Args:
            goal: The goal.
            timeout_sec: Seconds to wait, None for no end.
            feedback: Called in the background with each feedback message.

        Returns:
            The handle of the goal.

        Raises:
            LabTimeout: No answer came in time.
            LabError: No answer will come: the server has ended, or its callback failed.
        """
        with runtime.executor.between_callbacks():
            future = self._client.send_goal_async(goal, feedback)  # type: ignore[no-untyped-call]
        return self._wait(future, timeout_sec, 'did not say whether it accepts the goal')

    def result(
        self,
        handle: Any,
        timeout_sec: float | None,
        *,
        between: Callable[[], object] = lambda: None,
    ) -> Any:
        """Wait for the result of a goal, with its status.

        Args:
            handle: The handle of the goal.
            timeout_sec: Seconds to wait, None for no end.
            between: Called again and again meanwhile, and once at the end.

        Raises:
            LabTimeout, LabError: As `send` does.
        """
        # rclpy hands over no feedback any more when it has the result. In one process, all of it
        # may have come before this asks.
        runtime.executor.settle(SETTLE_SEC)
        with runtime.executor.between_callbacks():
            future = handle.get_result_async()
        result = self._wait(future, timeout_sec, 'gave no result', between)
        runtime.executor.settle(SETTLE_SEC)
        between()
        return result

    def cancel(self, handle: Any, timeout_sec: float | None) -> bool:
        """Ask for a goal to be canceled; return whether the server does it. Errors as `send`."""
        with runtime.executor.between_callbacks():
            future = handle.cancel_goal_async()
        answer = self._wait(future, timeout_sec, 'did not answer to cancel')
        return any(info.goal_id == handle.goal_id for info in answer.goals_canceling)

    def _is_ready(self) -> bool:
        return bool(self._client.server_is_ready())  # type: ignore[no-untyped-call]

    def _wait(
        self,
        future: Any,
        timeout_sec: float | None,
        what: str,
        between: Callable[[], object] = lambda: None,
    ) -> Any:
        begun = seen = time.monotonic()
        errors = self._errors()
        # In slices: between them the stop button is heard.
        while not future.done():
            time.sleep(POLL_SEC)
            between()
            now = time.monotonic()
            seen = now if self._is_ready() else seen
            if now > seen + GONE_SEC:
                raise LabError(f'The server of {self.name} has ended; it {what}.')
            found = self._errors()
            if found != errors and not future.done():
                error = found[-1][0]
                raise LabError(
                    f'{self.name} gives no answer: {error.callback} of {error.node_name} failed.',
                    todo='Its error is shown above.',
                )
            if timeout_sec is not None and now > begun + timeout_sec:
                raise LabTimeout(
                    f'{self.name} {what} within {timeout_sec:g} s.',
                    todo='Is the node that serves it spinning, and do its callbacks return?',
                )
        if future.exception() is not None:
            raise LabError(f'{self.name}: {future.exception()}')
        return future.result()

    def _errors(self) -> list[tuple[CallbackError, int]]:
        """Return what the server's callbacks in this notebook have raised, and how often.

        One of `execute_callback` is not among them: such a goal is aborted, with a result.
        """
        return [
            (error, error.count)
            for error in tuple(runtime.console.errors)
            if error.callback == 'ActionServer'
        ]


def shown_id(handle: Any) -> str:
    """Return the id of a goal as text; it is drawn by chance, so a stored output has a number."""
    if settings.audience().same_each_time:
        return f'{next(_numbers):032x}'
    return bytes(handle.goal_id.uuid).hex()
