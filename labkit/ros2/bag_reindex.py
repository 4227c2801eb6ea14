"""`ros2 bag reindex`: write the `metadata.yaml` of a bag anew."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from labkit.bags.finding import find_without_metadata
from labkit.bags.metadata import FILE_NAME, Metadata
from labkit.bags.reader import Bag
from labkit.errors import LabError, quoted
from labkit.files import write_atomically
from labkit.ros2.bag_play import add_reader_arguments, check_storage
from labkit.ros2.parser import Verb
from labkit.ros2.streams import log

__all__ = ['REINDEX']

_LOGGER = 'rosbag2_cpp'


def reindex(args: Namespace) -> None:
    """Write what the files of a bag hold to its metadata."""
    path = Path(args.bag_path)
    found = find_without_metadata(path)
    with Bag(found) as bag:
        check_storage(bag, args)
        log('INFO', _LOGGER, f'Beginning reindexing bag in directory: {path}')
        files = []
        for file in found.files:
            start, end = file.span() or (0, 0)
            count = sum(file.counts().values())
            entry = {'start_ns': start, 'duration_ns': end - start, 'count': count}
            files.append({'path': file.path.name, **entry})
            if file.note:
                log('WARN', _LOGGER, f'{file.path.name} {file.note}.')
        duration_ns = bag.end_ns - bag.start_ns
        metadata = Metadata(bag.storage, bag.files, bag.start_ns, duration_ns, bag.topics)
    try:
        # Not through a link: it may be to the metadata of another bag.
        write_atomically(path / FILE_NAME, metadata.text(files).encode(), follow_links=False)
    except OSError as error:
        raise LabError(f'{quoted(str(path))} can not be written: {error.strerror}.') from error
    log('INFO', _LOGGER, 'Reindexing complete.')


REINDEX = Verb(
    'reindex',
    'Reconstruct metadata file for a bag',
    reindex,
    add_reader_arguments,
    'What was cut off is left out.',
)
