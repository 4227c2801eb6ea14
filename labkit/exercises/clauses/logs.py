"""A clause on a node that logs each message that it hears."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises import common_mistakes
from labkit.exercises.clauses.answering import WITHIN_SEC, said_upon, value_of
from labkit.exercises.clauses.base import Evidence, GraphClause, Test
from labkit.exercises.draws import draw_texts
from labkit.exercises.expect.spinning import hanging, spun
from labkit.exercises.expect.values import show
from labkit.exercises.figures import many
from labkit.exercises.history import Note, history
from labkit.exercises.messages_heard import Lived, Sample
from labkit.exercises.mistakes import Mistake, anything, recognise
from labkit.exercises.observation import SAME_SEC, STEP_SEC
from labkit.exercises.verdict import Fail
from labkit.exercises.what_is_asked import SUBSCRIPTION, Role

__all__ = ['Logs']


@dataclass(frozen=True, eq=False)
class Logs(GraphClause):
    """A node logs a line for each message, and the line holds its text.

    Attributes:
        topic: Full name of the topic that it hears.
        msg_type: Name of its type.
        words: What is asked for, in words of the task.
        draw: Draws the texts that are sent as tests.
        field: Name of the field that holds the text.
        line: What has to stand in the line, from the text; the text itself if None.
        mistakes: What a wrong node may log. The first one whose model, made from the text, stands
            in the line is the reason.
        explain: Gets a text, and the line that came for it; returns the reason, or None.
        named: Returns the words of another clause, if that one says what is logged for a text, or,
            for None, that nothing else is.
    """

    topic: str
    msg_type: str
    words: str
    draw: Callable[[], Sequence[str]] = draw_texts
    field: str = 'data'
    line: Callable[[str], str] | None = None
    mistakes: Sequence[Mistake] = ()
    explain: Callable[[str, str], Mistake | None] = lambda text, line: None
    named: Callable[[str | None], str] = lambda text: ''

    @property
    def roles(self) -> dict[Role, str]:
        """It subscribes."""
        return {(SUBSCRIPTION, self.topic): self.msg_type}

    @property
    def listens(self) -> Collection[str]:
        """Where it hears."""
        return (self.topic,)

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription."""
        evidence.subscription(self.topic)

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return messages to be logged."""
        hears = evidence.subscription(self.topic)
        spun(evidence.probe, hears)
        return [
            Test(self.topic, hears.msg_type, {self.field: text}, ('/rosout',))
            for text in self.draw()
        ]

    def judge(self, evidence: Evidence) -> str:
        """Judge the lines: one for each message, and no other."""
        source, life = evidence.subscription(self.topic), evidence.life
        left = _lines_of(source.node, life.on('/rosout'))
        heard = [
            (each, is_due, self._wanted(each))
            for each, is_due in life.heard(self.topic, WITHIN_SEC)
        ]
        missing: list[Lived] = []
        known: list[str] = []
        # What stands before and after the text. An empty one is in every line.
        forms: list[tuple[str, str]] = []
        # The longest text takes its line first: a line that holds it may hold shorter ones, too.
        for sample, is_due, text in sorted(heard, key=lambda each: -len(each[2])):
            end = sample.at + WITHIN_SEC
            fits = [p for p in left if sample.at <= p[0] < end and text in p[1]]
            if fits:
                usual = (p for p in fits if any(p[1] == a + text + b for a, b in forms))
                found = next(usual, fits[0])
                left.remove(found)
                known.append(found[1])
                if text:
                    before, _, after = found[1].partition(text)
                    forms.append((before, after))
            elif is_due:
                missing.append(sample)
        if missing:
            self._refuse_missing(evidence, min(missing, key=lambda sample: sample.at), left, known)
        # At the beginning it may log what came before: a node may keep what it hears.
        notes = evidence.heard_by(source.node, self.topic)
        began = life.began or evidence.began
        earlier = [n for n in notes or () if n.began < began]
        texts = None if notes is None else list(map(self._wanted, earlier))
        more = [
            (t, line)
            for t, line in left
            if t >= WITHIN_SEC or (texts is not None and not any(text in line for text in texts))
        ]
        more = life.without_strangers(self.topic, more, known)
        if more:
            self._refuse_more(evidence, [sample.at for sample, *_ in heard], known, more)
        if texts is not None:
            self._refuse_earlier(evidence, texts)
        return (
            f'{source.node} logged each of {len(heard)} texts in a line. Of lines from before the '
            'check, only those of timers were looked at.'
        )

    def _refuse_earlier(self, evidence: Evidence, texts: Sequence[str]) -> None:
        """Raise Fail if a timer has logged what no message said, since the node was made.

        /rosout keeps a line for ten seconds (rcl/src/rcl/logging_rosout.c), so what it has would
        depend on when the check is run.
        """
        name = evidence.subscription(self.topic).node
        node = evidence.probe.node_object(name)
        early = history.lines_of(node) if node is not None else []
        lines = [
            line.text
            for line in early
            if line.began < (evidence.life.began or evidence.began)
            and _is_of(name, line.logger)
            and not any(text in line.text for text in texts)
        ]
        if lines:
            fail = Fail(
                f'one line of {name} for each message on {self.topic}, and no other',
                f'{many(len(lines), "line")} more, before the check: {show(lines)}',
                common_mistakes.LOGS_UNASKED,
            )
            fail.clause = self.named(None)
            raise fail

    def _wanted(self, sample: Sample | Note) -> str:
        text = str(value_of(sample, self.field))
        return text if self.line is None else self.line(text)

    def _refuse_missing(
        self,
        evidence: Evidence,
        sample: Lived,
        left: Sequence[tuple[float, str]],
        known: Sequence[str],
    ) -> NoReturn:
        source = evidence.subscription(self.topic)
        heard, text = str(value_of(sample, self.field)), self._wanted(sample)
        here = said_upon(sample.at, left)
        if not here:
            hanging()
        mistake = common_mistakes.LOGS_SOME if any(known) else common_mistakes.NOT_LOGGED
        late = [t - sample.at for t, line in left if text and t > sample.at and text in line]
        if here:
            found = self.explain(heard, here[0]) or recognise(
                self.mistakes, lambda each: _is_in(each, heard, here[0])
            )
            mistake = found or common_mistakes.LOGS_ELSE
        elif late:
            mistake = common_mistakes.LOGS_LATE.of(seconds=min(late))
        fail = Fail(
            f'{source.node} logs a line with {show([text])} when '
            f'{"that" if text == heard else show([heard])} comes on {self.topic}',
            f'{source.node} logged {show(here)}' if here else f'{source.node} logged nothing',
            mistake,
        )
        fail.clause, fail.at = self.named(heard), sample.at
        raise fail

    def _refuse_more(
        self,
        evidence: Evidence,
        moments: Sequence[float],
        known: Sequence[str],
        more: Sequence[tuple[float, str]],
    ) -> NoReturn:
        source, step = evidence.subscription(self.topic), evidence.life.step
        again = [line for _, line in more if line in known]
        with_one = [
            line for t, line in more if any(abs(t - at) <= step + SAME_SEC for at in moments)
        ]
        # With longer steps, lines of a timer come with a message by chance.
        is_exact = step <= STEP_SEC
        mistake = common_mistakes.LOGS_UNASKED
        if 2 * len(again) > len(more):
            mistake = common_mistakes.LOGS_TWICE
        elif 2 * len(with_one) > len(more) and (is_exact or 2 * len(more) > len(moments)):
            mistake = common_mistakes.LOGS_BESIDE
        fail = Fail(
            f'one line of {source.node} for each message on {self.topic}, and no other',
            f'{many(len(more), "line")} more: {show([line for _, line in more])}',
            mistake,
        )
        fail.clause, fail.at = self.named(None), more[0][0]
        raise fail


def _is_in(mistake: Mistake, text: str, line: str) -> bool:
    """Tell whether a node with this mistake may have logged a line for a text."""
    said = mistake.answer(text)
    return mistake.model is anything or (isinstance(said, str) and said in line)


def _lines_of(node: str, samples: Iterable[Lived]) -> list[tuple[float, str]]:
    """Return the lines of a node's logger and of the loggers below it, with their times `at`.

    Args:
        node: Full name of the node.
        samples: Messages of /rosout.
    """
    return [
        (sample.at, sample.message.msg) for sample in samples if _is_of(node, sample.message.name)
    ]


def _is_of(node: str, logger: str) -> bool:
    """Tell whether a logger is that of a node, or below it."""
    name = node.strip('/').replace('/', '.')
    return logger == name or logger.startswith(f'{name}.')
