"""Markers as shapes: every kind, what is none, and how long they are there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
import pytest
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from labkit.views.scene_markers import MOST_SOLIDS, marker_things
from labkit.views.scene_things import HERE, Thing, corners_of

ENDS = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 2.0, 1.0)]


def red() -> ColorRGBA:
    return ColorRGBA(r=1.0, a=0.5)


def marker(
    kind: int, *, points: Iterable[tuple[float, float, float]] = (), **more: object
) -> Marker:
    made = Marker(type=kind, color=red(), **more)
    made.header.frame_id = 'map'
    made.scale.x, made.scale.y, made.scale.z = 1.0, 2.0, 3.0
    made.points = [Point(x=x, y=y, z=z) for x, y, z in points]
    return made


def only(made: Marker) -> Thing:
    (thing,), why = marker_things(made, 'map', HERE)
    assert why == ''
    return thing


@pytest.mark.parametrize(
    ('kind', 'shape'),
    [(Marker.CUBE, 'box'), (Marker.SPHERE, 'sphere'), (Marker.CYLINDER, 'cylinder')],
)
def test_solids(kind: int, shape: str) -> None:
    made = marker(kind)
    made.pose.position.z = 4.0
    thing = only(made)
    assert (thing.shape, thing.frame, thing.size) == (shape, 'map', (1, 2, 3))
    assert (thing.colour, thing.alpha, thing.place[0]) == ('#ff0000', 0.5, (0, 0, 4))


@pytest.mark.parametrize(
    ('kind', 'shape'),
    [
        (Marker.LINE_STRIP, 'line'),
        (Marker.LINE_LIST, 'lines'),
        (Marker.POINTS, 'points'),
        (Marker.TRIANGLE_LIST, 'mesh'),
    ],
)
def test_shapes_of_points_with_and_without_colours(kind: int, shape: str) -> None:
    thing = only(marker(kind, points=ENDS))
    assert thing.shape == shape
    assert np.array_equal(thing.points, ENDS)
    assert thing.colours is None
    if kind != Marker.TRIANGLE_LIST:
        assert (thing.width, thing.metres) == (1.0, True)
    coloured = marker(kind, points=ENDS, colors=[red(), ColorRGBA(g=1.0, a=1.0), red()])
    coloured.color.a = 0.0
    thing = only(coloured)
    assert thing.colours.tolist() == [[255, 0, 0, 128], [0, 255, 0, 255], [255, 0, 0, 128]]
    assert thing.colour == '#ffffff'


@pytest.mark.parametrize('kind', [Marker.CUBE_LIST, Marker.SPHERE_LIST])
def test_lists_are_many_solids_or_points_if_they_are_too_many(kind: int) -> None:
    things, why = marker_things(marker(kind, points=ENDS), 'map', HERE)
    assert (why, len(things)) == ('', 3)
    assert [thing.place[0] for thing in things] == ENDS
    assert only(marker(kind, points=ENDS * MOST_SOLIDS)).shape == 'points'


def test_arrows_of_a_pose_and_of_points() -> None:
    made = marker(Marker.ARROW)
    (shaft, head), _ = marker_things(made, 'map', HERE)
    assert np.allclose(corners_of(head)[:, 0].max(), 1.0)
    assert np.allclose(shaft.size[0], 2.0)
    (shaft, head), _ = marker_things(marker(Marker.ARROW, points=ENDS[:2]), 'map', HERE)
    reach = np.concatenate([corners_of(shaft), corners_of(head)])
    # Its head is 3 m long, which is more than there is.
    assert np.allclose(corners_of(head)[:, 1].max() - corners_of(head)[:, 1].min(), 3.0)
    assert np.isfinite(reach).all()
    steep, _ = marker_things(marker(Marker.ARROW, points=ENDS[1:]), 'map', HERE)
    assert corners_of(steep[1])[:, 2].max() > 1.0


def test_a_text_is_as_long_as_can_be_read() -> None:
    assert only(marker(Marker.TEXT_VIEW_FACING, text='x' * 1000)).text == 'x' * 200


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        (lambda made: setattr(made.color, 'a', 0.0), 'alpha 0'),
        (lambda made: setattr(made.scale, 'y', 0.0), 'scale is 0'),
        (lambda made: setattr(made.scale, 'y', math.nan), 'none that can be drawn'),
        (lambda made: setattr(made.pose.position, 'x', math.inf), 'none that can be drawn'),
        (lambda made: setattr(made, 'type', 99), 'it has no points'),
        (lambda made: setattr(made, 'type', Marker.LINE_STRIP), 'it has no points'),
        (lambda made: setattr(made, 'type', Marker.MESH_RESOURCE), 'mesh'),
    ],
)
def test_what_is_not_drawn_has_a_reason(change: Callable[[Marker], None], words: str) -> None:
    made = marker(Marker.CUBE)
    change(made)
    things, why = marker_things(made, 'map', HERE)
    assert things == []
    assert words in why


def test_an_unknown_kind_and_a_point_that_is_nowhere_are_told() -> None:
    assert marker_things(marker(99, points=ENDS), '', HERE)[1] == 'nothing is known of its type 99'
    nowhere = marker(Marker.POINTS, points=[(math.nan, 0.0, 0.0)])
    assert 'a place of its points' in marker_things(nowhere, '', HERE)[1]
    assert 'two points' in marker_things(marker(Marker.ARROW, points=ENDS[:1]), '', HERE)[1]


# -- in a scene -----------------------------------------------------------------------------------

STAGE = """
import labkit as lab
from geometry_msgs.msg import TransformStamped
from labkit.background.runtime import runtime
from labkit.views.placed_frames import PlacedFrames
from labkit.views.scene_marker_display import MarkersDisplay
from visualization_msgs.msg import Marker, MarkerArray

