"""`ros2 bag`: record what is published, look into it, play it back, write it anew."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from labkit.background.progress_bar import ProgressBar
from labkit.bags.convert import convert, read_outputs
from labkit.bags.info import describe, topic_names
from labkit.bags.reader import open_bag
from labkit.errors import LabError
from labkit.ros2.bag_play import PLAY
from labkit.ros2.bag_record import RECORD
from labkit.ros2.bag_words import add_reader_arguments, bag_paths, check_kind, say
from labkit.ros2.parser import Command, Parser, Usage, Verb

__all__ = ['COMMAND']


def show_info(args: Namespace) -> None:
    """Print what is in a bag."""
    if args.topic_name and args.verbose:
        print(
            "Warning! You have set both the '-t' and '-v' parameters. The '-t' parameter "
            'will be ignored.'
        )
    with open_bag(args.bag_path) as bag:
        check_kind(bag, args)
        if bag.note:
            say('WARN', 'ros2bag', bag.note)
        names = topic_names(bag)
        print('\n'.join(names) if args.topic_name and not args.verbose else describe(bag))


def rewrite(args: Namespace) -> None:
    """Write bags anew."""
    inputs = [_input(words) for words in args.input]
    outputs = read_outputs(Path(args.output_options))
    bar = ProgressBar('Converting')
    try:
        counts = convert(inputs, outputs, lambda done: bar.show(done, f'{done:.0%}'))
    finally:
        bar.close()
    for output, count in zip(outputs, counts, strict=True):
        # The real one says nothing at all; a learner wants to know what has come of it.
        print(f'{output.path}: {count} messages')


def _input(words: list[str]) -> Path:
    if len(words) > 2:
        raise Usage(
            f'ros2 bag convert: --input expects 1 or 2 arguments, {len(words)} provided',
            todo='Give each bag an option of its own: -i first -i second',
        )
    path = Path(words[0])
    if len(words) == 2:
        with open_bag(path) as bag:
            if bag.storage != words[1]:
                raise LabError(f'{words[0]!r} is stored as {bag.storage}, not as {words[1]}.')
    return path


def _info_arguments(parser: Parser) -> None:
    add_reader_arguments(parser)
    parser.add('-t', '--topic-name', action='store_true', help='Only display topic names.')
    parser.add(
        *('-v', '--verbose'),
        action='store_true',
        help='Display request/response information for services',
    )


def _convert_arguments(parser: Parser) -> None:
    parser.add(
        *('-i', '--input'),
        required=True,
        action='append',
        nargs='+',
        metavar='uri',
        complete=bag_paths,
        help='URI (and optional storage ID) of an input bag. May be provided more than once',
    )
    parser.add(
        *('-o', '--output-options'),
        required=True,
        complete=lambda _: sorted(str(path) for path in Path().glob('*.y*ml')),
        help='YAML file with options for output bags. Must have one top-level key '
        '"output_bags", which contains a sequence of StorageOptions/RecordOptions objects.',
    )


COMMAND = Command(
    'bag',
    'Various rosbag related sub-commands',
    (
        Verb(
            'convert',
            'Given an input bag, write out a new bag with different settings',
            rewrite,
            _convert_arguments,
            'An output that would be empty is an error here. Bags are written without '
            'compression.',
        ),
        Verb(
            'info',
            'Print information about a bag to the screen',
            show_info,
            _info_arguments,
            'A bag that was not finished is read as far as it goes.',
        ),
        PLAY,
        RECORD,
    ),
)
