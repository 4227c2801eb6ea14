"""A simulated robot: commands, time, contacts, odometry, noise."""

from __future__ import annotations

import math

import pytest
from clearance import clearance
from hypothesis import given, settings
from hypothesis import strategies as st

from labkit.errors import LabError
from labkit.sim.kinematics import Pose, Twist2, wrap_angle
from labkit.sim.robots import BURGER
from labkit.sim.simulator import Simulator
from labkit.sim.world import Post, Wall, World, open_field, pillars, playground, room

R = BURGER.radius
# A drive: a command, and how long it holds before the next one.
drives = st.lists(
    st.tuples(st.floats(-0.3, 0.3), st.floats(-3, 3), st.floats(0.05, 2.0)),
    min_size=1,
    max_size=12,
)
starts = st.builds(Pose, st.floats(-0.9, 0.9), st.floats(-0.9, 0.9), st.floats(-3.1, 3.1))
nonsense = st.sampled_from([math.nan, math.inf, -math.inf, 1e300, -1e300, 1000.1])


def run(robot: Simulator, drive: list[tuple[float, float, float]], steps: int) -> Simulator:
    for v, w, seconds in drive:
        robot.command(v, w)
        for _ in range(steps):
            robot.step(seconds / steps)
    return robot


def gap(one: Pose, other: Pose) -> float:
    turn = wrap_angle(one.yaw - other.yaw)
    return max(abs(one.x - other.x), abs(one.y - other.y), abs(turn))


@given(starts, drives, st.integers(2, 40))
def test_where_it_ends_does_not_depend_on_the_steps(
    start: Pose, drive: list[tuple[float, float, float]], steps: int
) -> None:
    # A room so small that it touches something in every other drive.
    start = Pose(start.x / 5, start.y / 5, start.yaw)
    coarse, fine = (
        run(Simulator(room(1.2, 1.0, [Post(0.3, 0.3, 0.03)]), start=start, drift=0.02), drive, n)
        for n in (1, steps)
    )
    assert gap(coarse.pose, fine.pose) < 1e-6
    assert gap(coarse.odometry, fine.odometry) < 1e-6
    assert coarse.twist == pytest.approx(fine.twist, abs=1e-6)
    assert coarse.wheels == pytest.approx(fine.wheels, abs=1e-5)
    assert coarse.time == pytest.approx(fine.time)
    assert len(coarse.collisions) == len(fine.collisions)


@settings(max_examples=50)
@given(starts, drives, st.sampled_from([playground, pillars]), st.integers(0, 3))
def test_it_never_enters_a_wall(
    start: Pose, drive: list[tuple[float, float, float]], make: type[World], laps: int
) -> None:
    world = make()
    try:
        robot = Simulator(world, start=start)
    except LabError:
        assert clearance(world, start.x, start.y) < R
        return
    for v, w, seconds in drive * (1 + laps):
        robot.command(math.copysign(0.22, v), w / 3)
        for _ in range(10):
            robot.step(seconds / 10)
            assert clearance(world, robot.pose.x, robot.pose.y, but=robot.name) > R - 1e-7


@given(nonsense, st.floats(-1, 1))
def test_nonsense_is_refused_and_the_robot_stands(bad: float, good: float) -> None:
    for v, w in ((bad, good), (good, bad), (bad, bad)):
        robot = Simulator(open_field())
        assert not robot.command(v, w)
        robot.step(5.0)
        assert robot.pose == Pose()
        assert robot.twist == Twist2()


@given(nonsense)
def test_nonsense_stops_a_robot_that_drives(bad: float) -> None:
    robot = Simulator(open_field())
    assert robot.command(0.2, 1.0)
    robot.step(0.5)
    assert not robot.command(bad, 0.0)
    robot.step(1.0)
    assert robot.twist == Twist2()
    assert all(math.isfinite(number) for number in robot.pose)


