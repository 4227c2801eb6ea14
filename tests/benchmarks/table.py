"""How figures are shown: each with its target, and whether that is met."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ['Row', 'show']


@dataclass(frozen=True)
class Row:
    """One figure.

    Attributes:
        what: What was measured.
        figure: The figure; None if it could not be measured.
        unit: Its unit, or why it could not be measured.
        at_most: The target, if it is an upper limit.
        at_least: The target, if it is a lower limit.
    """

    what: str
    figure: float | None
    unit: str = ''
    at_most: float | None = None
    at_least: float | None = None

    @property
    def target(self) -> str:
        """Return the target as words."""
        if self.at_most is not None:
            return f'at most {self.at_most:g}'
        return f'at least {self.at_least:g}' if self.at_least is not None else ''

    @property
    def met(self) -> str:
        """Return whether the target is met, '' if there is none."""
        if not self.target:
            return ''
        if self.figure is None:
            return 'not measured'
        low = self.at_least is None or self.figure >= self.at_least
        high = self.at_most is None or self.figure <= self.at_most
        return 'met' if low and high else 'MISSED'


def show(title: str, rows: Sequence[Row]) -> None:
    """Print a table."""
    print(f'\n== {title}')
    width = max([len(row.what) for row in rows], default=0)
    for row in rows:
        figure = '-' if row.figure is None else f'{row.figure:.2f}'
        line = f'{row.what:<{width}}  {figure:>10}  {row.unit:<10}  {row.target:<14}  {row.met}'
        print(line.rstrip(), flush=True)
