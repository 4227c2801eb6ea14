"""The robot in a world that pushes back, without ROS."""

from __future__ import annotations

import math
import statistics
from typing import Any

import numpy as np
import pytest

from labkit.descriptions.forward_kinematics import Transform, link_transforms
from labkit.errors import LabError
from labkit.sim.kinematics import Pose, Twist2, wrap_angle
from labkit.sim.parts import description
from labkit.sim.physics.mujoco_world import PhysicsWorld, yard
from labkit.sim.physics.physics_robot import PhysicsSimulator
from labkit.sim.physics.text_drawing import drawn
from labkit.sim.physics.things import Crate, Ice, Ramp
from labkit.sim.robots import BURGER
from labkit.sim.simulator import GRAVITY, Simulator
from labkit.sim.world import Post, Wall, World, open_field, playground, room

ROUND = 1 / 30


def robot(world: Any = None, **options: Any) -> PhysicsSimulator:
    return PhysicsSimulator(world or open_field(), command_timeout=None, **options)


def run(simulator: Simulator, v: float, w: float, seconds: float) -> None:
    simulator.command(v, w)
    for _ in range(round(seconds / ROUND)):
        simulator.step(ROUND)


def gap(one: Pose, other: Pose) -> float:
    return math.hypot(one.x - other.x, one.y - other.y)


def test_at_rest_it_stands_on_its_wheels() -> None:
    found = robot(start=(0.5, -0.5, 1.0))
    run(found, 0.0, 0.0, 5.0)
    assert gap(found.pose, Pose(0.5, -0.5)) < 1e-3
    assert found.pose.yaw == pytest.approx(1.0, abs=1e-3)
    assert abs(found.height) < 1e-3 and not found.tipped_over
    assert found.specific_force == pytest.approx((0.0, 0.0, GRAVITY), abs=0.02)
    assert found.angular_velocity == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
    assert found.twist == Twist2() and found.time == pytest.approx(5.0)


@pytest.mark.parametrize(('v', 'w'), [(0.2, 0.0), (-0.1, 0.0), (0.15, 0.5), (0.0, 1.0)])
def test_on_a_floor_with_grip_it_drives_as_the_light_robot_does(v: float, w: float) -> None:
    light, heavy = Simulator(open_field(), command_timeout=None), robot()
    for each in (light, heavy):
        run(each, v, w, 5.0)
    # It takes a moment longer to speed up, and its wheels slip a little.
    assert gap(light.pose, heavy.pose) < 0.05
    assert abs(wrap_angle(light.pose.yaw - heavy.pose.yaw)) < 0.2
    assert heavy.odometry_twist == pytest.approx((v, w), abs=0.01)
    assert heavy.twist == pytest.approx((v, w), abs=0.03)


def test_odometry_believes_the_wheels() -> None:
    found = robot()
    run(found, 0.2, 0.0, 5.0)
    left, right = found.wheels
    assert found.odometry.x == pytest.approx((left + right) / 2 * BURGER.wheel_radius, abs=1e-3)
    assert gap(found.odometry, found.pose) < 0.02
    drifting = robot(drift=0.1)
    run(drifting, 0.2, 0.0, 5.0)
    assert drifting.odometry.yaw < -0.3 and abs(drifting.pose.yaw) < 0.02


def test_a_crate_is_pushed_and_a_wall_is_not() -> None:
    world = PhysicsWorld(World([Wall(1.0, -1.0, 1.0, 1.0)]), crates=[Crate(0.5, 0.0)])
    found = robot(world)
    run(found, 0.2, 0.0, 1.5)
    (crate,) = world.crate_poses()
    assert gap(crate, Pose(0.5, 0.0)) < 1e-3
    run(found, 0.2, 0.0, 10.0)
    (crate,) = world.crate_poses()
    assert crate.x == pytest.approx(0.9, abs=0.02) and found.collisions == []
    # It stands behind the crate, and its wheels turn on.
    assert found.pose.x < 0.9 - 0.1 and found.odometry.x > found.pose.x + 0.5
    world.reset()
    assert world.crate_poses() == [Pose(0.5, 0.0, 0.0)]


def test_a_heavy_crate_stays() -> None:
    world = PhysicsWorld(open_field(), crates=[Crate(0.5, 0.0, mass=20.0)])
    run(robot(world), 0.2, 0.0, 5.0)
    assert world.crate_poses()[0].x == pytest.approx(0.5, abs=0.01)


def test_a_contact_is_told_once() -> None:
    found = robot(World([Wall(0.5, -1.0, 0.5, 1.0)], [Post(-1.0, 0.0, 0.1)]))
    run(found, 0.2, 0.0, 4.0)
    (contact,) = found.collisions
    assert contact.thing == Wall(0.5, -1.0, 0.5, 1.0)
    assert contact.x == pytest.approx(0.5, abs=0.01) and 1.5 < contact.time < 4.0
    run(found, -0.2, 0.0, 9.0)
    assert [each.thing for each in found.collisions][1:] == [Post(-1.0, 0.0, 0.1)]


