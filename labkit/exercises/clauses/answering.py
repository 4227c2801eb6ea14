"""A clause on a node that answers each message that it hears.

Each message is answered once, and nothing is answered that did not come. Other nodes may talk on
the same topics meanwhile: what they send from this process has to be answered as well.
"""

from __future__ import annotations

import inspect
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from labkit.exercises.clauses.base import Evidence, GraphClause, Test
from labkit.exercises.draws import draw_for, filled
from labkit.exercises.expect.spinning import hanging, spun
from labkit.exercises.expect.values import show, text_trouble
from labkit.exercises.figures import figure, many
from labkit.exercises.history import Note
from labkit.exercises.messages_heard import Lived, Sample
from labkit.exercises.mistakes import Mistake, anything, recognise
from labkit.exercises.observation import SAME_SEC
from labkit.exercises.verdict import Fail
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION, Role
from labkit.exercises.words import words_of

if TYPE_CHECKING:
    from labkit.exercises.observation import Life
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['WITHIN', 'WITHIN_SEC', 'Answers', 'Explain', 'said_upon', 'value_of']

WORDS = words_of(__file__)

# How soon an answer has to come, s. A node may keep what it hears until its timer ticks.
WITHIN_SEC = 1.0
# The same in words of a task.
WITHIN = WORDS.of(seconds=figure(WITHIN_SEC)).clause('a-second' if WITHIN_SEC == 1.0 else 'within')
# So often an answer comes once more only where something repeats it.
MANY = 3
# How long the first answer of a node may take, if it makes its publisher only then, s.
FIRST_ANSWER_SEC = 0.6
# So many topics of the lesson more, which a node hears though it is not asked to, get a test, too.
MAX_OTHERS = 3

Explain = Callable[[Any, Sequence[Any]], Mistake | None]
T = TypeVar('T')
Values = Sequence[Any]
Timed = list[tuple[float, Any]]
# How long an answer took, the moment and the value of the message, and the answer.
Answered = tuple[float, float, Any, Any]

DIFFERS = WORDS.mistake('answers/differs')
SOME = WORDS.mistake('answers/some')
SILENT = WORDS.mistake('answers/silent')
LATE = WORDS.mistake('answers/late')
OTHER_TOPIC = WORDS.mistake('answers/other-topic')
TWICE = WORDS.mistake('answers/twice')
NOT_DUE = WORDS.mistake('answers/not-due')
REPEATED = WORDS.mistake('answers/repeated')
ECHO = WORDS.mistake('answers/echo')
TALKS_BACK = WORDS.mistake('answers/talks-back')
UNASKED = WORDS.mistake('answers/unasked')
ITSELF = WORDS.mistake('answers/itself')
MORE = WORDS.mistake('answers/more')
SHARED = WORDS.mistake('answers/shared')


