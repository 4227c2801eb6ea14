"""A bag as a still picture: timelines, lines over time, a robot's trail.

It is a PNG, like those of matplotlib: it shows times, which differ with each recording.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from labkit.views.bag_reading import BINS, Samples, Strip, Track
from labkit.views.plot_picture import COLOURS, DASHES

__all__ = ['to_png']

WIDTH, STRIP, PANEL, MAP = 7.2, 0.3, 1.7, 3.6
DPI = 90
# Further topics are listed in the text only.
MAX_STRIPS = 40
_STYLES = ('-', '--', ':', '-.', (0, (5, 2)), (0, (1, 4)))


def to_png(
    strips: Sequence[Strip], samples: Sequence[Samples], track: Track | None, seconds: float
) -> str:
    """Return a picture of a bag as a PNG, in base64; `seconds` is the duration of the bag."""
    from matplotlib.figure import Figure

    strips = strips[:MAX_STRIPS]
    units = list(dict.fromkeys(each.unit for each in samples))
    heights = [STRIP * len(strips) + 0.5, *[PANEL] * len(units), *[MAP] * (track is not None)]
    figure = Figure(figsize=(WIDTH, sum(heights) + 0.5 * len(heights)), layout='constrained')
    axes = figure.subplots(len(heights), gridspec_kw={'height_ratios': heights}, squeeze=False)
    places = iter(axes[:, 0])
    _draw_strips(next(places), strips, seconds)
    for unit in units:
        _draw_lines(next(places), samples, unit, seconds)
    if track is not None:
        _draw_track(next(places), track)
    buffer = io.BytesIO()
    figure.savefig(buffer, format='png', dpi=DPI)
    return base64.b64encode(buffer.getvalue()).decode()


def _draw_strips(axes: Any, strips: Sequence[Strip], seconds: float) -> None:
    width = max(seconds, 1e-9) / BINS
    for row, strip in enumerate(strips):
        columns = np.flatnonzero(strip.bins)
        most = max(int(strip.bins.max()), 1)
        heights = 0.25 + 0.55 * strip.bins[columns] / most
        axes.bar(
            columns * width, heights, width, row + 0.4, align='edge', color=COLOURS[0], linewidth=0
        )
    names = [_plain(strip.topic.name) for strip in strips]
    axes.set_yticks([row - 0.1 for row in range(1, len(strips) + 1)], names, fontsize=8)
    axes.set(ylim=(len(strips) + 0.4, 0.3), xlim=(0, max(seconds, width)), xlabel='time in s')
    axes.tick_params(left=False)


def _draw_lines(axes: Any, samples: Sequence[Samples], unit: str, seconds: float) -> None:
    for number, each in enumerate(samples):
        if each.unit == unit:
            style: Any = _STYLES[number % len(DASHES)]
            colour = COLOURS[number % len(COLOURS)]
            label = _plain(each.source.text)
            axes.plot(each.times, each.values, color=colour, linestyle=style, label=label)
    axes.set(xlabel='time in s', ylabel=unit, xlim=(0, max(seconds, 1e-9)))
    axes.legend(fontsize=8)
    axes.grid(color='#e0e0e0')


def _draw_track(axes: Any, track: Track) -> None:
    x, y = track.numbers[:, 0], track.numbers[:, 1]
    axes.plot(x, y, color='#1565c0', label=f'trail of {_plain(track.topic)}')
    if len(x):
        yaw = float(track.numbers[-1, 2])
        axes.plot(x[0], y[0], 'o', color='#2e7d32', label='first')
        # The tip of the arrow is the last position of the robot.
        way = (-20 * math.cos(yaw), -20 * math.sin(yaw))
        arrow = {'arrowstyle': '-|>', 'color': '#ef6c00', 'lw': 3}
        axes.annotate('', (x[-1], y[-1]), way, textcoords='offset points', arrowprops=arrow)
    axes.set_aspect('equal', 'datalim')
    axes.set(xlabel='x in m', ylabel='y in m')
    axes.legend(fontsize=8)
    axes.grid(color='#e0e0e0')


def _plain(text: str) -> str:
    """Return a name for matplotlib, where a dollar sign would start a formula."""
    # Names of ROS are ASCII, and fonts lack some other characters.
    ascii_only = ''.join(char if char.isascii() and char.isprintable() else '?' for char in text)
    return ascii_only.replace('$', r'\$')
