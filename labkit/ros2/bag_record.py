"""`ros2 bag record`: record topics to a bag."""

from __future__ import annotations

import datetime
import time
from argparse import Namespace
from contextlib import suppress
from pathlib import Path

from labkit.background.wait import wait_for
from labkit.bags.choice import SERVICE_EVENTS, TopicChoice
from labkit.bags.recorder import CACHE_BYTES, NODE_NAME, Recording, start_recording
from labkit.bags.writer import STORAGES, BagWriter
from labkit.errors import LabError
from labkit.progress_bar import ProgressBar
from labkit.ros2.graph_completion import service_names, topic_names
from labkit.ros2.graph_queries import asking_node, full_name
from labkit.ros2.parser import Parser, Verb, unsigned_int
from labkit.ros2.streams import Stop, add_stop_options, log
from labkit.rosgraph.qos_profiles import read_overrides

__all__ = ['RECORD']

_SELECTION = '--all, --all-topics, --all-services, --services, --topics, --topic-types or --regex'


def record(args: Namespace) -> str | None:
    """Record until a count, a timeout, or the stop button."""
    Stop(args.count, args.timeout)  # raises if nobody could end it
    if args.compression_mode != 'none':
        raise LabError(
            'Bags are written without compression here.',
            todo='Leave --compression-mode out. The folder can be packed afterwards.',
        )
    if args.use_sim_time and args.no_discovery:
        raise LabError(
            '[ERROR] [ros2bag]: --use-sim-time and --no-discovery both set, but are incompatible '
            'settings. The /clock topic needs to be discovered to record with sim time.'
        )
    path = args.qos_profile_overrides_path
    overrides = read_overrides(path) if path else {}
    choice = _choice(args)
    writer = _writer(args)
    log('INFO', NODE_NAME, 'Listening for topics...')
    recording = start_recording(
        writer,
        choice,
        count=args.count,
        cache_bytes=args.max_cache_size or CACHE_BYTES,
        discovery=not args.no_discovery,
        overrides=overrides,
        use_sim_time=args.use_sim_time,
    )
    stop = Stop(args.count, args.timeout)
    logged: set[str] = set()
    bar = ProgressBar('Recording')
    began = time.monotonic()
    with recording, suppress(KeyboardInterrupt):
        _log_changes(recording, logged)
        log('INFO', NODE_NAME, 'Recording...')

        def is_over() -> bool:
            _log_changes(recording, logged)
            bar.show(None, f'{recording.count} messages in {time.monotonic() - began:.0f} s')
            return stop.reached or recording.done

        wait_for(is_over, None)
    bar.close()
    _log_changes(recording, logged)
    log('INFO', NODE_NAME, 'Recording stopped')
    if recording.lost:
        log(
            'WARN',
            NODE_NAME,
            f'{recording.lost} messages were lost: they came faster than they were written.',
        )
    return str(recording.error) if recording.error is not None else None


def _log_changes(recording: Recording, logged: set[str]) -> None:
    for name in sorted(recording.counts.keys() - recording.skipped.keys() - logged):
        log('INFO', NODE_NAME, f"Subscribed to topic '{name}'")
        logged.add(name)
    for name in sorted(recording.skipped.keys() - logged):
        log('WARN', NODE_NAME, f"Topic '{name}' is not recorded: {recording.skipped[name]}")
        logged.add(name)
    for warning in list(recording.warnings):
        if warning not in logged:
            log('WARN', 'ROSBAG2_STORAGE', warning)
            logged.add(warning)


def _choice(args: Namespace) -> TopicChoice:
    """Return the selected topics; complain in the words of the real command."""
    names = list(args.topics)
    if args.topics_positional:
        log(
            *('WARN', 'ros2bag'),
            'Positional "topics" argument deprecated. Please use optional "--topics" argument '
            'instead.',
        )
        names = [*args.topics_positional, *names]
    everything = args.all or args.all_topics
    services = args.all or args.all_services
    named = names or args.services
    if not (everything or services or named or args.topic_types or args.regex):
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
            log('WARN', 'ros2bag', f'--all or --all-topics will override {option}')
    node = asking_node(args)
    events = [f'{full_name(name, node)}{SERVICE_EVENTS}' for name in args.services]
    no_events = [f'{full_name(name, node)}{SERVICE_EVENTS}' for name in args.exclude_services]
    return TopicChoice(
        everything,
        frozenset([*events, *(full_name(name, node) for name in names if not everything)]),
        frozenset(args.topic_types),
        args.regex,
        [args.exclude_regex] if args.exclude_regex else [],
        frozenset([*no_events, *(full_name(name, node) for name in args.exclude_topics)]),
        frozenset(args.exclude_topic_types),
        args.include_hidden_topics,
        services,
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
    parser.flag('--include-hidden-topics', 'Discover and record hidden topics as well.')
    parser.flag(
        '--no-discovery',
        'Disables topic auto discovery during recording: only topics present at startup will be '
        'recorded.',
    )
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
    _more_arguments(parser)
    add_stop_options(parser, 'messages')


def _more_arguments(parser: Parser) -> None:
    parser.add(
        '--qos-profile-overrides-path',
        metavar='FILE',
        help='Path to a yaml file defining overrides of the QoS profile for specific topics.',
    )
    parser.flag(
        '--use-sim-time',
        'Use simulation time for message timestamps by subscribing to the /clock topic. '
        'Until first /clock message is received, no messages will be written to bag.',
    )
    parser.add(
        '--compression-mode',
        choices=['none', 'file', 'message'],
        default='none',
        help='Bags are written without compression here: none',
    )
    parser.add(*('-f', '--serialization-format'), choices=['cdr'], help='cdr, as always here')
    for name in ('--polling-interval', '--log-level'):
        parser.accept(*(['-p'] * (name == '--polling-interval')), name)
    parser.accept('--disable-keyboard-controls', flag=True)
    for name, why in _REFUSED.items():
        parser.refuse(name, why=why)


def _topic_arguments(parser: Parser) -> None:
    """Add the options that select topics."""
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
    for name, text in (
        ('--services', 'Space-delimited list of services to record, by their introspection.'),
        ('--exclude-services', 'Space-delimited list of services not being recorded.'),
    ):
        parser.add(
            name, default=[], metavar='ServiceName', nargs='+', complete=service_names, help=text
        )
    parser.flag('-a, --all', 'Record all topics and services (Exclude hidden topic).')
    parser.flag('--all-services', 'Record all services via service event topics.')
    parser.flag('--all-topics', 'Record all topics (Exclude hidden topic).')
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


_REFUSED = {
    '--start-paused': 'there are no keys to go on with. Start it when it is to record.',
    '--snapshot-mode': 'all messages are written at once. Cut the bag with ros2 bag convert.',
    '--compression-format': 'bags are written without compression.',
    '--compression-queue-size': 'bags are written without compression.',
    '--compression-threads': 'bags are written without compression.',
    '--storage-preset-profile': 'storage has one form, which survives a crash.',
    '--storage-config-file': 'storage has one form, which survives a crash.',
    '--include-unpublished-topics': 'a topic is recorded once somebody publishes on it.',
    '--ignore-leaf-topics': 'name the topics, or leave some out with --exclude-topics.',
    '--node-name': f'the node is called {NODE_NAME}.',
    '--custom-data': 'metadata.yaml has what belongs to the messages.',
}

RECORD = Verb(
    'record',
    'Record ROS data to a bag',
    record,
    _arguments,
    'It ends after --count messages, after --timeout seconds, or with Ctrl-C or the stop button; '
    'the real one knows the last only. Services are recorded if they have introspection. What '
    'is refused here says so in a sentence.',
)
