"""Clauses on actions: what becomes of the goals that are sent to a server, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import expect
from labkit.exercises.clauses.base import Clause, Evidence
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Goal', 'Pursues', 'Pursuit']

# How long a client may take to find its server, and a server to answer, s of real time.
READY_SEC = 5.0
ANSWER_SEC = 5.0
# After so long it is looked whether a callback hangs, s.
PATIENCE_SEC = 1.0
# A request to cancel is to be taken while the goal goes on.
SOON_SEC = 0.3
# What was published before the result has come so long after it at the latest, s.
LATE_SEC = 0.5


@dataclass(frozen=True)
class Goal:
    """A goal to be sent.

    Attributes:
        fields: Its fields.
        cancel_after: After so many feedbacks it is canceled; 0 for never.
    """

    fields: Mapping[str, Any]
    cancel_after: int = 0


@dataclass
class Pursuit:
    """What has become of a goal.

    Attributes:
        goal: The goal.
        accepted: Whether the server has accepted it.
        feedback: The feedback on it, in its order.
        result: The result; None if it was rejected.
        status: How it ended, as a number of `action_msgs/msg/GoalStatus`.
        cancel_accepted: Whether the server has accepted to cancel it; None if nobody asked, or
            the goal was over before.
    """

    goal: Goal
    accepted: bool = False
    feedback: list[Any] = field(default_factory=list)
    result: Any = None
    status: int = 0
    cancel_accepted: bool | None = None

    @property
    def ending(self) -> str:
        """Return how it ended, in a word."""
        words = {4: 'succeeded', 5: 'canceled', 6: 'aborted'}
        return words.get(self.status, 'unknown') if self.accepted else 'rejected'


@dataclass(frozen=True, eq=False)
class Pursues(Clause):
    """An action treats goals as it should, one after the other.

    Attributes:
        action: Full name of the action. A clause `Serves` stands before this one.
        words: What is asked for, in words of the task.
        draw: Draws the goals.
        rule: Gets what has become of each goal, and raises Fail if it is not what was asked for.
    """

    action: str
    words: str
    draw: Callable[[], Sequence[Goal]]
    rule: Callable[[Sequence[Pursuit]], None]

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def judge(self, evidence: Evidence) -> str:
        """Send goals, and judge what becomes of them."""
        from rclpy.action.client import ActionClient
        from rclpy.callback_groups import ReentrantCallbackGroup

        from labkit.rosgraph.interfaces import action_class

        probe = evidence.probe
        type_name = probe.scope.serves[self.action]
        # In a group of its own: should it be destroyed when an answer waits to be taken, rclpy
        # would keep the group busy for ever.
        group = ReentrantCallbackGroup()
        action_type = action_class(type_name)
        client: Any = ActionClient(  # type: ignore[no-untyped-call]
            probe.spun_node, action_type, self.action, callback_group=group
        )
        watch = probe.watch(f'{self.action}/_action/feedback', f'{type_name}_FeedbackMessage')
        try:
            probe.wait(client.server_is_ready, READY_SEC)
            probe.wait(lambda: probe.node.count_publishers(watch.topic), READY_SEC)
            pursuits = [
                _Asking(probe, self.action, client, watch, goal).pursue() for goal in self.draw()
            ]
        finally:
            probe.forget([watch])
            watch.close()
            client.destroy()
        self.rule(pursuits)
        return f'{self.action}: {", ".join(pursuit.ending for pursuit in pursuits)}.'


class _Asking:
    """One goal on its way."""

    def __init__(self, probe: Probe, action: str, client: Any, watch: Any, goal: Goal) -> None:
        from labkit.rosgraph.interfaces import action_class

        self._probe, self._action, self._client, self._watch = probe, action, client, watch
        self._type = action_class(probe.scope.serves[action])
        self._id: Any = None
        self._pursuit = Pursuit(goal)

    def pursue(self) -> Pursuit:
        """Send the goal, and see what becomes of it."""
        goal, pursuit = self._pursuit.goal, self._pursuit
        future = self._client.send_goal_async(self._type.Goal(**goal.fields))
        handle = self._answer(future, 'is accepted or rejected')
        pursuit.accepted = handle.accepted
        if not handle.accepted:
            return pursuit
        self._id = handle.goal_id
        finished = handle.get_result_async()
        if goal.cancel_after:
            self._cancel(handle, finished)
        answer = self._answer(finished, 'comes to an end')
        pursuit.result, pursuit.status = answer.result, answer.status
        count = len(self._feedback())
        self._probe.wait(lambda: len(self._feedback()) > count, LATE_SEC / 5)
        pursuit.feedback = self._feedback()
        return pursuit

    def _cancel(self, handle: Any, finished: Any) -> None:
        wanted = self._pursuit.goal.cancel_after
        self._probe.wait(lambda: len(self._feedback()) >= wanted or finished.done(), ANSWER_SEC)
        answer = self._answer(handle.cancel_goal_async(), 'is canceled, or not', SOON_SEC)
        if answer.return_code not in (answer.ERROR_GOAL_TERMINATED, answer.ERROR_UNKNOWN_GOAL_ID):
            self._pursuit.cancel_accepted = bool(answer.goals_canceling)

    def _feedback(self) -> list[Any]:
        return [
            sample.message.feedback
            for sample in self._watch.samples
            if sample.message.goal_id == self._id
        ]

    def _answer(self, future: Any, what: str, patience_sec: float = PATIENCE_SEC) -> Any:
        began = time.monotonic()
        if not self._probe.wait(future.done, patience_sec):
            expect.hanging()
        if not self._probe.wait(future.done, ANSWER_SEC):
            self._refuse_silence(what, time.monotonic() - began)
        return future.result()

    def _refuse_silence(self, what: str, seconds: float) -> NoReturn:
        servers = {server.node for server in self._probe.all_servers()}
        why = 'A callback of the action has not returned, or it has raised an error.'
        todo = (
            'Each callback has to return: goal_callback a GoalResponse, cancel_callback a '
            'CancelResponse, execute_callback a Result.'
        )
        if not servers:
            why = f'The server of {self._action} has ended meanwhile.'
            todo = 'Look at the output of its program.'
        raise Fail(
            f'a goal with {show_fields(self._pursuit.goal.fields)} on {self._action} {what}',
            f'nothing in {seconds:.0f} s',
            why=why,
            todo=todo,
        )


def show_fields(fields: Mapping[str, Any]) -> str:
    """Return fields and their values as a text."""
    return ', '.join(f'{name} = {value}' for name, value in fields.items())
