"""Clauses on actions: what becomes of the goals that are sent to a server, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import common_mistakes
from labkit.exercises.clauses.base import Evidence, GraphClause
from labkit.exercises.observation import LIFE_SEC, live
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.messages_heard import Sample, Watch
    from labkit.exercises.probe import Probe
    from labkit.exercises.time.virtual_time import VirtualTime

__all__ = ['Goal', 'Pursues', 'Pursuit']

# How long a client may take to find its server, s of real time.
READY_SEC = 5.0
# How long a server of another process may do nothing, s of real time.
ANSWER_SEC = 5.0
# What it has published before the result comes so long after it at the latest, s.
LATE_SEC = 0.1
# So long it is looked at what a server does that nobody asks, s.
ALONE_SEC = 1.0
# What rclpy logs, with the id of the goal, when execute_callback has not said how it ended, and
# when it has raised (rclpy/action/server.py, _execute_goal).
NOT_SAID, RAISED = 'Goal state not set', 'Error raised in execute callback'


@dataclass(frozen=True)
class Goal:
    """A goal to be sent.

    Attributes:
        fields: Its fields.
        cancel_after: After so many feedbacks it is canceled; 0 for never.
        is_long: Whether it may take long. A server of another process does not get it: its time
            is real.
        after_rejection: Whether it is sent only if the one before it was rejected: who has
            accepted that one would accept it, too, and work on it for too long.
    """

    fields: Mapping[str, Any]
    cancel_after: int = 0
    is_long: bool = False
    after_rejection: bool = False


@dataclass
class Pursuit:
    """What has become of a goal.

    Attributes:
        goal: The goal.
        accepted: Whether the server has accepted it.
        feedback: The feedback on it, in its order.
        times: When each of these was published, s.
        exact: Whether these times are exact; else they are real ones.
        result: The result; None if it was rejected.
        status: How it ended, as a number of `action_msgs/msg/GoalStatus`.
        cancel_accepted: Whether the server has accepted to cancel it; None if nobody asked, or
            the goal was over before.
        before_cancel: How much of the feedback was published before that was accepted.
        not_said: Whether it was aborted because execute_callback has not said how it ended,
        raised: and whether that was because it has raised.
    """

    goal: Goal
    accepted: bool = False
    feedback: list[Any] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    exact: bool = True
    result: Any = None
    status: int = 0
    cancel_accepted: bool | None = None
    before_cancel: int = 0
    not_said: bool = False
    raised: bool = False

    @property
    def ending(self) -> str:
        """Return how it ended, in a word."""
        words = {4: 'succeeded', 5: 'canceled', 6: 'aborted'}
        return words.get(self.status, 'unknown') if self.accepted else 'rejected'


@dataclass(frozen=True, eq=False)
class Pursues(GraphClause):
    """An action treats goals as it should, one after the other.

    Attributes:
        action: Full name of the action. A clause `Serves` stands before this one.
        words: What is asked for, in words of the task.
        draw: Draws the goals.
        rule: Gets what has become of each goal, and raises Fail if it is not what was asked for.
        seconds: How long all of the goals may take, s of virtual time.
    """

    action: str
    words: str
    draw: Callable[[], Sequence[Goal]]
    rule: Callable[[Sequence[Pursuit]], None]
    seconds: float = LIFE_SEC
    own_life = True

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
        servers = [end.node for end in probe.all_servers() if end.service == self.action]
        node = servers[0] if servers else ''  # it may end at any time
        is_here = probe.node_object(node) is not None
        goals = [goal for goal in self.draw() if is_here or not goal.is_long]
        asking = _Asking(client, action_type, goals)
        topics = {f'{self.action}/_action/feedback': f'{type_name}_FeedbackMessage'}
        try:
            probe.wait(client.server_is_ready, READY_SEC)
            if is_here:
                self._live(evidence, node, topics, asking)
            else:
                self._watch(probe, node, topics, asking)
        finally:
            client.destroy()
        asking.take_logs(probe)
        self.rule(asking.pursuits)
        return f'{self.action}: {", ".join(pursuit.ending for pursuit in asking.pursuits)}.'

    def _live(
        self, evidence: Evidence, node: str, topics: Mapping[str, str], asking: _Asking
    ) -> None:
        """Let time pass for the server, without a goal and then until all goals are over."""
        alone = live(evidence.probe, topics, ALONE_SEC, nodes={node})
        replace(evidence, life=alone).refuse_trouble(())
        (topic,) = topics
        passing_now: list[VirtualTime] = []

        def begin(passing: VirtualTime) -> None:
            passing_now.append(passing)
            go(None)

        def go(watch: Watch | None) -> bool:
            passing = passing_now[0]
            while not (passing.hanging or passing.flooded):
                # What it waits for may have come already when it is asked.
                if not asking.go(watch.samples if watch else ()):
                    return asking.is_over
                passing.settle()
                if watch is not None:
                    watch.pump()
            return True

        life = live(
            evidence.probe,
            topics,
            self.seconds,
            nodes={node},
            before=begin,
            until=lambda _, watches: go(watches[topic]),
        )
        # What came of the first request came before time began to pass.
        samples = life.on(topic, before=True)
        asking.take_feedback(samples, [max(sample.at, 0.0) for sample in samples])
        replace(evidence, life=life).refuse_trouble(())
        if not asking.is_over:
            self._refuse_silence(evidence.probe, asking, life.seconds)

    def _watch(self, probe: Probe, node: str, topics: Mapping[str, str], asking: _Asking) -> None:
        """Wait in real time until all goals are over: the server is in another process."""
        from labkit.asking.service_calls import wait_until_spun

        ((topic, msg_type),) = topics.items()
        watch = probe.watch(topic, msg_type)
        probe.wait(lambda: probe.node.count_publishers(topic), READY_SEC)
        # One that answers a client knows the subscriptions that were made before it.
        wait_until_spun(probe.spun_node, node, READY_SEC)

        def moves(count: int) -> bool:
            return asking.go(watch.samples) or asking.is_over or len(watch) > count

        while not asking.is_over:
            if not probe.wait(partial(moves, len(watch)), ANSWER_SEC):
                self._refuse_silence(probe, asking, ANSWER_SEC)
        probe.wait(lambda: False, LATE_SEC)
        asking.take_feedback(watch.samples, [sample.stamp for sample in watch.samples])
        for pursuit in asking.pursuits:
            pursuit.exact = False
        probe.forget([watch])
        watch.close()

    def _refuse_silence(self, probe: Probe, asking: _Asking, seconds: float) -> NoReturn:
        servers = {server.node for server in probe.all_servers()}
        ended = common_mistakes.SERVER_ENDED.of(service=self.action)
        fields = asking.pursuits[-1].goal.fields
        raise Fail(
            f'a goal with {show_fields(fields)} on {self.action} {asking.waits_for}',
            f'nothing in {seconds:.0f} s',
            common_mistakes.ACTION_SILENT if servers else ended,
        )


class _Asking:
    """Goals that are sent one after the other.

    Args:
        client: The client.
        action_type: The class of the action.
        goals: The goals.

    Attributes:
        pursuits: What has become of them, as far as they were sent.
        waits_for: What the last one waits for, in words.
        is_over: Whether all of them are over.
    """

    def __init__(self, client: Any, action_type: Any, goals: Sequence[Goal]) -> None:
        self._client, self._type, self._goals = client, action_type, goals
        self._samples: Sequence[Sample] = ()
        self._ids: list[Any] = []
        self._canceled_at: list[float] = []
        self._steps = self._pursue()
        self.pursuits: list[Pursuit] = []
        self.waits_for = ''
        self.is_over = False

    def go(self, samples: Sequence[Sample]) -> bool:
        """Do what is next; tell whether anything was sent.

        Args:
            samples: The feedback of all goals up to now.
        """
        self._samples = samples
        sent = next(self._steps, None)
        self.is_over = sent is None
        return bool(sent)

    def take_feedback(self, samples: Sequence[Sample], times: Sequence[float]) -> None:
        """Give each goal its feedback, with the times."""
        for pursuit, goal_id, until in zip(
            self.pursuits, self._ids, self._canceled_at, strict=False
        ):
            own = [
                (sample, at)
                for sample, at in zip(samples, times, strict=True)
                if sample.message.goal_id == goal_id
            ]
            pursuit.feedback = [sample.message.feedback for sample, _ in own]
            pursuit.times = [at for _, at in own]
            pursuit.before_cancel = sum(sample.stamp <= until for sample, _ in own)

    def take_logs(self, probe: Probe) -> None:
        """Note what rclpy has logged about goals that were aborted."""

        def is_logged(*parts: str) -> bool:
            return any(all(part in log.msg for part in parts) for log in probe.logs)

        for pursuit, goal_id in zip(self.pursuits, self._ids, strict=True):
            if pursuit.ending == 'aborted':
                not_said = partial(is_logged, NOT_SAID, str(goal_id.uuid))
                pursuit.not_said = probe.wait(not_said, LATE_SEC)
                pursuit.raised = pursuit.not_said and is_logged(RAISED)

    def _pursue(self) -> Generator[bool, None, None]:
        """Give True each time that something was sent, and False while it waits."""
        for goal in self._goals:
            if goal.after_rejection and any(p.accepted for p in self.pursuits[-1:]):
                continue
            pursuit = Pursuit(goal)
            self.pursuits.append(pursuit)
            self._ids.append(None)
            self._canceled_at.append(0.0)
            request = self._type.Goal(**goal.fields)
            future = self._client.send_goal_async(request)
            handle = yield from self._answer(future, 'is accepted or rejected')
            pursuit.accepted = handle.accepted
            if not handle.accepted:
                continue
            self._ids[-1] = handle.goal_id
            finished = handle.get_result_async()
            if goal.cancel_after:
                yield from self._cancel(pursuit, handle, finished)
            answer = yield from self._answer(finished, 'comes to an end')
            pursuit.result, pursuit.status = answer.result, answer.status

    def _cancel(self, pursuit: Pursuit, handle: Any, finished: Any) -> Generator[bool, None, None]:
        self.waits_for = 'gets feedback, or comes to an end'
        yield True
        while not finished.done() and self._count(handle.goal_id) < pursuit.goal.cancel_after:
            yield False
        answer = yield from self._answer(handle.cancel_goal_async(), 'is canceled, or not')
        self._canceled_at[-1] = time.time()
        if answer.return_code not in (answer.ERROR_GOAL_TERMINATED, answer.ERROR_UNKNOWN_GOAL_ID):
            pursuit.cancel_accepted = bool(answer.goals_canceling)

    def _count(self, goal_id: Any) -> int:
        return sum(sample.message.goal_id == goal_id for sample in self._samples)

    def _answer(self, future: Any, what: str) -> Generator[bool, None, Any]:
        self.waits_for = what
        yield True
        while not future.done():
            yield False
        return future.result()


def show_fields(fields: Mapping[str, Any]) -> str:
    """Return fields and their values as a text."""
    return ', '.join(f'{name} = {value}' for name, value in fields.items())