# How much of the way that its wheels tell it has come, starting on ice, by the friction there.
def slipped(friction: float, seed: int) -> float:
    ice = Ice(0.0, 0.0, 8.0, 8.0, friction)
    found = robot(PhysicsWorld(open_field(), ice=[ice]), start=(0.1 * seed, 0.0, 0.3 * seed))
    run(found, 0.0, 0.0, 1.0)
    start, told = found.pose, found.odometry
    run(found, 0.22, 0.0, 0.5)
    return gap(found.pose, start) / gap(found.odometry, told)


def test_wheels_slip_on_ice_as_much_as_its_friction_says() -> None:
    shares = {
        friction: [slipped(friction, seed) for seed in range(5)]
        for friction in (0.01, 0.03, 0.1, 0.5)
    }
    means = {friction: statistics.mean(found) for friction, found in shares.items()}
    # The wheels pull with the friction of the weight on them, and the caster brakes with that of
    # the weight on it. Where the weight is, says the description.
    whole = sum(mass for mass, _ in masses())
    on_caster = -sum(mass * place.translation[0] for mass, place in masses()) / whole / 0.081
    told = 0.22 * 0.5 - 0.22**2 / (2 * BURGER.limits.v_rate)
    for friction in (0.01, 0.03, 0.1):
        come = friction * GRAVITY * (1 - 2 * on_caster) * 0.5**2 / 2
        assert means[friction] == pytest.approx(come / told, rel=0.35), means
    assert means[0.5] > 0.7
    assert all(max(found) - min(found) < 0.02 for found in shares.values()), shares


def masses() -> list[tuple[float, Transform]]:
    """Return the masses of the robot's links, kg, and where their centres are."""
    places = link_transforms(description())
    return [
        (each.inertial.mass, places[name] * Transform(each.inertial.origin.xyz))
        for name, each in description().links.items()
        if each.inertial is not None
    ]


def test_a_ramp_lifts_it_and_its_end_tips_it_over() -> None:
    found = robot(PhysicsWorld(open_field(), ramps=[Ramp(0.3, 0.0)]))
    run(found, 0.2, 0.0, 3.0)
    forces = []
    for _ in range(15):
        run(found, 0.2, 0.0, ROUND)
        forces.append(found.specific_force[0])
    assert 0.03 < found.height < 0.1 and not found.tipped_over
    # In a robot that climbs, the accelerometer feels a part of gravity.
    assert statistics.mean(forces) == pytest.approx(GRAVITY * math.sin(Ramp(0, 0).slope), rel=0.3)
    run(found, 0.2, 0.0, 4.0)
    assert found.tipped_over
    found.place((0.0, 0.0, 0.0))
    assert not found.tipped_over and found.pose == Pose(0.0, 0.0, 0.0)
    run(found, 0.1, 0.0, 1.0)
    assert found.pose.x == pytest.approx(0.1, abs=0.02)


@pytest.mark.parametrize('yaw', [0.0, 1.0, -2.5])
def test_it_scans_what_the_light_robot_scans(yaw: float) -> None:
    world, start = playground(), (0.2, -0.3, yaw)
    heavy = np.array(robot(world, start=start).scan())
    light = np.array(Simulator(playground(), start=start).scan())
    assert np.array_equal(np.isinf(light), np.isinf(heavy))
    both = np.isfinite(light)
    # Walls have a thickness; at the edge of a post a beam hits or misses.
    near = np.abs(light[both] - heavy[both]) < 0.01
    assert near.mean() > 0.98


def test_it_sees_crates_and_others_and_not_itself() -> None:
    world = PhysicsWorld(open_field(), crates=[Crate(0.0, 1.0)])
    one = robot(world, name='one')
    two = robot(world, name='two', start=(1.0, 0.0, 0.0))
    ranges = one.scan()
    # The scanner stands 32 mm behind the axle. Its beams pass 10 mm below the top of the other's.
    assert ranges[0] == pytest.approx(1.0 - 0.035, abs=0.01)
    assert ranges[90] == pytest.approx(0.9, abs=0.01)
    assert all(math.isinf(each) for each in ranges[120:330])
    two.close()
    assert math.isinf(one.scan()[0])
    assert len(one.world.walls) == 4 and [*one.world.robots] == ['one']


