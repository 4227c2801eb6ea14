"""What is in a bag, in words: for programs, for whoever can't see the picture, for its table."""

from __future__ import annotations

from datetime import datetime, timezone

from labkit import settings
from labkit.bags.reader import Bag
from labkit.views.arena_picture import Scene
from labkit.views.bag_reading import Content, Strip
from labkit.views.plot_picture import in_words

__all__ = ['about', 'bag_in_words', 'ordinal', 'printable', 'row_of']


def bag_in_words(bag: Bag, content: Content, note: str) -> str:
    """Return what a bag has as text; for a program, without what each recording has anew.

    Args:
        bag: The bag.
        content: What was read of it.
        note: What is wrong with it, as a sentence; '' if it is whole.
    """
    timeless = settings.audience().same_each_time
    topics = f'{len(bag.topics)} topic{"s" * (len(bag.topics) != 1)}'
    head = f'{bag.path.name}: {_messages(bag.message_count)} of {topics}'
    lines = [f'{head}, {bag.storage}' if timeless else f'{head}. {about(bag)}']
    table = [row_of(strip)[:-1] for strip in content.strips]
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


def about(bag: Bag) -> str:
    """Return when a bag was recorded, how long, and how large it is."""
    if not bag.message_count:
        return f'It is empty. {bag.storage}, {_size(bag.size_bytes)}.'
    began = datetime.fromtimestamp(bag.start_ns / 1e9, timezone.utc)
    return (
        f'{bag.duration_sec:.1f} s from {began:%Y-%m-%d %H:%M:%S} UTC, {bag.storage}, '
        f'{_size(bag.size_bytes)}.'
    )


def row_of(strip: Strip) -> list[str]:
    """Return name, type, count, rate and times of a topic, and the same as a sentence."""
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
    """Return a number of bytes as text, in units of 1000."""
    size, units = float(count), ['B', 'kB', 'MB', 'GB', 'TB']
    while size >= 999.5 and len(units) > 1:
        size, units = size / 1000, units[1:]
    return f'{size:.3g} {units[0]}'


def ordinal(number: int) -> str:
    """Return a number's place in an order, such as `'3rd'`."""
    ending = {1: 'st', 2: 'nd', 3: 'rd'}.get(number % 10, 'th')
    return f'{number}{"th" if 10 <= number % 100 <= 20 else ending}'


def printable(text: str) -> str:
    """Return a text with `?` for what can't be printed, such as the end of a line."""
    return ''.join(char if char.isprintable() else '?' for char in text)
