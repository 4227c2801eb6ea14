"""What the verbs of `ros2 bag` share: how a bag is named, what is offered for completion."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from labkit import settings
from labkit.bags.finding import is_bag
from labkit.bags.reader import Bag, open_bag
from labkit.bags.writer import STORAGES
from labkit.errors import LabError
from labkit.ros2.parser import Parser

__all__ = ['add_reader_arguments', 'bag_paths', 'check_kind', 'say', 'topics_in_bag']


def add_reader_arguments(parser: Parser) -> None:
    """Add the arguments of verbs that read one bag."""
    parser.add('bag_path', help='Bag to open', complete=bag_paths)
    parser.add(
        *('-s', '--storage'),
        choices=STORAGES,
        help='Storage implementation of bag. By default attempts to detect automatically - use '
        'this argument to override.',
    )


def check_kind(bag: Bag, args: Namespace) -> None:
    """Raise a LabError if a bag is of another storage than the one that was named."""
    if args.storage and args.storage != bag.storage:
        bag.close()
        raise LabError(
            f'{str(bag.path)!r} is stored as {bag.storage}, not as {args.storage}.',
            todo='Leave --storage out.',
        )


def bag_paths(_: Namespace) -> Iterable[str]:
    """Return the bags in this folder, and in the folders in it."""
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
    """Return the topics of the bag that stands before."""
    path = getattr(args, 'bag_path', '')
    if not path:
        return []
    with open_bag(path) as bag:
        return [topic.name for topic in bag.topics]


def say(level: str, node_name: str, text: str) -> None:
    """Print a line as the log of a node; without the time, so that it is the same each time."""
    print(f'[{level}] [{node_name}]: {text}', flush=not settings.in_kernel())
