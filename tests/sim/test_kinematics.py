"""The motion of a robot with two wheels, against closed forms and against brute force."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from labkit.sim.kinematics import (
    Motion,
    Pose,
    Twist2,
    believed,
    ramp,
    wheel_speeds,
    wrap_angle,
    yaw_from_quaternion,
    yaw_to_quaternion,
)
from labkit.sim.robots import BURGER

LIMITS = BURGER.limits
angles = st.floats(-1e3, 1e3)
poses = st.builds(Pose, st.floats(-5, 5), st.floats(-5, 5), st.floats(-math.pi, math.pi))
twists = st.builds(Twist2, st.floats(-0.22, 0.22), st.floats(-2.84, 2.84))
accelerations = st.builds(Twist2, st.floats(-2.5, 2.5), st.floats(-3.2, 3.2))
times = st.floats(0, 3)


def gap(one: Pose, other: Pose) -> float:
    turn = wrap_angle(one.yaw - other.yaw)
    return max(abs(one.x - other.x), abs(one.y - other.y), abs(turn))


@given(angles)
def test_a_wrapped_angle_is_the_same_direction(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@pytest.mark.parametrize('turns', [-3, -1, 1, 3])
def test_half_a_turn_is_pi_from_both_sides(turns: int) -> None:
    assert wrap_angle(turns * math.pi) == pytest.approx(math.pi)
    assert wrap_angle(-math.pi) == math.pi


@given(st.floats(-math.pi, math.pi), st.floats(0.1, 10))
def test_yaw_survives_the_way_through_a_quaternion(yaw: float, length: float) -> None:
    x, y, z, w = yaw_to_quaternion(yaw)
    assert x * x + y * y + z * z + w * w == pytest.approx(1)
    back = yaw_from_quaternion(x * length, y * length, z * length, w * length)
    assert abs(wrap_angle(back - yaw)) < 1e-12


def test_quarter_turn_to_the_left_is_the_known_quaternion() -> None:
    half = math.sqrt(0.5)
    assert yaw_to_quaternion(math.pi / 2) == pytest.approx((0, 0, half, half))
    assert yaw_from_quaternion(0, 0, -half, half) == pytest.approx(-math.pi / 2)


@given(poses, st.floats(-0.22, 0.22), times)
def test_without_turning_the_way_is_straight(pose: Pose, v: float, time: float) -> None:
    end = Motion(pose, Twist2(v, 0)).pose_at(time)
    expected = Pose(
        pose.x + v * time * math.cos(pose.yaw), pose.y + v * time * math.sin(pose.yaw), pose.yaw
    )
    assert gap(end, expected) < 1e-12


@given(poses, st.floats(-0.22, 0.22), st.floats(0.1, 2.84), st.sampled_from([-1, 1]))
def test_a_circle_closes(pose: Pose, v: float, w: float, side: int) -> None:
    motion = Motion(pose, Twist2(v, side * w))
    assert gap(motion.pose_at(math.tau / w), pose) < 1e-12
    # Half-way round it is one diameter aside: to the left if v and w have the same sign.
    half = motion.pose_at(math.pi / w)
    aside = 2 * v / (side * w)
    assert half.x == pytest.approx(pose.x - aside * math.sin(pose.yaw), abs=1e-12)
    assert half.y == pytest.approx(pose.y + aside * math.cos(pose.yaw), abs=1e-12)


@pytest.mark.parametrize(
    ('v', 'w', 'x_sign', 'y_sign', 'yaw_sign'),
    [
        (0.2, 0.5, 1, 1, 1),  # ahead, to the left
        (0.2, -0.5, 1, -1, -1),  # ahead, to the right
        (-0.2, 0.5, -1, 1, 1),  # back, nose to the left: the tail leads, and swings out to it
        (-0.2, -0.5, -1, -1, -1),
    ],
)
def test_signs_of_v_and_w(v: float, w: float, x_sign: int, y_sign: int, yaw_sign: int) -> None:
    end = Motion(Pose(), Twist2(v, w)).pose_at(1.0)
    assert end.x * x_sign > 0
    assert end.y * math.copysign(1, v * w) > 0
    assert end.yaw * yaw_sign > 0


@given(st.floats(1e-12, 1e-2), st.floats(0.01, 0.22))
def test_almost_straight_loses_no_digits(w: float, v: float) -> None:
    end = Motion(Pose(), Twist2(v, w)).pose_at(1.0)
    # Taylor series of the arc about w = 0.
    assert end.x == pytest.approx(v * (1 - w**2 / 6 + w**4 / 120), rel=1e-14)
    assert end.y == pytest.approx(v * (w / 2 - w**3 / 24 + w**5 / 720), rel=1e-13)


@given(poses, twists, accelerations, times, st.floats(0, 1))
def test_a_motion_cut_in_two_ends_where_the_whole_does(
    pose: Pose, twist: Twist2, acceleration: Twist2, time: float, share: float
) -> None:
    whole = Motion(pose, twist, acceleration)
    cut = share * time
    second = Motion(whole.pose_at(cut), whole.twist_at(cut), acceleration)
    assert gap(second.pose_at(time - cut), whole.pose_at(time)) < 1e-12


@pytest.mark.parametrize(
    ('twist', 'acceleration'),
    [
        (Twist2(0.1, 0.3), Twist2(0.5, 0.0)),
        (Twist2(0.1, -2.0), Twist2(-0.2, 3.2)),
        (Twist2(0.0, 0.0), Twist2(2.5, 3.2)),
    ],
)
def test_speeding_up_agrees_with_a_million_small_steps(
    twist: Twist2, acceleration: Twist2
) -> None:
    x = y = yaw = 0.0
    steps = 20_000
    dt = 1.0 / steps
    for step in range(steps):
        middle = (step + 0.5) * dt
        w = twist.w + acceleration.w * middle
        heading = twist.w * middle + acceleration.w * middle**2 / 2
        v = twist.v + acceleration.v * middle
        x, y, yaw = x + v * math.cos(heading) * dt, y + v * math.sin(heading) * dt, yaw + w * dt
    end = Motion(Pose(), twist, acceleration).pose_at(1.0)
    assert gap(end, Pose(x, y, wrap_angle(yaw))) < 1e-8


@given(twists, twists)
def test_a_ramp_ends_where_the_first_speed_is_reached(twist: Twist2, target: Twist2) -> None:
    acceleration, time = ramp(twist, target, LIMITS)
    assert abs(acceleration.v) in (0, LIMITS.v_rate)
    assert abs(acceleration.w) in (0, LIMITS.w_rate)
    if time < math.inf:
        end = Motion(Pose(), twist, acceleration).twist_at(time)
        left_v, left_w = abs(target.v - end.v), abs(target.w - end.w)
        assert min(left_v if acceleration.v else 9, left_w if acceleration.w else 9) < 1e-12
        assert left_v <= abs(target.v - twist.v) + 1e-12
        assert left_w <= abs(target.w - twist.w) + 1e-12
    else:
        assert twist == target


@given(st.floats(-1e308, 1e308), st.floats(-1e308, 1e308))
def test_commands_are_cut_to_the_published_limits(v: float, w: float) -> None:
    cut = LIMITS.clip(Twist2(v, w))
    assert abs(cut.v) <= 0.22
    assert abs(cut.w) <= 2.84
    assert cut.v * v >= 0
    assert cut.w * w >= 0


def test_wheels_turn_alike_ahead_and_against_each_other_on_the_spot() -> None:
    assert wheel_speeds(Twist2(0.33, 0.0), BURGER) == pytest.approx((10.0, 10.0))
    assert wheel_speeds(Twist2(0.0, 1.0), BURGER) == pytest.approx((-0.08 / 0.033, 0.08 / 0.033))


@given(twists, st.floats(-0.1, 0.1))
def test_odometry_believes_what_unequal_wheels_tell_it(twist: Twist2, mismatch: float) -> None:
    left, right = wheel_speeds(twist, BURGER)
    left, right = left * (1 + mismatch / 2), right * (1 - mismatch / 2)
    seen = believed(twist, mismatch, BURGER)
    assert seen.v == pytest.approx((left + right) / 2 * BURGER.wheel_radius)
    turn = (right - left) * BURGER.wheel_radius / BURGER.wheel_separation
    assert seen.w == pytest.approx(turn, abs=1e-12)
    assert believed(twist, 0.0, BURGER) == twist