@given(st.floats(0.01, 0.22))
def test_straight_ahead_with_acceleration(v: float) -> None:
    robot = Simulator(open_field())
    robot.command(v, 0)
    robot.step(0.9)
    # A ramp of v/a seconds costs v²/2a of way.
    assert robot.pose.x == pytest.approx(v * 0.9 - v**2 / (2 * 2.5))
    assert robot.twist.v == v
    robot.command(0, 0)
    robot.step(1.0)
    assert robot.pose.x == pytest.approx(v * 0.9)
    assert robot.wheels == pytest.approx((v * 0.9 / 0.033,) * 2)


@given(st.floats(0.05, 1.5), st.sampled_from([-1, 1]))
def test_a_turn_for_a_time_is_w_times_time(w: float, side: int) -> None:
    robot = Simulator(open_field())
    robot.command(0, side * w)
    robot.step(0.9)
    robot.command(0, 0)
    robot.step(1.0)
    assert robot.pose == pytest.approx((0, 0, side * w * 0.9), abs=1e-12)


def test_a_circle_closes_and_yaw_wraps() -> None:
    robot = Simulator(open_field())
    robot.command(0.2, 1.0)
    robot.step(0.9)
    begin, yaws = robot.pose, []
    for _ in range(1000):
        robot.command(0.2, 1.0)
        robot.step(math.tau / 1000)
        yaws.append(robot.pose.yaw)
    assert gap(robot.pose, begin) < 1e-9
    assert max(yaws) > 3
    assert min(yaws) < -3
    assert all(-math.pi < yaw <= math.pi for yaw in yaws)


def test_it_stops_when_commands_stop_coming() -> None:
    robot = Simulator(open_field(), command_timeout=0.5)
    robot.command(0.2, 0)
    robot.step(3600 * 24.0)
    assert robot.twist == Twist2()
    assert robot.pose.x == pytest.approx(0.2 * 0.5)
    assert robot.time == pytest.approx(3600 * 24.0)
    assert robot.timed_out
    robot.command(0, 0)
    assert not robot.timed_out


def test_without_a_timeout_it_keeps_its_last_velocity() -> None:
    robot = Simulator(open_field(), command_timeout=None)
    robot.command(0.2, 0)
    robot.step(3600.0)
    assert robot.twist == Twist2(0.2, 0)
    robot.command(0, 0)
    robot.step(3600.0)
    assert robot.twist == Twist2()
    assert not robot.timed_out


def test_only_what_its_timeout_has_stopped_is_called_so() -> None:
    told = Simulator(open_field())
    run(told, [(0.2, 0.0, 1.0), (0.0, 0.0, 1.0)], 1)
    told.step(10)
    at_a_wall = Simulator(World([Wall(0.2, -1, 0.2, 1)]))
    at_a_wall.command(0.2, 0)
    at_a_wall.step(10)
    new = Simulator()
    new.step(10)
    assert [robot.timed_out for robot in (told, at_a_wall, new)] == [False] * 3
    new.command(0.1, 0)
    new.step(10)
    assert new.timed_out
    new.place(Pose())
    assert not new.timed_out


def test_commands_that_keep_coming_keep_it_moving() -> None:
    robot = Simulator(open_field())
    for _ in range(40):
        robot.command(0.1, 0)
        robot.step(0.99)
    assert robot.twist.v == 0.1


def test_it_stops_at_a_wall_and_reports_it_once() -> None:
    robot = Simulator(World([Wall(0.5, -1, 0.5, 1)]))
    for _ in range(100):
        robot.command(0.22, 0.0)
        robot.step(0.1)
    assert robot.pose.x == pytest.approx(0.5 - R, abs=1e-8)
    assert robot.twist == Twist2()
    (contact,) = robot.collisions
    assert (contact.x, contact.y) == pytest.approx((0.5, 0))
    assert contact.time == pytest.approx((0.5 - R + 0.22**2 / 5) / 0.22)


