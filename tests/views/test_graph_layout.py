"""Where the parts of a graph's picture are: nothing covers anything else, and arrows lead on."""

from __future__ import annotations

import math
import random
from itertools import combinations

import pytest

from labkit.rosgraph.snapshot import Graph
from labkit.views.graph_layout import Arrow, Box
from labkit.views.graph_picture import Picture
from labkit.views.svg_drawing import MARGIN
from tests.views.graphs import (
    ALL,
    CHAIN,
    CHAT,
    ECHO,
    EYES,
    FORTY,
    LOOP,
    ROBOT,
    ROBOTS,
    graph,
    topic,
)

# Numbers are not exact.
NEAR = 0.01

each_graph = pytest.mark.parametrize('data', ALL.values(), ids=ALL)


def way(arrow: Arrow) -> list[tuple[float, float]]:
    """Return points on the way of an arrow, close to each other."""
    points, here = [arrow.begin], arrow.begin
    for kind, ends in arrow.steps:
        curve = [here, *ends]
        assert len(curve) == {'L': 2, 'Q': 3, 'C': 4}[kind]
        degree = len(curve) - 1
        for step in range(1, 41):
            t = step / 40
            parts = [
                math.comb(degree, n) * t**n * (1 - t) ** (degree - n) for n in range(degree + 1)
            ]
            points.append(
                (
                    sum(part * x for part, (x, _) in zip(parts, curve, strict=True)),
                    sum(part * y for part, (_, y) in zip(parts, curve, strict=True)),
                )
            )
        here = ends[-1]
    return points


def holds(box: Box, point: tuple[float, float], room: float = 0.0) -> bool:
    return (
        abs(point[0] - box.x) < box.width / 2 + room
        and abs(point[1] - box.y) < box.height / 2 + room
    )


def boxes(picture: Picture) -> dict[str, Box]:
    return {shape.box.name: shape.box for shape in picture.shapes}


@each_graph
@pytest.mark.parametrize('width', [900, 360])
def test_nothing_covers_anything_else(data: Graph, width: float):
    picture = Picture(data, width)
    found = boxes(picture)
    for one, other in combinations(found.values(), 2):
        apart_x = abs(one.x - other.x) - (one.width + other.width) / 2
        apart_y = abs(one.y - other.y) - (one.height + other.height) / 2
        assert max(apart_x, apart_y) > 8, (one.name, other.name)
    for line in picture.lines:
        for point in way(line.arrow):
            assert not [box.name for box in found.values() if holds(box, point, room=1)]
            assert -NEAR <= point[0] <= picture.width - 2 * MARGIN + NEAR
            assert -NEAR <= point[1] <= picture.height - 2 * MARGIN + NEAR
    for box in found.values():
        assert box.width / 2 - NEAR <= box.x <= picture.width - 2 * MARGIN - box.width / 2 + NEAR
        assert (
            box.height / 2 - NEAR <= box.y <= picture.height - 2 * MARGIN - box.height / 2 + NEAR
        )


@each_graph
def test_no_number_depends_on_the_last_bit(data: Graph):
    # Stored pictures are compared letter by letter, and floats are added otherwise since 3.12.
    picture = Picture(data)
    numbers = [value for box in boxes(picture).values() for value in (box.width, box.height)]
    assert all(isinstance(value, int) for value in numbers)
    for line in picture.lines:
        points = [
            line.arrow.begin,
            line.arrow.mark,
            *(p for _, ps in line.arrow.steps for p in ps),
        ]
        numbers += [value for point in points for value in point]
    numbers += [value for box in boxes(picture).values() for value in (box.x, box.y)]
    assert [value for value in numbers if value % 0.25] == []


@each_graph
def test_each_arrow_begins_and_ends_at_its_boxes(data: Graph):
    picture = Picture(data)
    found = boxes(picture)
    for line in picture.lines:
        points = way(line.arrow)
        assert holds(found[line.arrow.tail], points[0], room=6), line
        assert holds(found[line.arrow.head], points[-1], room=6), line


@each_graph
def test_words_at_a_line_cover_neither_boxes_nor_other_lines(data: Graph):
    picture = Picture(data)
    for line in picture.lines:
        if not line.words:
            continue
        (x, y), (width, height) = line.arrow.mark, line.arrow.words
        words = Box('', width, height, x, y + 14 + height / 2)
        if line.arrow.upright:
            words = Box('', width, height, x + 14 + width / 2, y)
        assert not [
            other.box.name
            for other in picture.shapes
            if max(
                abs(words.x - other.box.x) - (words.width + other.box.width) / 2,
                abs(words.y - other.box.y) - (words.height + other.box.height) / 2,
            )
            < 0
        ]
        for other in picture.lines:
            assert not [point for point in way(other.arrow) if holds(words, point)], other


