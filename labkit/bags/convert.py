"""Write bags anew: in another storage, merged, split, or with fewer topics."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from labkit.bags.choice import TopicChoice
from labkit.bags.metadata import profiles_to_text
from labkit.bags.reader import Bag, BagTopic, open_bag
from labkit.bags.schemas import ENCODING, full_definition
from labkit.bags.writer import BagWriter, Message, check_storage
from labkit.errors import LabError, nearest

__all__ = ['Output', 'convert', 'read_outputs']

_BATCH = 1000
# What an output may say, with the value that is meant if it does not.
_OPTIONS: Mapping[str, Any] = {
    **{'uri': '', 'storage_id': '', 'max_bagfile_size': 0, 'max_bagfile_duration': 0},
    **{'all': False, 'all_topics': False, 'topics': [], 'topic_types': [], 'regex': ''},
    **{'exclude_regex': '', 'exclude_topics': [], 'exclude_topic_types': []},
    'include_hidden_topics': False,
}
# What has no meaning here, or no effect on what is converted.
_WITHOUT_EFFECT = (
    *('all_services', 'services', 'exclude_services', 'include_unpublished_topics'),
    *('compression_queue_size', 'compression_threads', 'rmw_serialization_format'),
)


@dataclass(frozen=True)
class Output:
    """A bag that is to be written.

    Attributes:
        path: Its folder.
        choice: Which topics it gets.
        storage: `'mcap'` or `'sqlite3'`.
        split_bytes: A new file is begun after so many bytes; 0 for never.
        split_sec: A new file is begun after so many seconds; 0 for never.
    """

    path: Path
    choice: TopicChoice = field(default_factory=TopicChoice)
    storage: str = 'mcap'
    split_bytes: int = 0
    split_sec: float = 0.0


def convert(
    inputs: Sequence[Path],
    outputs: Sequence[Output],
    progress: Callable[[float], object] = lambda done: None,
) -> list[int]:
    """Write the messages of some bags to others.

    Args:
        inputs: Bags, which are merged by time.
        outputs: Bags to write, which must not be there.
        progress: Told from time to time how much is done, from 0 to 1.

    Returns:
        How many messages each output got.

    Raises:
        LabError: An input can't be read, or an output not be written. What was read is written.
    """
    with ExitStack() as stack:
        bags = [stack.enter_context(open_bag(path)) for path in inputs]
        sinks = []
        for output in outputs:
            writer = BagWriter(
                output.path,
                output.storage,
                split_bytes=output.split_bytes,
                split_sec=output.split_sec,
            )
            sinks.append(_Sink(writer, output, bags))
            stack.callback(sinks[-1].close)
        total = sum(bag.message_count for bag in bags) or 1
        each = [bag.messages() for bag in bags]
        for number, message in enumerate(heapq.merge(*each, key=lambda found: found.stamp_ns)):
            if not number % _BATCH:
                progress(number / total)
            for sink in sinks:
                sink.take(message.topic, message.msg_type, message.stamp_ns, message.data)
    return [sink.count for sink in sinks]


class _Sink:
    """A bag that is being written, with the messages that wait for it."""

    def __init__(self, writer: BagWriter, output: Output, bags: Sequence[Bag]) -> None:
        self.count = 0
        self._writer = writer
        self._waiting: list[Message] = []
        self._topics: dict[tuple[str, str], int] = {}
        same: dict[tuple[str, str], list[BagTopic]] = {}
        for topic in (topic for bag in bags for topic in bag.topics):
            if output.choice.takes(topic.name, topic.msg_type):
                same.setdefault((topic.name, topic.msg_type), []).append(topic)
        for key, topics in sorted(same.items()):
            self._topics[key] = self._add(*key, topics)

    def take(self, topic: str, msg_type: str, stamp_ns: int, data: bytes) -> None:
        """Write a message, if it is meant for this bag."""
        number = self._topics.get((topic, msg_type))
        if number is None:
            return
        self._waiting.append((number, stamp_ns, stamp_ns, data))
        self.count += 1
        if len(self._waiting) >= _BATCH or len(data) > 1 << 16:
            self._write()

    def close(self) -> None:
        """Write what waits, and end the bag."""
        try:
            self._write()
            self._writer.close()
        except OSError as error:
            raise self._unwritten(error) from error

    def _write(self) -> None:
        try:
            self._writer.write(self._waiting)
        except OSError as error:
            self._waiting = []
            self._writer.abandon()
            raise self._unwritten(error) from error
        self._waiting = []

    def _add(self, name: str, msg_type: str, topics: Sequence[BagTopic]) -> int:
        profiles = [profile for topic in topics for profile in topic.qos_profiles]
        known = next((topic for topic in topics if topic.definition), None)
        return self._writer.add_topic(
            name,
            msg_type,
            qos=profiles_to_text(profiles),
            definition=known.definition if known else _installed(msg_type),
            encoding=known.encoding if known else ENCODING,
            type_hash=next((topic.type_hash for topic in topics if topic.type_hash), ''),
            serialization_format=topics[0].serialization_format,
        )

    def _unwritten(self, error: OSError) -> LabError:
        return LabError(
            f'{str(self._writer.path)!r} can not be written: {error.strerror or error}.',
            todo='Is the disk full?',
        )


def _installed(msg_type: str) -> str:
    """Return how a type is defined here, '' if it is not installed."""
    try:
        return full_definition(msg_type)
    except (OSError, ValueError):
        return ''


# --- The file with options -----------------------------------------------------------------------


def read_outputs(path: Path) -> list[Output]:
    """Read which bags are to be written from a file, in the terms of the real `ros2 bag convert`.

    Args:
        path: A YAML file with a list under `output_bags`.

    Raises:
        LabError: It can't be read, or asks for what is not possible here.
    """
    example = 'output_bags:\n- uri: copy\n  storage_id: sqlite3\n  all_topics: true'
    try:
        content = yaml.safe_load(path.read_text(encoding='utf-8'))
        entries = content['output_bags']
        outputs = [_output(dict(entry)) for entry in entries]
    except OSError as error:
        raise LabError(f'{str(path)!r} can not be read: {error.strerror or error}.') from error
    except (yaml.YAMLError, TypeError, KeyError, ValueError) as error:
        raise LabError(
            f'{str(path)!r} does not list output bags.', todo=f'It should look like:\n{example}'
        ) from error
    if not outputs:
        raise LabError(f'{str(path)!r} lists no output bag.', todo=f'Such as:\n{example}')
    return outputs


def _output(entry: dict[str, Any]) -> Output:
    for name, value in entry.items():
        if name not in _OPTIONS and name not in _WITHOUT_EFFECT and value:
            near = nearest(name, _OPTIONS)
            raise LabError(
                f'Output bags have no option {name!r} here.',
                todo=f'Did you mean {near!r}?' if near else f'Known: {", ".join(_OPTIONS)}.',
            )
    told = {name: entry.get(name) or default for name, default in _OPTIONS.items()}
    if not told['uri']:
        raise LabError('An output bag needs a name.', todo='Add its folder: uri: copy')
    choice = TopicChoice(
        bool(told['all'] or told['all_topics']),
        frozenset(told['topics']),
        frozenset(told['topic_types']),
        str(told['regex']),
        [str(told['exclude_regex'])] if told['exclude_regex'] else [],
        frozenset(told['exclude_topics']),
        frozenset(told['exclude_topic_types']),
        bool(told['include_hidden_topics']),
    )
    if not (choice.everything or choice.names or choice.types or choice.regex):
        raise LabError(
            f'Output bag {told["uri"]!r} chooses no topics, so it would be empty.',
            todo='Add all_topics: true, or topics: [/odom].',
        )
    return Output(
        Path(str(told['uri'])),
        choice,
        check_storage(str(told['storage_id'] or 'mcap')),
        int(told['max_bagfile_size']),
        float(told['max_bagfile_duration']),
    )
