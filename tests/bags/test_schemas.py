"""Definitions of types as bags hold them."""

from __future__ import annotations

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from labkit.bags.schemas import full_definition


@pytest.mark.parametrize('part', ['Goal', 'Result', 'Feedback', 'FeedbackMessage'])
def test_parts_of_an_action_are_defined_as_ros_has_them(part: str) -> None:
    name = f'test_msgs/action/Fibonacci_{part}'
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(full_definition(name), name))
    fields = {
        'Goal': ['order'],
        'Result': ['sequence'],
        'Feedback': ['sequence'],
        'FeedbackMessage': ['goal_id', 'feedback'],
    }
    assert [field for field, _ in store.fielddefs[name][1]] == fields[part]


def test_a_nested_message_has_its_definition_behind_a_line() -> None:
    text = full_definition('geometry_msgs/msg/Twist')
    assert text.count('=' * 80) == 1
    assert 'MSG: geometry_msgs/Vector3\n' in text