@pytest.mark.parametrize('width', [900, 360])
def test_a_namespace_has_a_frame_with_its_parts_and_no_others(width: float):
    picture = Picture(ROBOTS, width)
    frames = {shape.box.group for shape in picture.shapes if shape.box.group}
    assert sorted(frame.name for frame in frames) == [
        *('namespace /robot1', 'namespace /robot1/arm', 'namespace /robot2', 'namespace /robot3'),
    ]
    for shape in picture.shapes:
        within = [frame.name for frame in frames if holds(frame, (shape.box.x, shape.box.y))]
        space = shape.name.rpartition('/')[0]
        assert within == ([f'namespace {space}'] if space else [])
        for frame in frames:
            if frame.name in within:
                assert abs(frame.x - shape.box.x) <= (frame.width - shape.box.width) / 2
                assert abs(frame.y - shape.box.y) <= (frame.height - shape.box.height) / 2
    for one, other in combinations(frames, 2):
        apart_x = abs(one.x - other.x) - (one.width + other.width) / 2
        apart_y = abs(one.y - other.y) - (one.height + other.height) / 2
        assert max(apart_x, apart_y) > 8
    drawn = picture.svg()
    assert all(f'>{frame.name.split()[1]}</text></g>' in drawn for frame in frames)


def test_messages_lead_to_the_right():
    found = boxes(Picture(EYES))
    row = ['node /left_eye', 'topic /sight', 'node /brain', 'topic /move', 'node /left_leg']
    assert [found[name].x for name in row] == sorted(found[name].x for name in row)
    # What belongs to a line is on it.
    assert len({round(found[name].y) for name in row[1:4]}) == 1
    assert found['node /left_eye'].x == found['node /right_eye'].x


def test_a_chain_that_is_too_long_leads_down():
    picture = Picture(CHAIN)
    found = boxes(picture)
    assert picture.width < 900
    assert len({round(box.x) for box in found.values()}) == 1
    ys = [found[f'node /stage_{number}'].y for number in range(7)]
    assert ys == sorted(ys)


def test_a_page_that_is_narrow_gets_a_picture_that_is():
    assert Picture(EYES, 900).width > 800
    assert Picture(EYES, 400).width <= 400


def test_a_loop_leads_around_the_others():
    picture = Picture(LOOP)
    bottom = max(box.y + box.height / 2 for box in boxes(picture).values())
    around = [line for line in picture.lines if max(y for _, y in way(line.arrow)) > bottom]
    assert [(line.kind, line.node, line.other) for line in around] == [('hears', '/a', '/ca')]


@pytest.mark.parametrize('data', [ECHO, CHAT], ids=['echo', 'chat'])
def test_both_directions_are_two_lines(data: Graph):
    picture = Picture(data)
    there = {line.node: way(line.arrow) for line in picture.lines if line.kind == 'publishes'}
    back = {line.node: way(line.arrow) for line in picture.lines if line.kind == 'hears'}
    for node in there.keys() & back.keys():
        ends = (there[node][0], back[node][-1])
        assert abs(ends[0][1] - ends[1][1]) > 8


def test_the_order_of_boxes_has_few_crossings():
    # As a person would draw it: none.
    picture = Picture(EYES)
    for one, other in combinations(picture.lines, 2):
        points = set(way(other.arrow))
        assert not points & set(way(one.arrow))


def test_many_nodes_are_drawn_in_reasonable_size():
    picture = Picture(FORTY)
    assert picture.width < 2500 and picture.height < 2500
    # Words can be read, in full size, though the page shows all of it smaller.
    assert len(picture.shapes) == 48


@pytest.mark.slow('hundreds of graphs')
def test_random_graphs_have_no_faults():
    chance = random.Random(7)
    for _ in range(60):
        nodes = [f'/n{number}' for number in range(chance.randint(1, 9))]
        topics = [
            topic(
                f'/t{number}',
                chance.sample(nodes, chance.randint(0, len(nodes))),
                chance.sample(nodes, chance.randint(0, len(nodes))),
            )
            for number in range(chance.randint(0, 6))
        ]
        data = graph(*topics, alone=nodes)
        for width in (900, 360):
            test_nothing_covers_anything_else(data, width)
        test_each_arrow_begins_and_ends_at_its_boxes(data)


def test_robot_drives_in_a_loop():
    picture = Picture(ROBOT)
    found = boxes(picture)
    order = [
        'node /teleop',
        'topic /cmd_vel',
        'node /turtlebot',
        'topic /odom',
        'node /controller',
    ]
    ways = [(found[name].x, found[name].y) for name in order]
    assert ways == sorted(ways) or [y for _, y in ways] == sorted(y for _, y in ways)
