"""Messages as YAML and back."""

from __future__ import annotations

import hypothesis.strategies as st
import pytest
import yaml
from geometry_msgs.msg import Point, PoseWithCovariance, Twist
from hypothesis import given, settings
from sensor_msgs.msg import Image, LaserScan, PointCloud2
from std_msgs.msg import Bool, Byte, Char, Float32, Header, Int16, Int16MultiArray, String, UInt64
from visualization_msgs.msg import Marker

from labkit.errors import LabError
from labkit.rosgraph import interfaces
from labkit.rosgraph.message_yaml import field_paths, fill, prototype, read_yaml, to_csv, to_yaml


@pytest.mark.parametrize('name', interfaces.names('msg'))
def test_what_is_shown_can_be_read_back(name):
    msg_type = interfaces.message_class(name)
    message = msg_type()
    assert fill(message, read_yaml(to_yaml(msg_type()))) == []
    assert message == msg_type()
    assert fill(message, read_yaml(prototype(msg_type))) == []
    assert message == msg_type()


@settings(deadline=None, database=None)
@given(
    st.text(st.characters(exclude_categories=['Cc', 'Cs', 'Zl', 'Zp']) | st.sampled_from('\t\n'))
)
def test_any_text_can_be_read_back(text):
    message = String()
    fill(message, yaml.safe_load(to_yaml(String(data=text))))
    assert message.data == text


def test_yaml_is_that_of_the_real_one():
    scan = LaserScan(ranges=[1.5, 2.0], angle_min=-0.5)
    assert to_yaml(scan).splitlines() == [
        'header:',
        '  stamp:',
        '    sec: 0',
        '    nanosec: 0',
        "  frame_id: ''",
        'angle_min: -0.5',
        'angle_max: 0.0',
        'angle_increment: 0.0',
        'time_increment: 0.0',
        'scan_time: 0.0',
        'range_min: 0.0',
        'range_max: 0.0',
        'ranges:',
        '- 1.5',
        '- 2.0',
        'intensities: []',
    ]
    assert "ranges: '<sequence type: float, length: 2>'" in to_yaml(scan, no_arr=True)
    assert to_yaml(String(data='Grüße')) == 'data: Grüße\n'
    assert to_yaml(String(data='abcdef'), truncate_length=3) == 'data: abc...\n'
    assert to_yaml(Image(data=[1, 2, 3]), truncate_length=2).splitlines()[-3:] == [
        *('- 1', '- 2', "- '...'")
    ]


def test_in_flow_style_only_lists_stand_on_one_line():
    twist = Twist()
    twist.linear.x = 0.5
    assert to_yaml(twist, flow_style=True) == to_yaml(twist)
    marker = Marker(ns='a', points=[Point(x=1.0), Point(z=2.0)])
    lines = to_yaml(marker, flow_style=True).splitlines()
    assert 'points: [{x: 1.0, y: 0.0, z: 0.0}, {x: 0.0, y: 0.0, z: 2.0}]' in lines
    assert lines[:4] == ['header:', '  stamp:', '    sec: 0', '    nanosec: 0']
    assert {'ns: a', 'colors: []', '  position:', '    x: 0.0'} <= set(lines)


def test_a_prototype_stands_on_one_line():
    assert prototype(Twist) == (
        '{linear: {x: 0.0, y: 0.0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 0.0}}'
    )


def test_csv():
    twist = Twist()
    twist.linear.x = 0.5
    assert to_csv(twist) == '0.5,0.0,0.0,0.0,0.0,0.0'
    assert to_csv(Int16MultiArray(data=[1, 2])) == ',0,1,2'
    assert to_csv(Bool(data=True)) == 'True'


def test_bytes_in_csv_are_those_of_python():
    assert to_csv(Byte(data=b'\x05')) == str(b'\x05')


def test_fill_nested_fields_arrays_and_messages_in_arrays():
    pose = PoseWithCovariance()
    fill(pose, {'pose': {'position': {'x': 1}}, 'covariance': [0.5] * 36})
    assert (pose.pose.position.x, pose.covariance[35]) == (1.0, 0.5)
    marker = Marker()
    fill(marker, {'points': [{'x': 1, 'y': 2.5}, {}], 'colors': [{'r': 1.0}]})
    assert [(point.x, point.y) for point in marker.points] == [(1.0, 2.5), (0.0, 0.0)]
    cloud = PointCloud2()
    fill(cloud, {'fields': [{'name': 'x'}], 'data': [1, 255]})
    assert (cloud.fields[0].name, list(cloud.data)) == ('x', [1, 255])


