"""Where links are, from the positions of joints."""

from __future__ import annotations

import math

import pytest

from labkit.descriptions.forward_kinematics import (
    Transform,
    all_positions,
    joint_transform,
    link_transforms,
)
from labkit.descriptions.links_and_joints import Description, Joint, Link, Mimic, Origin
from labkit.transforms.rotations import from_rpy, matrix

QUARTER = math.pi / 2


def arm() -> Description:
    """A shoulder that turns about z, an elbow 1 m ahead about y, a hand that slides 1 m ahead."""
    ahead = Origin((1.0, 0.0, 0.0))
    joints = (
        Joint('shoulder', 'revolute', 'base', 'upper', axis=(0.0, 0.0, 1.0)),
        Joint('elbow', 'continuous', 'upper', 'lower', ahead, (0.0, 1.0, 0.0)),
        Joint('slide', 'prismatic', 'lower', 'hand', ahead, mimic=Mimic('elbow', 0.5, 0.25)),
        Joint('tip', 'fixed', 'hand', 'finger', Origin((0.0, 0.1, 0.0), (0.0, 0.0, QUARTER))),
    )
    links = ('finger', 'base', 'upper', 'lower', 'hand')
    return Description('arm', {n: Link(n) for n in links}, {j.name: j for j in joints})


def test_a_chain_is_followed():
    robot = arm()
    resting = link_transforms(robot)
    assert resting['hand'].translation == pytest.approx((2.25, 0.0, 0.0))
    found = link_transforms(robot, {'shoulder': QUARTER, 'elbow': -QUARTER})
    assert found['base'] == Transform()
    assert found['lower'].translation == pytest.approx((0.0, 1.0, 0.0))
    # The elbow is bent up; the hand has slid by 0.25 - pi/4.
    up = 1.25 - QUARTER / 2
    assert found['hand'].translation == pytest.approx((0.0, 1.0, up))
    assert found['finger'].translation == pytest.approx((-0.1, 1.0, up))
    assert found['finger'].apply((1.0, 0.0, 0.0)) == pytest.approx((-1.1, 1.0, up))


def test_a_turn_is_about_the_axis():
    axis = (1 / 3, 2 / 3, -2 / 3)
    joint = Joint('a', 'continuous', 'b', 'c', axis=axis)
    step = joint_transform(joint, 0.7)
    assert step.apply(axis) == pytest.approx(axis)
    # The trace of a rotation matrix is 1 + 2 cos of its angle.
    rows = matrix(step.rotation)
    assert sum(rows[i][i] for i in range(3)) == pytest.approx(1 + 2 * math.cos(0.7))


@pytest.mark.parametrize('kind', ['fixed', 'floating', 'planar'])
def test_what_one_number_does_not_move_stands(kind):
    joint = Joint('a', kind, 'b', 'c', Origin((1.0, 2.0, 3.0), (0.1, 0.2, 0.3)))
    assert joint_transform(joint, 5.0) == Transform((1.0, 2.0, 3.0), from_rpy(0.1, 0.2, 0.3))


def test_one_that_follows_has_a_position_if_its_leader_has_one():
    robot = arm()
    assert all_positions(robot, {'elbow': 2.0}) == {'elbow': 2.0, 'slide': 1.25}
    assert all_positions(robot, {'shoulder': 2.0}) == {'shoulder': 2.0}
    assert all_positions(robot, {'elbow': 2.0, 'slide': 7.0})['slide'] == 7.0


def test_leaders_may_follow_too():
    joints = [
        Joint('c', 'continuous', 'y', 'z', mimic=Mimic('b', 3.0)),
        Joint('b', 'continuous', 'x', 'y', mimic=Mimic('a', 2.0)),
        Joint('a', 'continuous', 'w', 'x'),
    ]
    robot = Description('r', {n: Link(n) for n in 'wxyz'}, {j.name: j for j in joints})
    assert all_positions(robot, {'a': 1.0}) == {'a': 1.0, 'b': 2.0, 'c': 6.0}
