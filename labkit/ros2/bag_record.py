"""`ros2 bag record`: write what is published to a bag."""

from __future__ import annotations

import datetime
import time
from argparse import Namespace
from contextlib import suppress
from pathlib import Path

from labkit.background.progress_bar import ProgressBar
from labkit.bags.choice import TopicChoice
from labkit.bags.recorder import CACHE_BYTES, NODE_NAME, Recording, start_recording
from labkit.bags.writer import STORAGES, BagWriter
from labkit.errors import LabError
from labkit.ros2.asking import asking_node, full_name
from labkit.ros2.bag_words import say
from labkit.ros2.graph_words import topic_names
from labkit.ros2.parser import Parser, Verb, unsigned_int
from labkit.ros2.streams import Stop, add_stop_options

__all__ = ['RECORD']

_SELECTION = '--all, --all-topics, --topics, --topic-types or --regex'


def record(args: Namespace) -> str | None:
    """Record until a count, a time, or the stop button."""
    Stop(args.count, args.timeout)  # refuses what nobody could end
    choice = _choice(args)
    writer = _writer(args)
    say('INFO', NODE_NAME, 'Listening for topics...')
    recording = start_recording(
        writer,
        choice,
        count=args.count,
        cache_bytes=args.max_cache_size or CACHE_BYTES,
        discovery=not args.no_discovery,
    )
    stop = Stop(args.count, args.timeout)
    told: set[str] = set()
    bar = ProgressBar('Recording')
    began = time.monotonic()
    with recording, suppress(KeyboardInterrupt):
        _tell_new(recording, told)
        say('INFO', NODE_NAME, 'Recording...')
        while not (stop.reached or recording.done):
            time.sleep(stop.left_sec)
            _tell_new(recording, told)
            bar.show(None, f'{recording.count} messages in {time.monotonic() - began:.0f} s')
    bar.close()
    _tell_new(recording, told)
    say('INFO', NODE_NAME, 'Recording stopped')
    if recording.lost:
        say('WARN', NODE_NAME, f'{recording.lost} messages were lost: the disk is too slow.')
    return str(recording.error) if recording.error is not None else None


def _tell_new(recording: Recording, told: set[str]) -> None:
    for name in sorted(recording.counts.keys() - recording.skipped.keys() - told):
        say('INFO', NODE_NAME, f"Subscribed to topic '{name}'")
        told.add(name)
    for name in sorted(recording.skipped.keys() - told):
        say('WARN', NODE_NAME, f"Topic '{name}' is not recorded: {recording.skipped[name]}")
        told.add(name)
    for warning in list(recording.warnings):
        if warning not in told:
            say('WARN', 'ROSBAG2_STORAGE', warning)
            told.add(warning)


def _choice(args: Namespace) -> TopicChoice:
    """Return which topics are meant; complain in the words of the real command."""
    names = list(args.topics)
    if args.topics_positional:
        say(
            *('WARN', 'ros2bag'),
            'Positional "topics" argument deprecated. Please use optional "--topics" argument '
            'instead.',
        )
        names = [*args.topics_positional, *names]
    everything = args.all or args.all_topics
    if not (everything or names or args.topic_types or args.regex):
        raise LabError(
            f'[ERROR] [ros2bag]: Need to specify at least one option out of {_SELECTION}',
            todo='ros2 bag record -a   records all topics.',
        )
    for option, value in (
        ('--exclude-regex', args.exclude_regex),
        ('--exclude-topics', args.exclude_topics),
        ('--exclude-topic-types', args.exclude_topic_types),
    ):
        if value and not (everything or args.topic_types or args.regex):
            raise LabError(
                f'[ERROR] [ros2bag]: {option} argument requires either --all, --all-topics, '
                '--topic-types or --regex'
            )
    for option, value in (('--topics', names), ('--regex', args.regex)):
        if everything and value:
            say('WARN', 'ros2bag', f'--all or --all-topics will override {option}')
    node = asking_node(args)
    return TopicChoice(
        everything,
        frozenset() if everything else frozenset(full_name(name, node) for name in names),
        frozenset(args.topic_types),
        args.regex,
        [args.exclude_regex] if args.exclude_regex else [],
        frozenset(full_name(name, node) for name in args.exclude_topics),
        frozenset(args.exclude_topic_types),
        args.include_hidden_topics,
    )


