"""Lines as a still picture, one panel per unit: numbers over time, or over the message number.

The latter where stored outputs have to be the same each time.
"""

from __future__ import annotations

import html
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

__all__ = ['COLOURS', 'DASHES', 'Line', 'in_words', 'limits', 'thin', 'ticks', 'to_svg']

Floats = NDArray[np.float64]

# From Okabe and Ito, "Color Universal Design" (2008), those that are dark enough on white. Dashes
# tell lines apart without colour.
COLOURS = ('#0072b2', '#d55e00', '#007a59', '#a8427f', '#3d3d3d', '#8a6d00')
DASHES = ('', '8 4', '2 3', '10 3 2 3', '5 2', '1 4')

# Ranges beyond these would be infinite, or too small to be divided.
_HUGE, _TINY = sys.float_info.max, 1e-302

WIDTH, PANEL, LEFT, RIGHT, TOP, BOTTOM = 640, 170, 64, 12, 14, 40


@dataclass(frozen=True)
class Line:
    """One line: label, unit, values, and optionally their times, s."""

    label: str
    unit: str
    values: Sequence[float]
    times: Sequence[float] = ()


def in_words(values: Sequence[float], unit: str) -> str:
    """Return the first, the last, the least and the greatest of numbers as text."""
    unit = f' {unit}' if unit else ''
    finite = [value for value in values if math.isfinite(value)]
    text = f'first {_short(values[0])}{unit}, last {_short(values[-1])}{unit}'
    if finite:
        text += f', least {_short(min(finite))}{unit}, greatest {_short(max(finite))}{unit}'
    return text


def _short(value: float) -> str:
    text = f'{value:.4g}'
    number = float(text) + 0.0  # no -0
    # The greatest numbers are infinite when they are rounded up.
    return text if math.isinf(number) else f'{number:g}'


def limits(values: Sequence[float]) -> tuple[float, float]:
    """Return the range of an axis: all finite values, and a margin."""
    finite = [value for value in values if math.isfinite(value)] or [0.0]
    low, high = min(finite), max(finite)
    # Numbers that are closer together than floats can divide are one.
    room = min(high - low, _HUGE) * 0.06 if high - low > _TINY else abs(low) / 2
    room = room if room > _TINY else 0.5
    return max(low - room, -_HUGE), min(high + room, _HUGE)


def ticks(low: float, high: float, most: int = 5) -> list[float]:
    """Return at most `most` round numbers between two others, and at least two."""
    rough = min(high - low, _HUGE) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(step * power for step in (1, 2, 5, 10) if step * power >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [number * step for number in range(first, last + 1)]


def thin(times: Floats, values: Floats, step: float) -> tuple[Floats, Floats]:
    """Return fewer samples that look the same: the least and the greatest per column.

    A gap, which is a NaN, is kept, however close the values around it.

    Args:
        times: Times in ascending order, s.
        values: Values, NaN for a gap.
        step: Time per column of the picture, s.
    """
    columns = np.floor(times / step)
    starts = np.flatnonzero(np.diff(columns, prepend=np.nan))
    if len(values) <= 2 * len(starts) + 1:
        return times, values
    ends = np.append(starts[1:], len(values)) - 1
    least, greatest = np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)
    gap = np.logical_or.reduceat(np.isnan(values), starts) & ~np.isnan(least)
    kept = np.stack([np.full_like(gap, True), gap, np.full_like(gap, True)], axis=1)
    few_times = np.stack([times[starts], times[starts], times[ends]], axis=1)[kept]
    few = np.stack([least, np.full_like(least, np.nan), greatest], axis=1)[kept]
    # Keep the last sample: it is shown as the latest value.
    return np.append(few_times, times[-1]), np.append(few, values[-1])


