"""`ros2 bag`: record, inspect, play back and convert bags."""

from __future__ import annotations

from argparse import Namespace

from labkit.bags.info import describe, topic_names
from labkit.bags.reader import open_bag
from labkit.bags.writer import STORAGES
from labkit.ros2.bag_convert import CONVERT
from labkit.ros2.bag_play import PLAY, add_reader_arguments, check_storage
from labkit.ros2.bag_record import RECORD
from labkit.ros2.bag_reindex import REINDEX
from labkit.ros2.parser import Command, Parser, Verb
from labkit.ros2.streams import log

__all__ = ['COMMAND']


def show_info(args: Namespace) -> None:
    """Print a summary of a bag."""
    if args.topic_name and args.verbose:
        print(
            "Warning! You have set both the '-t' and '-v' parameters. The '-t' parameter "
            'will be ignored.'
        )
    with open_bag(args.bag_path) as bag:
        check_storage(bag, args)
        if bag.note:
            log('WARN', 'ros2bag', bag.note)
        names = topic_names(bag)
        print('\n'.join(names) if args.topic_name and not args.verbose else describe(bag))


def list_plugins(args: Namespace) -> None:
    """Print the kinds of storage, or what can be unpacked."""
    plugins = {'storage': STORAGES, 'decompressor': ['zstd']}.get(args.plugin_type, [])
    if args.verbose:
        print(f'available {args.plugin_type} plugins are:')
    for name in plugins:
        print(f'name: {name}' if args.verbose else name)


def _list_arguments(parser: Parser) -> None:
    parser.add(
        'plugin_type',
        choices=['storage', 'converter', 'compressor', 'decompressor'],
        help='lists available plugins',
    )
    parser.flag('-v, --verbose', 'output verbose information about the available plugin')


def _info_arguments(parser: Parser) -> None:
    add_reader_arguments(parser)
    parser.flag('-t, --topic-name', 'Only display topic names.')
    parser.flag('-v, --verbose', 'Display request/response information for services')


COMMAND = Command(
    'bag',
    'Various rosbag related sub-commands',
    (
        CONVERT,
        Verb(
            'info',
            'Print information about a bag to the screen',
            show_info,
            _info_arguments,
            'A bag that is not complete is read as far as it goes.',
        ),
        Verb(
            'list',
            'Print information about available plugins to the screen',
            list_plugins,
            _list_arguments,
        ),
        PLAY,
        RECORD,
        REINDEX,
    ),
    elsewhere={
        'burst': 'publishes the messages of a bag at once, by keys. Here: ros2 bag play -r 100'
    },
)
