"""Walls, posts, contacts and the laser scan, against closed forms and against brute force."""

from __future__ import annotations

import math

import pytest
from clearance import clearance
from hypothesis import given
from hypothesis import strategies as st

from labkit.errors import LabError
from labkit.sim.kinematics import Motion, Pose, Twist2
from labkit.sim.robots import BURGER
from labkit.sim.world import Post, Wall, World, open_field, pillars, playground, room

R = BURGER.radius
coordinates = st.floats(-3, 3)
walls = st.builds(Wall, coordinates, coordinates, coordinates, coordinates).filter(
    lambda wall: math.hypot(wall.x2 - wall.x1, wall.y2 - wall.y1) > 0.01
)
posts = st.builds(Post, coordinates, coordinates, st.floats(0.05, 0.5))


@given(walls, coordinates, coordinates)
def test_distance_of_a_wall_is_that_of_its_nearest_point(wall: Wall, x: float, y: float) -> None:
    shares = [step / 1000 for step in range(1001)]
    sampled = min(
        math.hypot(
            wall.x1 + share * (wall.x2 - wall.x1) - x, wall.y1 + share * (wall.y2 - wall.y1) - y
        )
        for share in shares
    )
    distance, away_x, away_y = wall.away(x, y)
    assert distance <= sampled + 1e-12
    assert distance == pytest.approx(sampled, abs=0.01)
    if distance > 1e-6:
        assert math.hypot(away_x, away_y) == pytest.approx(1)
        assert wall.away(x - distance * away_x, y - distance * away_y)[0] < 1e-9


def test_distance_of_a_post_is_negative_inside() -> None:
    post = Post(1.0, 0.0, 0.3)
    assert post.away(0.0, 0.0) == pytest.approx((0.7, -1.0, 0.0))
    assert post.away(1.0, 0.1)[0] == pytest.approx(-0.2)
    assert post.away(1.0, 0.0)[0] == pytest.approx(-0.3)


def test_clearance_is_the_nearest_of_all_things() -> None:
    assert clearance(open_field(), 0, 0) == math.inf
    assert clearance(room(4, 2), 1.5, 0.2) == pytest.approx(0.5)
    world = room(4, 4, [Post(1, 0, 0.2)])
    assert clearance(world, 0, 0) == pytest.approx(0.8)
    world.robots['other'] = Post(-0.5, 0, 0.1)
    assert clearance(world, 0, 0) == pytest.approx(0.4)
    assert clearance(world, 0, 0, but='other') == pytest.approx(0.8)


@pytest.mark.parametrize(
    'thing', [Wall(0, 0, 0, 0), Wall(0, 0, math.nan, 1), Post(0, 0, 0), Post(0, math.inf, 1)]
)
def test_nonsense_in_a_world_is_refused(thing: Wall | Post) -> None:
    with pytest.raises(LabError, match=r'must be|needs two'):
        World([thing]) if isinstance(thing, Wall) else World([], [thing])


@given(st.floats(0.01, 0.22), st.floats(-1.2, 1.2))
def test_straight_into_a_wall(v: float, yaw: float) -> None:
    world = World([Wall(1, -50, 1, 50)])
    contact = world.first_contact(Motion(Pose(0, 0, yaw), Twist2(v, 0)), 1000.0, R)
    assert contact is not None
    assert contact.time == pytest.approx((1 - R) / (v * math.cos(yaw)), abs=1e-6)
    assert contact.x == pytest.approx(1)
    assert contact.thing == world.walls[0]


@given(st.floats(0.05, 0.22), st.floats(0.2, 1.0), st.floats(0.1, 0.9))
def test_along_an_arc_into_a_wall(v: float, w: float, share: float) -> None:
    # The arc's highest point is at 2 v/w; the wall is met below it, at a known angle.
    high = R + share * 2 * v / w
    world = World([Wall(-50, high, 50, high)])
    contact = world.first_contact(Motion(Pose(), Twist2(v, w)), 100.0, R)
    assert contact is not None
    assert contact.time == pytest.approx(math.acos(1 - share * 2) / w, abs=1e-6)


@given(st.floats(-0.3, 0.3), st.floats(0.05, 0.3))
def test_straight_into_a_post(aside: float, radius: float) -> None:
    world = World([], [Post(2.0, aside, radius)])
    contact = world.first_contact(Motion(Pose(), Twist2(0.2, 0)), 100.0, R)
    if abs(aside) < radius + R - 1e-6:
        assert contact is not None
        until = 2.0 - math.sqrt((radius + R) ** 2 - aside**2)
        assert contact.time == pytest.approx(until / 0.2, abs=1e-4)
    elif abs(aside) > radius + R + 1e-6:
        assert contact is None


def test_the_end_of_a_wall_is_met_like_a_point() -> None:
    world = World([Wall(1.0, 0.05, 1.0, 5.0)])
    contact = world.first_contact(Motion(Pose(), Twist2(0.1, 0)), 100.0, R)
    assert contact is not None
    assert (contact.x, contact.y) == pytest.approx((1.0, 0.05))
    assert contact.time == pytest.approx((1 - math.sqrt(R**2 - 0.05**2)) / 0.1, abs=1e-6)


def test_a_thin_wall_is_not_jumped_over_in_one_long_step() -> None:
    world = World([Wall(1, -1, 1, 1)])
    contact = world.first_contact(Motion(Pose(), Twist2(1000.0, 0)), 1000.0, R)
    assert contact is not None
    assert contact.time == pytest.approx((1 - R) / 1000)


