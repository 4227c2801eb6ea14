"""`ros2 bag play`: publish the messages of a bag."""

from __future__ import annotations

import argparse
import re
import time
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from labkit import settings
from labkit.background.wait import wait_for
from labkit.bags.choice import SERVICE_EVENTS, TopicChoice
from labkit.bags.finding import is_bag
from labkit.bags.player import CLOCK, NODE_NAME, Playing, start_playing
from labkit.bags.reader import Bag, open_bag
from labkit.bags.writer import STORAGES
from labkit.errors import LabError, quoted
from labkit.progress_bar import ProgressBar
from labkit.ros2.graph_queries import asking_node, full_name
from labkit.ros2.keys import DOWN, RIGHT, SPACE, UP, pressed_keys
from labkit.ros2.parser import Parser, Usage, Verb, positive_float
from labkit.ros2.streams import Stop, log
from labkit.rosgraph.qos_profiles import read_overrides

__all__ = ['PLAY', 'add_reader_arguments', 'bag_paths', 'check_storage']

_CLOCK_HZ = 40.0
_KEYS = {
    'SPACE': 'Pause/Resume',
    'CURSOR_RIGHT': 'Play Next Message',
    'CURSOR_UP': 'Increase Rate 10%',
    'CURSOR_DOWN': 'Decrease Rate 10%',
}
_FASTER = {UP: 1.1, DOWN: 0.9}


def play_back(args: Namespace) -> str | None:
    """Play until the end of the bag, a timeout, or the stop button."""
    endless = args.loop or args.start_paused

    def limit() -> Stop | None:
        return Stop(None, args.timeout) if endless or args.timeout else None

    limit()  # raises if nobody could end it
    node = asking_node(args)
    remap = dict(_rule(words) for words in args.remap)
    topics, end_sec = _chosen(args)
    path = args.qos_profile_overrides_path
    overrides = read_overrides(path) if path else {}
    if args.delay:
        time.sleep(args.delay)
    bar = ProgressBar('Playing')
    log('INFO', NODE_NAME, f'Set rate to {args.rate:g}')
    playing = start_playing(
        args.bag_path,
        topics,
        rate=args.rate,
        loop=args.loop,
        remap={old: full_name(new, node) for old, new in remap.items()},
        start_offset=args.start_offset,
        paused=args.start_paused,
        clock=args.clock,
        end_sec=end_sec,
        overrides=overrides,
    )
    for name, why in playing.skipped.items():
        log('WARN', NODE_NAME, f'Ignoring a topic {quoted(name)}, reason: {why}.')
    length, stop = playing.bag.duration_sec, limit()
    with playing, _keys(args) as pressed, suppress(KeyboardInterrupt):

        def is_over() -> bool:
            for key in pressed():
                _obey(key, playing)
            at = playing.position_sec
            bar.show(at / length if length else None, f'{at:.0f} of {length:.0f} s')
            return playing.done or (stop is not None and stop.reached)

        wait_for(is_over, None)
    bar.close()
    return str(playing.error) if playing.error is not None else None


@contextmanager
def _keys(args: Namespace) -> Iterator[Callable[[], list[str]]]:
    """Give a function that returns the keys pressed in the terminal, if there is one."""
    if args.disable_keyboard_controls or settings.in_kernel():
        yield list
        return
    with pressed_keys() as pressed:
        for name, does in _KEYS.items() if pressed else ():
            log('INFO', NODE_NAME, f'Press {name} for {does}')
        yield pressed or list


def _obey(key: str, playing: Playing) -> None:
    """Do what a key asks for."""
    if key == SPACE:
        (playing.resume if playing.paused else playing.pause)()
        log('INFO', NODE_NAME, 'Pausing play.' if playing.paused else 'Resuming play.')
    elif key == RIGHT:
        playing.play_next()
    elif key in _FASTER:
        playing.set_rate(playing.rate * _FASTER[key])
        log('INFO', NODE_NAME, f'Set rate to {playing.rate:g}')


def _chosen(args: Namespace) -> tuple[list[str], float | None]:
    """Return the selected topics of the bag, and where to end, s from its beginning."""
    with open_bag(args.bag_path) as bag:
        check_storage(bag, args)
        if bag.note:
            log('WARN', 'ros2bag', bag.note)
        choice = TopicChoice(
            not (args.topics or args.services or args.regex),
            frozenset(bag.topic(name).name for name in (*args.topics, *_events(args.services))),
            regex=args.regex,
            exclude=[args.exclude_regex] if args.exclude_regex else [],
            exclude_names=frozenset(
                bag.topic(name).name
                for name in (*args.exclude_topics, *_events(args.exclude_services))
            ),
            hidden=True,
        )
        found = [topic.name for topic in bag.topics if choice.takes(topic.name, topic.msg_type)]
    if args.clock is not None:
        found = [name for name in found if name != CLOCK]
    if not found and bag.topics:
        raise LabError(
            f'None of the topics of {quoted(args.bag_path)} is chosen.',
            todo=f'It has {", ".join(topic.name for topic in bag.topics)}.',
        )
    ends = []
    if args.playback_duration >= 0:
        ends.append(args.start_offset + args.playback_duration)
    if args.playback_until_sec >= 0:
        ends.append(args.playback_until_sec - bag.start_ns * 1e-9)
    if args.playback_until_nsec >= 0:
        ends.append((args.playback_until_nsec - bag.start_ns) * 1e-9)
    return found, max(ends, default=None)