def test_two_share_the_time_of_their_world() -> None:
    world = PhysicsWorld(open_field())
    one, two = robot(world, name='one'), robot(world, name='two', start=(0.0, 1.0, 0.0))
    one.command(0.2, 0.0)
    for _ in range(60):
        one.step(ROUND)
        two.step(ROUND)
    assert world.time == pytest.approx(2.0) and one.time == two.time
    # One that stands still, as in a check, goes on from where the others are.
    for _ in range(60):
        one.step(ROUND)
    two.command(0.2, 0.0)
    two.step(ROUND)
    assert world.time == pytest.approx(4.0 + ROUND) and two.time == pytest.approx(world.time)
    assert two.pose.x > 0 and one.pose.x == pytest.approx(0.8, abs=0.03)


def test_robots_push_each_other() -> None:
    world = PhysicsWorld(open_field())
    one, two = robot(world, name='one'), robot(world, name='two', start=(0.4, 0.0, 0.0))
    one.command(0.2, 0.0)
    for _ in range(150):
        one.step(ROUND)
        two.step(ROUND)
    assert two.pose.x > 0.45


def test_the_same_commands_give_the_same_path() -> None:
    def path() -> list[Pose]:
        found = robot(yard(), noise=0.01, seed=3)
        places = []
        for count in range(60):
            found.command(0.2, math.sin(count / 5))
            found.step(ROUND)
            places.append(found.pose)
        return places

    assert path() == path()


def test_its_command_has_a_time_limit() -> None:
    found = PhysicsSimulator(open_field(), command_timeout=1.0)
    run(found, 0.2, 0.0, 4.0)
    assert found.timed_out and found.twist == pytest.approx((0.0, 0.0), abs=2e-3)
    assert found.pose.x == pytest.approx(0.2, abs=0.05)
    assert not found.command(math.nan, 0.0) and found.target == Twist2()


@pytest.mark.parametrize(
    ('make', 'said'),
    [
        (lambda: PhysicsWorld(crates=[Crate(0.0, math.nan)]), 'must be finite'),
        (lambda: PhysicsWorld(crates=[Crate(0.0, 0.0, mass=0.0)]), 'are more than 0'),
        (lambda: PhysicsWorld(ice=[Ice(0.0, 0.0, -1.0, 1.0)]), 'are more than 0'),
        (lambda: robot(PhysicsWorld(crates=[Crate(0.1, 0.0)])), 'a crate is at x=0.10, y=0.00'),
        (lambda: robot(room(), start=(2.45, 0.0, 0.0)), 'needs 0.105 m of room'),
        (lambda: robot().step(-1.0), 'dt must be a time'),
        (lambda: drawn('#?'), r'this has .\?. in line 1'),
        (lambda: drawn('#', cell=0.0), 'squares of 0.0 m'),
    ],
)
def test_what_makes_no_sense_is_refused(make: Any, said: str) -> None:
    with pytest.raises(LabError, match=said):
        make()


DRAWING = """
#####
#c~>#
# @o#
#####
"""


def test_a_text_draws_a_world() -> None:
    world = drawn(DRAWING, cell=0.5)
    assert world.crates == (Crate(-0.5, 0.5, size=0.2),)
    assert world.ice == (Ice(0.0, 0.5, 0.5, 0.5),)
    assert world.ramps == (Ramp(0.25, 0.5, 0.0, 0.5, 0.5, 0.5 / 6),)
    assert world.plan.posts == (Post(0.5, 0.0, 0.125),)
    found = robot(world)
    ranges = found.scan()
    assert ranges[180] == pytest.approx(1.0 - 0.032, abs=0.01)
    assert ranges[270] == pytest.approx(0.5, abs=0.01)


@pytest.mark.slow('an hour of the world')
def test_an_hour_of_two_robots_that_push_things_has_no_nan() -> None:
    crates = [Crate(0.4 * i - 0.8, 0.4 * j - 0.8) for i in range(5) for j in range(5) if i != 2]
    world = PhysicsWorld(room(3.0, 3.0), crates=crates, ice=[Ice(0.0, 0.0, 1.0, 1.0)])
    both = [robot(world, name=name, start=(0.0, y, 0.0)) for name, y in (('a', -1.2), ('b', 1.2))]
    random = np.random.default_rng(1)
    for count in range(3600 * 30):
        for each in both:
            if count % 60 == 0:
                each.command(float(random.uniform(-0.22, 0.22)), float(random.uniform(-2, 2)))
            each.step(ROUND)
        if count % 300 == 0:
            ranges = np.array(both[0].scan())
            assert not np.isnan(ranges).any() and np.isfinite(world.data.qpos).all()
    assert world.time == pytest.approx(3600, abs=0.1)
    for pose in (*world.crate_poses(), *(each.pose for each in both)):
        assert max(abs(pose.x), abs(pose.y)) < 1.6, pose


def test_what_is_no_plan_is_refused_in_words() -> None:
    with pytest.raises(LabError, match=r"A plan is a World, .* and this is 'yard'"):
        PhysicsWorld('yard')  # type: ignore[arg-type]
