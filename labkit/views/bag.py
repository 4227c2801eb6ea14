"""What is in a bag, as a picture: `lab.bag('drive')`.

A table of its topics, a strip for each of when messages came, a plot of chosen fields, and a map
where the bag has a robot's odometry. In a page, a slider goes through the time of the bag, and a
button plays it. Nothing is published, and ROS need not run: the page gets what it draws once, and
asks for single messages and scans.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.background.progress_bar import ProgressBar
from labkit.bags.reader import open_bag
from labkit.errors import LabError
from labkit.views.bag_picture import to_png
from labkit.views.bag_reading import (
    ODOMETRY,
    SCAN,
    Content,
    Samples,
    check_field,
    chosen_topic,
    number_paths,
    read_samples,
    read_strip,
    read_track,
)
from labkit.views.bag_words import about, bag_in_words, ordinal, printable, row_of
from labkit.views.live import Live
from labkit.views.message_tree import rows
from labkit.views.plot_fields import Source, parse
from labkit.views.plot_picture import COLOURS, thin
from labkit.views.robot_messages import beam_ends, motion_of
from labkit.views.stored import Stored
from labkit.views.widget import widget_class

if TYPE_CHECKING:
    from labkit.bags.reader import BagMessage, BagTopic
    from labkit.views.widget import PageWidget

__all__ = ['BagView', 'bag']

# So many columns a line has at most; what is in between can't be seen.
COLUMNS = 800


class BagView(Live):
    """A bag, to be shown in a cell; see `bag`.

    Attributes:
        note: What is wrong with the bag, as a sentence; '' if it is whole.
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
        self._content: Content | None = None
        self._widget: PageWidget | None = None
        if self._watched:
            self._widget = widget_class(self._name)()
            self._widget.on_msg(self._on_message)
            self._take_place()

    # -- for cells ------------------------------------------------------------------------------

    @property
    def topics(self) -> list[BagTopic]:
        """Return the topics: name, type (`msg_type`) and how many messages there are (`count`)."""
        return self._bag.topics

    @property
    def duration_sec(self) -> float:
        """Return the time from the first to the last message, s."""
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
            start_sec: The first time, s since the beginning of the bag.
            end_sec: The last time, s since the beginning of the bag.

        Raises:
            LabError: The bag has no such topic, or is damaged at some place.
        """
        return self._bag.messages(topics, start_sec, end_sec)

    def __repr__(self) -> str:
        return bag_in_words(self._bag, self._read(), self.note)

    def _repr_mimebundle_(self, **_: object) -> dict[str, object]:
        content = self._read()
        shown: dict[str, object] = {'text/plain': repr(self)}
        if self._bag.message_count:
            seconds = self._bag.duration_sec
            shown['image/png'] = to_png(content.strips, content.samples, content.track, seconds)
        return shown

    def _ipython_display_(self) -> None:
        if self._widget is None or self._ended:
            raise NotImplementedError  # then IPython asks for the bundle
        Stored(self._widget).show({'text/plain': repr(self)})

    # -- life: it listens to nothing, so it has no part in that of ROS ---------------------------

    def _cut_off(self) -> str:
        return ''

    def _close(self) -> None:
        super()._close()
        self._bag.close()

    def _say_end(self) -> None:
        self._tell({'ended': self._ended})

    # -- reading --------------------------------------------------------------------------------

    def _read(self) -> Content:
        """Read what the picture shows, once."""
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
            f'Every {ordinal(each.step)} message of {each.source.topic} is drawn.'
            for each in samples
            if each.step > 1
        ]
        return Content(strips, samples, track, list(dict.fromkeys(problems)))

    def _samples(self, sources: Sequence[Source], progress: ProgressBar) -> list[Samples]:
        """Return the numbers of fields, in their order; each topic is read once."""
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
        """The page asks for something."""
        if self._ended:
            self._say_end()
            return
        try:
            self._answer(content)
        except LabError as error:
            self._tell({'refused': str(error), 'answered': content})

    def _answer(self, content: dict[str, Any]) -> None:
        if 'see' in content:
            self._tell_all()
        elif isinstance(content.get('paths'), str):
            self._tell_paths(content['paths'])
        elif isinstance(content.get('lines'), list):
            sources = _checked([parse(field) for field in content['lines']])
            with self._lock:
                progress = ProgressBar('Reading')
                samples = self._samples(sources, progress)
            self._tell(*_told(samples, self._bag.duration_sec))
        elif isinstance(content.get('at'), (int, float)):
            self._tell_moment(float(content['at']), content.get('topic') or '')

    def _tell_all(self) -> None:
        content, bag = self._read(), self._bag
        state, lines = _told(content.samples, bag.duration_sec)
        bins = [strip.bins for strip in content.strips]
        buffers = [np.concatenate([np.empty(0), *bins]).astype('<f4').tobytes()]
        if content.track is not None:
            table = np.column_stack([content.track.times, content.track.numbers])
            buffers.append(table.astype('<f8').tobytes())
        state |= {
            'name': bag.path.name,
            'about': about(bag),
            'seconds': bag.duration_sec,
            'topics': [row_of(strip) for strip in content.strips],
            'track': content.track.topic if content.track is not None else '',
            'scan': self._scan,
            'note': ' '.join([*[self.note] * bool(self.note), *content.problems]),
        }
        self._tell(state, [*buffers, *lines])

    def _tell_paths(self, topic: str) -> None:
        stamps = self._bag.stamps(topic)
        first = self._bag.at(topic, int(stamps[0])) if len(stamps) else None
        paths = number_paths(first.message) if first is not None else []
        self._tell({'paths': paths, 'of': topic})

    def _tell_moment(self, seconds: float, topic: str) -> None:
        """Tell what the last message of a topic said at some time, and what a scanner saw."""
        moment = self._bag.start_ns + round(seconds * 1e9)
        state: dict[str, Any] = {'at': seconds, 'of': topic}
        if topic:
            found = self._bag.at(topic, moment)
            tree = rows(found.message) if found is not None else []
            came = (found.stamp_ns - self._bag.start_ns) / 1e9 if found is not None else None
            state |= {'came': came, 'fields': [list(row) for row in tree]}
        self._tell(state, self._scan_at(moment))

    def _scan_at(self, moment: int) -> list[bytes]:
        """Return where the beams of the last scan end, as bytes; nothing if there is none."""
        scan = self._bag.at(self._scan, moment) if self._scan else None
        pose = self._bag.at(self._odom, scan.stamp_ns) if scan is not None else None
        if scan is None or pose is None:
            return []
        motion = motion_of(pose.message)
        return (
            [] if motion is None else [beam_ends(scan.message, motion[0]).astype('<f4').tobytes()]
        )

    def _tell(self, content: dict[str, Any], buffers: Sequence[bytes] = ()) -> None:
        if self._widget is not None:
            self._widget.send(content, list(buffers) or None)


def bag(
    path: str | os.PathLike[str],
    *fields: str,
    odom: str | None = None,
    scan: str | None = None,
) -> BagView:
    """Show what is in a bag: its topics, when their messages came, and what they said.

    In a notebook, a slider goes through the time of the bag: through a plot of fields, and through
    a map where the bag has a robot's odometry. Elsewhere it is a text, and a picture. Nothing is
    published.

    Args:
        path: Folder of the bag, or one file of it. Those of real robots are read, too.
        fields: What to plot, written as for `lab.plot`: `'/odom.pose.pose.position.x'`.
        odom: Topic with the `nav_msgs/msg/Odometry` for the map; '' for no map. By default the
            one with most messages.
        scan: Topic with the `sensor_msgs/msg/LaserScan` for the map; '' for none.

    Returns:
        What a cell shows. `.topics` and `.messages()` are for programs, `.close()` ends it.

    Raises:
        LabError: There is no such bag, topic or field, or the bag can't be read.
    """
    return BagView(path, fields, odom=odom, scan=scan)


def _told(samples: Sequence[Samples], seconds: float) -> tuple[dict[str, Any], list[bytes]]:
    """Return what the page is told of fields."""
    buffers = []
    for each in samples:
        times, values = thin(each.times, each.values, max(seconds, 1e-9) / COLUMNS)
        buffers.append(np.concatenate([times, values]).astype('<f8').tobytes())
    problems = [each.problem for each in samples if each.problem]
    series = [[each.source.text, each.unit] for each in samples]
    return {'series': series, 'refused': ' '.join(dict.fromkeys(problems))}, buffers


def _checked(sources: Sequence[Source]) -> list[Source]:
    """Return fields, each once.

    Raises:
        LabError: There are too many.
    """
    found = list(dict.fromkeys(sources))
    if len(found) > len(COLOURS):
        raise LabError(f'A plot has at most {len(COLOURS)} fields, but got {len(found)}.')
    return found