def test_the_nearest_of_several_is_met_first() -> None:
    world = World([Wall(2, -1, 2, 1), Wall(1, -1, 1, 1)], [Post(1.5, 0, 0.1)])
    contact = world.first_contact(Motion(Pose(), Twist2(0.2, 0)), 100.0, R)
    assert contact is not None
    assert contact.thing == Wall(1, -1, 1, 1)


@pytest.mark.parametrize(
    ('twist', 'acceleration', 'touches'),
    [
        (Twist2(0.0, 0.0), Twist2(2.5, 0.0), True),  # starts against the wall
        (Twist2(0.0, 0.0), Twist2(-2.5, 0.0), False),  # backs off
        (Twist2(0.0, 0.0), Twist2(0.0, 3.2), False),  # turns on the spot
        (Twist2(-0.2, 1.0), Twist2(0.0, 0.0), False),
    ],
)
def test_what_touches_already_may_leave_but_not_push(
    twist: Twist2, acceleration: Twist2, touches: bool
) -> None:
    world = World([Wall(1, -1, 1, 1)])
    motion = Motion(Pose(1 - R), twist, acceleration)
    contact = world.first_contact(motion, 0.05, R)
    assert (contact is not None) == touches
    if contact:
        assert contact.time == 0


def test_along_a_wall_that_it_touches_the_way_is_free() -> None:
    world = World([Wall(-5, 1, 5, 1)])
    assert world.first_contact(Motion(Pose(0, 1 - R), Twist2(0.2, 0)), 10.0, R) is None
    starting = Motion(Pose(0, 1 - R), Twist2(), Twist2(2.5, 0))
    assert world.first_contact(starting, 0.088, R) is None
    inwards = Motion(Pose(0, 1 - R), Twist2(0.2, 0.5))
    assert world.first_contact(inwards, 10.0, R) is not None
    outwards = Motion(Pose(0, 1 - R), Twist2(0.2, -0.5))
    assert world.first_contact(outwards, 6.0, R) is None


@given(
    st.floats(-2, 2), st.floats(-2, 2), st.floats(-math.pi, math.pi), st.integers(0, 359)
)  # fmt: skip
def test_scan_of_a_room(x: float, y: float, yaw: float, beam: int) -> None:
    ranges = room(5, 5).ranges(Pose(x, y, yaw))
    eye_x, eye_y = x - 0.032 * math.cos(yaw), y - 0.032 * math.sin(yaw)
    cos, sin = math.cos(yaw + math.radians(beam)), math.sin(yaw + math.radians(beam))
    to_x = (math.copysign(2.5, cos) - eye_x) / cos if cos else math.inf
    to_y = (math.copysign(2.5, sin) - eye_y) / sin if sin else math.inf
    assert len(ranges) == 360
    assert ranges[beam] == pytest.approx(min(to_x, to_y), abs=1e-6)


@given(st.floats(0.5, 3.0), st.floats(0.05, 0.3), st.integers(-30, 30))
def test_scan_of_a_post(ahead: float, radius: float, beam: int) -> None:
    ranges = World([], [Post(ahead - 0.032, 0, radius)]).ranges(Pose())
    under = radius**2 - (ahead * math.sin(math.radians(beam))) ** 2
    if under < -1e-9:
        assert ranges[beam] == math.inf
    elif under > 1e-9:
        expected = ahead * math.cos(math.radians(beam)) - math.sqrt(under)
        assert ranges[beam] == pytest.approx(expected, abs=1e-6)


def test_beams_count_to_the_left_from_straight_ahead() -> None:
    world = World([Wall(-9, 1, 9, 1)])
    ranges = world.ranges(Pose(0, 0, 0))
    assert ranges[90] == pytest.approx(1.0)
    assert ranges[0] == ranges[180] == ranges[270] == math.inf
    turned = world.ranges(Pose(0, 0, math.pi / 2))
    assert turned[0] == pytest.approx(1.032)


@given(posts, walls)
def test_what_a_beam_hits_is_on_a_thing(post: Post, wall: Wall) -> None:
    world = World([wall], [post])
    for beam, distance in enumerate(world.ranges(Pose()).tolist()):
        if distance < math.inf:
            x = -0.032 + distance * math.cos(math.radians(beam))
            y = distance * math.sin(math.radians(beam))
            assert min(abs(wall.away(x, y)[0]), abs(post.away(x, y)[0])) < 1e-6


def test_robots_see_each_other_but_not_themselves() -> None:
    world = open_field()
    world.robots['me'] = Post(0, 0, R)
    world.robots['you'] = Post(1.0 + R, 0, R)
    assert world.ranges(Pose(), but='me')[0] == pytest.approx(1.032)
    assert world.ranges(Pose(), but='me')[180] == math.inf


@pytest.mark.parametrize(
    ('world', 'start'),
    [(playground(), Pose()), (pillars(), Pose(-1.65, -0.55)), (room(), Pose())],
)
def test_arenas_are_closed_and_have_room_at_their_start(world: World, start: Pose) -> None:
    assert clearance(world, start.x, start.y) > 2 * R
    assert world.ranges(start).max() < 10
    assert 'walls' in repr(world)


def test_outside_is_beyond_the_sides_of_the_room() -> None:
    world = pillars()
    assert len(world.walls) == 6
    assert not world.is_outside(0.0, 2.4)
    assert world.is_outside(0.0, 2.6)
    # Within the box around the hexagon, beyond a side.
    assert world.is_outside(2.8, 2.0)
    turned_round = World(corners=reversed(room(4.0, 2.0).corners))
    assert turned_round.is_outside(0.0, 1.1)
    assert not turned_round.is_outside(1.9, -0.9)
    assert not World([Wall(1, -1, 1, 1)]).is_outside(5.0, 0.0)
    assert not open_field().is_outside(1e9, 0.0)
