"""Frames of which a scene tells, as data: what is told, and what looks similar and is not."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped

from labkit.asking.traffic import Sent
from labkit.rosgraph.snapshot import Graph
from labkit.silent.broadcasts import note_transforms
from labkit.silent.frame_faults import look_at_frames
from labkit.silent.kinds import Fault
from labkit.silent.message_faults import look_at_messages
from labkit.silent.scene import Broadcast, Listening, OwnNode, Publisher, Scene
from labkit.silent.timing_faults import look_at_clocks
from labkit.transforms.tree import Edge

NOW = 100.0
STAMP = 1_700_000_000 * 10**9
TYPE = 'tf2_msgs/msg/TFMessage'


def speaker(name: str, *sent: Broadcast, topic: str = '/tf') -> OwnNode:
    """Make a node that says so on /tf."""
    last = max(each.last for each in sent)
    pub = Publisher(topic, TYPE, None, 9, 0.0, last, broadcasts=sent)
    return OwnNode(name, '/', now=STAMP, publishers=(pub,))


def often(parent: str, child: str, **more: Any) -> Broadcast:
    return Broadcast(parent, child, **{'first': 90.0, 'last': NOW, 'count': 50, **more})


def scene(
    *nodes: OwnNode, hears: dict[str, str] | None = None, count: int = 0, **more: Any
) -> Scene:
    """Make a scene, with a listener if it hears something: child -> parent."""
    listeners = ()
    if hears is not None:
        latest, heard = more.pop('latest', STAMP), more.pop('heard', NOW)
        edges = tuple(
            Edge(child, parent, 'me', 30.0, latest, latest, heard)
            for child, parent in hears.items()
        )
        listeners = (Listening('/ear', edges, frozenset((*hears, *hears.values())), **more),)
        nodes = (*nodes, OwnNode('/ear', '/', now=STAMP))
    own = sum(pub.topic != '/scan' for node in nodes for pub in node.publishers)
    return Scene(Graph((), ()), {'/tf': count or own}, nodes, now=NOW, listeners=listeners)


def told(scene: Scene) -> list[str]:
    return [fault.kind.id for fault in faults(scene)]


def faults(scene: Scene) -> list[Fault]:
    return list(look_at_frames(scene))


ODOM = {'base': 'odom'}


def test_a_frame_in_a_header_that_nobody_publishes() -> None:
    scan = Publisher('/scan', 'sensor_msgs/msg/LaserScan', None, frame='base_scn')
    laser = OwnNode('/laser', '/', publishers=(scan,))
    robot = speaker('/robot', often('odom', 'base'), often('base', 'base_scan'))
    (fault,) = faults(scene(laser, robot))
    assert str(fault) == (
        '/laser publishes on /scan in the frame base_scn, but nobody publishes where that is.'
    )
    assert (fault.kind.id, fault.nodes) == ('frames.unknown', ('/laser',))
    assert fault.advice == "Did you mean 'base_scan'?"
    # Frames of another process that nobody here hears; then somebody does.
    assert told(replace(scene(laser, robot), publishers={'/tf': 3, '/tf_static': 1})) == []
    assert told(scene(laser, hears=ODOM, count=2)) == ['frames.unknown']
    assert told(scene(laser, hears={'base_scn': 'odom'}, count=2)) == []
    # There are no frames at all; the slash in front is another kind.
    assert told(scene(laser)) == told(scene(laser, hears={})) == []
    slash = replace(laser, publishers=(replace(scan, frame='/base'),))
    assert told(scene(slash, robot)) == []
    # A simulator's truth is in its own world.
    truth = replace(laser, publishers=(replace(scan, topic='/base_pose_ground_truth'),))
    assert told(scene(truth, robot)) == []


def test_a_frame_that_is_asked_for() -> None:
    asked = {('odom', 'bsae'): 3.0}
    (fault,) = faults(scene(hears=ODOM, count=2, asked=asked))
    assert str(fault) == '/ear asks for the frame bsae, which nobody publishes.'
    assert fault.advice == "Did you mean 'base'?"
    # For how long, and whether anything can come.
    assert told(scene(hears=ODOM, count=2, asked={('odom', 'bsae'): 1.0})) == []
    assert told(scene(hears={}, count=2, asked=asked)) == []
    silent = faults(scene(hears={}, asked=asked))
    assert [fault.about for fault in silent] == ['odom', 'bsae']
    assert str(silent[0]).endswith('Nobody publishes on /tf or /tf_static at all.')


def test_two_parents() -> None:
    one, two = speaker('/a', often('odom', 'base')), speaker('/b', often('map', 'base'))
    (fault,) = faults(scene(one, two))
    assert (fault.kind.id, fault.nodes) == ('frames.two-parents', ('/a', '/b'))
    # The nodes come in any order; the fault stays the same.
    assert [str(same) for same in faults(scene(two, one))] == [str(fault)]
    # Wherever one looks: at the nodes, and at the topic.
    assert fault.names == ('/a', '/b', 'base', '/tf')
    # One after the other; and once a thing is picked up, the parent is another one.
    early = speaker('/a', often('odom', 'base', last=98.0))
    late = speaker('/b', often('map', 'base', first=98.5))
    assert 'frames.two-parents' not in told(scene(early, late))
    picked = speaker('/a', often('table', 'cup', last=99.0), often('hand', 'cup', first=99.1))
    assert 'frames.two-parents' not in told(scene(picked))
    torn = speaker('/a', often('table', 'cup'), often('hand', 'cup', first=99.1))
    assert 'frames.two-parents' in told(scene(torn))
    # One of them has ended long ago.
    assert told(scene(one, speaker('/b', often('map', 'base', last=90.0)))) == []
    # On /tf_static the last message counts, and what it lacks is nothing.
    fixed = speaker('/b', often('map', 'base', count=1), topic='/tf_static')
    assert 'frames.two-parents' in told(scene(one, fixed))
    old = often('map', 'base', count=1, last=50.0), often('map', 'other', count=1)
    fixed = speaker('/b', *old, topic='/tf_static')
    assert 'frames.two-parents' not in told(scene(one, fixed))


def test_two_parents_that_are_heard() -> None:
    def moves(*times: float) -> dict[str, tuple[tuple[float, str, str], ...]]:
        names = ('odom', 'map') * len(times)
        steps = [(time, *names[n : n + 2]) for n, time in enumerate(times)]
        return {'base': tuple(steps)}  # type: ignore[arg-type]

    (fault,) = faults(scene(hears=ODOM, count=2, moves=moves(98.0, 98.5, 99.0)))
    assert (fault.kind.id, fault.about) == ('frames.two-parents', 'base')
    assert '/ear hears that base is in odom and in map, in turns' in str(fault)
    assert told(scene(hears=ODOM, count=2, moves=moves(99.0))) == []
    assert told(scene(hears=ODOM, count=2, moves=moves(10.0, 11.0, 12.0))) == []


def test_two_publishers_of_one_frame() -> None:
    one, two = (speaker(name, often('odom', 'base')) for name in ('/driver', '/filter'))
    assert told(scene(one, two)) == ['frames.two-publishers']
    fixed = [
        speaker(name, often('odom', 'base', count=1, place=(x,)), topic='/tf_static')
        for name, x in (('/a', 1.0), ('/b', 1.0), ('/c', 2.0))
    ]
    assert told(scene(*fixed[:2])) == []
    assert told(scene(*fixed[1:])) == ['frames.two-publishers']
    assert told(scene(one, fixed[0])) == ['frames.two-publishers']


def test_a_loop() -> None:
    (fault,) = faults(scene(hears={'a': 'b', 'b': 'c', 'c': 'a', 'd': 'a'}, count=2))
    assert (fault.kind.id, fault.nodes, fault.about) == ('frames.loop', ('/ear',), 'a')
    assert 'a is in b, b is in c, c is in a.' in str(fault)
    loop = scene(hears={'a': 'b', 'b': 'a'}, count=2)
    twice = replace(loop, listeners=(*loop.listeners, replace(loop.listeners[0], node='/b')))
    assert told(twice) == ['frames.loop']
    # Mended, and still in the buffer: not under the cell of who has mended it.
    right = speaker('/robot', often('a', 'b'))
    for heard, count in ((NOW - 10.0, 2), (NOW, 1)):
        mended = scene(right, hears={'a': 'b', 'b': 'a'}, heard=heard, count=count)
        (fault,) = faults(mended)
        assert (fault.kind.id, fault.nodes, fault.aloud) == ('frames.loop', ('/ear',), False)
        assert fault.todo.startswith('It may be mended meanwhile')
    # In itself, which tf2 ignores, but its publisher does not know.
    (fault,) = faults(scene(speaker('/robot', often('base', 'base'))))
    assert (fault.kind.id, fault.nodes) == ('frames.loop', ('/robot',))
    assert told(scene(hears={'b': 'a', 'c': 'b', 'd': 'a'}, count=2)) == []


def test_trees_that_are_apart() -> None:
    hears = {'base': 'odom', 'lens': 'bsae'}
    (fault,) = faults(scene(hears=hears, count=2, asked={('odom', 'lens'): 3.0}))
    assert fault.kind.id == 'frames.apart' and fault.is_aloud
    assert str(fault) == (
        '/ear asks where lens is in odom, but nothing connects them: lens is in the tree of bsae, '
        'odom in that of odom.'
    )
    assert fault.advice.startswith("Did you mean 'base'?")
    # Nobody asks, or not for long: it is there for those who look.
    for asked in ({}, {('odom', 'lens'): 1.0}, {('odom', 'base'): 9.0}):
        (fault,) = faults(scene(hears=hears, count=2, asked=asked))
        assert fault.kind.id == 'frames.apart' and not fault.is_aloud
    fleet = {'a/base': 'a/odom', 'b/base': 'b/odom'}
    assert told(scene(hears=fleet, count=2)) == []
    assert told(scene(hears=fleet, count=2, asked={('a/odom', 'b/base'): 3.0})) == ['frames.apart']


@pytest.mark.parametrize(
    ('ahead', 'kind'),
    [
        *((-0.5, ''), (-9.0, ''), (0.5, ''), (5.0, 'time.future'), (-60.0, 'frames.clock')),
        *((1e9, 'frames.clock'), (-1.6e9, 'frames.clock')),
    ],
)
def test_times_of_another_clock(ahead: float, kind: str) -> None:
    stamp = STAMP + int(ahead * 1e9)
    assert told(scene(hears=ODOM, count=2, latest=stamp)) == [kind] * bool(kind)
    # It is long ago that the last one came; it does not move; it is told of who sends it here.
    assert told(scene(hears=ODOM, count=2, latest=stamp, heard=50.0)) == []
    assert told(scene(hears=ODOM, count=2, latest=0)) == []
    robot = speaker('/robot', often('odom', 'base'))
    assert told(scene(robot, hears=ODOM, count=2, latest=stamp)) == []


def test_what_is_on_the_wrong_topic() -> None:
    once = often('odom', 'base', count=1, last=90.0)
    (fault,) = faults(scene(speaker('/a', once)))
    assert fault.kind.id == 'frames.once' and not fault.is_aloud
    assert told(scene(speaker('/a', often('odom', 'base', count=1)))) == []
    assert told(scene(speaker('/a', once, topic='/tf_static'))) == []
    mover = often('odom', 'base', count=6, changes=5, first=98.0)
    assert told(scene(speaker('/a', mover, topic='/tf_static'))) == ['frames.static-moves']
    assert told(scene(speaker('/a', mover))) == []
    for quiet in ({'changes': 0}, {'first': 50.0}, {'last': 90.0}):
        node = speaker('/a', replace(mover, **quiet), topic='/tf_static')
        assert told(scene(node)) == [], quiet


def transform(child: str, x: float = 0.0, w: float = 1.0, sec: int = 5) -> TransformStamped:
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id, made.header.stamp.sec = '/odom', sec
    made.transform.translation.x, made.transform.rotation.w = x, w
    return made


def of_messages(sent: Sent, topic: str) -> list[str]:
    pub = Publisher(topic, TYPE, None, found=sent.found, stamp=sent.stamp)
    node = OwnNode('/robot', '/', now=4 * 10**9, publishers=(pub,))
    scene = Scene(Graph((), ()), {}, (node,))
    return [
        f'{fault.kind.id}: {fault}'
        for look in (look_at_messages, look_at_clocks)
        for fault in look(scene)
    ]


def test_each_message_is_noted_and_its_numbers_now_and_then() -> None:
    sent = Sent(last=1.0)
    note_transforms(sent, [transform('a'), transform('b', w=0.0)], '/tf')
    # Right after that, another frame, which one message alone would not have told of.
    sent.last = 1.1
    note_transforms(sent, [transform('c', x=math.nan, sec=0)], '/tf')
    assert sent.each and [(key, each.count) for key, each in sent.parts.items()] == [
        *((('/odom', name), 1) for name in 'abc')
    ]
    assert of_messages(sent, '/tf') == [
        'messages.quaternion-zero: /robot publishes on /tf (TFMessage): in the transform of b, '
        'transform.rotation is (0, 0, 0, 0), which is no orientation.',
        'messages.stamp-zero: /robot publishes on /tf (TFMessage): in the transform of c, the '
        'stamp in its header is 0.',
        'messages.nan: /robot publishes on /tf (TFMessage): in the transform of c, x of '
        'transform.translation is not a number.',
    ]
    assert {each.parent for each in sent.parts.values()} == {'odom'}
    sent.last = 1.2
    note_transforms(sent, [transform('a', x=1.0)], '/tf')
    assert sent.parts['/odom', 'a'].changes == 0
    sent.last = 2.0
    note_transforms(sent, [transform('a', x=1.0), transform('b')], '/tf')
    assert (sent.parts['/odom', 'a'].changes, sent.parts['/odom', 'a'].count) == (1, 3)
    # What is mended is told no more; what is not sent any more neither.
    assert [line.partition(':')[0] for line in of_messages(sent, '/tf')] == [
        *('messages.stamp-zero', 'messages.nan')
    ]
    sent.last = 5.0
    note_transforms(sent, [transform('a')], '/tf')
    assert of_messages(sent, '/tf') == []
    sent.last = 6.0
    note_transforms(sent, [transform('a', sec=60)], '/tf')
    (line,) = of_messages(sent, '/tf')
    assert line.startswith('time.future: The stamp of the last message of /robot on /tf is 56 s')


def test_what_does_not_move_has_no_time() -> None:
    for sec in (0, 60):
        sent = Sent(last=1.0)
        note_transforms(sent, [transform('a', sec=sec)], '/tf_static')
        assert of_messages(sent, '/tf_static') == []