@pytest.mark.parametrize(
    ('msg_type', 'value', 'held'),
    [
        (Int16, '5', 5),
        (Int16, -32768, -32768),
        (UInt64, 2**64 - 1, 2**64 - 1),
        (Float32, 1, 1.0),
        (Float32, '1e3', 1000.0),
        (Float32, float('inf'), float('inf')),
        (String, 5, '5'),
        (String, True, 'True'),
        (Bool, False, False),
        (Byte, 7, b'\x07'),
        (Char, 65, 65),
    ],
)
def test_fill_takes(msg_type, value, held):
    message = msg_type()
    fill(message, {'data': value})
    assert message.data == held


@pytest.mark.parametrize(
    ('msg_type', 'values', 'sentence'),
    [
        (Int16, {'data': 32768}, 'whole number from -32768 to 32767, but got 32768.'),
        (Int16, {'data': 1.5}, 'but got 1.5.'),
        (Int16, {'data': True}, 'but got True.'),
        (Int16, {'data': None}, 'but got None.'),
        (Int16, {'data': 10**400}, 'but got 1000'),
        (Int16, {'Data': 1}, "has no field 'Data'.\nDid you mean 'data'?"),
        (Int16, {'data:1': None}, "A space is missing after the colon. Write 'data: 1'."),
        (Int16, {5: 1}, "has no field '5'.\nIts fields: data."),
        (Byte, {'data': 256}, 'from 0 to 255'),
        (UInt64, {'data': -1}, 'from 0 to 18446744073709551615'),
        (Float32, {'data': 1e39}, 'at most 3.4e+38'),
        (Float32, {'data': 10**400}, 'must be a number'),
        (Bool, {'data': 1}, 'must be true or false'),
        (String, {'data': [1]}, 'must be a text'),
        (Twist, {'linear': {'x': 'a'}}, "The 'linear.x' field must be a number, but got 'a'."),
        (Twist, {'linear': [1, 2, 3]}, 'linear: a geometry_msgs/msg/Vector3 needs a value'),
        (PoseWithCovariance, {'covariance': [1.0]}, 'must be a list of 36 values'),
        (Marker, {'points': [{}, {'w': 1}]}, 'points[1]: geometry_msgs/msg/Point has no field'),
        (Header, {'stamp': 'soon'}, 'needs a value for each field'),
        # The words of the real one.
        (Int16, None, "Value 'None' is expected to be a dictionary but is a NoneType\n"),
        (Int16, 5, "Value '5' is expected to be a dictionary but is a int\n"),
    ],
)
def test_fill_refuses(msg_type, values, sentence):
    with pytest.raises(LabError) as caught:
        fill(msg_type(), values)
    assert str(caught.value).startswith('Failed to populate field: ')
    assert sentence in str(caught.value)


def test_the_present_time_is_filled_in_when_asked_for():
    from builtin_interfaces.msg import Time

    scan, header = LaserScan(), Header()
    setters = [*fill(scan, {'header': 'auto'}), *fill(header, {'stamp': 'now', 'frame_id': 'a'})]
    for set_time in setters:
        set_time(Time(sec=5))
    assert (scan.header.stamp.sec, header.stamp.sec, header.frame_id) == (5, 5, 'a')


@pytest.mark.parametrize(
    'text',
    ['', '{', '- 1', 'data:1', '5', '[1]', '&a [*a]', '!!python/object:os.system {}', '\x00'],
)
def test_what_is_no_dictionary_in_yaml_is_refused(text):
    with pytest.raises(LabError):
        fill(String(), read_yaml(text))


def test_field_paths():
    paths = list(field_paths(PoseWithCovariance))
    assert paths[:3] == ['pose', 'pose.position', 'pose.position.x']
    assert paths[-1] == 'covariance'


def test_long_values_are_quoted_in_part():
    for text in ('[' * 3000, 'x' * 3000 + '{'):
        with pytest.raises(LabError) as caught:
            fill(String(), read_yaml(text))
        assert len(str(caught.value)) < 600
    with pytest.raises(LabError) as caught:
        fill(Int16(), {'data': 'x' * 3000})
    assert len(str(caught.value)) < 600
