"""What a scene is made of: shapes of messages, where they are, and the picture of them."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseStamped
from nav_msgs.msg import Odometry, Path
from sensor_msgs.msg import LaserScan

from labkit.descriptions.urdf import read
from labkit.errors import LabError
from labkit.sim.world import Post, Wall, World
from labkit.transforms.rotations import from_rpy
from labkit.views.scene_meshes import thinned, triangles_of
from labkit.views.scene_messages import (
    odometry_things,
    path_things,
    pose_things,
    scan_things,
    world_things,
)
from labkit.views.scene_picture import HEIGHT, WIDTH, camera_for, to_svg
from labkit.views.scene_robot import robot_things
from labkit.views.scene_shapes import faces_of
from labkit.views.scene_things import (
    HERE,
    Thing,
    arrow,
    as_points,
    composed,
    corners_of,
    is_same,
    numbers_of,
    told_to_page,
)

LEFT = from_rpy(0.0, 0.0, math.pi / 2)
SOLIDS = ('box', 'cylinder', 'cone', 'sphere')


def posed(x: float = 0.0, y: float = 0.0, *, frame: str = 'map', w: float = 1.0) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y = x, y
    message.pose.orientation.w = w
    return message


def near(rows: object, expected: object) -> bool:
    return np.allclose(np.asarray(rows), np.asarray(expected), atol=1e-6)


def test_beams_end_where_the_scanner_was_at_their_time() -> None:
    nan, inf = math.nan, math.inf
    ranges = [1.0, 2.0, inf, nan, 0.05, 9.0]
    scan = LaserScan(angle_increment=math.pi / 2, range_min=0.1, range_max=3.5, ranges=ranges)
    (thing,) = scan_things(scan, ((1.0, 0.0, 0.2), LEFT)).values()
    # The first beam looks ahead, which is left by now, and the second one back.
    assert near(thing.points, [(1.0, 1.0, 0.2), (-1.0, 0.0, 0.2)])
    assert (thing.shape, thing.frame) == ('points', '')


def test_a_scan_that_sees_nothing_is_no_points() -> None:
    (thing,) = scan_things(LaserScan(range_max=3.5, ranges=[math.inf] * 4), HERE).values()
    assert thing.points.shape == (0, 3)


def test_a_path_is_a_line_in_its_frame_and_one_pose_is_none() -> None:
    message = Path(poses=[posed(0.0, 0.0), posed(1.0, 2.0)])
    message.header.frame_id = 'map'
    (line,) = path_things(message).values()
    assert (line.shape, line.frame) == ('line', 'map')
    assert near(line.points[:, :2], [(0, 0), (1, 2)])
    message.poses = message.poses[:1]
    assert path_things(message) == {}


def test_a_goal_is_an_arrow_that_points_where_it_looks() -> None:
    message = posed(1.0, 0.0)
    message.pose.orientation.z = message.pose.orientation.w = 0.5**0.5
    shaft, head = pose_things(message).values()
    tip = max(corners_of(head).tolist(), key=lambda corner: corner[1])
    assert near(tip[1], 0.4)
    assert near(corners_of(shaft)[:, 1].min(), 0.0)
    assert all(part.frame == 'map' for part in (shaft, head))


@pytest.mark.parametrize('wrong', [math.nan, math.inf, 1e9])
def test_what_is_nowhere_is_not_drawn(wrong: float) -> None:
    assert pose_things(posed(wrong)) == {}
    odometry = Odometry()
    odometry.pose.pose.position.x = wrong
    assert odometry_things(odometry, ()) == {}


def test_a_turn_that_nobody_has_filled_in_is_none() -> None:
    empty = Pose()
    empty.orientation.w = 0.0
    assert numbers_of(empty) == HERE
    empty.orientation.z = 5.0
    assert numbers_of(empty) == ((0, 0, 0), (0, 0, 1, 0))


def test_a_trail_is_a_line_from_its_second_point_on() -> None:
    odometry = posed(frame='odom')
    message = Odometry(header=odometry.header)
    message.pose.pose = odometry.pose
    assert set(odometry_things(message, [(0, 0, 0)])) == {'shaft', 'head'}
    line = odometry_things(message, [(0, 0, 0), (1, 0, 0)])['line']
    assert (line.frame, len(line.points)) == ('odom', 2)


def test_walls_stand_on_the_floor_where_the_world_has_them() -> None:
    world = World([Wall(0, 0, 0, 2)], [Post(1, 1, 0.25)])
    wall, post = world_things(world, 'odom').values()
    corners = corners_of(wall)
    assert near(corners.min(axis=0), (-0.01, -0.01, 0))
    assert near(corners.max(axis=0)[:2], (0.01, 2.01))
    assert near(corners_of(post).min(axis=0), (0.75, 0.75, 0))


def test_places_are_put_one_after_the_other() -> None:
    place = composed(((1.0, 0.0, 0.0), LEFT), ((2.0, 0.0, 0.0), LEFT))
    assert near(place[0], (1, 2, 0))
    assert near(np.abs(place[1]), (0, 0, 1, 0))


def test_things_that_look_the_same_are_known() -> None:
    points = as_points([(1, 2, 3)])
    thing = Thing('points', points=points)
    assert is_same(thing, Thing('points', points=points.copy()))
    others = [Thing('points'), Thing('points', points=points + 1), Thing('box', points=points)]
    assert not any(is_same(thing, other) for other in others)


@pytest.mark.parametrize('shape', SOLIDS)
def test_faces_look_outward_and_close(shape: str) -> None:
    closed, groups = faces_of(Thing(shape, size=(1.0, 2.0, 3.0)), 10)
    assert closed
    edges: dict[tuple[tuple[float, ...], ...], int] = {}
    for face in (face for faces in groups for face in faces):
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        assert face.mean(axis=0) @ normal > 0
        corners = [tuple(np.round(corner, 6) + 0.0) for corner in face]
        for edge in zip(corners, [*corners[1:], corners[0]], strict=True):
            edges[edge] = edges.get(edge, 0) + 1
    # Each edge is met once in each direction.
    assert all(edges.get((end, begin)) == count == 1 for (begin, end), count in edges.items())


def test_a_large_mesh_is_the_box_around_it_in_a_picture() -> None:
    points = as_points(np.random.default_rng(1).uniform(-1, 1, (30, 3)))
    closed, groups = faces_of(Thing('mesh', points=points), 10)
    assert not closed
    assert len(groups[0]) == 10
    closed, groups = faces_of(Thing('mesh', points=points), 9)
    assert closed
    assert len(groups[0]) == 6
    assert near(groups[0].max(axis=(0, 1)), points.max(axis=0))


def test_the_page_gets_numbers_in_buffers_and_the_rest_in_words() -> None:
    points = as_points([(1, 2, 3), (math.nan, 0, 0), (4, 5, 6)])
    buffers = [b'before']
    colours = np.array([(255, 0, 0, 255), (0, 255, 0, 128)])
    thing = Thing('points', 'odom', HERE, points=points, colours=colours, width=0.1, metres=True)
    told = told_to_page(thing, buffers)
    assert told == {
        **{'shape': 'points', 'frame': 'odom', 'at': [0, 0, 0, 0, 0, 0, 1], 'size': (1, 1, 1)},
        **{'colour': 'thing', 'alpha': 1.0, 'points': 1, 'colours': 2},
        **{'width': 0.1, 'metres': True},
    }
    assert np.frombuffer(buffers[1], '<f4').tolist() == [1, 2, 3, 4, 5, 6]
    assert list(buffers[2]) == [255, 0, 0, 255, 0, 255, 0, 128]


# -- robots and meshes ----------------------------------------------------------------------------

URDF = """
<robot name="one">
  <material name="red"><color rgba="1 0 0 0.5"/></material>
  <link name="base">
    <visual>
      <origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="red"/>
    </visual>
    <visual><geometry><sphere radius="2"/></geometry></visual>
  </link>
  <link name="hand">
    <visual><geometry><mesh filename="{mesh}" scale="2 2 2"/></geometry></visual>
    <collision><geometry><cylinder radius="0.5" length="3"/></geometry></collision>
  </link>
  <joint name="j" type="fixed"><parent link="base"/><child link="hand"/></joint>
