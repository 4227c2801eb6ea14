"""Plot message fields over time, live: `lab.plot(field, ...)`.

Only the plotted number of each message is kept; the page gets new ones a few times a second, as
bytes, thinned to what can be seen.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from labkit.errors import LabError, quoted
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.names import full_topic_name
from labkit.views.feed import Feed, subscribed
from labkit.views.live import helper
from labkit.views.live_page import LivePage, Update
from labkit.views.plot_fields import Source, parse, reader, resolve, unit_of
from labkit.views.plot_picture import COLOURS, Floats, Line, in_words, thin, to_svg

__all__ = ['Plot', 'plot']

# Most columns of the picture; more can't be seen.
COLUMNS = 800
# Most unsent samples of a field; if the timer is late, the oldest are dropped.
MAX_WAITING = 20_000
# Shortest and longest window, s.
MIN_SEC, MAX_SEC = 0.1, 3600.0


class Series:
    """The numbers of one field.

    Attributes:
        topic: Full name of its topic.
        unit: Its unit; '' if unknown.
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
        # What the page has received, for a page that is opened later.
        self._sent: deque[tuple[Floats, Floats]] = deque()
        self._latest = -math.inf

    def add(self, moment: float, data: bytes, msg_type: Any) -> None:
        """Keep the field of a serialized message that arrived at a time."""
        if msg_type is not self._type:
            self.set_type(msg_type)
        if self._get is None:
            return
        try:
            value = self._get(data)
        except IndexError:
            self.problem = f'{self.source.text}: the array is shorter than that in some messages.'
            value = math.nan
        self.waiting.append((moment, value))

    def set_type(self, msg_type: Any) -> None:
        """Find the field in a message type; note the problem if it can't be read."""
        self._type, self._get, self.problem = msg_type, None, ''
        try:
            self._get = reader(self.source, msg_type)
            self.unit = unit_of(self.source.path, msg_type)
        except LabError as error:
            self.problem = str(error)

    def take(self, window: float) -> tuple[Floats, Floats] | None:
        """Return times and values of new samples, None without any."""
        if not self.waiting:
            return None
        count = len(self.waiting)
        samples = np.array([self.waiting.popleft() for _ in range(count)], dtype=np.float64)
        chunk = thin(samples[:, 0], samples[:, 1], window / COLUMNS)
        self._sent.append(chunk)
        # Relative to the last sample, not to now: the last window stays when messages stop.
        subscribed = samples[~np.isnan(samples[:, 1]), 0]
        self._latest = max([self._latest, *subscribed[-1:]])
        while self._sent[0][0][-1] < self._latest - window:
            self._sent.popleft()
        return chunk

    def kept(self, window: float) -> tuple[Floats, Floats]:
        """Return times and values of the window, as far as taken."""
        if not self._sent:
            return np.empty(0), np.empty(0)
        times, values = (np.concatenate(parts) for parts in zip(*self._sent, strict=True))
        return thin(times, values, window / COLUMNS)


class Plot(LivePage):
    """A live plot of fields, to be shown in a cell; see `plot`."""

    _name = 'plot'
    # At most 20 updates in any second, even if the timer is late.
    _period = 0.055
    _min_interval = 0.052

    def __init__(self, sources: list[Source], *, seconds: float, count: int) -> None:
        self._sources, self._seconds, self._count = sources, seconds, count
        self._series = [Series(source) for source in sources]
        feeds = _feeds(self._series)
        for feed in feeds:
            _refuse_wrong_fields(feed, self._series)
        # Zero of the page's time axis.
        self._begin = 0.0
        super().__init__(feeds)
        self._bundle = {} if self._watched else self._wait_for_bundle()

    def __repr__(self) -> str:
        return (self._bundle or self._wait_for_bundle())['text/plain']

    def _static(self) -> dict[str, str]:
        self._open_early()
        return self._bundle or self._stored_form()

    def _stored_form(self) -> dict[str, str]:
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

    def _wait_for_bundle(self) -> dict[str, str]:
        """Wait for messages; return text and picture that are the same each time."""
        series = [Series(source) for source in self._sources]
        feeds = _feeds(series)

        def enough() -> bool:
            return all(len(each.waiting) >= self._count or each.problem for each in series)

        with subscribed(feeds, enough):
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
        # A gap for the time when nobody was looking.
        moment = time.monotonic()
        self._begin = self._begin or moment
        for each in self._series:
            each.waiting.append((moment, math.nan))
        super()._open()

    def _close(self) -> None:
        with self._lock:
            # What has come since the last update, for the page and for what is stored.
            if any(each.waiting for each in self._series):
                self._send_to_page(*self._update(everything=False))
            super()._close()

    def _update(self, everything: bool) -> Update:
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
        changes = self._changes(state)
        if changes or parts:
            changes |= {'parts': parts, 'now': time.monotonic() - self._begin, 'anew': everything}
        return changes, buffers


def plot(*fields: str, seconds: float = 10.0, count: int = 10) -> Plot:
    """Plot message fields over time.

    A field is the topic, a dot and the path in the message: `'/odom.pose.pose.position.x'`, or
    `'/scan.ranges[0]'`. In a notebook the plot is live, and subscribes while it is visible. A
    cursor at the pointer tells the values at its time; while the plot is paused, keys move it too,
    and what is shown can be saved as CSV. Drag sideways to pause and zoom in. Elsewhere it is a
    picture and a text of the next messages.

    Args:
        fields: Fields to plot. The topics need not exist yet.
        seconds: Window of the live plot, s.
        count: For the picture: number of messages to wait for.

    Returns:
        A view to show in a cell. `.close()` ends it.

    Raises:
        LabError: A field does not exist, or is not a number.
    """
    if not 1 <= len(fields) <= len(COLOURS):
        raise LabError(
            f'lab.plot() takes 1 to {len(COLOURS)} fields, but got {len(fields)}.',
            todo="Write for example: lab.plot('/odom.twist.twist.linear.x')",
        )
    if not isinstance(seconds, (int, float)) or not MIN_SEC <= seconds <= MAX_SEC:
        raise LabError(
            f'seconds must be a number from {MIN_SEC} to {MAX_SEC:.0f}, but it is '
            f'{quoted(seconds)}.'
        )
    if not isinstance(count, int) or not 1 <= count <= MAX_WAITING:
        raise LabError(
            f'count must be a whole number from 1 to {MAX_WAITING}, but it is {quoted(count)}.'
        )
    return Plot([parse(field) for field in fields], seconds=float(seconds), count=count)


def _feeds(series: list[Series]) -> list[Feed]:
    """Return one subscription per topic."""
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
    """Raise a LabError for a field that can't be plotted, if the message type is known."""
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
