"""Send a goal to an action, and wait for its result in a cell or terminal."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rclpy.action.client import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup

from labkit import settings
from labkit.asking.silence import why_unanswered
from labkit.background import compat
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabError, LabTimeout, quoted
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.servers import action_ends

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.background.console import CallbackError

__all__ = ['ActionGoals', 'shown_id']

# A server has ended when it was not ready for so long.
GONE_SEC = 1.0
SETTLE_SEC = 2.0
_numbers = itertools.count(1)


class ActionGoals:
    """A client of an action, for a `with` block.

    Raises:
        LabError: The name is invalid, or the action has another type in this process.
    """

    def __init__(self, node: Node, action_type: Any, name: str) -> None:
        self._node, self.name = node, name
        try:
            # In a separate group: if it is destroyed before an answer was taken, rclpy keeps the
            # group busy for ever.
            group = ReentrantCallbackGroup()
            self._client = ActionClient(node, action_type, name, callback_group=group)  # type: ignore[no-untyped-call]
        except (compat.RCLError, ValueError, TypeError) as error:
            raise LabError(
                f'The action {quoted(name)} can not be used with {type_name(action_type)}: '
                f'{str(error).splitlines()[0]}'
            ) from error

    def __enter__(self) -> ActionGoals:
        return self

    def __exit__(self, *_: object) -> None:
        # Otherwise the background may be taking a message of it, such as the last status.
        with runtime.executor.between_callbacks():
            self._client.destroy()  # type: ignore[no-untyped-call]

    def wait_until_ready(self, timeout_sec: float | None) -> bool:
        """Wait until goals can be sent, and return whether they can."""
        return wait_for(self._is_ready, timeout_sec)

    def send(
        self,
        goal: Any,
        timeout_sec: float | None,
        *,
        feedback: Callable[[Any], object] | None = None,
    ) -> Any:
        """Send a goal, wait until the server has accepted or rejected it, and return its handle.

        Args:
            goal: The goal.
            timeout_sec: Seconds to wait, None for no limit.
            feedback: Called in the background with each feedback message.

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
            timeout_sec: Seconds to wait, None for no limit.
            between: Called repeatedly meanwhile, and once at the end.

        Raises:
            LabTimeout, LabError: As `send` does.
        """
        # In one process, all feedback and the result may have arrived already.
        runtime.executor.settle(SETTLE_SEC)
        with runtime.executor.between_callbacks():
            future = handle.get_result_async()
            forget_feedback = compat.keep_feedback(handle, future)
        result = self._wait(future, timeout_sec, 'gave no result', between)
        runtime.executor.settle(SETTLE_SEC)
        with runtime.executor.between_callbacks():
            forget_feedback()
        between()
        return result

    def cancel(self, handle: Any, timeout_sec: float | None) -> bool:
        """Request to cancel a goal; return whether the server does. Raises as `send` does."""
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
        begun = last_ready = time.monotonic()
        errors = self._errors()

        def is_done() -> bool:
            nonlocal last_ready
            if future.done():
                return True
            between()
            now = time.monotonic()
            last_ready = now if self._is_ready() else last_ready
            if now > last_ready + GONE_SEC:
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
                    todo=why_unanswered(self._servers()),
                )
            return False

        wait_for(is_done, None)
        if future.exception() is not None:
            raise LabError(f'{self.name}: {future.exception()}')
        return future.result()

    def _servers(self) -> list[str]:
        """Return the full names of the nodes that serve it."""
        ends = action_ends(self._node, full_topic_name(self.name, self._node))
        return [name for name, _ in ends.servers]

    def _errors(self) -> list[tuple[CallbackError, int]]:
        """Return errors of action servers' callbacks in this notebook, with their counts.

        An error of `execute_callback` is not among them: it aborts the goal, with a result.
        """
        return [
            (error, error.count)
            for error in tuple(runtime.console.errors)
            if error.callback == 'ActionServer'
        ]


def shown_id(handle: Any) -> str:
    """Return the id of a goal as text; in stored outputs a number, as ids are random."""
    if settings.audience().same_each_time:
        return f'{next(_numbers):032x}'
    return bytes(handle.goal_id.uuid).hex()