def to_svg(lines: Sequence[Line], text: str) -> str:
    """Return lines as an SVG picture with a text alternative."""
    units = list(dict.fromkeys(line.unit for line in lines))
    legend = 18 * len(lines) + 8
    height = legend + len(units) * (PANEL + TOP) + BOTTOM
    span = _span(lines)
    parts: list[str] = []
    for number, line in enumerate(lines):
        y = 16 + 18 * number
        label = f'{line.label} [{line.unit}]' if line.unit else line.label
        parts.append(f'<path d="M{LEFT} {y}h34" {_stroke(number)}/>')
        parts.append(f'<text x="{LEFT + 44}" y="{y + 4}">{html.escape(label)}</text>')
    for row, unit in enumerate(units):
        top = legend + TOP + row * (PANEL + TOP)
        parts += _panel(lines, unit, top, span, row == len(units) - 1)
    middle = (LEFT + WIDTH - RIGHT) / 2
    what = 'time [s]' if any(line.times for line in lines) else 'message'
    parts.append(f'<text x="{middle}" y="{height - 6}" text-anchor="middle">{what}</text>')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        f'width="{WIDTH}" height="{height}" role="img" font-family="sans-serif" font-size="12" '
        f'fill="#424242"><title>{html.escape(text)}</title>'
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>\n'
        + '\n'.join(parts)
        + '\n</svg>'
    )


def _span(lines: Sequence[Line]) -> tuple[float, float]:
    """Return the first and the last time, or message number, to draw."""
    times = [time for line in lines for time in line.times]
    if not times:
        return 1, max([len(line.values) for line in lines] + [2])
    return min(times), max(max(times), min(times) + 1)


def _panel(
    lines: Sequence[Line], unit: str, top: float, span: tuple[float, float], is_last: bool
) -> list[str]:
    low, high = limits([value for line in lines if line.unit == unit for value in line.values])

    def px(number: float) -> float:
        return LEFT + 8 + (WIDTH - RIGHT - LEFT - 16) * (number - span[0]) / (span[1] - span[0])

    def py(value: float) -> float:
        # Smaller by a power of two, since the difference of great numbers is infinite.
        return top + PANEL * (high / 1024 - value / 1024) / (high / 1024 - low / 1024)

    parts = []
    for value in ticks(low, high):
        y = f'{py(value):.1f}'
        parts.append(f'<path d="M{LEFT} {y}H{WIDTH - RIGHT}" stroke="#e0e0e0"/>')
        parts.append(
            f'<text x="{LEFT - 6}" y="{py(value) + 4:.1f}" text-anchor="end">{value:.4g}</text>'
        )
    for number in ticks(*span, 8):
        if number == round(number):
            x = f'{px(number):.1f}'
            parts.append(f'<path d="M{x} {top}v{PANEL}" stroke="#e0e0e0"/>')
            if is_last:
                parts.append(
                    f'<text x="{x}" y="{top + PANEL + 14}" text-anchor="middle">{number:.0f}'
                    '</text>'
                )
    parts.append(
        f'<rect x="{LEFT}" y="{top}" width="{WIDTH - RIGHT - LEFT}" height="{PANEL}" '
        'fill="none" stroke="#9e9e9e"/>'
    )
    middle = top + PANEL / 2
    parts.append(
        f'<text transform="translate(14 {middle}) rotate(-90)" text-anchor="middle">'
        f'{html.escape(unit)}</text>'
    )
    for number, line in enumerate(lines):
        if line.unit == unit:
            places = line.times or range(1, len(line.values) + 1)
            pairs = zip(places, line.values, strict=True)
            points = [(px(i), py(v)) if math.isfinite(v) else None for i, v in pairs]
            path = _path(points)
            parts.append(f'<path d="{path}" {_stroke(number)}/>' if path else '')
    return parts


def _path(points: Sequence[tuple[float, float] | None]) -> str:
    """Return an SVG path through points, with a gap where there is none."""
    path = ''
    for is_gap, group in groupby(points, key=lambda point: point is None):
        if not is_gap:
            part = [f'{point[0]:.1f} {point[1]:.1f}' for point in group if point is not None]
            # A single value becomes a short line: one of zero length would be invisible.
            path += 'M' + 'L'.join(part) + 'h3' * (len(part) == 1)
    return path


def _stroke(number: int) -> str:
    dash = DASHES[number % len(DASHES)]
    return (
        f'fill="none" stroke="{COLOURS[number % len(COLOURS)]}" stroke-width="2" '
        'stroke-linejoin="round"'
    ) + (f' stroke-dasharray="{dash}"' if dash else '')
