"""Clauses on parameters: declared as asked for, followed while the node runs, guarded."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.errors import nearest
from labkit.exercises import common_mistakes, expect
from labkit.exercises.clauses.base import Evidence, GraphClause, Stream
from labkit.exercises.clauses.parameter_client import Values, asked, get_values, kept, set_values
from labkit.exercises.clauses.publishing import Publishes
from labkit.exercises.expect import spinning
from labkit.exercises.figures import many
from labkit.exercises.observation import LIFE_SEC
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Follows', 'HasParameter', 'Refuses']

# How many messages of a changed rate are looked at, and how long at least, s.
MESSAGES, LEAST_SEC = 12, 3.0
# So many sets of values are looked at in another process, where each takes long.
ELSEWHERE = 4
# Fewer than that do not tell a rate.
FEW = 6
# A node may begin anew with a message when a parameter changes.
AT_ONCE = 1
# What comes so slowly is looked at in steps of this rate, Hz.
SLOW_HZ = 2.0
# What rclpy says where a callback does not return a SetParametersResult (rclpy/node.py).
INVALID = 'Callback returned an invalid type'
_TYPES = {bool: 'boolean', int: 'integer', float: 'double', str: 'string'}


@dataclass(frozen=True)
class HasParameter(GraphClause):
    """A node has declared a parameter: of a type, perhaps with limits, with a description.

    Attributes:
        node: Full name of the node.
        name: Name of the parameter.
        kind: The type in Python: bool, int, float or str.
        words: What is asked for, in words of the task.
        limits: The range that its descriptor has to have; none is asked for if None.
    """

    node: str
    name: str
    kind: type
    words: str
    limits: tuple[float, float] | None = None

    def find(self, evidence: Evidence) -> None:
        """Ask the node for the parameter and its descriptor."""
        from labkit.asking.parameter_calls import describe_parameters, parameter_names
        from labkit.rosgraph.parameter_values import type_word

        probe, node = evidence.probe, self.node
        if not spinning.runs(probe, node):
            expect.hanging()
            raise Fail(
                f'{node} answers questions about its parameters',
                f'{node} is there, but it is not spun',
                todo=spinning.how_to_spin(probe, node),
            )
        with asked(probe, node):
            names = parameter_names(probe.spun_node, node)
            if self.name not in names:
                self._refuse_missing(names)
            found = describe_parameters(probe.spun_node, node, [self.name])[0]
        word = _TYPES[self.kind]
        expect.that(
            type_word(found.type) == word and not found.dynamic_typing,
            expected=f'{self.name} is of type {word}',
            seen='a parameter of any type: dynamic_typing is on'
            if found.dynamic_typing
            else f'it is of type {type_word(found.type)}',
            mistake=common_mistakes.PARAMETER_TYPE.of(kind=self.kind.__name__),
        )
        expect.that(
            found.description.strip(),
            expected=f'{self.name} with a description',
            seen='a descriptor without a description',
            mistake=common_mistakes.NO_DESCRIPTION,
        )
        if self.limits is not None:
            self._judge_limits([*found.floating_point_range, *found.integer_range])

    def _refuse_missing(self, names: Sequence[str]) -> NoReturn:
        near = nearest(self.name, list(names))
        raise Fail(
            f'{self.node} has the parameter {self.name}',
            f'it has {", ".join(names)}',
            (common_mistakes.PARAMETER_NAME if near else common_mistakes.PARAMETER_MISSING).of(
                near=near, name=self.name
            ),
        )

    def _judge_limits(self, found: Sequence[Any]) -> None:
        wanted = self.limits
        seen = (found[0].from_value, found[0].to_value) if found else None
        expect.that(
            seen == wanted,
            expected=f'{self.name} with a range from {wanted[0]} to {wanted[1]}',  # type: ignore[index]
            seen=f'a range from {seen[0]} to {seen[1]}' if seen else 'no range',
            mistake=common_mistakes.OTHER_RANGE if seen else common_mistakes.NO_RANGE,
        )


@dataclass(frozen=True, eq=False)
class Follows(GraphClause):
    """What a node publishes follows its parameters, at once after each change.

    Attributes:
        node: Full name of the node.
        topic: Full name of the topic. Its type is in the `publishes` of the exercise.
        words: What is asked for, in words of the task.
        draw: Draws the values that are set, one set after the other. A set is set at once.
        hz: How many messages a second there are with some values.
        rule: Gets the values and the messages that came with them, and raises Fail.
    """

    node: str
    topic: str
    words: str
    draw: Callable[[], Sequence[Values]]
    hz: Callable[[Values], float]
    rule: Callable[[Values, Stream], None] = lambda _values, _stream: None
    own_life = True

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher."""
        evidence.publisher(self.topic, self.node)

    def judge(self, evidence: Evidence) -> str:
        """Set the parameters, and look at what is published then."""
        sets = self.draw()
        if evidence.probe.node_object(self.node) is None:
            sets = sets[:ELSEWHERE]
        with kept(evidence.probe, self.node, list(sets[0])) as before:
            self.look(evidence, before)
            for values in sets:
                self.look(evidence, values, before)
                before = values
        return f'{self.node} follows {_show(sets[0])}, and {len(sets) - 1} more.'

    def _set(self, probe: Probe, values: Values) -> None:
        complaint = set_values(probe, self.node, values)
        if complaint is not None:
            if complaint == INVALID:
                raise Fail(
                    f'{self.node} takes {_show(values)}',
                    f'it refuses: {complaint}',
                    common_mistakes.NO_RESULT,
                )
            raise Fail(
                f'{self.node} takes {_show(values)}',
                f'it refuses: {complaint or "without a reason"}',
                common_mistakes.REFUSES_SET
                if len(values) > 1
                else common_mistakes.REFUSES_ALLOWED,
            )

    def look(self, evidence: Evidence, values: Values, before: Values | None = None) -> None:
        """Let time pass, and look at what is published.

        Args:
            evidence: What was seen up to now.
            values: The values that the node has,
            before: and those that it has had until now. If given, the others are set first.

        Raises:
            Fail: It is not what belongs to them.
        """
        now = self._seen(evidence, values, is_new=before is not None)
        try:
            self._fit(now, values)
        except Fail as fail:
            expected = f'with {_show(values)}: {fail.expected}'
            if before is None or not self._is_as_before(evidence, before):
                mistake = fail.mistake
                if mistake is not None and mistake.id == 'rate/other':
                    mistake = common_mistakes.PARAMETER_RATE
                raise Fail(expected, fail.seen, mistake, todo=fail.todo) from None
            raise Fail(
                expected,
                fail.seen,
                common_mistakes.READ_ONCE,
            ) from None

    def _seen(self, evidence: Evidence, values: Values, *, is_new: bool = False) -> Evidence:
        """Let time pass as exactly as the rate needs it that belongs to these values.

        New ones are set while time stands still. So what comes then is what the change sets off.

        Raises:
            Fail: That is more than one message.
        """
        rate = self._rate(evidence.probe, values)
        topics, seconds = {self.topic: rate.msg_type}, max(LEAST_SEC, MESSAGES / rate.hz)
        changed = math.inf

        def change() -> None:
            nonlocal changed
            changed = time.time()
            self._set(evidence.probe, values)

        before = change if is_new else None
        life = evidence.live(topics, seconds, [rate], nodes=[self.node], before=before)
        said = life.on(self.topic, before=True)
        at_once = sum(each.at < 0 and each.stamp >= changed for each in said)
        # The time of a process that does not follow goes on meanwhile.
        stood = evidence.probe.node_object(self.node) is not None or self.node in life.remote
        if at_once > AT_ONCE and stood:
            raise Fail(
                f'with {_show(values)}: {AT_ONCE} message at most on {self.topic} in the moment '
                'of the change',
                f'{many(at_once, "message")} in that moment',
                common_mistakes.BURSTS,
            )
        if len(life.on(self.topic)) < FEW:
            # So much too slow that the reason shows only later, such as a rate for a period.
            seconds, slow = max(LIFE_SEC, FEW * rate.hz), replace(rate, hz=min(rate.hz, SLOW_HZ))
            life = evidence.live(topics, seconds, [slow], nodes=[self.node])
        now = replace(evidence, life=life)
        now.refuse_trouble(())
        return now

    def _rate(self, probe: Probe, values: Values) -> Publishes:
        msg_type = probe.scope.publishes[self.topic]
        return Publishes(self.topic, self.hz(values), msg_type, by=self.node, from_start=False)

    def _fit(self, evidence: Evidence, values: Values) -> None:
        self._rate(evidence.probe, values).judge(evidence)
        self.rule(values, evidence.streams[self.topic, self.node])

    def _is_as_before(self, evidence: Evidence, before: Values) -> bool:
        """Tell whether what is published belongs to the values before the change."""
        try:
            self._fit(self._seen(evidence, before), before)
        except (Fail, ArithmeticError):
            return False
        return True