@dataclass(frozen=True, eq=False)
class Answers(GraphClause):
    """A node answers each message on one topic with one message on another topic.

    Attributes:
        inner: Full name of the topic that it hears.
        outer: Full name of the topic that it publishes on. It may be the same one: then the node
            replies to what others say, and may make its publisher when a reply is due.
        msg_type: Name of the type of the messages on `inner`.
        words: What is asked for, in words of the task.
        answer: Returns the value of an answer from the value that was heard; None if nothing
            should be published for it. A node with a memory is a generator function, which is
            sent each value and yields the answer to it; see `resume` for where it begins.
        draw: Draws the values that are sent as tests; by their type if None.
        outer_type: Name of the type of the answers; that of the messages if empty.
        field: Name of the field that is heard, or of several: then a value is a tuple of them.
        outer_field: Name of the field that is answered; the same one if empty.
        near: How far a number may be off.
        by: Full name of the node; any node if empty.
        mistakes: What a wrong node may do. The first one whose model answers as the node did is
            the reason. A model that returns None is a node that says nothing; that of a node with
            a memory is a generator function, too.
        explain: Gets a value that was heard, and the values that came for it (maybe none);
            returns the reason where it is no matter of one answer, or None.
        resume: A node with a memory has heard messages before the check. Gets the first value and
            the first answer to it or a later one, and returns what the node may have remembered
            before; the generator function is called with each of them, and one has to fit. By
            default that is the answer, as it is for the largest value so far. None if what it has
            heard before has no influence on the answers to the tests.
        otherwise: Words of the task for what gets no answer, where they are those of a clause.
        answers_all: Whether each message has an answer. Then a node whose first answer is seen
            has heard nothing before.
        lasting: Whether a value has the same answer at all times. Else what was answered before
            the check can not be judged.
    """

    inner: str
    outer: str
    msg_type: str
    words: str
    answer: Callable[..., Any]
    draw: Callable[[], Values] | None = None
    outer_type: str = ''
    field: str | tuple[str, ...] = 'data'
    outer_field: str = ''
    near: float = 0.0
    by: str = ''
    mistakes: Sequence[Mistake] = ()
    explain: Explain | None = None
    resume: Callable[[Any, Any], Iterable[Any]] | None = lambda value, said: [said]
    otherwise: str = ''
    answers_all: bool = False
    lasting: bool = True
    judges_parts = True

    @property
    def roles(self) -> dict[Role, str]:
        """It subscribes to one topic, and publishes on another one."""
        return {
            (SUBSCRIPTION, self.inner): self.msg_type,
            (PUBLISHER, self.outer): self.outer_type or self.msg_type,
        }

    @property
    def listens(self) -> Collection[str]:
        """Both topics."""
        return (self.inner, self.outer)

    @property
    def _shown(self) -> str:
        return self.field if isinstance(self.field, str) else ', '.join(self.field)

    @property
    def _says(self) -> str:
        return self.outer_field or (self.field if isinstance(self.field, str) else 'data')

    @property
    def _remembers(self) -> bool:
        return inspect.isgeneratorfunction(self.answer)

    def _drawn(self) -> Values:
        return self.draw() if self.draw is not None else draw_for(self.msg_type)

    def _fields(self, value: Any) -> dict[str, Any]:
        if isinstance(self.field, str):
            return {self.field: value}
        return dict(zip(self.field, value, strict=True))

    def _heard(self, sample: Sample | Note) -> Any:
        if isinstance(self.field, str):
            return value_of(sample, self.field)
        return tuple(value_of(sample, path) for path in self.field)

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription and the publisher of one node."""
        from labkit.exercises import expect

        if self.inner == self.outer:
            evidence.subscription(self.inner, self.by)
            return
        probe, by = evidence.probe, self.by
        found = probe.publishers(self.outer)
        if not by and found:
            by = expect.publisher(probe, self.outer).node
        hears = expect.subscription(probe, self.inner, by=by)
        echoes = {endpoint.node for endpoint in probe.publishers(self.inner)}
        if not found and hears.node not in echoes:
            # It may make its publisher when the first message comes.
            test = self._fields(self._drawn()[0])
            probe.sender(self.inner, hears.msg_type)(test)
            evidence.asked.setdefault(self.inner, []).append(test)
            probe.wait(lambda: probe.publishers(self.outer), FIRST_ANSWER_SEC)
        says = expect.publisher(probe, self.outer, by=hears.node)
        evidence.ends['subscription', self.inner, self.by] = hears
        evidence.ends['publisher', self.outer, self.by] = says

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return messages to be answered, and some on topics that are none of its business."""
        hears = evidence.subscription(self.inner, self.by)
        spun(evidence.probe, hears)
        values = self._drawn()
        known = not self._remembers or self.resume is None
        rights = self._rights(values, []) if known else values
        tests: list[Test] = []
        for i, (value, right) in enumerate(zip(values, rights, strict=True)):
            # What is sent twice in a row is the same message, with all that no task names.
            again = i and value == values[i - 1]
            fields = tests[-1].fields if again else filled(hears.msg_type, self._fields(value))
            due = int(right is not None)
            tests.append(Test(self.inner, hears.msg_type, fields, (self.outer,), due=due))
        for other in _others(evidence.probe, hears)[:MAX_OTHERS]:
            # An answer to it tells by itself where it comes from.
            value = next((value for value in self._drawn() if value not in values), values[1])
            tests.append(Test(other.topic, other.msg_type, self._fields(value)))
        return tests

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers."""
        life = evidence.life
        self._refuse_talking_back(evidence)
        in_turn, answers = self._in_turn(life)
        values = [self._heard(s) for s in in_turn]
        said = [(s.at, value_of(s, self._says)) for s in answers]
        rights = self._rights(values, _following(answers, in_turn))
        came = [(at, self._same(value, rights)) for at, value in said]
        right_of = {id(sample): right for sample, right in zip(in_turn, rights, strict=True)}
        heard = [(s.at, value, right_of[id(s)]) for s, value in zip(in_turn, values, strict=True)]
        left = list(came)
        answered: list[Answered] = []
        waiting = [
            (sample.at, self._heard(sample), right_of[id(sample)], is_due)
            for sample, is_due in life.heard(self.inner, WITHIN_SEC)
            if right_of.get(id(sample)) is not None
        ]
        # What comes at once, or in time, is nobody else's late answer.
        for longest in (SAME_SEC, WITHIN_SEC, math.inf):
            for each in list(waiting):
                at, value, right, _ = each
                found = next(
                    (i for i, (t, v) in enumerate(left) if 0 <= t - at < longest and v == right),
                    None,
                )
                if found is not None:
                    answered.append((left[found][0] - at, at, value, right))
                    del left[found]
                    waiting.remove(each)
        missing = [(at, value, right) for at, value, right, is_due in waiting if is_due]
        if missing and any(
            WITHIN_SEC <= t < missing[0][0] and v == missing[0][2] for t, v in left
        ):
            # It was said before it was due, and that is where it went wrong.
            self._refuse_extra(evidence, heard, left)
        sure = [(s.at, right_of[id(s)]) for s in in_turn if life.is_known(self.inner, s)]
        unsure = [(s.at, right_of[id(s)]) for s in in_turn if not life.is_known(self.inner, s)]
        # What a timer says again and again is missed where two messages come between its ticks.
        repeated = _repeats(heard, left) >= MANY and _always_last(sure, unsure, came)
        if missing and not repeated:
            self._refuse_missing(evidence, missing, left, answered)
        if not repeated:
            self._refuse_late(evidence, answered)
        # At the beginning it may answer what came before: a node may keep what it hears.
        extra = [(t, value) for t, value in left if t >= WITHIN_SEC]
        sent = [self._heard_of(s.fields) for s in life.sent if self._fits(s.fields)]
        known = {*sent, *(rights if self._remembers else map(self.answer, sent))}
        # Who says one thing again and again may have said it once more than was seen.
        for right in {right for _, right in unsure}:
            once_more = next((each for each in extra if each[1] == right), None)
            if once_more is not None:
                extra.remove(once_more)
        extra = self._without_first(evidence, life.without_strangers(self.inner, extra, known))
        if extra:
            self._refuse_extra(evidence, heard, extra)
        if missing:
            self._refuse_missing(evidence, missing, left, answered)
        self._refuse_earlier(evidence)
        examples = [(value, right) for _, value, right in heard if right is not None][:2]
        pairs = ', '.join(f'{show([value])} -> {show([right])}' for value, right in examples)
        hears = evidence.subscription(self.inner, self.by)
        return f'{hears.node} has answered {many(len(answered), "message")}, each once: {pairs}.'

    def _without_first(self, evidence: Evidence, extra: Timed) -> Timed:
        """Leave out answers to what was sent before time passed: a busy process is slow."""
        asked = [] if self._remembers else evidence.asked.get(self.inner, [])
        due = [self.answer(self._heard_of(fields)) for fields in asked if self._fits(fields)]
        left = []
        for moment, value in extra:
            if value in due:
                due.remove(value)
            else:
                left.append((moment, value))
        return left

    def _refuse_earlier(self, evidence: Evidence) -> None:
        """Raise Fail if the node has published something else than answers since it was made.

        What it has said while the learner may have tried something out is not looked at.
        """
        hears = evidence.subscription(self.inner, self.by)
        # In this order: time goes on, and what was heard for each answer is known before it.
        said = evidence.said_by(hears.node, self.outer)
        heard = evidence.heard_by(hears.node, self.inner)
        if said is None or not self.lasting:
            return
        if heard is None:
            # Whatever it has heard: what it says while it is made, nobody has asked for.
            said, heard = [each for each in said if each.in_making], []
        node = evidence.probe.node_object(hears.node)
        others = [each for each in heard if not each.is_by(node)]
        due, rights, extra = Counter[Any](), list[Any](), list[Any]()
        mistake = UNASKED
        for note in sorted([*others, *said], key=lambda each: each.began):
            if not note.is_by(node):
                # What a node with a memory has to say, is judged in the check alone.
                right = '' if self._remembers else self.answer(self._heard(note))
                due[right] += right is not None
                rights.append(right)
                continue
            value = value_of(note, self._says)
            right = '' if self._remembers else self._same(value, rights)
            if due[right]:
                due[right] -= 1
                continue
            if rights and not extra:
                mistake = TWICE if right in rights else MORE
            extra.append(value)
        if extra:
            raise Fail(
                f'one message on {self.outer} for each one on {self.inner}, and no other',
                f'{len(extra)} more on {self.outer} since {hears.node} was made: {self._says} = '
                f'{show(extra)}',
                mistake.of(inner=self.inner, outer=self.outer),
            )

    def _refuse_talking_back(self, evidence: Evidence) -> None:
        """Raise Fail if the node speaks on the topic that it hears, and no task asks for that."""
        life, node = evidence.life, evidence.subscription(self.inner, self.by).node
        besides = [s for s in life.besides_tests(self.inner) if s.node in ('', node)]
        if self.inner == self.outer or not besides:
            return
        scope, role = evidence.probe.scope, (PUBLISHER, self.inner)
        if role in scope.roles or role in scope.earlier:
            return
        if any(end.node == node for end in evidence.probe.publishers(self.inner)):
            raise Fail(
                f'messages of {node} on {self.outer}, and none on {self.inner}',
                f'{len(besides)} on {self.inner}: {self._shown} = '
                f'{show(list(map(self._heard, besides)))}',
                TALKS_BACK.of(inner=self.inner, outer=self.outer),
            )

    def _in_turn(self, life: Life) -> tuple[list[Lived], list[Lived]]:
        """Return what was heard, and what was said."""
        # What was heard just before time began may be answered just after.
        heard, said = (life.on(topic, before=True) for topic in (self.inner, self.outer))
        if self.inner == self.outer:
            said = life.besides_tests(self.outer, before=True)
            heard = [s for s in heard if not any(s is other for other in said)]
        if self._remembers:
            heard = [s for s in heard if s.at >= life.since]
        return heard, said

    def _rights(
        self, heard: Values, answers: Sequence[Sample], model: Callable[..., Any] | None = None
    ) -> Values:
        """Return the right answer to each value that was heard, or that of a model."""
        if not self._remembers:
            return [self.answer(value) for value in heard]
        came = [value_of(sample, self._says) for sample in answers]
        memories: Iterable[Any] = [None]
        is_new = self.answers_all and bool(answers) and answers[0].number == 1
        if self.resume and heard and came and not is_new:
            memories = self.resume(heard[0], came[0])
        found = [_replies(model or self.answer, memory, heard) for memory in memories]
        if len(found) == 1:
            return found[0]
        # What it remembered fits what it said, where anything does.
        said = Counter(came)
        return max(found, key=lambda rights: (Counter(rights) & said).total(), default=[])

    def _same(self, value: Any, rights: Values) -> Any:
        """Return the right answer that a value stands for, the value itself if it is none."""
        if not self.near:
            return value
        return next((right for right in rights if self._is_near(right, value)), value)

    def _is_near(self, right: Any, value: Any) -> bool:
        return isinstance(right, (int, float)) and abs(right - value) <= self.near

    def _explained(
        self,
        evidence: Evidence,
        at: float,
        value: Any,
        came: Values,
        answered: Sequence[Answered],
    ) -> Mistake | None:
        """Return the reason that the exercise knows for wrong answers to a value."""

        def fits(mistake: Mistake) -> bool:
            if inspect.isgeneratorfunction(mistake.model):
                in_turn, answers = self._in_turn(evidence.life)
                heard, answers = list(map(self._heard, in_turn)), _following(answers, in_turn)
                number = [sample.at for sample in in_turn].index(at)
                said = self._rights(heard, answers, mistake.model)[number]
                return any(said == each or self._is_near(said, each) for each in came)
            said = mistake.answer(value)
            if came:
                return said in came
            # It is silent here, and not where this node has answered.
            return said is None and all(mistake.answer(v) == r for _, _, v, r in answered)

        found = recognise(self.mistakes, fits)
        if found is not None:
            return found
        if self._repeats_others(evidence, value, came):
            return REPEATED.of(inner=self.inner, outer=self.outer)
        return self.explain(value, came) if self.explain is not None else None

    def _has_a_timer(self, evidence: Evidence) -> bool:
        """Tell whether the node is one of this notebook, and has a timer."""
        node = evidence.probe.node_object(evidence.subscription(self.inner, self.by).node)
        return node is not None and any(node.timers)

    def _repeats_others(self, evidence: Evidence, value: Any, came: Values) -> bool:
        """Tell whether a timer has said what is right for other messages, and nothing else."""
        if not came or self._remembers or not self._has_a_timer(evidence):
            return False
        heard, _ = self._in_turn(evidence.life)
        others = {self.answer(each) for each in map(self._heard, heard) if each != value}
        return {*came} <= others - {self.answer(value)}

    def _refuse_missing(
        self,
        evidence: Evidence,
        missing: Sequence[tuple[float, Any, Any]],
        left: Sequence[tuple[float, Any]],
        answered: Sequence[Answered],
    ) -> NoReturn:
        hears = evidence.subscription(self.inner, self.by)
        # What came at once for a message may have been taken for a late answer to another one, but
        # not for one to somebody else: when that was heard, nobody knows.
        others = self._by_others(evidence.life)
        late = [
            (at + delay, right)
            for delay, at, _, right in answered
            if delay >= SAME_SEC and at not in others
        ]

        def came_for(at: float) -> list[Any]:
            return said_upon(at, [*left, *((t, v) for t, v in late if 0 <= t - at < SAME_SEC)])

        # Some texts hide what is wrong, as one of digits that are to become capital letters does.
        came_of = [(value, right, came_for(at), at) for at, value, right in missing]
        value, right, came, at = next(
            (each for each in came_of if {*each[2]} - {each[0]}), came_of[0]
        )
        if not left:
            hanging()
        mistake = self._explained(evidence, at, value, came, answered)
        if mistake is None or mistake.model is anything:
            # What answers something else may have come beside it.
            troubles = (text_trouble(each, right) for each in reversed(came))
            mistake = next(filter(None, troubles), mistake)
        if mistake is None and answered:
            mistake = SOME.of(answered=len(answered), count=len(answered) + len(missing))
        if mistake is None:
            silent = SILENT.of(node=hears.node, inner=self.inner, outer=self.outer)
            mistake = DIFFERS if came else silent
        fail = Fail(
            f'{self._says} = {show([right])} on {self.outer} when {self._shown} = {show([value])} '
            f'comes on {self.inner}',
            f'{self._says} = {show(came)}' if came else f'nothing on {self.outer}',
            mistake,
        )
        fail.at = at
        raise fail

    def _by_others(self, life: Life) -> set[float]:
        """Return when messages came of which nobody knows when the node has heard them."""
        return {s.at for s in life.on(self.inner) if not life.is_known(self.inner, s)}

    def _refuse_late(self, evidence: Evidence, answered: Sequence[Answered]) -> None:
        """Raise Fail if a test was answered too late.

        What others have sent is not looked at: they may have sent it in real time. Neither is a
        process whose time was real: what keeps it busy is not known.
        """
        life = evidence.life
        node = evidence.subscription(self.inner, self.by).node
        if node in life.real and node not in life.lost:  # one that is lost did follow
            return
        others = self._by_others(life)
        tests = {sent.at for sent in life.sent if sent.topic == self.inner}
        late = [
            (delay, value, at)
            for delay, at, value, _ in answered
            if delay > WITHIN_SEC + life.step + SAME_SEC
            and at not in others
            and any(abs(at - sent) < SAME_SEC for sent in tests)
        ]
        if late:
            delay, value, at = max(late, key=lambda each: each[0])
            fail = Fail(
                f'an answer on {self.outer} within {figure(WITHIN_SEC)} s',
                f'{delay:.1f} s from {self._shown} = {show([value])} to its answer',
                LATE,
            )
            fail.at = at
            raise fail

    def _refuse_extra(
        self,
        evidence: Evidence,
        heard: Sequence[tuple[float, Any, Any]],
        left: Sequence[tuple[float, Any]],
    ) -> NoReturn:
        rights = {right for _, _, right in heard}
        others = {}
        if not self._remembers:
            others = {
                self.answer(self._heard_of(each.fields)): each.topic
                for each in evidence.life.sent
                if each.topic != self.inner and self._fits(each.fields)
            }
        other = next((v for _, v in left if v in others and v not in rights), None)
        # Of a text without letters, the echo is the answer: another one tells more.
        at, value = next(((t, v) for t, v in left if v not in rights), left[0])
        answered = [v for t, v, right in heard if right == value and t <= at]
        before = [v for t, v, _ in heard if t <= at]
        # Where several speak, another message may have come between a message and its echo.
        lately = [v for t, v, _ in heard if t <= at < t + WITHIN_SEC] or before[-1:]
        silent = [v for t, v, right in heard if t <= at < t + WITHIN_SEC and right is None]
        if other is not None:
            mistake = OTHER_TOPIC.of(topic=others[other])
        elif Counter(v for _, v in left) == Counter(r for _, _, r in heard if r is not None):
            mistake = TWICE
        elif silent:
            came = [v for t, v in left if at <= t < at + WITHIN_SEC]
            named = [each for each in self.mistakes if each.model is not anything]
            found = recognise(named, lambda each: each.answer(silent[-1]) in came)
            mistake = found if found is not None else NOT_DUE.of(value=show(silent[-1:]))
        elif _between(heard, left) and self._has_a_timer(evidence):
            mistake = REPEATED
        elif _repeats(heard, left) >= MANY:
            known = evidence.probe.node_object(evidence.subscription(self.inner, self.by).node)
            mistake = SHARED if known is not None else REPEATED
        elif answered:
            mistake = TWICE
        elif value in lately:
            mistake = ECHO
        elif before and self.inner == self.outer:
            mistake = ITSELF
        else:
            mistake = MORE if before else UNASKED
        fail = Fail(
            f'one message on {self.outer} for each one on {self.inner}, and no other',
            f'{len(left)} more on {self.outer}: {self._says} = {show([v for _, v in left])}',
            mistake.of(inner=self.inner, outer=self.outer),
        )
        fail.at = at
        if silent or mistake is ITSELF:
            fail.clause = self.otherwise
        raise fail

    def _fits(self, fields: Mapping[str, Any]) -> bool:
        paths = (self.field,) if isinstance(self.field, str) else self.field
        return {*paths} <= fields.keys()

    def _heard_of(self, fields: Mapping[str, Any]) -> Any:
        if isinstance(self.field, str):
            return fields[self.field]
        return tuple(fields[path] for path in self.field)


def _following(answers: Sequence[Lived], heard: Sequence[Lived]) -> list[Lived]:
    """Return the answers that came after something was heard."""
    return [each for each in answers if heard and each.at >= heard[0].at]


def said_upon(at: float, said: Sequence[tuple[float, T]]) -> list[T]:
    """Return what was said at once for a message, or else what came within the time for it."""
    here = [(t, value) for t, value in said if at <= t < at + WITHIN_SEC]
    return [v for t, v in here if t - at < SAME_SEC] or [value for _, value in here]


def _replies(answer: Callable[..., Any], memory: Any, heard: Values) -> list[Any]:
    """Return what a node with a memory answers to each value."""
    node = answer(memory)
    next(node)
    return [node.send(value) for value in heard]


def _repeats(heard: Sequence[tuple[float, Any, Any]], left: Sequence[tuple[float, Any]]) -> int:
    """Return how often a right answer came once more for a message, at most."""
    rights = Counter(right for _, _, right in heard)
    more = Counter(value for _, value in left if value in rights)
    return max((count // rights[value] for value, count in more.items()), default=0)


def _between(heard: Sequence[tuple[float, Any, Any]], left: Sequence[tuple[float, Any]]) -> bool:
    """Tell whether right answers come once more mostly between messages, as a timer says them."""
    rights = {right for _, _, right in heard}
    more = [t for t, value in left if value in rights]
    at_once = sum(any(0 <= t - at < SAME_SEC for at, _, _ in heard) for t in more)
    return len(more) >= MANY and at_once < len(more) / 2


def _always_last(sure: Timed, unsure: Timed, came: Timed) -> bool:
    """Tell whether all that was said is the answer to the last message at that moment.

    Args:
        sure: When messages were heard, and the answers to them.
        unsure: The same of messages of strangers, when they were sent: the node has heard each of
            them once, then or later.
        came: What was said.
    """
    left, explained = list(unsure), list[tuple[int, Any]]()
    for at, value in came:
        before = [right for t, right in sure if t < at - SAME_SEC and right is not None]
        now = [right for t, right in sure if abs(t - at) <= SAME_SEC]
        # Until the next message a node may repeat the answer to one that it has heard meanwhile.
        if not before or value in (before[-1], *now) or (len(before), value) in explained:
            continue
        end = min((t for t, _ in sure if t > at + SAME_SEC), default=math.inf)
        found = next((each for each in left if each[0] < end and each[1] == value), None)
        if found is None:
            return False
        left.remove(found)
        explained.append((len(before), value))
    return True


def _others(probe: Probe, hears: Endpoint) -> list[Endpoint]:
    """Return what else of the lesson the node hears, of the same type, though nobody has asked.

    What it does on topics of its own is nobody's business.
    """
    return [
        end
        for end in probe.all_subscriptions()
        if end.node == hears.node
        and end.topic in probe.scope.known
        and end.topic not in probe.scope.subscribes
        and end.msg_type == hears.msg_type
    ]


def value_of(sample: Sample | Note, path: str) -> Any:
    """Return a field of a message; dots lead to inner ones."""
    return reduce(getattr, path.split('.'), sample.message)
