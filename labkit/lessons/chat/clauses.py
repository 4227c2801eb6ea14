"""Clauses on a node that replies on the very topic that it hears."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises import Fail, expect
from labkit.exercises.clauses import Clause, Evidence, Test
from labkit.exercises.expect.values import show, text_trouble

__all__ = ['STRING', 'Replies', 'UsedOnce', 'split']

STRING = 'std_msgs/msg/String'
# How soon a reply has to come, s.
WITHIN_SEC = 1.0
# How long a publisher may take to be gone from the graph, s.
GONE_SEC = 2.0


def split(message: str) -> tuple[str, str]:
    """Return who says what: `'Bo: Hello'` is from Bo."""
    who, _, text = message.partition(': ')
    return who, text


@dataclass(frozen=True, eq=False)
class Replies(Clause):
    """A node replies on the topic that it hears, where a reply is due, and says nothing else.

    Attributes:
        topic: Full name of the topic.
        words: What is asked for, in words of the task.
        replies: The reply that each of the messages has, in their order; None where none is due.
        draw: Draws the texts that are sent as tests.
        explain: Gets a message, and what came upon it (maybe nothing); returns the misconception
            and the next step, or two empty texts.
    """

    topic: str
    words: str
    replies: Callable[[Sequence[str]], Sequence[str | None]]
    draw: Callable[[], Sequence[str]]
    explain: Callable[[str, Sequence[str]], tuple[str, str]]

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription."""
        evidence.subscription(self.topic)

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return messages of others."""
        hears = evidence.subscription(self.topic)
        expect.spun(evidence.probe, hears)
        texts = self.draw()
        return [
            Test(self.topic, STRING, {'data': text}, (self.topic,), due=right is not None)
            for text, right in zip(texts, self.replies(texts), strict=True)
        ]

    def judge(self, evidence: Evidence) -> str:
        """Compare what was published with what is due."""
        sent = [each for each in evidence.life.sent if each.topic == self.topic]
        texts = [str(each.fields['data']) for each in sent]
        left = [(s.at, s.message.data) for s in evidence.life.besides_tests(self.topic)]
        replied: set[str] = set()
        for each, text, right in zip(sent, texts, self.replies(texts), strict=True):
            here = [pair for pair in left if each.at <= pair[0] < each.at + WITHIN_SEC]
            came = [value for _, value in here]
            if right is None and came:
                self._refuse(text, came, None)
            if right is None:
                continue
            found = next((pair for pair in here if pair[1] == right), None)
            if found is None:
                self._refuse(text, came, right, again=text in replied)
            left.remove(found)
            replied.add(text)
            if right in came[came.index(right) + 1 :]:
                raise Fail(
                    f'one reply to {show([text])}',
                    f'{len(came)}: {show(came)}',
                    why='It replies more than once.',
                    todo='Publish once for each message that wants a reply.',
                )
        if left:
            raise Fail(
                f'replies on {self.topic}, and nothing else',
                f'{len(left)} more: {show([value for _, value in left])}',
                why='What it has said itself comes to it as well, and is answered, or something '
                'is said upon no message at all.',
                todo='Do not answer what you have said yourself.',
            )
        hears = evidence.subscription(self.topic)
        count = sum(right is not None for right in self.replies(texts))
        return f'{hears.node} has replied to {count} of {len(texts)} messages.'

    def _refuse(
        self, text: str, came: Sequence[str], right: str | None, *, again: bool = False
    ) -> NoReturn:
        why, todo = self.explain(text, came)
        if again and not came:
            why = 'The same message had a reply before. Is something used up by the first one?'
            todo = 'Do the same for each message that wants a reply, each time.'
        if not why and came and right is not None:
            why = text_trouble(came[-1], right)
            todo = 'Compare the text that is wanted with the one seen.'
        raise Fail(
            f'{show([right]) if right else "nothing"} on {self.topic} upon {show([text])}',
            show(came) if came else 'nothing',
            why=why,
            todo=todo,
        )


@dataclass(frozen=True)
class UsedOnce(Clause):
    """Each message comes from a publisher that was made for it, and is gone afterwards.

    A clause on what is published stands before this one.

    Attributes:
        topic: Full name of the topic.
        words: What is asked for, in words of the task.
    """

    topic: str
    words: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def judge(self, evidence: Evidence) -> str:
        """Look at the numbers of the messages, which each publisher counts from 1, and for it."""
        from labkit.background.patience import answer_sec

        again = [s for s in evidence.life.besides_tests(self.topic) if s.number > 1]
        if again:
            raise Fail(
                'a publisher of its own for each reply',
                f'one has published {max(s.number for s in again)} messages',
                why='A publisher that is kept is used again and again.',
                todo='Call create_publisher() when a reply is due, and destroy_publisher() '
                'afterwards.',
            )
        node = evidence.subscription(self.topic).node
        probe = evidence.probe

        def kept() -> int:
            return sum(end.node == node for end in probe.publishers(self.topic))

        if not probe.wait(lambda: not kept(), answer_sec(GONE_SEC)):
            raise Fail(
                f'no publisher of {node} on {self.topic} between two replies',
                f'{kept()} of them',
                why='Each reply leaves a publisher behind, and they become more and more.',
                todo='self.destroy_publisher(publisher), when the reply is on its way.',
            )
        return ''
