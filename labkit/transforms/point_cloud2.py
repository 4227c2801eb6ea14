"""Point clouds as arrays, and back: the functions of `sensor_msgs_py.point_cloud2`.

Their names, arguments and results are those of ros2/common_interfaces, branch jazzy,
sensor_msgs_py/sensor_msgs_py/point_cloud2.py.
"""

from __future__ import annotations

import array
import sys
from collections import namedtuple
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured, unstructured_to_structured
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

from labkit.errors import LabError

__all__ = [
    'create_cloud',
    'create_cloud_xyz32',
    'dtype_from_fields',
    'read_points',
    'read_points_list',
    'read_points_numpy',
]

Points = NDArray[Any]
# The datatype of a field, in numpy's words.
_TYPES: dict[int, np.dtype[Any]] = {
    PointField.INT8: np.dtype(np.int8),
    PointField.UINT8: np.dtype(np.uint8),
    PointField.INT16: np.dtype(np.int16),
    PointField.UINT16: np.dtype(np.uint16),
    PointField.INT32: np.dtype(np.int32),
    PointField.UINT32: np.dtype(np.uint32),
    PointField.FLOAT32: np.dtype(np.float32),
    PointField.FLOAT64: np.dtype(np.float64),
}


def read_points(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> Points:
    """Return the points of a cloud as a structured array: `points['x']`.

    Args:
        cloud: The cloud.
        field_names: The fields to read, by default all.
        skip_nans: Whether to leave out points with NaN, unless the cloud says it has none.
        uvs: Numbers of the points to read, by default all.
        reshape_organized_cloud: Whether a cloud with rows is returned with two dimensions.

    Raises:
        LabError: The cloud has no such field.
    """
    kind = dtype_from_fields(cloud.fields, cloud.point_step)
    points: Points = np.ndarray((cloud.width * cloud.height,), kind, buffer=cloud.data)
    if field_names is not None:
        _check_fields(field_names, kind.names or ())
        points = points[list(field_names)]
    if (sys.byteorder != 'little') != bool(cloud.is_bigendian):
        points = points.byteswap()
    if skip_nans and not cloud.is_dense:
        known = [~np.isnan(points[name]) for name in points.dtype.names or ()]
        points = points[np.logical_and.reduce(known)]
    if uvs is not None:
        points = points[np.fromiter(uvs, int)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.width, cloud.height)
    return points


def read_points_numpy(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
    reshape_organized_cloud: bool = False,
) -> Points:
    """Return the points of a cloud as a plain array, a row for each; see `read_points`.

    Raises:
        LabError: The cloud has no such field, or fields of several types.
    """
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    _check_one_type(points.dtype)
    return structured_to_unstructured(points)


def read_points_list(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[int] | None = None,
) -> list[Any]:
    """Return the points of a cloud as named tuples; see `read_points`."""
    points = read_points(cloud, field_names, skip_nans, uvs)
    point = namedtuple('Point', points.dtype.names or ())  # type: ignore[misc]
    return [point._make(each) for each in points]


def create_cloud(
    header: Header, fields: Sequence[PointField], points: Any, point_step: int | None = None
) -> PointCloud2:
    """Return a cloud of points.

    Args:
        header: Its header.
        fields: What is known of each point.
        points: A structured array of these fields, a plain one with a column for each, or the
            values of each point in turn.
        point_step: Bytes from one point to the next, by default as many as the fields take.

    Raises:
        LabError: The points do not have these fields.
    """
    kind = dtype_from_fields(fields, point_step)
    if not isinstance(points, np.ndarray):
        points = np.array([tuple(point) for point in points], kind)
    elif points.dtype.names is None:
        _check_one_type(kind)
        points = unstructured_to_structured(points, kind)
    elif points.dtype != kind:
        raise LabError(f'The points have the fields {points.dtype}, and not {kind}.')
    height = points.shape[1] if points.ndim == 2 else 1
    cloud = PointCloud2(
        header=header,
        height=height,
        width=points.shape[0],
        is_dense=False,
        is_bigendian=sys.byteorder != 'little',
        fields=fields,
        point_step=kind.itemsize,
        row_step=kind.itemsize * points.shape[0],
    )
    cloud.data = array.array('B', points.tobytes())
    return cloud


def create_cloud_xyz32(header: Header, points: Any) -> PointCloud2:
    """Return a cloud of points with x, y and z as numbers of four bytes; see `create_cloud`."""
    return create_cloud(header, [_field(name, 4 * n) for n, name in enumerate('xyz')], points)


def dtype_from_fields(
    fields: Iterable[PointField], point_step: int | None = None
) -> np.dtype[Any]:
    """Return the numpy type of a point with some fields.

    A field that counts more than one value is as many fields: `name_0`, `name_1` and so on.

    Raises:
        LabError: A field has no type, no value, or the name of another one.
    """
    names: list[str] = []
    formats, offsets = [], []
    for number, field in enumerate(fields):
        if field.datatype not in _TYPES or field.count < 1:
            raise LabError(
                f'A field has a datatype from 1 to 8 and a count of 1 or more, but {field.name!r} '
                f'has datatype {field.datatype} and count {field.count}.'
            )
        kind = _TYPES[field.datatype]
        name = field.name or f'unnamed_field_{number}'
        for part in range(field.count):
            names.append(f'{name}_{part}' if field.count > 1 else name)
            formats.append(kind)
            offsets.append(field.offset + part * kind.itemsize)
    if len(names) != len({*names}):
        raise LabError(f'Two fields have the same name: {", ".join(names)}.')
    described: dict[str, Any] = {'names': names, 'formats': formats, 'offsets': offsets}
    if point_step is not None:
        described['itemsize'] = point_step
    return np.dtype(described)  # type: ignore[no-any-return, call-overload]


def _field(name: str, offset: int, datatype: int = PointField.FLOAT32) -> PointField:
    return PointField(name=name, offset=offset, datatype=datatype, count=1)


def _check_fields(wanted: Iterable[str], known: Sequence[str]) -> None:
    for name in wanted:
        if name not in known:
            raise LabError(f'The cloud has no field {name!r}. It has {", ".join(known)}.')


def _check_one_type(kind: np.dtype[Any]) -> None:
    fields: dict[str, Any] = dict(kind.fields or {})
    if len({each[0] for each in fields.values()}) > 1:
        told = ', '.join(f'{name}: {each[0]}' for name, each in fields.items())
        raise LabError(
            f'A plain array has numbers of one type, but the fields are of several: {told}.',
            todo="Name those that you want: field_names=['x', 'y', 'z'], or use read_points.",
        )
