"""A clause on a node that asks one of the lesson, which notes what it is asked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from labkit.exercises import expect
from labkit.exercises.callback_count import find_node
from labkit.exercises.clauses.base import Evidence, GraphClause
from labkit.exercises.figures import many
from labkit.exercises.mistakes import Mistake, recognise
from labkit.exercises.verdict import Fail
from labkit.exercises.words import words_of

__all__ = ['AsksForEach']

WORDS = words_of(__file__)

# Of a process that is slow the last one may be on its way, s of real time.
UNDERWAY_SEC = 1.0
# A node that answers nobody for so long waits for itself, s of real time.
ANSWER_SEC = 2.5

NO_PARTNER = WORDS.mistake('asks/no-partner')
DEADLOCK = WORDS.mistake('asks/deadlock')
NOTHING = WORDS.mistake('asks/nothing')
MORE = WORDS.mistake('asks/more')
SOME = WORDS.mistake('asks/some')
CANCELED = WORDS.mistake('asks/canceled')
SAME = WORDS.mistake('asks/same')
OTHER = WORDS.mistake('asks/other')


@dataclass(frozen=True, eq=False)
class AsksForEach(GraphClause):
    """A node sends one request or goal for each message.

    Attributes:
        topic: Full name of the topic of the messages.
        by: Full name of the node.
        service: Full name of the service or the action.
        partner: Full name of the node of the lesson that serves it. Its list `asked` has the field
            of each request or goal that has come, `canceled` that of each goal called off.
        cell: The line of the lesson that makes and spins it.
        words: What is asked for, in words of the task.
        request: How the request or goal is made of the message.
        change: Gets the partner, and lets it answer otherwise than before.
        mistakes: Their models say what the request is in place of the data of the message.
        is_action: Whether it is an action.
    """

    topic: str
    by: str
    service: str
    partner: str
    cell: str
    words: str
    request: str
    change: Callable[[Any], None]
    mistakes: Sequence[Mistake] = ()
    is_action: bool = False

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription and for the partner, and change how that answers."""
        evidence.subscription(self.topic, self.by)
        partner = self._partner()
        expect.only_given(evidence.probe, self.service, self.partner)
        expect.asks(evidence.probe, self.by, self.service)
        evidence.partners.add(self.partner)
        self.change(partner)

    def tests(self, evidence: Evidence) -> Sequence[Any]:
        """Count from now on. The tests are those of the answers."""
        partner = self._partner()
        partner.asked.clear()
        if self.is_action:
            partner.canceled.clear()
        return ()

    def judge(self, evidence: Evidence) -> str:
        """Compare what was heard with what was asked."""
        from labkit.asking.service_calls import wait_until_spun

        probe, asked = evidence.probe, self._partner().asked
        heard = [sample.message.data for sample in evidence.life.on(self.topic)]
        probe.wait(lambda: len(asked) >= len(heard), UNDERWAY_SEC)
        came = list(asked)
        what = 'goal' if self.is_action else 'request'
        canceled = self._partner().canceled if self.is_action else []
        if canceled:
            raise Fail(
                f'{len(heard)} {what}s to {self.service}, each of which comes to its end',
                f'{len(canceled)} of them were canceled, such as {expect.show(canceled[:1])}',
                CANCELED,
            )
        if came == heard:
            return f'{many(len(heard), "message")}, {many(len(came), what)}.'
        if 0 < len(came) < len(heard) and not wait_until_spun(
            probe.spun_node, self.by, ANSWER_SEC
        ):
            raise Fail(
                f'a {what} to {self.service} for each message',
                f'{len(came)} of {len(heard)}, and then {self.by} answers nobody any more',
                self._in_words(DEADLOCK),
            )
        if not came:
            expect.hanging()
            expect.spun(probe, evidence.subscription(self.topic, self.by))
        if len(came) == len(heard):
            other = SAME if len({*came}) == 1 else OTHER
            mistake = recognise(self.mistakes, lambda m: [*map(m.answer, heard)] == came) or other
        else:
            mistake = MORE if len(came) > len(heard) else SOME if came else NOTHING
        wanted, seen = expect.apart(heard, came)
        raise Fail(
            f'{len(heard)} {what}s to {self.service}, with {wanted}',
            f'{len(came)} {what}s' + (f', with {seen}' if came else ''),
            self._in_words(mistake),
        )

    def _in_words(self, mistake: Mistake) -> Mistake:
        what, call = ('goal', 'send_goal') if self.is_action else ('request', 'call')
        return mistake.of(what=what, call=call, partner=self.partner, request=self.request)

    def _partner(self) -> Any:
        """Return the node of the lesson; raise Fail if nobody spins it."""
        found = find_node(self.partner)
        expect.that(
            hasattr(found, 'asked') and found.executor is not None,
            expected=f'{self.partner} of this lesson, which serves {self.service}',
            seen='nobody who serves it',
            mistake=NO_PARTNER.of(cell=self.cell),
        )
        return found
