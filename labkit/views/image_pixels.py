"""Images in messages as pixels: the encodings of `sensor_msgs/msg/Image`.

Names of encodings: ros2/common_interfaces, sensor_msgs/include/sensor_msgs/image_encodings.hpp.
Depth in metres (32FC1) and in millimetres (16UC1): REP 118.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from PIL import Image as Pixels

from labkit.errors import LabError, quoted

if TYPE_CHECKING:
    from sensor_msgs.msg import Image

__all__ = ['Picture', 'picture_of', 'to_jpeg', 'to_png']

# Encoding -> numbers per pixel, their type, and the positions of red, green and blue.
_COLOURS = {
    'rgb8': (3, 'u1', (0, 1, 2)),
    'bgr8': (3, 'u1', (2, 1, 0)),
    'rgba8': (4, 'u1', (0, 1, 2)),
    'bgra8': (4, 'u1', (2, 1, 0)),
    '8UC3': (3, 'u1', (2, 1, 0)),  # as OpenCV has it
    'rgb16': (3, 'u2', (0, 1, 2)),
    'bgr16': (3, 'u2', (2, 1, 0)),
}
_GREYS = {'mono8': 'u1', '8UC1': 'u1', 'mono16': 'u2'}
# Encoding -> type of the numbers, and units per metre.
_DEPTHS = {'16UC1': ('u2', 1000.0), '32FC1': ('f4', 1.0)}
# Limits for the page: width and height, px; JPEG quality, 0 to 100.
LARGEST = (640, 480)
QUALITY = 80


class Picture(NamedTuple):
    """An image ready to be shown.

    Attributes:
        pixels: Rows of pixels, 0 to 255: grey, or red, green and blue.
        words: Size and encoding, and for a depth image the meaning of light and dark.
    """

    pixels: Any
    words: str


def picture_of(message: Image) -> Picture:
    """Return the image of a message.

    Raises:
        LabError: The encoding is unsupported, or the data is shorter than stated.
    """
    name = message.encoding
    words = f'{message.width} x {message.height} pixels, {name}'
    if name in _COLOURS:
        count, kind, order = _COLOURS[name]
        pixels = _as_bytes(_numbers(message, kind, count)[..., order])
    elif name in _GREYS:
        pixels = _as_bytes(_numbers(message, _GREYS[name], 1)[..., 0])
    elif name in _DEPTHS:
        kind, scale = _DEPTHS[name]
        pixels, more = _depth(_numbers(message, kind, 1)[..., 0] / scale)
        words += more
    else:
        known = ', '.join([*_COLOURS, *_GREYS, *_DEPTHS])
        raise LabError(
            f'Pictures with the encoding {quoted(name)} can not be shown.',
            todo=f'Let the camera publish one of these: {known}.',
        )
    return Picture(pixels, words)


def to_jpeg(picture: Picture, largest: tuple[int, int] = LARGEST) -> bytes:
    """Return an image as a JPEG, scaled down for a page to a width and a height, px."""
    image = Pixels.fromarray(picture.pixels)
    image.thumbnail(largest)
    return _saved(image, format='JPEG', quality=QUALITY)


def to_png(picture: Picture) -> bytes:
    """Return an image as a PNG, scaled down for a page."""
    image = Pixels.fromarray(picture.pixels)
    image.thumbnail(LARGEST)
    return _saved(image, format='PNG')


def _saved(image: Any, **options: Any) -> bytes:
    file = io.BytesIO()
    image.save(file, **options)
    return file.getvalue()


def _numbers(message: Image, kind: str, count: int) -> Any:
    """Return the numbers of an image as an array: row, column, channel."""
    dtype = np.dtype(f'{">" if message.is_bigendian else "<"}{kind}')
    row = message.width * count * dtype.itemsize
    # A single row has no next one, and its step may be any number.
    step, height = message.step if message.step and message.height > 1 else row, message.height
    if not row or not height:
        raise LabError('The picture has no pixels.', todo='Look at its width and height.')
    if step < row or len(message.data) < step * (height - 1) + row:
        raise LabError(
            f'The picture says that it has {message.width} x {height} pixels of '
            f'{message.encoding} in rows of {step} bytes, but it has {len(message.data)} bytes.',
            todo='The node that publishes it should set width, height, step and data to match.',
        )
    # Rows may be padded, except for the last one.
    data = np.zeros(step * height, np.uint8)
    given = np.frombuffer(message.data, np.uint8)[: step * height]
    data[: len(given)] = given
    rows = np.ascontiguousarray(data.reshape(height, step)[:, :row])
    return rows.view(dtype).reshape(height, message.width, count)


def _as_bytes(numbers: Any) -> Any:
    if numbers.dtype.itemsize == 2:
        numbers = numbers >> 8
    return np.ascontiguousarray(numbers.astype(np.uint8))


def _depth(metres: Any) -> tuple[Any, str]:
    """Return distances as grey, near is light; and a description of that."""
    known = np.isfinite(metres) & (metres > 0)  # 0 and NaN: not measured
    if not known.any():
        return np.zeros(metres.shape, np.uint8), ', a depth of which nothing was measured'
    near, far = float(metres[known].min()), float(metres[known].max())
    share = (metres - near) / max(far - near, 1e-9)
    grey = np.where(known, 255 - 205 * np.where(known, share, 0), 0)
    return grey.astype(np.uint8), f', a depth from {near:.2f} m (light) to {far:.2f} m (dark)'
