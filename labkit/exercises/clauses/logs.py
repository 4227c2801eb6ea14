"""A clause on a node that logs each message that it hears."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises.clauses.answering import WITHIN_SEC, Explain, value_of
from labkit.exercises.clauses.base import Clause, Evidence, Test
from labkit.exercises.expect.spinning import hanging, spun
from labkit.exercises.expect.values import show
from labkit.exercises.verdict import Fail
from labkit.exercises.watch import Lived

__all__ = ['Logs']


@dataclass(frozen=True, eq=False)
class Logs(Clause):
    """A node logs a line for each message, and the line holds its text.

    Attributes:
        topic: Full name of the topic that it hears.
        words: What is asked for, in words of the task.
        draw: Draws the texts that are sent as tests.
        field: Name of the field that holds the text.
        line: What has to stand in the line, from the text; the text itself if None.
        explain: Gets a text that was heard, and the lines that came upon it; returns the
            misconception and the next step, or two empty texts.
    """

    topic: str
    words: str
    draw: Callable[[], Sequence[str]]
    field: str = 'data'
    line: Callable[[str], str] | None = None
    explain: Explain | None = None

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

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
        """Judge the lines."""
        source = evidence.subscription(self.topic)
        lines = _lines_of(source.node, evidence.life.on('/rosout'))
        life, samples = evidence.life, evidence.life.on(self.topic)
        texts = [str(value_of(s, self.field)) for s in samples]
        wanted = texts if self.line is None else [self.line(text) for text in texts]
        heard = [(sample.at, line) for sample, line in zip(samples, wanted, strict=True)]
        known = [line for _, line in lines if any(text and text in line for _, text in heard)]
        for number, (at, text) in enumerate(heard):
            if not life.is_known(self.topic, samples[number]):
                continue
            later = [t for t, _ in heard[number + 1 :] if t > at]
            end = min([at + WITHIN_SEC, *later])
            here = [line for t, line in lines if at <= t < end]
            same = [n for n, (t, other) in enumerate(heard) if at <= t < end and other == text]
            holding = [line for line in here if text in line]
            if len(holding) < sum(life.is_known(self.topic, samples[n]) for n in same):
                self._refuse(evidence, texts[number], text, here, bool(known))
            if len(holding) > len(same):
                raise Fail(
                    f'one line of {source.node} for each message on {self.topic}',
                    f'{len(holding)} lines: {show(holding)}',
                    why='The same message is logged more than once.',
                    todo='Call get_logger().info(...) once in the callback.',
                )
        # At the beginning it may log what came before: a node may keep what it hears.
        silent = [
            (t, line)
            for t, line in lines
            if t >= WITHIN_SEC and not any(a <= t < a + WITHIN_SEC for a, _ in heard)
        ]
        quiet = [line for _, line in evidence.life.without_strangers(self.topic, silent, known)]
        if quiet:
            raise Fail(
                f'lines of {source.node} when a message comes, and none otherwise',
                f'{len(quiet)} lines when none had come: {show(quiet)}',
                why='A timer or a loop logs, too.',
                todo='Log in the callback of the subscription only.',
            )
        return f'{source.node} logged each of {len(heard)} texts in a line.'

    def _refuse(
        self, evidence: Evidence, heard: str, text: str, here: Sequence[str], some: bool
    ) -> NoReturn:
        source = evidence.subscription(self.topic)
        if not here:
            hanging()
        why = 'The callback runs, but its line does not hold what the message says.'
        todo = "In the callback: self.get_logger().info(f'...{msg.data}')"
        if self.explain is not None and here:
            why, todo = self.explain(heard, here)
        if not here:
            why = (
                'The callback does not log it. print() shows a text here; the logger also tells '
                'all other nodes of it.'
            )
        if some and not here:
            why = 'Some messages are logged as they came, and this one is not.'
        raise Fail(
            f'{source.node} logs a line with {show([text])} when '
            f'{"that" if text == heard else show([heard])} comes on {self.topic}',
            f'{source.node} logged {show(here)}' if here else f'{source.node} logged nothing',
            why=why,
            todo=todo,
        )


def _lines_of(node: str, samples: Iterable[Lived]) -> list[tuple[float, str]]:
    """Return the lines of a node's logger and of the loggers below it, with their times `at`.

    Args:
        node: Full name of the node.
        samples: Messages of /rosout.
    """
    logger = node.strip('/').replace('/', '.')
    return [
        (sample.at, sample.message.msg)
        for sample in samples
        if sample.message.name == logger or sample.message.name.startswith(f'{logger}.')
    ]