</robot>
"""
TRIANGLES = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 0, 1), (1, 0, 1), (0, 1, 1)]])


def binary(triangles: object) -> bytes:
    rows = np.asarray(triangles, '<f4').reshape(-1, 9)
    parts = [bytes(12) + row.tobytes() + bytes(2) for row in rows]
    return b'solid'.ljust(80) + len(rows).to_bytes(4, 'little') + b''.join(parts)


def text(triangles: object) -> bytes:
    corners = ''.join(f'vertex {x} {y} {z}\n' for x, y, z in np.asarray(triangles).reshape(-1, 3))
    return f'solid it\nfacet normal 0 0 1\nouter loop\n{corners}endloop\n'.encode()


def test_a_robot_is_the_shapes_of_its_links(tmp_path) -> None:
    path = tmp_path / 'hand.stl'
    path.write_bytes(binary(TRIANGLES))
    things, wrong = robot_things(read(URDF.format(mesh=path)))
    assert wrong == []
    assert list(things) == ['base', 'base 1', 'hand']
    box, ball, mesh = things.values()
    assert (box.shape, box.frame, box.size, box.colour, box.alpha) == (
        *('box', 'base', (1, 2, 3), '#ff0000', 0.5),
    )
    assert near(box.place[0], (0, 0, 1))
    assert (ball.shape, ball.size, ball.colour) == ('sphere', (4, 4, 4), '#b2b2b2')
    assert (mesh.shape, mesh.frame, mesh.size) == ('mesh', 'hand', (2, 2, 2))
    assert near(corners_of(mesh).max(axis=0), (2, 2, 2))


@pytest.mark.parametrize(
    ('name', 'words'),
    [
        ('/nowhere/hand.stl', 'There is no file for the mesh'),
        ('/etc/hosts', "The mesh 'hosts' is not drawn: only files of STL are."),
        ('http://example.org/hand.stl', 'is not loaded'),
    ],
)
def test_in_place_of_a_mesh_is_what_others_touch_with_the_reason(name: str, words: str) -> None:
    things, (wrong,) = robot_things(read(URDF.format(mesh=name)))
    assert words in wrong
    assert (things['hand'].shape, things['hand'].size) == ('cylinder', (1, 1, 3))


@pytest.mark.parametrize('data', [binary(TRIANGLES), text(TRIANGLES)])
def test_meshes_are_read_in_both_formats(data: bytes) -> None:
    assert near(triangles_of(data, 'it.stl'), TRIANGLES)


@pytest.mark.parametrize(
    'data', [b'', b'solid', b'vertex 1 2', binary(TRIANGLES)[:-1], b'vertex a b c', bytes(84)]
)
def test_what_is_no_mesh_is_refused_in_words(data: bytes) -> None:
    with pytest.raises(LabError, match=r"'it\.stl' is not drawn: it is no STL, or it is empty"):
        triangles_of(data, 'it.stl')


def test_a_mesh_of_many_triangles_becomes_one_of_few_that_is_as_large() -> None:
    # A sphere of 20,000 triangles.
    ball = Thing('mesh', points=np.zeros((0, 3)))
    assert faces_of(ball, 10) == (False, [])
    u, v = np.meshgrid(np.linspace(0.01, 3.13, 101), np.linspace(0, 2 * math.pi, 101))
    at = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    many = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)])
    many = many.reshape(-1, 3, 3)
    few = thinned(many, 3000).reshape(-1, 3, 3)
    assert 1000 < len(few) <= 3000
    assert near(few.min(axis=(0, 1)).round(1), (-1, -1, -1))
    assert np.abs(np.linalg.norm(few, axis=2) - 1).max() < 0.1
    # A small one stays as it is.
    assert near(thinned(TRIANGLES, 3000).reshape(-1, 3, 3), TRIANGLES)


# -- the picture ----------------------------------------------------------------------------------

PLACES = {'odom': HERE, 'base_link': ((1.0, 0.0, 0.0), LEFT)}


def everything() -> list[Thing]:
    line = as_points([(0, 0, 0), (1, 1, 0)])
    return [
        *(Thing(shape, 'base_link', ((0.1 * i, 0, 0.1), LEFT)) for i, shape in enumerate(SOLIDS)),
        Thing('mesh', points=as_points([(0, 0, 0), (1, 0, 0), (0, 1, 0)]), alpha=0.5),
        Thing('line', points=line, colour='path'),
        Thing('lines', points=line, colour='#123456'),
        Thing('points', points=line, colour='laser'),
        Thing('text', text='<script>'),
        *arrow('odom', HERE, 0.3, 0.02, colour='goal'),
        Thing('box', 'nowhere', colour='#010203'),
    ]


def test_picture_is_the_same_for_the_same_scene_and_escapes_words() -> None:
    picture = to_svg(everything(), PLACES, 'A <b> scene')
    assert picture == to_svg(everything(), PLACES, 'A <b> scene')
    texts = [each.text for each in ElementTree.fromstring(picture).iter() if each.text]
    assert {'A <b> scene', '<script>', 'odom', 'base_link'} <= set(texts)
    for colour in ('#2e7d32', '#123456', '#c62828'):
        assert f'stroke="{colour}"' in picture
    # What nobody knows the place of is left out.
    assert '#0101' not in picture
    assert 'odom<' not in to_svg([], PLACES, '', axes=False, grid=False)


def test_many_things_are_dots_and_the_large_ones_are_not() -> None:
    large = Thing('sphere', place=((0, 0, 3), HERE[1]), size=(2, 2, 2), colour='#ff0000')
    spheres = [Thing('sphere', place=((n, 0, 0), HERE[1]), size=(0.1,) * 3) for n in range(2000)]
    few = to_svg([*spheres[:20], large], PLACES, '')
    assert 'stroke-linecap' not in few
    many = to_svg([*spheres, large], PLACES, '')
    assert 'stroke-linecap' in many
    assert len(many) < 1e6
    reds = {'#' + match for match in re.findall('fill="#([0-9a-f]{2}0000)"', many)}
    assert len(reds) > 10  # it has its faces, each as bright as it is


@pytest.mark.parametrize('shape', ['points', 'line', 'lines'])
def test_of_many_marks_some_are_drawn(shape: str) -> None:
    rows = np.random.default_rng(1).uniform(-1, 1, (50_000, 3))
    cloud = Thing(shape, points=as_points(rows), colour='#123456')
    small = Thing('points', points=as_points(rows[:300]), colour='#654321')
    picture = to_svg([cloud, small], {}, '', grid=False)
    assert len(picture) < 200_000
    assert picture.count('h0') >= 300  # what has few is complete


def test_a_text_that_is_no_xml_is_readable_all_the_same() -> None:
    picture = to_svg([Thing('text', text='a\x07b')], {'\x1bodom': HERE}, 'one\ntwo\x00')
    texts = [each.text for each in ElementTree.fromstring(picture).iter() if each.text]
    assert {'a?b', '?odom', 'one\ntwo?'} <= set(texts)


def test_what_is_near_is_drawn_over_what_is_far() -> None:
    camera = camera_for([], {'odom': HERE})
    boxes = [
        Thing('box', place=((x, 0.0, 0.0), HERE[1]), size=(0.1,) * 3, colour=colour)
        for x, colour in ((0.5, '#ff0000'), (-0.5, '#0000ff'))
    ]
    assert camera.seen([boxes[0].place[0]])[0, 2] > camera.seen([boxes[1].place[0]])[0, 2]
    for order in (boxes, boxes[::-1]):
        drawn = to_svg(order, {'odom': HERE}, '', axes=False, grid=False)
        far, close = (re.findall(fill, drawn) for fill in ('fill="#..0000', 'fill="#0000..'))
        assert min(len(far), len(close)) >= 2
        assert drawn.rindex(far[-1]) < drawn.index(close[0])


def test_all_is_in_the_picture_also_what_is_large() -> None:
    for size in (0.01, 1.0, 30.0):
        box = Thing('box', size=(size, size, size))
        camera = camera_for([box], {})
        at = camera.on_paper(camera.seen(corners_of(box)))
        assert (at > 0).all()
        assert (at < (WIDTH, HEIGHT)).all()
        assert camera.seen(corners_of(box))[:, 2].min() > 0


def test_a_frame_that_is_followed_is_in_the_middle_and_nearer() -> None:
    things = [Thing('box', size=(5.0, 5.0, 0.1))]
    far, close = camera_for(things, PLACES), camera_for(things, PLACES, 'base_link')
    assert near(close.on_paper(close.seen([(1.0, 0.0, 0.0)]))[0], (WIDTH / 2, HEIGHT / 2))
    assert close.distance < far.distance / 2


def test_what_lies_behind_the_eye_is_cut_off() -> None:
    line = Thing('line', points=as_points([(0, 0, 0), (-400, -400, 0)]), colour='path')
    drawn = to_svg([line], {'odom': HERE}, '', axes=False, grid=False)
    assert 'nan' not in drawn
    assert 'stroke="#2e7d32"' in drawn


def test_the_page_has_a_colour_for_each_name() -> None:
    from labkit.views.scene_picture import COLOURS
    from labkit.views.widget import page_files

    style = page_files('scene')[1]
    assert [name for name in COLOURS if f'--labkit-{name}:' not in style] == []
