"""`ros2 bag play`: publish what a bag holds."""

from __future__ import annotations

import argparse
import re
import time
from argparse import Namespace
from contextlib import suppress

from labkit.background.progress_bar import ProgressBar
from labkit.bags.choice import TopicChoice
from labkit.bags.player import CLOCK, NODE_NAME, play
from labkit.bags.reader import open_bag
from labkit.errors import LabError
from labkit.ros2.asking import asking_node, full_name
from labkit.ros2.bag_words import add_reader_arguments, check_kind, say, topics_in_bag
from labkit.ros2.parser import Parser, Usage, Verb, positive_float
from labkit.ros2.streams import POLL_SEC, Stop

__all__ = ['PLAY']

_CLOCK_HZ = 40.0


def play_back(args: Namespace) -> str | None:
    """Play until the end of the bag, a time, or the stop button."""
    endless = args.loop or args.start_paused

    def limit() -> Stop | None:
        return Stop(None, args.timeout) if endless or args.timeout else None

    limit()  # refuses what nobody could end
    node = asking_node(args)
    remap = dict(_rule(words) for words in args.remap)
    topics = _topics(args)
    if args.delay:
        time.sleep(args.delay)
    bar = ProgressBar('Playing')
    say('INFO', NODE_NAME, f'Set rate to {args.rate:g}')
    playing = play(
        args.bag_path,
        topics,
        rate=args.rate,
        loop=args.loop,
        remap={old: full_name(new, node) for old, new in remap.items()},
        start_offset=args.start_offset,
        paused=args.start_paused,
        clock=args.clock,
    )
    for name, why in playing.skipped.items():
        say('WARN', NODE_NAME, f"Ignoring a topic '{name}', reason: {why}.")
    length, stop = playing.bag.duration_sec, limit()
    with playing, suppress(KeyboardInterrupt):
        while not (playing.done or (stop is not None and stop.reached)):
            time.sleep(stop.left_sec if stop is not None else POLL_SEC)
            at = playing.position_sec
            bar.show(at / length if length else None, f'{at:.0f} of {length:.0f} s')
    bar.close()
    return str(playing.error) if playing.error is not None else None


def _topics(args: Namespace) -> list[str]:
    """Return the topics of the bag that are meant."""
    with open_bag(args.bag_path) as bag:
        check_kind(bag, args)
        if bag.note:
            say('WARN', 'ros2bag', bag.note)
        choice = TopicChoice(
            not (args.topics or args.regex),
            frozenset(bag.topic(name).name for name in args.topics),
            regex=args.regex,
            exclude=[args.exclude_regex] if args.exclude_regex else [],
            exclude_names=frozenset(bag.topic(name).name for name in args.exclude_topics),
            hidden=True,
        )
        found = [topic.name for topic in bag.topics if choice.takes(topic.name, topic.msg_type)]
    if args.clock is not None:
        found = [name for name in found if name != CLOCK]
    if not found and bag.topics:
        raise LabError(
            f'None of the topics of {args.bag_path!r} is chosen.',
            todo=f'It has {", ".join(topic.name for topic in bag.topics)}.',
        )
    return found


def _rule(words: str) -> tuple[str, str]:
    """Take a rule such as `/odom:=/odom2` apart."""
    found = re.fullmatch(r'([^:=]+):=([^:=]+)', words)
    if found is None:
        raise Usage(
            f'ros2 bag play: {words!r} is no remapping.', todo='Write old:=new: -m /odom:=/odom2'
        )
    return found[1], found[2]


def _not_negative_float(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < float('inf'):
        raise argparse.ArgumentTypeError(f'expected a number of at least 0, but got {text!r}')
    return value


def _arguments(parser: Parser) -> None:
    add_reader_arguments(parser)
    parser.add(
        *('-r', '--rate'),
        type=positive_float,
        default=1.0,
        help='rate at which to play back messages. Valid range > 0.0.',
    )
    for names, metavar, text in (
        (['--topics'], 'topic', 'Space-delimited list of topics to play.'),
        (['--exclude-topics'], 'topic', 'Space-delimited list of topics not to play.'),
    ):
        parser.add(
            *names, default=[], metavar=metavar, nargs='+', complete=topics_in_bag, help=text
        )
    for names, text in (
        (['-e', '--regex'], 'Play only topics and services matches with regular expression.'),
        (
            ['-x', '--exclude-regex'],
            'regular expressions to exclude topics and services from replay.',
        ),
    ):
        parser.add(*names, default='', help=text)
    parser.add(
        *('-l', '--loop'),
        action='store_true',
        help='enables loop playback when playing a bagfile: it starts back at the beginning on '
        'reaching the end and plays indefinitely.',
    )
    parser.add(
        *('--remap', '-m'),
        default=[],
        nargs='+',
        metavar='old:=new',
        help='list of topics to be remapped: in the form "old_topic1:=new_topic1 '
        'old_topic2:=new_topic2 etc."',
    )
    parser.add(
        '--clock',
        type=positive_float,
        nargs='?',
        const=_CLOCK_HZ,
        metavar='HZ',
        help='Publish to /clock at a specific frequency in Hz, to act as a ROS Time Source. '
        'Value must be positive. Defaults to not publishing. If specified, /clock topic in the '
        'bag file is excluded to publish.',
    )
    parser.add(
        *('-p', '--start-paused'),
        action='store_true',
        help='Start the playback player in a paused state.',
    )
    for names, text in (
        (['--start-offset'], 'Start the playback player this many seconds into the bag file.'),
        (['-d', '--delay'], 'Sleep duration before play, in seconds.'),
    ):
        parser.add(*names, type=_not_negative_float, default=0.0, metavar='SEC', help=text)
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='Exit after N seconds (only here)'
    )


PLAY = Verb(
    'play',
    'Play back ROS data from a bag',
    play_back,
    _arguments,
    'It waits until those who subscribe already are connected. There are no keys to press: '
    'lab.play(...) in a cell can be paused, resumed and sent elsewhere.',
)
