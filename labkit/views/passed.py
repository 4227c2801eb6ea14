"""The card of an exercise that is solved: what was seen, where one is, what comes next."""

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


@dataclass(frozen=True, repr=False)
class PassedCard(Card):
    """A card that also says what was asked for, and where the learner is in the lesson.

    In text it is a card as any other.

    Attributes:
        asked: What the task asks for, clause by clause: all of it was seen.
        exercises: Those of the lesson.
        onward: What comes next: pairs of a text and where it is.
    """

    asked: Sequence[str] = ()
    exercises: Sequence[Item] = ()
    onward: Sequence[tuple[str, str]] = ()

    def _repr_html_(self) -> str:
        """Return the card as HTML; everything in it is escaped."""
        asked = '\n'.join(f'✔ {text}' for text in self.asked)
        rows = [('Task', asked), ('Seen', self.text), *self.rows]
        card = Card(self.tone, self.word, self.title, rows=rows)
        start, _, _ = card._repr_html_().rpartition('</div>')
        return '\n'.join([start.rstrip(), *self._lesson(), '</div>'])

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
