"""A clause on a node that answers each message that it hears.

Each message is answered once, and nothing is answered that did not come. Other nodes may talk on
the same topics meanwhile: what they send from this process has to be answered as well.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises.clauses.base import Clause, Evidence, Test
from labkit.exercises.expect.spinning import hanging, spun
from labkit.exercises.expect.values import show, text_trouble
from labkit.exercises.verdict import Fail
from labkit.exercises.watch import Sample

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['WITHIN_SEC', 'Answers', 'Explain', 'find_stage', 'value_of']

# How soon an answer has to come, s. A node may keep what it hears until its timer ticks.
WITHIN_SEC = 1.0
# So often an answer comes once more only where something repeats it.
MANY = 3
# How far a time may be off where it is not known exactly, s.
LATE_SEC = 0.1
# How long the first answer of a node may take, if it makes its publisher only then, s.
FIRST_ANSWER_SEC = 0.6
# So many topics more, which a node hears though nobody has asked for it, get a test, too.
MAX_OTHERS = 3

Explain = Callable[[Any, Sequence[Any]], tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Answers(Clause):
    """A node answers each message on one topic with one message on another topic.

    Attributes:
        inner: Full name of the topic that it hears.
        outer: Full name of the topic that it publishes on.
        words: What is asked for, in words of the task.
        answer: The value that an answer has, from the value that was heard; None if nothing is to
            be said upon it.
        draw: Draws the values that are sent as tests.
        field: Name of the field of both messages.
        by: Full name of the node; any node if empty.
        explain: Gets a value that was heard, and the values that came upon it (maybe none);
            returns the misconception and the next step, or two empty texts.
    """

    inner: str
    outer: str
    words: str
    answer: Callable[[Any], Any]
    draw: Callable[[], Sequence[Any]]
    field: str = 'data'
    by: str = ''
    explain: Explain | None = None
    judges_parts = True

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription and the publisher of one node."""
        hears, says = find_stage(
            evidence.probe, self.inner, self.outer, {self.field: self.draw()[0]}, by=self.by
        )
        evidence.ends['subscription', self.inner, self.by] = hears
        evidence.ends['publisher', self.outer, self.by] = says

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return messages to be answered, and some on topics that are none of its business."""
        hears = evidence.subscription(self.inner, self.by)
        spun(evidence.probe, hears)
        values = self.draw()
        tests = [
            Test(
                self.inner,
                hears.msg_type,
                {self.field: value},
                (self.outer,),
                due=self.answer(value) is not None,
            )
            for value in values
        ]
        for other in _others(evidence.probe, hears)[:MAX_OTHERS]:
            # An answer to it tells by itself where it comes from.
            value = next((value for value in self.draw() if value not in values), values[1])
            tests.append(Test(other.topic, other.msg_type, {self.field: value}))
        return tests

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers."""
        life = evidence.life
        heard = [(s.at, value_of(s, self.field)) for s in life.on(self.inner)]
        came = [(s.at, value_of(s, self.field)) for s in life.on(self.outer)]
        left = list(came)
        missing, answered = [], []
        for sample, is_due in life.heard(self.inner, WITHIN_SEC):
            at, value = sample.at, value_of(sample, self.field)
            right = self.answer(value)
            if right is None:
                continue
            found = next((i for i, (t, v) in enumerate(left) if t >= at and v == right), None)
            if found is not None:
                answered.append((left[found][0] - at, at, value))
                del left[found]
            elif is_due:
                missing.append((at, value))
        repeated = self._repeats(heard, left) >= MANY and len(missing) < len(heard) / 2
        if missing and not repeated:
            self._refuse_missing(evidence, missing, left, len(answered))
        if not repeated:
            self._refuse_late(evidence, answered)
        # At the beginning it may answer what came before: a node may keep what it hears.
        extra = [(t, value) for t, value in left if t >= WITHIN_SEC]
        values = [s.fields[self.field] for s in life.sent if self.field in s.fields]
        extra = life.without_strangers(
            self.inner, extra, {*values, *(self.answer(value) for value in values)}
        )
        if extra:
            self._refuse_extra(evidence, heard, extra)
        if missing:
            self._refuse_missing(evidence, missing, left, len(answered))
        examples = [value for _, value in heard if self.answer(value) is not None][:2]
        pairs = ', '.join(f'{show([v])} -> {show([self.answer(v)])}' for v in examples)
        hears = evidence.subscription(self.inner, self.by)
        return f'{hears.node} has answered {len(answered)} messages, each once: {pairs}.'

    def _refuse_missing(
        self,
        evidence: Evidence,
        missing: Sequence[tuple[float, Any]],
        left: Sequence[tuple[float, Any]],
        answered: int,
    ) -> NoReturn:
        hears = evidence.subscription(self.inner, self.by)
        # Some texts hide what is wrong, as one of digits that are to become capital letters does.
        came_of = [(v, [w for t, w in left if at <= t < at + WITHIN_SEC]) for at, v in missing]
        value, came = next((pair for pair in came_of if {*pair[1]} - {pair[0]}), came_of[0])
        if not left:
            hanging()
        right = self.answer(value)
        why, todo = self.explain(value, came) if self.explain is not None else ('', '')
        if not why and came:
            why = text_trouble(came[-1], right)
            todo = 'Compare the value that is wanted with the one seen.'
        if not why and answered:
            count = answered + len(missing)
            why = f'{answered} of {count} messages were answered rightly, others not.'
            todo = 'Do the same for each message that comes, whatever it says, and each time.'
        if not why:
            why = f'The message reached {hears.node}, but its callback did not publish.'
            todo = f'Publish on {self.outer} in the callback of the subscription to {self.inner}.'
        raise Fail(
            f'{self.field} = {show([right])} on {self.outer} when {self.field} = {show([value])} '
            f'comes on {self.inner}',
            f'{self.field} = {show(came)}' if came else f'nothing on {self.outer}',
            why=why,
            todo=todo,
        )

    def _repeats(
        self, heard: Sequence[tuple[float, Any]], left: Sequence[tuple[float, Any]]
    ) -> int:
        """Return how often a right answer came once more, at most."""
        rights = {self.answer(value) for _, value in heard}
        return max(Counter(value for _, value in left if value in rights).values(), default=0)

    def _refuse_late(self, evidence: Evidence, delays: Sequence[tuple[float, float, Any]]) -> None:
        """Raise Fail if a test was answered too late.

        What others have sent is not looked at: they may have sent it in real time.
        """
        life = evidence.life
        tests = {sent.at for sent in life.sent if sent.topic == self.inner}
        late = [
            (delay, value)
            for delay, at, value in delays
            if delay > WITHIN_SEC + LATE_SEC and any(abs(at - sent) < LATE_SEC for sent in tests)
        ]
        if late:
            delay, value = max(late, key=lambda pair: pair[0])
            raise Fail(
                f'an answer on {self.outer} within {WITHIN_SEC:g} s',
                f'{delay:.1f} s from {self.field} = {show([value])} to its answer',
                why='The answers wait for a timer, or for something else that comes seldom.',
                todo='Publish in the callback of the subscription, or take a shorter period.',
            )

    def _refuse_extra(
        self,
        evidence: Evidence,
        heard: Sequence[tuple[float, Any]],
        left: Sequence[tuple[float, Any]],
    ) -> NoReturn:
        expected = f'one message on {self.outer} for each one on {self.inner}, and no other'
        rights = {self.answer(value) for _, value in heard}
        others = {
            self.answer(sent.fields[self.field]): sent.topic
            for sent in evidence.life.sent
            if sent.topic != self.inner
        }
        other = next((v for _, v in left if v in others and v not in rights), None)
        # Of a text without letters, the echo is the answer: another one tells more.
        at, value = next(((t, v) for t, v in left if v not in rights), left[0])
        answered = [v for t, v in heard if self.answer(v) == value and t <= at]
        before = [v for t, v in heard if t <= at]
        silent = [v for t, v in heard if t <= at < t + WITHIN_SEC and self.answer(v) is None]
        why, todo = '', f'Publish on {self.outer} only in the callback for {self.inner}, and once.'
        if other is not None:
            why = f'What comes on {others[other]} is answered, too. Nobody asked for that.'
        elif Counter(v for _, v in left) == Counter(self.answer(v) for _, v in heard):
            why = 'A message is answered more than once.'
        elif silent:
            why = f'Upon {show(silent[-1:])} nothing is to be said.'
            todo = f'Look at what has come before you publish on {self.outer}.'
        elif self._repeats(heard, left) >= MANY:
            why = 'The answer is repeated, again and again: a timer or a loop publishes it.'
        elif answered:
            why = 'A message is answered more than once.'
        elif before and value == before[-1]:
            why = 'What came in goes out as well, as it is, beside the answer.'
        elif not before:
            why = 'It publishes although nothing has come.'
        else:
            why = 'More is published than answers.'
        raise Fail(
            expected,
            f'{len(left)} more on {self.outer}: {self.field} = {show([v for _, v in left])}',
            why=why,
            todo=todo,
        )


