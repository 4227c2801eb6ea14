"""Exercise `leg`: the fields in the text of a type."""

from __future__ import annotations

import pytest

from labkit.lessons.interfaces_and_actions.leg import FIELDS, fields_of


@pytest.mark.parametrize(
    'text',
    [
        'float64 speed\nfloat64 turn\n',
        '# A leg\n\n  float64   speed  # m/s\n\tfloat64\tturn# rad/s',
        'float64 speed 0.1\nfloat64 turn 0.0\nfloat64 FASTEST=0.22\nint8 KIND = 1\n',
    ],
)
def test_the_fields_of_the_task_are_found(text: str) -> None:
    assert fields_of(text) == FIELDS


@pytest.mark.parametrize(
    ('text', 'fields'),
    [
        ('', {}),
        ('speed float64\n', {'float64': 'speed'}),
        ('float32 speed\nfloat64 turn\n', {'speed': 'float32', 'turn': 'float64'}),
        ('float64[] speed\nstring<=10 turn', {'speed': 'float64[]', 'turn': 'string<=10'}),
        ('geometry_msgs/Twist command', {'command': 'geometry_msgs/Twist'}),
    ],
)
def test_others_are_told_as_they_are(text: str, fields: dict[str, str]) -> None:
    assert fields_of(text) == fields
