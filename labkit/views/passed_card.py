"""The card of a passed exercise: what was seen, progress in the lesson, what comes next."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.views.card import Card
from labkit.views.progress_picture import Item, marks

__all__ = ['PassedCard']

_LESSON = (
    'border-top:1px solid var(--jp-border-color2, #9e9e9e);margin-top:0.8em;padding-top:0.6em'
)
_ONWARD = (
    'display:inline-block;margin:0.5em 0.6em 0 0;padding:0.2em 0.9em;border-radius:4px;'
    'border:2px solid var(--jp-brand-color1, #1976d2);font-weight:600;text-decoration:none;'
    'color:var(--jp-content-font-color1, inherit)'
)
# The robot of the course from above, as on the map (cm, front at the top): it turns once.
_ROBOT = (
    '<svg class="labkit-turn" viewBox="-12 -12 24 24" width="32" height="32" aria-hidden="true" '
    'style="vertical-align:middle;margin-right:0.5em" fill="none" stroke="currentColor">'
    '<path d="M-8 -3.3V3.3M8 -3.3V3.3" stroke-width="1.8"/>'
    '<path d="M-6.2 10.2V-3.8H6.2V10.2Z" stroke-width="0.9" stroke-linejoin="round"/>'
    '<path d="M0 -8.8L4 -3.8H-4Z" fill="var(--jp-success-color1, #2e7d32)" stroke="none"/>'
    '<circle cy="3.2" r="3.5" fill="currentColor" stroke="none"/></svg>'
)
_TURN = (
    '<style>@keyframes labkit-turn{to{transform:rotate(1turn)}}'
    '@media (prefers-reduced-motion:no-preference){'
    '.labkit-turn{animation:labkit-turn 1s ease-in-out}}</style>'
)


@dataclass(frozen=True, repr=False)
class PassedCard(Card):
    """A card with the task, the learner's progress and a robot; as text, an ordinary card.

    Attributes:
        asked: Clauses of the task, all of which were seen.
        exercises: Exercises of the lesson.
        onward: Links to what comes next: pairs of text and target.
    """

    asked: Sequence[str] = ()
    exercises: Sequence[Item] = ()
    onward: Sequence[tuple[str, str]] = ()

    def _repr_html_(self) -> str:
        asked = '\n'.join(f'✔ {text}' for text in self.asked)
        rows = [('Task', asked), ('Seen', self.text), *self.rows]
        card = Card(self.tone, self.word, self.title, rows=rows)
        start, _, _ = card._repr_html_().rpartition('</div>')
        box, _, rest = start.rstrip().partition('\n<div>')
        return '\n'.join([box, f'<div>{_ROBOT}{rest}', *self._lesson(), _TURN, '</div>'])

    def _lesson(self) -> list[str]:
        if not self.exercises:
            return []
        done = sum(item.state == 'done' for item in self.exercises)
        what = 'exercise' + 's' * (len(self.exercises) != 1)
        onward = ''.join(
            f'<a href="{html.escape(href)}" style="{_ONWARD}">{html.escape(text)} '
            '<span aria-hidden="true">→</span></a>'
            for text, href in self.onward
        )
        return [
            f'<div style="{_LESSON}">',
            f'<div>{marks(self.exercises)} {done} of {len(self.exercises)} {what} of this lesson'
            '</div>',
            f'<div>{onward}</div>' if onward else '',
            '</div>',
        ]
