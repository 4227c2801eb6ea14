"""`ros2 bag convert`: write bags in another storage, merged, split, or with fewer topics."""

from __future__ import annotations

import heapq
from argparse import Namespace
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from labkit.bags.choice import TopicChoice
from labkit.bags.metadata import profiles_to_text
from labkit.bags.reader import Bag, open_bag
from labkit.bags.writer import BagWriter, check_storage
from labkit.errors import LabError, nearest, quoted
from labkit.progress_bar import ProgressBar
from labkit.ros2.bag_play import bag_paths
from labkit.ros2.parser import Parser, Verb
from labkit.rosgraph.yaml_loading import load_yaml_file

__all__ = ['CONVERT']

_SUMMARY = 'Given an input bag, write out a new bag with different settings'
_OPTIONS: dict[str, type] = {
    **dict.fromkeys(('uri', 'storage_id', 'regex'), str),
    **dict.fromkeys(('topics', 'topic_types'), list),
    **dict.fromkeys(('all', 'all_topics'), bool),
    **dict.fromkeys(('max_bagfile_size', 'max_bagfile_duration'), int),
}


def convert(args: Namespace) -> None:
    """Write the messages of bags, merged by time, to others."""
    bar = ProgressBar('Converting')
    with ExitStack() as stack:
        stack.callback(bar.close)
        bags = [stack.enter_context(open_bag(path)) for path in args.input]
        outputs = [_output(e, bags, stack) for e in _read_outputs(args.output_options)]
        merged = heapq.merge(*(bag.messages() for bag in bags), key=lambda each: each.stamp_ns)
        for done, found in enumerate(merged):
            bar.show(None, f'{done} messages')
            for writer, topics in outputs:
                if topic := topics.get((found.topic, found.msg_type)):
                    writer.write([(topic, found.stamp_ns, found.stamp_ns, found.data)])
    for writer, _ in outputs:
        with open_bag(writer.path) as bag:
            print(f'{writer.path}: {bag.message_count} messages')  # the real command is silent


def _output(entry: dict[str, Any], bags: list[Bag], stack: ExitStack) -> tuple[BagWriter, Any]:
    """Create a bag; return it with the numbers of its topics, by name and type."""
    wanted = [entry[name] for name in ('topics', 'topic_types', 'regex')]
    choice = TopicChoice(entry['all'] or entry['all_topics'], *wanted)
    found = {(each.name, each.msg_type): each for bag in bags for each in bag.topics}
    topics = {key: topic for key, topic in sorted(found.items()) if choice.takes(*key)}
    if not topics:
        todo = f'Add all_topics: true, or topics: [{", ".join(dict(sorted(found)))}]'
        raise LabError(f'Output bag {quoted(entry["uri"])} chooses no topics.', todo=todo)
    limits = {'split_bytes': entry['max_bagfile_size'], 'split_sec': entry['max_bagfile_duration']}
    writer = BagWriter(Path(entry['uri']), check_storage(entry['storage_id'] or 'mcap'), **limits)
    stack.callback(writer.close)
    numbers = {}
    for key, topic in topics.items():
        schema = {name: getattr(topic, name) for name in ('definition', 'encoding', 'type_hash')}
        numbers[key] = writer.add_topic(*key, qos=profiles_to_text(topic.qos_profiles), **schema)
    return writer, numbers


def _read_outputs(path: str) -> list[dict[str, Any]]:
    try:
        entries = load_yaml_file(path)['output_bags']
        options = [pair for entry in entries if entry['uri'] for pair in entry.items()]
        if not options:
            raise KeyError('uri')
    except OSError as error:
        raise LabError(f'{quoted(path)} can not be read: {error.strerror}.') from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        todo = 'Such as: output_bags: [{uri: copy, storage_id: sqlite3, all_topics: true}]'
        raise LabError(f'{quoted(path)} lists no output bags with a uri.', todo=todo) from error
    for name, value in options:
        if value and not isinstance(value, _OPTIONS.get(name, ())):
            near = nearest(name, _OPTIONS)
            todo = f'Known: {", ".join(_OPTIONS)}. Bags are written without compression.'
            todo = f'Did you mean {near!r} ({_OPTIONS[near].__name__})?' if near else todo
            raise LabError(f'Output bags have no option {name}: {quoted(value)} here.', todo=todo)
    return [{name: e.get(name) or kind() for name, kind in _OPTIONS.items()} for e in entries]


def _arguments(parser: Parser) -> None:
    text = 'URI of an input bag. May be provided more than once'
    parser.add('-i', '--input', action='append', required=True, complete=bag_paths, help=text)
    text = 'YAML file with options for output bags, below one top-level key "output_bags"'
    parser.add('-o', '--output-options', required=True, help=text)


CONVERT = Verb('convert', _SUMMARY, convert, _arguments, 'Bags are written without compression.')
