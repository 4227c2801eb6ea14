"""What the check of the exercise two_stages asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Fail, expect
from labkit.exercises.clauses import Answers, Clause, Evidence, Says, Test
from labkit.exercises.draws import draw_texts

__all__ = ['OPENING', 'STRING', 'Completes', 'TwoNodes', 'name_trouble', 'says_opening']

STRING = 'std_msgs/msg/String'
OPENING = 'My name is '


@dataclass(frozen=True)
class Completes(Clause):
    """A stage appends a first name to each text. Which one that is, its first answer tells."""

    inner: str = '/incomplete'
    outer: str = '/complete'
    text = (
        'for each text on `/incomplete`, publish that text with your first name right behind it '
        'on `/complete` (both `std_msgs/msg/String`), once, within a second'
    )

    def find(self, evidence: Evidence) -> None:
        """Look for the stage."""
        self._answers('').find(evidence)

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers to what stage one says, and to texts of the check alone."""
        hears = evidence.subscription(self.inner)
        texts = [OPENING, *draw_texts()]
        tests = [Test(self.inner, STRING, {'data': text}, (self.outer,)) for text in texts]
        # Stage one stands still meanwhile, so that its own messages are its own.
        tested = evidence.alone(self, tests, hears.node)
        came = [sample.message.data for sample in tested.life.on(self.outer)]
        name = self._name(came) if came else ''
        answers = self._answers(name)
        answers.judge(tested)
        answers.judge(evidence)
        one = evidence.publisher(self.inner)
        return (
            f'{one.node} -> {self.inner} -> {hears.node} -> {self.outer}: {OPENING + name!r}\n'
            f'{len(texts)} texts of the check have got the name, too.'
        )

    def _answers(self, name: str) -> Answers:
        return Answers(
            self.inner,
            self.outer,
            self.text,
            answer=lambda text: f'{text}{name}',
            draw=lambda: [OPENING],
            explain=_explain,
        )

    def _name(self, came: Sequence[str]) -> str:
        name = came[0].removeprefix(OPENING)
        why, todo = name_trouble(OPENING, came[0])
        if why:
            raise Fail(
                f'{OPENING!r} and your first name',
                f'data = {expect.show(came[:1])}',
                why=why,
                todo=todo,
            )
        return name


class TwoNodes(Clause):
    """Each stage is a node."""

    text = 'the two stages are two nodes'

    def find(self, evidence: Evidence) -> None:
        """Compare their names."""
        one = evidence.publisher('/incomplete').node
        expect.that(
            evidence.subscription('/incomplete').node != one,
            expected='two nodes, one for each stage',
            seen=f'{one} publishes on /incomplete and subscribes to it',
            why='One node does the work of both stages, so neither can be replaced without the '
            'other.',
            todo='Write a class for each stage.',
        )


def says_opening() -> Says:
    """Return what the messages of stage one have to say."""
    return Says(
        '/incomplete',
        OPENING,
        words=f'each message says `{OPENING}`, with the space at the end',
        todo=f'Publish {OPENING!r}, with a space at the end.',
    )


def name_trouble(text: str, answer: str) -> tuple[str, str]:
    """Say what is wrong with a text and a name that was appended, and what to do.

    Args:
        text: The text that came.
        answer: What was made of it.

    Returns:
        Two empty texts if it is the text with a name right behind it.
    """
    put = 'String(data=msg.data + ...), with your name for the dots.'
    name = answer.removeprefix(text)
    if answer == text or not name.strip():
        return 'The text is passed on as it came: no name is added.', put
    if answer.startswith(text):
        if text in name:
            return (
                'The texts of earlier messages are still in it: the string grows.',
                'Make a new string from msg.data each time.',
            )
        if name != name.strip():
            return 'There is a space too many beside the name.', put
        return '', ''
    if answer.startswith(text.rstrip()):
        return 'The space between the text and the name is missing.', put
    if text.strip() in answer:
        return 'The name stands before the text.', put
    return 'The text that came in is not part of what goes out.', put


def _explain(text: str, came: Sequence[str]) -> tuple[str, str]:
    if came and text.strip() and not any(text in other for other in came):
        return (
            'The string is always the same, or is changed: it is not made of the message that '
            'came, as it came.',
            'Use msg.data in the callback.',
        )
    return '', ''
