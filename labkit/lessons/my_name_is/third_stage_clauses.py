"""What the check of the exercise third_stage asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import expect
from labkit.exercises.clauses import Answers, Evidence

__all__ = ['ENDING', 'AtTheEnd', 'explain']

ENDING = '. Nice to meet you.'


@dataclass(frozen=True, eq=False)
class AtTheEnd(Answers):
    """The last stage of a chain hears the one before it, and no earlier one."""

    def find(self, evidence: Evidence) -> None:
        """Look for the stage."""
        probe = evidence.probe
        names = {endpoint.node for endpoint in probe.publishers(self.outer)}
        hears = {endpoint.node for endpoint in probe.subscriptions(self.inner)}
        for endpoint in probe.subscriptions('/incomplete'):
            expect.that(
                endpoint.node not in names - hears,
                expected=f'a third stage that subscribes to {self.inner}',
                seen=f'{endpoint.node} subscribes to /incomplete',
                why='It hears stage one and goes past stage two, so the first name is missing.',
                todo=f"Write the topic as '{self.inner}'.",
            )
        super().find(evidence)


def explain(text: str, came: Sequence[str], ending: str = ENDING) -> tuple[str, str]:
    """Return the misconception and the next step, from what came upon a text."""
    if not came:
        return '', ''
    if text in came:
        return 'The text is passed on as it came: nothing is added.', f'msg.data + {ending!r}'
    if not any(text in other for other in came):
        return (
            'What goes out does not hold the text that came in: the string is made beforehand, or '
            'the text is changed.',
            'Make the string in the callback, of msg.data as it is.',
        )
    beginning = next((other for other in came if other.startswith(text)), '')
    return expect.text_trouble(beginning, text + ending), 'Compare the two texts.'