@dataclass(frozen=True, eq=False)
class Refuses(GraphClause):
    """A node refuses values of its parameters, says why, and keeps what it had.

    Attributes:
        node: Full name of the node.
        words: What is asked for, in words of the task.
        draw: Draws the values that are set before, which are right, and the sets of values that
            are to be refused then.
        follows: What the node publishes goes on as it was, see there; not looked at if None.
    """

    node: str
    words: str
    draw: Callable[[], tuple[Values, Sequence[Values]]]
    follows: Follows | None = None

    def judge(self, evidence: Evidence) -> str:
        """Try to set each of them."""
        probe, node = evidence.probe, self.node
        keeps, sets = self.draw()
        with kept(probe, node, list(keeps)):
            complaint = set_values(probe, node, keeps)
            expect.that(
                complaint is None,
                expected=f'{node} takes {_show(keeps)}',
                seen=f'it refuses: {complaint or "without a reason"}',
                mistake=common_mistakes.REFUSES_ALLOWED,
            )
            taken = [values for values in sets if not self._is_refused(probe, keeps, values)]
            self._judge_taken(keeps, taken, sets)
            self._look(evidence, keeps)
        return f'{node} refuses {_show(sets[0])}, and {len(sets) - 1} more.'

    def _is_refused(self, probe: Probe, keeps: Values, values: Values) -> bool:
        """Try to set values; tell whether they are refused, with a reason, and nothing changes."""
        complaint = set_values(probe, self.node, values)
        if complaint is None:
            set_values(probe, self.node, keeps)
            return False
        tried = f'{_show(values)}, while it has {_show(keeps)}'
        expect.that(
            complaint != INVALID,
            expected=f'a reason why {self.node} refuses {tried}',
            seen=f'what rclpy says: {complaint}',
            mistake=common_mistakes.NO_RESULT,
        )
        expect.that(
            complaint,
            expected=f'a reason why {self.node} refuses {tried}',
            seen='no reason',
            mistake=common_mistakes.NO_REASON,
        )
        after = get_values(probe, self.node, list(keeps))
        expect.that(
            after == keeps,
            expected=f'{self.node} still has {_show(keeps)}',
            seen=f'it has {_show(after)}',
            mistake=common_mistakes.CHANGES_ANYWAY.of(values=_show(values)),
        )
        return True

    def _judge_taken(self, keeps: Values, taken: Sequence[Values], sets: Sequence[Values]) -> None:
        """Raise Fail if values were taken that are to be refused."""
        if not taken:
            return
        # That nan is a number of its own kind is the reason only where nothing else is taken.
        plain = [values for values in taken if not any(map(_is_nan, values.values()))]
        mistake = common_mistakes.TAKES_TOGETHER if len(keeps) > 1 else common_mistakes.TAKES_SOME
        if len(taken) == len(sets):
            mistake = common_mistakes.TAKES_ALL
        elif not plain:
            mistake = common_mistakes.TAKES_NAN
        raise Fail(
            f'{self.node} refuses {_show((plain or taken)[0])}, while it has {_show(keeps)}',
            'it takes it',
            mistake,
        )

    def _look(self, evidence: Evidence, keeps: Values) -> None:
        if self.follows is None:
            return
        try:
            self.follows.look(evidence, keeps)
        except Fail as fail:
            raise Fail(
                f'{fail.expected}, after it has refused other values',
                fail.seen,
                common_mistakes.USES_ANYWAY,
            ) from None


def _show(values: Values) -> str:
    return ', '.join(f'{name} = {value!r}' for name, value in values.items())


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)
