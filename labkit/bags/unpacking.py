"""Unpack what is compressed in a bag, up to a size: some bytes may stand for gigabytes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from mcap.records import Chunk

__all__ = ['MOST_BYTES', 'unpacked', 'unpacked_chunk', 'unpacked_size']

# The largest message or chunk that is unpacked, bytes: a picture of 8K has 100 MB.
MOST_BYTES = 1 << 28
_PIECE_BYTES = 1 << 20
CUT_OFF = 'something in it is cut off'


def unpacked(data: bytes) -> bytes:
    """Return what was compressed with zstd.

    Raises:
        ValueError: It is damaged, or larger than `MOST_BYTES`.
    """
    import zstandard

    try:
        declared = zstandard.get_frame_parameters(data).content_size
    except zstandard.ZstdError as error:
        raise ValueError(str(error)) from error
    found = bytearray()
    for piece in _pieces(data):
        found += piece
        _refuse_more(len(found))
    # A frame that was cut off gives what it has.
    if declared not in (zstandard.CONTENTSIZE_UNKNOWN, len(found)):
        raise ValueError(CUT_OFF)
    return bytes(found)


def unpacked_chunk(chunk: Chunk) -> Chunk:
    """Return a chunk of an MCAP file as one that is not compressed.

    Raises:
        ValueError: It is damaged, or larger than `MOST_BYTES`.
    """
    if chunk.compression == 'zstd':
        return replace(chunk, compression='', data=unpacked(chunk.data))
    if chunk.compression == 'lz4':
        import lz4.frame  # type: ignore[import-untyped]

        unpack = lz4.frame.LZ4FrameDecompressor()
        try:
            data = unpack.decompress(chunk.data, max_length=MOST_BYTES + 1)
        except RuntimeError as error:
            raise ValueError(str(error)) from error
        _refuse_more(len(data))
        if not unpack.eof:
            raise ValueError(CUT_OFF)
        return replace(chunk, compression='', data=data)
    return chunk


def unpacked_size(path: Path, most: int) -> int:
    """Return the size of a file that was compressed with zstd, as it is unpacked, in bytes.

    Args:
        path: The file.
        most: Of a larger one only that it is.

    Raises:
        OSError: It can't be read.
        ValueError: It is damaged.
    """
    size = 0
    with path.open('rb') as file:
        for piece in _pieces(file):
            size += len(piece)
            if size > most:
                break
    return size


def _pieces(source: bytes | BinaryIO) -> Iterator[bytes]:
    import zstandard

    try:
        unpack = zstandard.ZstdDecompressor()
        yield from unpack.read_to_iter(source, write_size=_PIECE_BYTES)
    except zstandard.ZstdError as error:
        raise ValueError(str(error)) from error


def _refuse_more(size: int) -> None:
    if size > MOST_BYTES:
        raise ValueError(
            f'something in it is larger than {MOST_BYTES >> 20} MB when it is unpacked'
        )