def _writer(args: Namespace) -> BagWriter:
    path = args.output or datetime.datetime.now().strftime('rosbag2_%Y_%m_%d-%H_%M_%S')
    if Path(path).exists():
        raise LabError(
            f"[ERROR] [ros2bag]: Output folder '{path}' already exists.",
            todo='Choose another name, or remove it first.',
        )
    return BagWriter(
        Path(path),
        args.storage,
        split_bytes=args.max_bag_size,
        split_sec=args.max_bag_duration,
    )


def _arguments(parser: Parser) -> None:
    parser.add(
        'topics_positional',
        metavar='Topic',
        default=[],
        nargs='*',
        complete=topic_names,
        help='Space-delimited list of topics to record. (deprecated)',
    )
    parser.add(
        *('-o', '--output'),
        help='Destination of the bagfile to create, defaults to a timestamped folder in the '
        'current directory.',
    )
    parser.add(
        *('-s', '--storage'),
        default='mcap',
        choices=STORAGES,
        help="Storage identifier to be used, defaults to 'mcap'.",
    )
    _topic_arguments(parser)
    for names, text in (
        (['--include-hidden-topics'], 'Discover and record hidden topics as well.'),
        (
            ['--no-discovery'],
            'Disables topic auto discovery during recording: only topics present at startup '
            'will be recorded.',
        ),
    ):
        parser.add(*names, action='store_true', help=text)
    for names, default, text in (
        (
            ['-b', '--max-bag-size'],
            0,
            'Maximum size in bytes before the bagfile will be split.',
        ),
        (
            ['-d', '--max-bag-duration'],
            0,
            'Maximum duration in seconds before the bagfile will be split.',
        ),
        (
            ['--max-cache-size'],
            CACHE_BYTES,
            'Maximum size (in bytes) of messages to hold in cache.',
        ),
    ):
        words = f'{text} Default: {default}'
        parser.add(*names, type=unsigned_int, default=default, metavar='N', help=words)
    add_stop_options(parser, 'messages')


def _topic_arguments(parser: Parser) -> None:
    """Add the options that choose topics."""
    parser.add(
        '--topics',
        default=[],
        metavar='Topic',
        nargs='+',
        complete=topic_names,
        help='Space-delimited list of topics to record.',
    )
    parser.add(
        '--topic-types',
        default=[],
        metavar='TopicType',
        nargs='+',
        help='Space-delimited list of topic types to record.',
    )
    for names, text in (
        (['-a', '--all'], 'Record all topics and services (Exclude hidden topic).'),
        (['--all-topics'], 'Record all topics (Exclude hidden topic).'),
    ):
        parser.add(*names, action='store_true', help=text)
    parser.add(
        *('-e', '--regex'),
        default='',
        help='Record only topics containing provided regular expression. Note: --all or '
        '--all-topics will override --regex.',
    )
    parser.add(
        '--exclude-regex',
        default='',
        help='Exclude topics containing provided regular expression. Works on top of --all, '
        '--all-topics, --topics or --regex.',
    )
    parser.add(
        '--exclude-topic-types',
        default=[],
        metavar='TopicType',
        nargs='+',
        help='Space-delimited list of topic types not being recorded.',
    )
    parser.add(
        '--exclude-topics',
        default=[],
        metavar='Topic',
        nargs='+',
        complete=topic_names,
        help='Space-delimited list of topics not being recorded.',
    )


RECORD = Verb(
    'record',
    'Record ROS data to a bag',
    record,
    _arguments,
    'It ends after --count messages, after --timeout seconds, or with Ctrl-C or the stop button; '
    'the real one knows the last only. Its options for services, compression and simulation '
    'time are not here.',
)