def find_stage(
    probe: Probe, inner: str, outer: str, test: dict[str, Any], *, by: str = ''
) -> tuple[Endpoint, Endpoint]:
    """Expect a node of the learner's that subscribes to one topic and publishes on another one.

    Args:
        probe: The probe of the check.
        inner: Full name of the topic that it hears.
        outer: Full name of the topic that it publishes on.
        test: Fields of a message to send, should the node not have a publisher yet.
        by: Full name of the node; any node if empty.

    Returns:
        Its subscription and its publisher.

    Raises:
        NotAttempted: Nothing of the learner's is there.
        Fail: One of the two is missing, misnamed, of another type, or not the only one.
    """
    from labkit.exercises import expect

    found = probe.publishers(outer)
    if not by and found:
        by = expect.publisher(probe, outer).node
    hears = expect.subscription(probe, inner, by=by)
    echoes = {endpoint.node for endpoint in probe.publishers(inner)}
    if not found and hears.node not in echoes:
        probe.sender(inner, hears.msg_type)(test)
        probe.wait(lambda: probe.publishers(outer), FIRST_ANSWER_SEC)
    return hears, expect.publisher(probe, outer, by=hears.node)


def _others(probe: Probe, hears: Endpoint) -> list[Endpoint]:
    """Return what else the node hears, of the same type, though nobody has asked for it."""
    return [
        end
        for end in probe.all_subscriptions()
        if end.node == hears.node
        and end.topic not in probe.scope.subscribes
        and end.msg_type == hears.msg_type
    ]


def value_of(sample: Sample, path: str) -> Any:
    """Return a field of a message; dots lead to inner ones."""
    return reduce(getattr, path.split('.'), sample.message)