def _events(services: Iterable[str]) -> list[str]:
    return [f'{name}{SERVICE_EVENTS}' for name in services]


def _rule(words: str) -> tuple[str, str]:
    """Parse a rule such as `/odom:=/odom2`."""
    found = re.fullmatch(r'([^:=]+):=([^:=]+)', words)
    if found is None:
        raise Usage(
            f'ros2 bag play: {quoted(words)} is no remapping.',
            todo='Write old:=new: -m /odom:=/odom2',
        )
    return found[1], found[2]


def _not_negative_float(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < float('inf'):
        raise argparse.ArgumentTypeError(
            f'expected a number of at least 0, but got {quoted(text)}'
        )
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
        (['--services'], 'service', 'Space-delimited list of services to play, by their events.'),
        (['--exclude-services'], 'service', 'Space-delimited list of services not to play.'),
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
    parser.flag(
        '-l, --loop',
        'enables loop playback when playing a bagfile: it starts back at the beginning on '
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
    parser.flag('-p, --start-paused', 'Start the playback player in a paused state.')
    for names, text in (
        (['--start-offset'], 'Start the playback player this many seconds into the bag file.'),
        (['-d', '--delay'], 'Sleep duration before play, in seconds.'),
    ):
        parser.add(*names, type=_not_negative_float, default=0.0, metavar='SEC', help=text)
    _more_arguments(parser)
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='Exit after N seconds (only here)'
    )


def _more_arguments(parser: Parser) -> None:
    parser.add(
        '--qos-profile-overrides-path',
        metavar='FILE',
        help='Path to a yaml file defining overrides of the QoS profile for specific topics.',
    )
    for name, kind, text in (
        ('--playback-duration', float, 'Playback duration, in seconds.'),
        ('--playback-until-sec', float, 'Playback until a time, in seconds since epoch.'),
        ('--playback-until-nsec', int, 'Playback until a time, in nanoseconds since epoch.'),
    ):
        words = f'{text} Negative: until the end. The latest of the three counts.'
        parser.add(name, type=kind, default=-1, metavar='N', help=words)
    for name in ('--read-ahead-queue-size', '--log-level', '--wait-for-all-acked'):
        parser.accept(name)
    parser.flag('--disable-keyboard-controls', 'Do not read keys from the terminal.')
    parser.accept('--disable-loan-message', flag=True)
    for name, why in _REFUSED.items():
        parser.refuse(name, why=why)


# -- shared by the verbs that read a bag --------------------------------------------------------


def add_reader_arguments(parser: Parser) -> None:
    """Add the arguments of verbs that read one bag."""
    parser.add('bag_path', help='Bag to open', complete=bag_paths)
    parser.add(
        *('-s', '--storage'),
        choices=STORAGES,
        help='Storage implementation of bag. By default attempts to detect automatically - use '
        'this argument to override.',
    )


def check_storage(bag: Bag, args: Namespace) -> None:
    """Raise a LabError if a bag has another storage than requested."""
    if args.storage and args.storage != bag.storage:
        bag.close()
        raise LabError(
            f'{quoted(str(bag.path))} is stored as {bag.storage}, not as {args.storage}.',
            todo='Leave --storage out.',
        )


def bag_paths(_: Namespace) -> Iterable[str]:
    """Return the bags in this folder and one level below."""
    found: list[str] = []
    with suppress(OSError):
        for path in Path().iterdir():
            if is_bag(path):
                found.append(str(path))
            elif path.is_dir() and not path.name.startswith('.'):
                with suppress(OSError):
                    found += [str(inner) for inner in path.iterdir() if is_bag(inner)]
    return sorted(found)


def topics_in_bag(args: Namespace) -> Iterable[str]:
    """Return the topics of the bag named earlier on the line."""
    path = getattr(args, 'bag_path', '')
    if not path:
        return []
    with open_bag(path) as bag:
        return [topic.name for topic in bag.topics]


_REFUSED = {
    '--clock-topics': 'take --clock HZ.',
    '--clock-topics-all': 'take --clock HZ.',
    '--storage-config-file': 'bags of all forms are read without one.',
    '--publish-service-requests': 'events are played as messages, and nobody is called.',
    '--service-requests-source': 'events are played as messages, and nobody is called.',
}

PLAY = Verb(
    'play',
    'Play back ROS data from a bag',
    play_back,
    _arguments,
    'It waits until those who subscribe already are connected. In a terminal, keys pause it, '
    'play the next message and change the rate. In a cell there are none: lab.play(...) can do '
    'that, and go elsewhere. The services of /rosbag2_player are not here: their types are in no '
    'wheel.',
)