def test_at_a_wall_it_stands_until_the_command_leads_away() -> None:
    robot = Simulator(World([Wall(0.5, -1, 0.5, 1)]), start=Pose(0.3))
    run(robot, [(0.22, 0.0, 1.0), (0.22, 1.0, 0.9)], 3)
    assert robot.pose == pytest.approx((0.5 - R, 0, 0), abs=1e-8)
    run(robot, [(0.0, 1.0, 0.9)], 3)
    assert robot.pose.yaw > 0.5
    run(robot, [(-0.2, 0.0, 0.9)], 3)
    assert robot.pose.x < 0.5 - R - 0.05
    assert len(robot.collisions) == 1


@settings(max_examples=30)
@given(drives)
def test_pushing_for_ever_does_not_creep(drive: list[tuple[float, float, float]]) -> None:
    robot = Simulator(room(1, 1))
    for _ in range(20):
        run(robot, [(abs(v) + 0.05, w / 10, seconds) for v, w, seconds in drive], 2)
    assert clearance(robot.world, robot.pose.x, robot.pose.y, but=robot.name) > R - 1e-7


def test_robots_in_one_world_stop_when_they_meet() -> None:
    world = open_field()
    left = Simulator(world, start=Pose(-0.5, 0, 0), name='left')
    right = Simulator(world, start=Pose(0.5, 0, math.pi), name='right')
    for _ in range(100):
        for robot in (left, right):
            robot.command(0.2, 0)
            robot.step(0.1)
    assert right.pose.x - left.pose.x == pytest.approx(2 * R, abs=1e-7)
    assert left.collisions or right.collisions
    assert left.scan()[0] == pytest.approx(R + 0.032, abs=1e-6)
    right.close()
    assert left.scan()[0] == math.inf


def test_what_pushes_goes_on_when_what_it_pushes_is_gone() -> None:
    world = open_field()
    left = Simulator(world, name='left')
    right = Simulator(world, start=Pose(0.3), name='right')
    run(left, [(0.2, 0, 0.9)] * 3, 5)
    stopped = left.pose.x
    assert stopped == pytest.approx(0.3 - 2 * R, abs=1e-7)
    right.close()
    run(left, [(0.2, 0, 0.9)], 5)
    assert left.pose.x > stopped + 0.1


def test_a_push_in_another_direction_is_another_one() -> None:
    robot = Simulator(World([Wall(0.5, -1, 0.5, 1)]), start=Pose(0.3))
    run(robot, [(0.2, 0.0, 0.9)] * 3, 5)
    place = robot.pose.x
    run(robot, [(0.1, 0.0, 0.9)], 5)
    assert robot.pose.x == place
    run(robot, [(-0.1, 0.0, 0.9), (0.2, 0.0, 0.2)], 5)
    assert robot.pose.x < place - 0.02
    robot.place(Pose(0.0))
    run(robot, [(0.2, 0.0, 0.9)], 5)
    assert robot.pose.x > 0.1


def test_a_robot_of_the_same_name_replaces_the_old_one() -> None:
    world = open_field()
    old = Simulator(world)
    new = Simulator(world)
    new.command(0.2, 0)
    new.step(1.0)
    assert new.pose.x > 0.1
    old.close()
    assert list(world.robots) == ['turtlebot']
    new.close()
    assert not world.robots


@given(st.floats(0.005, 0.1), st.sampled_from([-1, 1]))
def test_drifting_odometry_bends_a_straight_way(drift: float, side: int) -> None:
    robot = Simulator(open_field(), drift=side * drift)
    for _ in range(50):
        robot.command(0.2, 0)
        robot.step(0.1)
    assert robot.pose.y == 0
    # The wheels tell a turning rate of -drift v / separation, so the whole way turns by that.
    expected = -side * drift * robot.pose.x / 0.160
    assert robot.odometry.yaw == pytest.approx(wrap_angle(expected))
    assert robot.odometry_twist.w == pytest.approx(-side * drift * 0.2 / 0.160)
    left, right = robot.wheels
    assert left - right == pytest.approx(side * drift * robot.pose.x / 0.033)


