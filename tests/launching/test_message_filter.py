"""The expressions of `ros2 topic echo --filter`: what they can ask of a message, and no more."""

from __future__ import annotations

import pytest
from geometry_msgs.msg import TwistWithCovariance
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from labkit.errors import LabError
from labkit.launching.expressions import message_filter

HELLO = String(data='Hello World: 4')
SCAN = LaserScan(ranges=[0.25, 1.0])
TWIST = TwistWithCovariance()


@pytest.mark.parametrize(
    ('expression', 'message', 'passes'),
    [
        ("m.data == 'Hello World: 4'", HELLO, True),
        ("int(m.data.rpartition(':')[-1]) % 2 == 0", HELLO, True),
        ("m.data.startswith('Bye') or len(m.data) > 20", HELLO, False),
        ('min(m.ranges) < 0.5', SCAN, True),
        ('m.ranges[0] == 0.25 and len(m.ranges[1:]) == 1', SCAN, True),
        ('m.twist.linear.x > 0', TWIST, False),
        ('m.covariance[35] ** 2 == 0 and m.covariance[0] % 2 == 0', TWIST, True),
    ],
)
def test_filter(expression, message, passes):
    assert message_filter(expression, type(message)())(message) is passes


@pytest.mark.parametrize(
    ('expression', 'sentence'),
    [
        ('m.dta', "'dta' is no field of a String.\nDid you mean 'data'?"),
        ('m.__class__', "'__class__' is no field"),
        ('().__class__', "'__class__' is no field"),
        ('m.data.format', "'format' is no field"),
        ('m.data.format(1)', 'is not allowed'),
        ('m.data.center(10 ** 9)', 'is not allowed'),
        ("__import__('os')", 'is not allowed'),
        ("open('x')", 'is not allowed'),
        ('round(1, -10 ** 9)', 'takes up to 300 digits'),
        ('max(m.data, key=len)', 'is not allowed'),
        ('[x for x in m.data]', 'is not allowed'),
        ("f'{m}'", 'is not allowed'),
        ("'a' * 10 ** 9", 'more than 10000 characters'),
        ('10 ** 10 ** 10', 'is too large'),
        ('x == 1', 'x is no name in it'),
        ('m.data[', 'is no expression'),
        ('', 'is no expression'),
        ('1 +' * 10_000, 'more than 10000 characters'),
    ],
)
def test_more_than_that_is_refused_before_a_message_has_come(expression, sentence):
    with pytest.raises(LabError) as caught:
        message_filter(expression, String())
    assert sentence in str(caught.value)


def test_a_message_for_which_there_is_no_value():
    passes = message_filter("int(m.data.split(':')[1]) > 3", String())
    assert passes(HELLO)
    with pytest.raises(LabError, match='list index out of range'):
        passes(String(data='Hello'))
