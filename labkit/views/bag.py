"""A bag as an interactive picture: `lab.bag('drive')`.

A table of its topics, a timeline of messages for each, a plot of chosen fields, and a map if the
bag has a robot's odometry. In a page, a slider moves through the time of the bag, and a button
plays it. Nothing is published, and ROS need not run: the page gets its drawing data once, and asks
for single messages and scans.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime, timezone
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit import settings
from labkit.bags.reader import Bag, open_bag
from labkit.errors import LabError, printable
from labkit.progress_bar import ProgressBar
from labkit.views.arena_picture import Scene
from labkit.views.bag_picture import to_png
from labkit.views.bag_reading import (
    ODOMETRY,
    SCAN,
    Content,
    Samples,
    Strip,
    check_field,
    chosen_topic,
    number_paths,
    read_samples,
    read_strip,
    read_track,
)
from labkit.views.image_pixels import picture_of, to_jpeg
from labkit.views.live import Live
from labkit.views.message_tree import rows
from labkit.views.plot_fields import Source, parse
from labkit.views.plot_picture import COLOURS, in_words, thin
from labkit.views.robot_messages import beam_ends, motion_of
from labkit.views.stored_form import Stored
from labkit.views.widget import widget_class

if TYPE_CHECKING:
    from labkit.bags.reader import BagMessage, BagTopic
    from labkit.views.widget import PageWidget

__all__ = ['BagView', 'bag']

IMAGE = 'sensor_msgs/msg/Image'
# Most columns of a line; more can't be seen.
COLUMNS = 800


class BagView(Live):
    """A bag, to be shown in a cell; see `bag`.

    Attributes:
        note: Damage of the bag as a sentence; '' if it is intact.
    """

    _name = 'bag'

    def __init__(
        self,
        path: str | os.PathLike[str],
        fields: Sequence[str],
        *,
        odom: str | None,
        scan: str | None,
    ) -> None:
        super().__init__()
        self._bag = open_bag(path)
        try:
            self._sources = _checked([parse(field) for field in fields])
            for source in self._sources:
                check_field(self._bag, source)
            self._odom = chosen_topic(self._bag, odom, ODOMETRY)
            self._scan = chosen_topic(self._bag, scan, SCAN, self._odom) if self._odom else ''
        except BaseException:
            self._bag.close()
            raise
        self.note = self._bag.note
        self._types = {topic.name: topic.msg_type for topic in self._bag.topics}
        self._content: Content | None = None
        self._widget: PageWidget | None = None
        if self._watched:
            self._widget = widget_class(self._name)()
            self._widget.on_msg(self._on_message)
            self._start()

    # -- for cells ------------------------------------------------------------------------------

    @property
    def topics(self) -> list[BagTopic]:
        """The topics, each with `name`, `msg_type` and `count`."""
        return self._bag.topics

    @property
    def duration_sec(self) -> float:
        """The time from the first to the last message, s."""
        return self._bag.duration_sec

    def messages(
        self,
        topics: str | Iterable[str] | None = None,
        start_sec: float | None = None,
        end_sec: float | None = None,
    ) -> Iterator[BagMessage]:
        """Yield messages in order of time, each with `topic`, `stamp_ns` and `message`.

        Args:
            topics: Names of topics; all if None.
            start_sec: Start, s from the beginning of the bag.
            end_sec: End, s from the beginning of the bag.

        Raises:
            LabError: The bag has no such topic, or is damaged.
        """
        return self._bag.messages(topics, start_sec, end_sec)

    def __repr__(self) -> str:
        return _bag_in_words(self._bag, self._read(), self.note)

    def _repr_mimebundle_(self, **_: object) -> dict[str, object]:
        content = self._read()
        shown: dict[str, object] = {'text/plain': repr(self)}
        if self._bag.message_count:
            seconds = self._bag.duration_sec
            shown['image/png'] = to_png(content.strips, content.samples, content.track, seconds)
        return shown

    def _ipython_display_(self) -> None:
        if self._widget is None or self._ended:
            raise NotImplementedError  # IPython then asks for the bundle
        Stored(self._widget).show({'text/plain': repr(self)})

    # -- lifetime: it subscribes to nothing, so it outlives ROS ----------------------------------

    def _why_stopped(self) -> str:
        return ''

    def _close(self) -> None:
        super()._close()
        self._bag.close()

    def _show_end(self) -> None:
        self._send_to_page({'ended': self._ended})

    # -- reading --------------------------------------------------------------------------------

    def _read(self) -> Content:
        """Read the content of the picture, once."""
        if self._content is None:
            progress = ProgressBar(f'Reading {printable(self._bag.path.name)}')
            try:
                self._content = self._read_all(progress)
            finally:
                progress.close()
        return self._content

    def _read_all(self, progress: ProgressBar) -> Content:
        strips, problems = [], []
        track = None
        topics = self._bag.topics
        try:
            for number, topic in enumerate(topics):
                progress.show(number / len(topics), f'topic {number + 1} of {len(topics)}')
                strips.append(read_strip(self._bag, topic))
            if self._odom:
                show = partial(progress.show, words=self._odom)
                track = read_track(self._bag, self._odom, show)
        except LabError as error:
            problems.append(error.message)
        samples = self._samples(self._sources, progress)
        problems += [each.problem for each in samples if each.problem]
        problems += [
            f'Every {_ordinal(each.step)} message of {each.source.topic} is drawn.'
            for each in samples
            if each.step > 1
        ]
        return Content(strips, samples, track, list(dict.fromkeys(problems)))

    def _samples(self, sources: Sequence[Source], progress: ProgressBar) -> list[Samples]:
        """Return the numbers of fields, in their order; read each topic once."""
        groups: dict[str, list[Source]] = {}
        for source in sources:
            groups.setdefault(source.topic, []).append(source)
        found: list[Samples] = []
        for topic, group in groups.items():
            show = partial(progress.show, words=topic)
            found += read_samples(self._bag, group, show)
        return sorted(found, key=lambda each: sources.index(each.source))

    # -- the page -------------------------------------------------------------------------------

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        """Answer a request of the page."""
        if self._ended:
            self._show_end()
            return
        try:
            self._answer(content)
        except LabError as error:
            self._send_to_page({'refused': str(error), 'answered': content})

    def _answer(self, content: dict[str, Any]) -> None:
        if 'see' in content:
            self._send_all()
        elif isinstance(content.get('paths'), str):
            self._send_paths(content['paths'])
        elif isinstance(content.get('lines'), list):
            sources = _checked([parse(field) for field in content['lines']])
            with self._lock:
                progress = ProgressBar('Reading')
                samples = self._samples(sources, progress)
            self._send_to_page(*_for_page(samples, self._bag.duration_sec))
        elif isinstance(content.get('at'), (int, float)):
            self._send_moment(float(content['at']), content.get('topic') or '')

    def _send_all(self) -> None:
        content, bag = self._read(), self._bag
        state, lines = _for_page(content.samples, bag.duration_sec)
        bins = [strip.bins for strip in content.strips]
        buffers = [np.concatenate([np.empty(0), *bins]).astype('<f4').tobytes()]
        if content.track is not None:
            table = np.column_stack([content.track.times, content.track.numbers])
            buffers.append(table.astype('<f8').tobytes())
        state |= {
            'name': bag.path.name,
            'about': _about(bag),
            'seconds': bag.duration_sec,
            'topics': [_row_of(strip) for strip in content.strips],
            'track': content.track.topic if content.track is not None else '',
            'scan': self._scan,
            'note': ' '.join([*[self.note] * bool(self.note), *content.problems]),
        }
        self._send_to_page(state, [*buffers, *lines])

    def _send_paths(self, topic: str) -> None:
        stamps = self._bag.stamps(topic)
        first = self._bag.at(topic, int(stamps[0])) if len(stamps) else None
        paths = number_paths(first.message) if first is not None else []
        self._send_to_page({'paths': paths, 'of': topic})

    def _send_moment(self, seconds: float, topic: str) -> None:
        """Send the last message of a topic before some time, and the scan of that time.

        A message with a picture is sent as that, too.
        """
        moment = self._bag.start_ns + round(seconds * 1e9)
        state: dict[str, Any] = {'at': seconds, 'of': topic}
        buffers: dict[str, bytes] = {}
        if topic:
            found = self._bag.at(topic, moment)
            tree = rows(found.message) if found is not None else []
            came = (found.stamp_ns - self._bag.start_ns) / 1e9 if found is not None else None
            state |= {'came': came, 'fields': [list(row) for row in tree]}
            if found is not None and self._types[topic] == IMAGE:
                try:
                    picture = picture_of(found.message)
                    state['picture'], buffers['picture'] = picture.words, to_jpeg(picture)
                except LabError as error:
                    state['picture'] = str(error)
        buffers |= self._scan_at(moment)
        state['buffers'] = list(buffers)
        self._send_to_page(state, list(buffers.values()))

    def _scan_at(self, moment: int) -> dict[str, bytes]:
        """Return the ends of the beams of the last scan as bytes; nothing without a scan."""
        scan = self._bag.at(self._scan, moment) if self._scan else None
        pose = self._bag.at(self._odom, scan.stamp_ns) if scan is not None else None
        motion = motion_of(pose.message) if pose is not None else None
        if scan is None or motion is None:
            return {}
        return {'scan': beam_ends(scan.message, motion[0]).astype('<f4').tobytes()}

    def _send_to_page(self, content: dict[str, Any], buffers: Sequence[bytes] = ()) -> None:
        if self._widget is not None:
            self._widget.send(content, list(buffers) or None)


def bag(
    path: str | os.PathLike[str],
    *fields: str,
    odom: str | None = None,
    scan: str | None = None,
) -> BagView:
    """Show a bag: its topics, when their messages arrived, and their values.

    In a notebook, a slider moves through the time of the bag: along a plot of fields, through the
    messages and pictures of a topic, and on a map if the bag has a robot's odometry. The plot and
    the time lines of the topics can be dragged over, too. Elsewhere it is text and a picture.
    Nothing is published.

    Args:
        path: Folder of the bag, or one of its files. Bags of real robots work, too.
        fields: Fields to plot, written as for `lab.plot`: `'/odom.pose.pose.position.x'`.
        odom: Topic with the `nav_msgs/msg/Odometry` for the map; '' for no map. By default the
            topic with the most messages.
        scan: Topic with the `sensor_msgs/msg/LaserScan` for the map; '' for none.

    Returns:
        A view to show in a cell. `.topics` and `.messages()` are for programs, `.close()` ends it.

    Raises:
        LabError: There is no such bag, topic or field, or the bag can't be read.
    """
    return BagView(path, fields, odom=odom, scan=scan)


def _for_page(samples: Sequence[Samples], seconds: float) -> tuple[dict[str, Any], list[bytes]]:
    """Return the state and the buffers of fields for the page."""
    buffers = []
    for each in samples:
        times, values = thin(each.times, each.values, max(seconds, 1e-9) / COLUMNS)
        buffers.append(np.concatenate([times, values]).astype('<f8').tobytes())
    problems = [each.problem for each in samples if each.problem]
    series = [[each.source.text, each.unit] for each in samples]
    return {'series': series, 'refused': ' '.join(dict.fromkeys(problems))}, buffers


def _checked(sources: Sequence[Source]) -> list[Source]:
    """Return fields without duplicates.

    Raises:
        LabError: There are too many.
    """
    found = list(dict.fromkeys(sources))
    if len(found) > len(COLOURS):
        raise LabError(f'A plot has at most {len(COLOURS)} fields, but got {len(found)}.')
    return found


# -- in words -----------------------------------------------------------------------------------


def _bag_in_words(bag: Bag, content: Content, note: str) -> str:
    """Return a bag as text; for a program, without what differs between recordings.

    Args:
        bag: The bag.
        content: What was read of it.
        note: Damage of the bag as a sentence; '' if it is intact.
    """
    timeless = settings.audience().same_each_time
    topics = f'{len(bag.topics)} topic{"s" * (len(bag.topics) != 1)}'
    head = f'{bag.path.name}: {_messages(bag.message_count)} of {topics}'
    lines = [f'{head}, {bag.storage}' if timeless else f'{head}. {_about(bag)}']
    table = [_row_of(strip)[:-1] for strip in content.strips]
    if timeless:
        table = [row[:3] for row in table]
    table = [[row[0], f'[{row[1]}]', _messages(int(row[2])), *row[3:]] for row in table]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for row in table:
        cells = [text.ljust(width) for text, width in zip(row, widths, strict=True)]
        lines.append(f'  {"  ".join(cells)}'.rstrip())
    for each in content.samples:
        if len(each.values):
            count = f'{len(each.values)} numbers'
            lines.append(
                f'{each.source.text}: {count}, {in_words(each.values.tolist(), each.unit)}'
            )
    if content.track is not None and len(content.track.times):
        pose = content.track.pose_at(float('inf'))
        lines.append(f'At the end: {Scene(pose=pose).words().partition(". ")[0]}.')
    lines += [note] * bool(note)
    return '\n'.join(printable(line) for line in [*lines, *content.problems])


def _about(bag: Bag) -> str:
    """Return the date, duration and size of a bag."""
    if not bag.message_count:
        return f'It is empty. {bag.storage}, {_size(bag.size_bytes)}.'
    began = datetime.fromtimestamp(bag.start_ns / 1e9, timezone.utc)
    return (
        f'{bag.duration_sec:.1f} s from {began:%Y-%m-%d %H:%M:%S} UTC, {bag.storage}, '
        f'{_size(bag.size_bytes)}.'
    )


def _row_of(strip: Strip) -> list[str]:
    """Return name, type, count, rate and times of a topic, and all of it as a sentence."""
    topic, rate = strip.topic, strip.rate
    rate_text = '' if rate is None else f'{rate:.3g} Hz' if rate < 99.5 else f'{rate:.0f} Hz'
    times = f'{strip.first_sec:.1f} s to {strip.last_sec:.1f} s' if topic.count else ''
    words = f'{_messages(topic.count)} of {topic.name}'
    if topic.count:
        words += f' from {times}'
    if strip.gap is not None:
        words += f', longest pause {strip.gap[0]:.2g} s, from {strip.gap[1]:.1f} s on'
    return [topic.name, topic.msg_type, str(topic.count), rate_text, times, words]


def _messages(count: int) -> str:
    return f'{count} message{"s" * (count != 1)}'


def _size(count: int) -> str:
    """Return a number of bytes with a decimal unit."""
    size, units = float(count), ['B', 'kB', 'MB', 'GB', 'TB']
    while size >= 999.5 and len(units) > 1:
        size, units = size / 1000, units[1:]
    return f'{size:.3g} {units[0]}'


def _ordinal(number: int) -> str:
    """Return a number as an ordinal such as `'3rd'`."""
    ending = {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')
    return f'{number}{"th" if 10 <= number % 100 <= 20 else ending}'