def test_without_drift_odometry_is_the_truth() -> None:
    robot = run(Simulator(), [(0.2, 0.7, 0.9), (-0.1, -2, 0.9)], 5)
    assert robot.odometry == robot.pose
    assert robot.odometry_twist == robot.twist
    assert robot.wheel_rates[1] - robot.wheel_rates[0] == pytest.approx(
        robot.twist.w * 0.16 / 0.033
    )


def test_scan_follows_the_convention_for_what_it_cannot_measure() -> None:
    near, far = Wall(-0.14, -1, -0.14, 1), Wall(5, -1, 5, 1)
    scan = Simulator(World([near, far, Wall(-2, 2, 2, 2)])).scan()
    assert scan[180] == -math.inf  # 0.108 m behind the scanner
    assert scan[0] == math.inf
    assert scan[90] == pytest.approx(2.0)


@pytest.mark.parametrize('nothing', [math.inf, 0.0])
def test_scan_of_an_empty_world_has_all_beams(nothing: float) -> None:
    alone = Simulator(open_field(), noise=0.01, scan_nothing=nothing)
    # The wall is far beyond the range.
    far = Simulator(World([Wall(99, -1, 99, 1)]), noise=0.01, scan_nothing=nothing)
    assert alone.scan() == far.scan() == [nothing] * 360


def test_noise_is_the_same_for_the_same_seed() -> None:
    def scans(seed: int, noise: float = 0.01) -> list[list[float]]:
        robot = Simulator(noise=noise, seed=seed)
        return [robot.scan() for _ in range(3)]

    assert scans(1) == scans(1)
    assert scans(1) != scans(2)
    assert scans(1)[0] != scans(1)[1]
    exact = scans(1, noise=0.0)[0]
    errors = [a - b for a, b in zip(scans(1)[0], exact, strict=True) if abs(a) < 9 and abs(b) < 9]
    spread = math.sqrt(sum(error**2 for error in errors) / len(errors))
    assert 0.008 < spread < 0.012


def test_place_starts_again() -> None:
    robot = run(Simulator(drift=0.1), [(0.2, 0.5, 0.9)], 1)
    robot.place((1.0, -0.5, 3 * math.pi))
    assert robot.pose == robot.odometry == pytest.approx((1.0, -0.5, math.pi))
    robot.step(1.0)
    assert robot.pose.x == 1.0
    assert 'x=1.000 y=-0.500' in repr(robot)


@pytest.mark.parametrize(
    ('options', 'words'),
    [
        ({'start': (2.45, 0, 0)}, '0.050 m away'),
        ({'start': (math.nan, 0, 0)}, 'finite'),
        ({'command_timeout': 0}, 'command_timeout'),
        ({'command_timeout': math.nan}, 'command_timeout'),
        ({'drift': 2}, 'drift'),
        ({'noise': -0.1}, 'noise'),
        ({'noise': math.inf}, 'noise'),
    ],
)
def test_arguments_without_sense_are_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(LabError, match=words):
        Simulator(**options)  # type: ignore[arg-type]


@pytest.mark.parametrize('dt', [-0.1, math.nan, math.inf])
def test_time_passes_forwards_only(dt: float) -> None:
    with pytest.raises(LabError, match='dt must be'):
        Simulator().step(dt)


def test_a_post_is_an_obstacle_too() -> None:
    robot = Simulator(World([], [Post(0.6, 0, 0.2)]))
    for _ in range(60):
        robot.command(0.22, 0)
        robot.step(0.1)
    assert robot.pose.x == pytest.approx(0.4 - R, abs=1e-8)
    assert isinstance(robot.collisions[0].thing, Post)
