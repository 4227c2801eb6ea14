"""Messages in another frame are what the real tf2_geometry_msgs makes of them, to 1e-9."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped, Twist, Vector3Stamped
from transforms.replay import KINDS, transformed

from labkit.transforms import buffer_interface, tf2_geometry_msgs

CASES = json.loads(Path(__file__).with_name('real_messages.json').read_text(encoding='utf-8'))


@pytest.mark.parametrize('kind', KINDS)
def test_it_is_what_the_real_one_makes(kind):
    cases = [case for case in CASES if case['kind'] == kind]
    if 'covariance' in kind:
        # For a quaternion of another length than 1 the real one's covariance is no covariance.
        cases = [case for case in cases if abs(np.linalg.norm(case['turn']) - 1) < 1e-9]
    assert len(cases) >= 8
    # The corners of a polygon are numbers of four bytes.
    exact = 1e-6 if kind == 'polygon_stamped' else 1e-9
    for case in cases:
        found = transformed(tf2_geometry_msgs, case)
        assert found == pytest.approx(case['said'], rel=exact, abs=exact), case


def test_the_transform_stays_as_it_is():
    transform = TransformStamped()
    transform.header.frame_id = 'odom'
    transform.transform.translation.x = 3.0
    found = tf2_geometry_msgs.do_transform_vector3(Vector3Stamped(), transform)
    found.header.frame_id = 'mine'
    assert (transform.transform.translation.x, transform.header.frame_id) == (3.0, 'odom')


def test_types_are_registered_for_a_buffer_and_others_are_named():
    known = buffer_interface.TransformRegistration()
    assert known.get(PointStamped) is tf2_geometry_msgs.do_transform_point
    with pytest.raises(buffer_interface.TypeException) as raised:
        known.get(Twist)
    assert str(raised.value) == f'Type {Twist} is not loaded or supported'
    pose = PoseStamped()
    copied = buffer_interface.convert(pose, PoseStamped)
    assert copied == pose and copied is not pose
    assert buffer_interface.convert(pose, PointStamped) is pose  # by the registered functions
    with pytest.raises(buffer_interface.TypeException):
        buffer_interface.convert(Twist(), PoseStamped)


def test_what_a_program_registers_is_used():
    known = buffer_interface.ConvertRegistration()
    known.add_convert((PointStamped, np.ndarray), lambda one: np.array([one.point.x]))
    try:
        assert buffer_interface.convert(PointStamped(), np.ndarray).tolist() == [0.0]
    finally:
        del known._convert[PointStamped, np.ndarray]