lab.start()
frames = PlacedFrames(runtime.helper)

def be_at(x, sec):
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = 'map', 'cart'
    message.header.stamp.sec = sec
    message.transform.translation.x, message.transform.rotation.w = x, 1.0
    frames.heard.set_transform(message, 'test')

def marker(number, sec=0, frame='cart', **more):
    made = Marker(ns='n', id=number, type=Marker.CUBE, **more)
    made.header.frame_id, made.header.stamp.sec = frame, sec
    made.scale.x = made.scale.y = made.scale.z = made.color.a = 1.0
    return made

def show(*markers):
    display.take(MarkerArray(markers=markers))
    return look()

def look(fixed='map'):
    frames.why.clear()
    found = display.things(frames, fixed)
    return {name: (thing.frame, thing.place[0][0]) for name, thing in found.items()}

display = MarkersDisplay('/marks', is_on=True)
be_at(1.0, 10)
be_at(2.0, 20)
"""


def test_a_marker_stays_where_its_frame_was_or_moves_with_it(run: Callable[[str], str]) -> None:
    assert run('print(show(marker(1, 10), marker(2), marker(3, 10, frame_locked=True)))') == (
        "{'n 1 0': ('', 1.0), 'n 2 0': ('cart', 0.0), 'n 3 0': ('cart', 0.0)}"
    )
    # It waits for the transforms of its time.
    assert "'n 4 0'" not in run('print(show(marker(4, 30)))')
    assert "'n 4 0': ('', 3.0)" in run('be_at(3.0, 30); print(look())')
    assert "'n 1 0': ('', 0.0)" in run('print(look("cart"))')


def test_markers_are_taken_away_and_end(run: Callable[[str], str]) -> None:
    run('show(marker(1), marker(2), marker(3))')
    assert run('print(list(show(marker(2, action=Marker.DELETE))))') == "['n 1 0', 'n 3 0']"
    assert run('print(show(marker(2, action=Marker.DELETEALL)))') == '{}'
    run('brief = marker(5)\nbrief.lifetime.nanosec = 1\nshow(brief)')
    assert run('print(look())') == '{}'
    # The same again is the same object, so that it is not sent again.
    run('show(marker(1)); one = display.things(frames, "map")["n 1 0"]; show(marker(1))')
    assert run('print(display.things(frames, "map")["n 1 0"] is one)') == 'True'


def test_why_a_marker_is_not_there_is_told(run: Callable[[str], str]) -> None:
    run("show(marker(1, frame='moon'))")
    why = run("print(frames.why['/marks'])")
    assert why.startswith('/marks, marker n 1 can\'t be drawn in map: "moon" passed')
    run('one = marker(2); one.scale.x = 0.0; show(marker(1, action=Marker.DELETE), one)')
    assert 'marker n 2: ' in run("print(frames.why['/marks'])")


def test_of_many_markers_that_are_not_there_one_reason_is_told(run: Callable[[str], str]) -> None:
    run("show(*(marker(n, frame='moon') for n in range(2050)))")
    assert run('print(list(frames.why), len(look()))') == "['/marks'] 0"
    why = run("print(frames.why['/marks'])")
    assert why.count('lookupTransform') == 1
    assert why.endswith(
        'Not drawn either: 1999 more markers. /marks: only the first 2000 markers are drawn.'
    )
    run('show(marker(1, action=Marker.DELETEALL))')
    assert run('print(frames.why)') == '{}'
