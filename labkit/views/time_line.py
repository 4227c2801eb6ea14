"""The time line of a check: what came on each topic, when and from whom."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

__all__ = ['Event', 'TimeLine']

# The picture, px: names on the left, then time; a lane for each publisher of a topic.
_NAMES, _WIDTH, _LANE = 250, 720, 20
_TICKS = 6
# Times that differ by less are the same, but for rounding, s.
_SAME_SEC = 1e-6
_CELL = 'padding:0.1em 1em 0.1em 0;text-align:left;vertical-align:top'


@dataclass(frozen=True)
class Event:
    """A message: when it came in the check's time, s, on which topic, from whom, and its text."""

    at: float
    topic: str
    by: str
    text: str


@dataclass(frozen=True, repr=False)
class TimeLine:
    """What came in a check, as a picture with a table in a notebook, as lines elsewhere.

    Attributes:
        seconds: How much time passed.
        lanes: When messages came, in s, for each topic and publisher.
        events: Some of them in the order of time, with their texts: those around `at`.
        at: When it went wrong, s; None if it did not, or at no single moment.
    """

    seconds: float
    lanes: Mapping[tuple[str, str], Sequence[float]]
    events: Sequence[Event]
    at: float | None = None

    @property
    def _counted(self) -> str:
        count = sum(map(len, self.lanes.values()))
        shown = len(self.events)
        what = f'all {count}' if shown == count else f'{shown} of {count}'
        return f'{what} messages in {self.seconds:.0f} s of the time of your nodes'

    def __repr__(self) -> str:
        lines = [f'TIME LINE: {self._counted}']
        for event in self.events:
            mark = '>' if self._is_where(event) else ' '
            lines.append(f'{mark} {event.at:7.3f} s  {event.topic}  {event.by}: {event.text}')
        return '\n'.join(lines)

    def _repr_html_(self) -> str:
        """Return the picture and the table as HTML; everything in it is escaped."""
        rows = ''.join(
            ('<tr style="font-weight:bold">' if self._is_where(event) else '<tr>')
            + ''.join(
                f'<td style="{_CELL}">{html.escape(text)}</td>'
                for text in (f'{event.at:.3f}', event.topic, event.by, event.text)
            )
            + '</tr>'
            for event in self.events
        )
        heads = ''.join(
            f'<th scope="col" style="{_CELL}">{head}</th>'
            for head in ('Time in s', 'Topic', 'From', 'Message')
        )
        return (
            f'{self._picture()}<details><summary>{html.escape(self._counted)}</summary>'
            '<table style="border-collapse:collapse;font-size:inherit">'
            f'<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></details>'
        )

    def _is_where(self, event: Event) -> bool:
        return self.at is not None and abs(event.at - self.at) < _SAME_SEC

    def _x(self, at: float) -> int:
        return _NAMES + round((_WIDTH - _NAMES - 20) * max(at, 0.0) / (self.seconds or 1.0))

    def _picture(self) -> str:
        height = _LANE * (len(self.lanes) + 1) + 6
        parts = []
        for number, ((topic, by), moments) in enumerate(self.lanes.items()):
            top = _LANE * number + 4
            ticks = ''.join(f'M{x} {top}v12' for x in sorted({self._x(at) for at in moments}))
            name = html.escape(_short(f'{topic} from {by}'))
            parts.append(
                f'<text x="0" y="{top + 11}" fill="currentColor">{name}</text>'
                f'<path d="{ticks}" stroke="currentColor" stroke-width="1.5"/>'
            )
        foot = height - 6
        for number in range(_TICKS + 1):
            at = self.seconds * number / _TICKS
            parts.append(
                f'<text x="{self._x(at)}" y="{foot}" text-anchor="middle" fill="currentColor">'
                f'{at:.3g} s</text>'
            )
        if self.at is not None:
            x = self._x(self.at)
            parts.append(
                f'<path d="M{x} 0V{foot - 12}" stroke="var(--jp-error-color1, #c62828)" '
                'stroke-width="2" stroke-dasharray="4 2"/>'
            )
        where = '' if self.at is None else f' It went wrong at {self.at:.1f} s.'
        label = html.escape(f'Time line: {self._counted}.{where}')
        return (
            f'<svg role="img" aria-label="{label}" viewBox="0 0 {_WIDTH} {height}" '
            f'style="width:100%;max-width:{_WIDTH}px;margin-top:0.6em;font-size:12px">'
            f'{"".join(parts)}</svg>'
        )


def _short(name: str, longest: int = 36) -> str:
    return name if len(name) <= longest else f'{name[: longest - 1]}…'
