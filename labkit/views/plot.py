"""Numbers of messages over time, live: `lab.plot(field, ...)`.

Of every message the number is taken, and no more; the page gets what is new some times a second,
as bytes, and thinned to what can be seen.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from labkit.errors import LabError
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.names import full_topic_name
from labkit.views.feed import Feed, heard
from labkit.views.live import helper
from labkit.views.live_page import LivePage, News
from labkit.views.plot_fields import Source, parse, reader, resolve, unit_of
from labkit.views.plot_picture import COLOURS, Floats, Line, in_words, thin, to_svg

__all__ = ['Plot', 'plot']

# So many columns the picture has at most; what is in between can't be seen.
COLUMNS = 800
# Samples of a field that may wait to be sent; a timer that is late for longer loses the oldest.
MAX_WAITING = 20_000
# Longest window, s.
MOST_SEC = 3600.0


class Series:
    """The numbers of one field.

    Args:
        source: The field.

    Attributes:
        topic: Full name of its topic.
        unit: Its unit; '' if none is known.
        problem: Why it can't be drawn, '' if it can.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.topic = ''
        self.unit = ''
        self.problem = ''
        self.waiting: deque[tuple[float, float]] = deque(maxlen=MAX_WAITING)
        self._get: Callable[[bytes], Any] | None = None
        self._type: Any = None
        # What the page has been sent, for the next page.
        self._sent: deque[tuple[Floats, Floats]] = deque()
        self._latest = -math.inf

    def add(self, moment: float, data: bytes, msg_type: Any) -> None:
        """Keep the field of a serialized message that came at a moment."""
        if msg_type is not self._type:
            self.settle(msg_type)
        if self._get is None:
            return
        try:
            value = self._get(data)
        except IndexError:
            self.problem = f'{self.source.text}: the array is shorter than that in some messages.'
            value = math.nan
        self.waiting.append((moment, value))

    def settle(self, msg_type: Any) -> None:
        """Find the field in a type of messages; note why if that can't be."""
        self._type, self._get, self.problem = msg_type, None, ''
        try:
            self._get = reader(self.source, msg_type)
            self.unit = unit_of(self.source.path, msg_type)
        except LabError as error:
            self.problem = str(error)

    def take(self, window: float) -> tuple[Floats, Floats] | None:
        """Return times and values of what is new, None if nothing is."""
        if not self.waiting:
            return None
        count = len(self.waiting)
        samples = np.array([self.waiting.popleft() for _ in range(count)], dtype=np.float64)
        chunk = thin(samples[:, 0], samples[:, 1], window / COLUMNS)
        self._sent.append(chunk)
        # Not with the time that goes on: what came last is kept when nothing comes any more.
        heard = samples[~np.isnan(samples[:, 1]), 0]
        self._latest = max([self._latest, *heard[-1:]])
        while self._sent[0][0][-1] < self._latest - window:
            self._sent.popleft()
        return chunk

    def kept(self, window: float) -> tuple[Floats, Floats]:
        """Return times and values of the whole window, as far as they have been taken."""
        if not self._sent:
            return np.empty(0), np.empty(0)
        times, values = (np.concatenate(parts) for parts in zip(*self._sent, strict=True))
        return thin(times, values, window / COLUMNS)


