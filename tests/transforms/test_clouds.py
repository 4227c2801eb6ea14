"""Scans and clouds of points are what the real packages make of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header
from transforms.clouds import CASES, cloud_of, told

from labkit.errors import LabError
from labkit.transforms import laser_geometry, point_cloud2, tf2_sensor_msgs
from labkit.transforms.buffer import Buffer

SAID = json.loads(Path(__file__).with_name('real_clouds.json').read_text(encoding='utf-8'))


@pytest.mark.parametrize('number', range(len(CASES)))
def test_a_scan_becomes_the_cloud_of_the_real_one_and_moves_as_it_does(number):
    found = told(cloud_of(laser_geometry, CASES[number]), point_cloud2, tf2_sensor_msgs)
    for points in ('points', 'moved'):
        expected = SAID[number].pop(points)
        ours = found.pop(points)
        assert len(ours) == len(expected)
        for one, other in zip(ours, expected, strict=True):
            # Numbers of four bytes.
            assert one == pytest.approx(other, rel=1e-6, abs=1e-6)
    assert found == SAID[number]


def cloud(count: int = 4) -> PointCloud2:
    points = np.arange(3.0 * count).reshape(count, 3)
    return point_cloud2.create_cloud_xyz32(Header(frame_id='base'), points)


def test_points_are_read_in_all_forms():
    made = cloud()
    np.frombuffer(made.data, np.float32)[0] = np.nan
    assert point_cloud2.read_points(made)['y'].tolist() == [1, 4, 7, 10]
    known = point_cloud2.read_points_numpy(made, ('x', 'z'), skip_nans=True)
    assert known.tolist() == [[3, 5], [6, 8], [9, 11]]
    some = point_cloud2.read_points_list(made, uvs=[1, 3])
    assert [(point.x, point.z) for point in some] == [(3, 5), (9, 11)]
    rows = np.zeros((2, 3), point_cloud2.dtype_from_fields(made.fields))
    organized = point_cloud2.create_cloud(Header(), made.fields, rows)
    assert (organized.width, organized.height) == (2, 3)
    read = point_cloud2.read_points(organized, reshape_organized_cloud=True)
    assert read.shape == (2, 3)


def test_a_field_may_count_several_values_and_the_other_order_of_bytes_is_read():
    field = PointField(name='rgb', offset=0, datatype=PointField.INT16, count=3)
    assert point_cloud2.dtype_from_fields([field]).names == ('rgb_0', 'rgb_1', 'rgb_2')
    made = point_cloud2.create_cloud(Header(), [field], [(1, 2, 3)])
    made.is_bigendian = not made.is_bigendian
    assert point_cloud2.read_points(made).tolist() == [(256, 512, 768)]
    # The message stays as it was.
    assert point_cloud2.read_points(made).tolist() == [(256, 512, 768)]


def test_a_buffer_takes_a_cloud_to_another_frame():
    buffer = Buffer()
    transform = TransformStamped(child_frame_id='base')
    transform.header.frame_id = 'odom'
    transform.transform.translation.x, transform.transform.rotation.w = 10.0, 1.0
    buffer.set_transform_static(transform, 'the test')
    moved = buffer.transform(cloud(1), 'odom')
    assert moved.header.frame_id == 'odom'
    assert point_cloud2.read_points_numpy(moved).tolist() == [[10, 1, 2]]


def test_what_can_not_be_is_said():
    mixed = [*cloud().fields, PointField(name='i', offset=12, datatype=PointField.INT32, count=1)]
    with pytest.raises(LabError, match='plain array has numbers of one type'):
        point_cloud2.create_cloud(Header(), mixed, np.zeros((2, 4)))
    with pytest.raises(LabError, match="The cloud has no field 'w'"):
        point_cloud2.read_points(cloud(), ['w'])
    with pytest.raises(LabError, match='Two fields have the same name: x, x'):
        point_cloud2.dtype_from_fields([cloud().fields[0]] * 2)
    with pytest.raises(LabError, match='datatype from 1 to 8 and a count of 1 or more'):
        point_cloud2.dtype_from_fields([PointField(name='x', datatype=PointField.INT8)])
    with pytest.raises(LabError, match='Only a cloud with x, y and z has a place'):
        flat = point_cloud2.create_cloud(Header(), cloud().fields[:2], np.zeros((2, 2)))
        tf2_sensor_msgs.do_transform_cloud(flat, TransformStamped())
    with pytest.raises(LabError, match='The points have the fields'):
        point_cloud2.create_cloud(Header(), cloud().fields, np.zeros(2, [('x', 'f4')]))


def test_names_are_those_of_the_real_packages(script):
    done = script(
        'import labkit\n'
        'from laser_geometry import LaserProjection\n'
        'import laser_geometry.laser_geometry as lg\n'
        'import sensor_msgs_py.point_cloud2 as pc2\n'
        'from sensor_msgs_py.point_cloud2 import read_points_numpy\n'
        'from tf2_sensor_msgs.tf2_sensor_msgs import do_transform_cloud, transform_points\n'
        'from tf2_sensor_msgs import do_transform_cloud\n'
        'print(lg.LaserProjection is LaserProjection, pc2.create_cloud_xyz32.__name__)'
    )
    assert done.stdout == 'True create_cloud_xyz32\n', done.stderr