class Plot(LivePage):
    """A live plot of fields, to be shown in a cell; see `plot`."""

    _name = 'plot'
    # No more than 20 in any second, also where the timer is late.
    _period = 0.055
    _least = 0.052

    def __init__(self, sources: list[Source], *, seconds: float, count: int) -> None:
        self._sources, self._seconds, self._count = sources, seconds, count
        self._series = [Series(source) for source in sources]
        feeds = _feeds(self._series)
        for feed in feeds:
            _refuse_wrong_fields(feed, self._series)
        # The moment that is the page's zero of time.
        self._begin = 0.0
        super().__init__(feeds)
        self._bundle = {} if self._watched else self._heard_bundle()

    def __repr__(self) -> str:
        return (self._bundle or self._heard_bundle())['text/plain']

    def _still(self) -> dict[str, str]:
        return self._bundle or self._known_bundle()

    def _known_bundle(self) -> dict[str, str]:
        """Return text and picture of the last window."""
        words, lines = [], []
        for each in self._series:
            times, values = each.kept(self._seconds)
            known = values[~np.isnan(values)].tolist()
            text = in_words(known, each.unit) if known else 'no number has come'
            words.append(f'{each.source.text}: {text}')
            seconds = (times - self._begin).tolist()
            lines.append(Line(each.source.text, each.unit, values.tolist(), seconds))
        text = '\n'.join(words)
        drawn = any(math.isfinite(value) for line in lines for value in line.values)
        return {'text/plain': text, **({'image/svg+xml': to_svg(lines, text)} if drawn else {})}

    def _heard_bundle(self) -> dict[str, str]:
        """Wait for messages; return text and picture that are the same each time."""
        series = [Series(source) for source in self._sources]
        feeds = _feeds(series)

        def enough() -> bool:
            return all(len(each.waiting) >= self._count or each.problem for each in series)

        with heard(feeds, enough):
            values = [[float(v) for _, v in list(each.waiting)[: self._count]] for each in series]
            words = [
                _in_words(each, numbers, self._count)
                for each, numbers in zip(series, values, strict=True)
                if numbers
            ]
            text = '\n'.join([*words, *_problems(series, feeds)])
        lines = [
            Line(each.source.text, each.unit, numbers)
            for each, numbers in zip(series, values, strict=True)
        ]
        return (
            {'text/plain': text, 'image/svg+xml': to_svg(lines, text)}
            if words
            else {'text/plain': text}
        )

    def _open(self) -> None:
        # A gap where nobody looked on.
        moment = time.monotonic()
        self._begin = self._begin or moment
        for each in self._series:
            each.waiting.append((moment, math.nan))
        super()._open()

    def _news(self, everything: bool) -> News:
        parts, buffers = [], []
        for number, each in enumerate(self._series):
            chunk = each.take(self._seconds)
            if everything:
                chunk = each.kept(self._seconds)
            if chunk is not None and len(chunk[0]):
                parts.append(number)
                buffers.append(
                    np.concatenate([chunk[0] - self._begin, chunk[1]]).astype('<f8').tobytes()
                )
        state = {
            'series': [[each.source.text, each.unit] for each in self._series],
            'seconds': self._seconds,
            'note': ' '.join(_problems(self._series, self._feeds)),
        }
        news = self._new_of(state)
        if news or parts:
            news |= {'parts': parts, 'now': time.monotonic() - self._begin, 'anew': everything}
        return news, buffers


def plot(*fields: str, seconds: float = 10.0, count: int = 10) -> Plot:
    """Draw numbers of messages over time.

    A field is the topic, a dot and the path in the message: `'/odom.pose.pose.position.x'`, or
    `'/scan.ranges[0]'`. In a notebook the plot is live, and listens for as long as it can be
    seen. Elsewhere it is a picture and a text of the next messages.

    Args:
        fields: What to draw. The topics need not exist yet.
        seconds: How much time the live plot shows, s.
        count: For the picture: how many messages to wait for.

    Returns:
        What a cell shows. `.close()` ends it.

    Raises:
        LabError: A field does not exist, or is not a number.
    """
    if not 1 <= len(fields) <= len(COLOURS):
        raise LabError(
            f'lab.plot() takes 1 to {len(COLOURS)} fields, but got {len(fields)}.',
            todo="Write for example: lab.plot('/odom.twist.twist.linear.x')",
        )
    if not isinstance(seconds, (int, float)) or not 0 < seconds <= MOST_SEC:
        raise LabError(
            f'seconds must be a number above 0, up to {MOST_SEC:.0f}, but it is {seconds!r}.'
        )
    if not isinstance(count, int) or not 1 <= count <= MAX_WAITING:
        raise LabError(
            f'count must be a whole number from 1 to {MAX_WAITING}, but it is {count!r}.'
        )
    return Plot([parse(field) for field in fields], seconds=float(seconds), count=count)


def _feeds(series: list[Series]) -> list[Feed]:
    """Return one subscription for each topic."""
    groups: dict[str, list[Series]] = {}
    for each in series:
        each.topic = full_topic_name(each.source.topic, helper())
        groups.setdefault(each.topic, []).append(each)
    return [_feed(topic, group) for topic, group in groups.items()]


def _feed(topic: str, group: list[Series]) -> Feed:
    def add(data: bytes) -> None:
        moment = time.monotonic()
        for each in group:
            each.add(moment, data, feed.msg_type)

    feed = Feed(topic, helper(), add, raw=True)
    return feed


def _refuse_wrong_fields(feed: Feed, series: list[Series]) -> None:
    """Raise a LabError for a field that can't be drawn, if the type of its messages is known."""
    ends = helper().get_publishers_info_by_topic(feed.topic)
    types = {end.topic_type for end in ends}
    if len(types) == 1:
        msg_type = message_class(types.pop())
        for each in series:
            if each.topic == feed.topic:
                resolve(each.source, msg_type)


def _problems(series: list[Series], feeds: list[Feed]) -> list[str]:
    found = [each.problem for each in series] + [feed.silence() for feed in feeds]
    return [words for words in dict.fromkeys(found) if words]


def _in_words(series: Series, values: list[float], wanted: int) -> str:
    of = '' if len(values) == wanted else f' of {wanted}'
    plural = 's' if wanted > 1 else ''
    numbers = in_words(values, series.unit)
    return f'{series.source.text}: {len(values)}{of} message{plural}, {numbers}'
