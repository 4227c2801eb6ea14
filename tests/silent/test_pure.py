"""Faults that one process can't make, or only by chance: their looks, with a scene as data."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.snapshot import Graph, GraphAction, GraphTopic
from labkit.silent.kinds import Fault
from labkit.silent.matching_faults import look_at_history, look_at_pairs, look_at_servers
from labkit.silent.message_faults import NO_STAMP, look_at_messages
from labkit.silent.name_faults import alike, look_at_names
from labkit.silent.reading import files_in
from labkit.silent.rereading import reads_only_in_init
from labkit.silent.scene import OwnNode, Publisher, Scene, Subscription, Timer
from labkit.silent.spinning_faults import look_at_spinning
from labkit.silent.timing_faults import look_at_clocks


def end(node: str, msg_type: str, type_hash: str = '') -> Endpoint:
    return Endpoint(node, '/topic', msg_type, QoSProfile(depth=1), b'', type_hash)


def pair(publisher: Endpoint, subscription: Endpoint) -> Scene:
    topic = GraphTopic('/topic', (publisher.msg_type,), (publisher,), (subscription,))
    return Scene(Graph((), (topic,)), {'/topic': 1})


def told(scene: Scene) -> list[str]:
    looks = (look_at_pairs, look_at_servers, look_at_spinning, look_at_history)
    looks = (*looks, look_at_clocks, look_at_messages)
    return [fault.kind.id for look in looks for fault in look(scene)]


def test_files_of_parameters_that_are_read_again(tmp_path: Path) -> None:
    good, pipe, endless = (str(tmp_path / name) for name in ('good', 'pipe', 'endless'))
    Path(good).write_text(
        '/robot:\n  cruiser: &c\n    ros__parameters: {a: {b: 1}}\n  other: *c\n'
    )
    os.mkfifo(pipe)  # without a writer, opening it would block
    Path(endless).write_text('&a {cruiser: *a}')
    args = [
        '--ros-args',
        *(word for path in (good, pipe, endless) for word in ('--params-file', path)),
    ]
    (file,) = files_in(args)
    assert file.sections == (('/robot/cruiser', {'a.b': 1}), ('/robot/other', {'a.b': 1}))


READER = """
class Cruiser(Node):
    def __init__(self):
        super().__init__()
        self.speed = self.get_parameter('speed').value
"""


@pytest.mark.parametrize(
    ('more', 'only'),
    [
        ('    def tick(self):\n        return self.speed', True),
        ('    size = 3\n    @property\n    def half(self):\n        return self.speed / 2', True),
        ('    def tick(self):\n        return self.get_parameter("speed")', False),
        ('        self.now = lambda: self.get_parameter("speed")', False),
        ('    @property\n    def now(self):\n        return self.get_parameter("speed")', False),
        ('    @functools.lru_cache\n    def tick(self):\n        return 3', False),
        ('    def count(self):\n        self.set_parameters([])', False),
        ('def tick(node):\n    return node.get_parameter("speed")', False),
        ('def tick(node):\n    return node.speed', True),
        ('class Helper:\n    def go(self):\n        self.node.get_parameters([])', False),
        ('class Other(Node):\n    def go(self):\n        self.get_parameters([])', True),
        ('class Cruiser(Node):\n    pass', False),
    ],
)
def test_who_reads_its_parameters_only_in_its_init(
    more: str, only: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    notebook = ModuleType('__main__')
    monkeypatch.setitem(sys.modules, '__main__', notebook)
    vars(notebook).update(Node=Path, functools=functools)
    exec(READER + more, vars(notebook))
    Cruiser = vars(notebook)['Cruiser']
    assert reads_only_in_init(Cruiser, Path, ()) is only
    # Callbacks that are made elsewhere: one that reads, and one that nobody can look into.
    for callback in (lambda: notebook.get_parameter('speed'), functools.partial(print, 1)):
        assert not reads_only_in_init(Cruiser, Path, [callback])


def test_type_of_another_package() -> None:
    mine = end('/listener', 'std_msgs/msg/String')
    assert told(pair(end('/talker', 'example_interfaces/msg/String'), mine)) == ['types.package']
    assert told(pair(end('/talker', 'std_msgs/msg/String'), mine)) == []


def test_two_versions_of_a_type() -> None:
    one, two = end('/a', 'my/msg/Own', 'RIHS01_1'), end('/b', 'my/msg/Own', 'RIHS01_2')
    assert told(pair(one, two)) == ['types.version']
    assert told(pair(one, replace(two, type_hash='RIHS01_1'))) == []
    assert told(pair(one, replace(two, type_hash=''))) == []


def test_action_with_two_types() -> None:
    two = ('a/action/Go', 'b/action/Go')
    action = GraphAction('/go', two, ('/server',), ('/client', '/other'), ('/other',))
    (fault,) = look_at_servers(Scene(Graph((), (), (), (action,)), {}))
    assert fault.kind.id == 'types.action' and fault.nodes == ('/other', '/server')
    # Two servers of two types, and each client finds one.
    assert told(Scene(Graph((), (), (), (replace(action, lost=()),)), {})) == []


def test_a_name_under_which_a_message_has_come_is_right() -> None:
    deaf = Endpoint('/bot', '/left/go', 'std_msgs/msg/String', QoSProfile(depth=1), b'')
    loud = replace(deaf, node='/talker', topic='/go')
    topics = (
        GraphTopic('/left/go', (deaf.msg_type,), (), (deaf,)),
        GraphTopic('/go', (loud.msg_type,), (loud,), ()),
    )
    for heard, ids in ((0, ['names.namespace']), (1, [])):
        sub = Subscription('/left/go', deaf.msg_type, deaf.qos, None, heard)
        scene = Scene(Graph((), topics), {}, (OwnNode('/bot', '/', subscriptions=(sub,)),))
        assert [fault.kind.id for fault in look_at_names(scene)] == ids


def test_a_slash_in_front_at_either_end_is_told() -> None:
    one = Endpoint('/robot1/driver', '/odom', 'std_msgs/msg/String', QoSProfile(depth=1), b'')
    two = replace(one, node='/robot1/base', topic='/robot1/odom')
    for deaf, loud in ((one, two), (two, one)):
        topics = (
            GraphTopic(deaf.topic, (deaf.msg_type,), (), (deaf,)),
            GraphTopic(loud.topic, (loud.msg_type,), (loud,), ()),
        )
        (fault,) = look_at_names(Scene(Graph((), topics), {}))
        assert fault.kind.id == 'names.absolute'
        assert f'{one.node} names /odom with a slash in front.' in str(fault)


def test_node_that_nobody_spins() -> None:
    timer = Timer(1.0, 'tick', None)
    node = OwnNode('/sleepy', '/', is_spun=False, timers=(timer,))
    assert told(Scene(Graph((), ()), {}, (node,))) == ['life.unspun']
    assert told(Scene(Graph((), ()), {}, (replace(node, is_spun=True),))) == []
    assert told(Scene(Graph((), ()), {}, (replace(node, timers=()),))) == []


def test_what_does_not_match_is_not_lost_in_a_queue() -> None:
    some, more = (
        QoSProfile(depth=5, reliability=r)
        for r in (ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE)
    )
    pub = Publisher('/range', 'std_msgs/msg/Int16', some, count=20)
    sub = Subscription('/range', pub.msg_type, some, None, missed=14)
    node = OwnNode('/sonar', '/', publishers=(pub,), subscriptions=(sub,))
    assert told(Scene(Graph((), ()), {'/range': 1}, (node,))) == ['qos.depth']
    reliable = replace(node, subscriptions=(replace(sub, qos=more),))
    assert told(Scene(Graph((), ()), {'/range': 1}, (reliable,))) == []


def test_stamps_of_a_node_that_makes_the_time() -> None:
    found = {NO_STAMP.id: 'the stamp in its header is 0'}
    odom = Publisher('/odom', 'nav_msgs/msg/Odometry', None, stamp=3 * 10**9)
    zero = replace(odom, stamp=0, found=found)
    clock = Publisher('/clock', 'rosgraph_msgs/msg/Clock', None)
    for pub, ids in ((odom, ['time.other-clock']), (zero, [NO_STAMP.id])):
        pub = replace(pub, qos=QoSProfile(depth=1))
        robot = OwnNode('/robot', '/', now=17 * 10**17, publishers=(pub,))
        assert told(Scene(Graph((), ()), {}, (robot,))) == ids
        robot = replace(robot, publishers=(pub, replace(clock, qos=pub.qos)))
        assert told(Scene(Graph((), ()), {}, (robot,))) == []


def test_a_graph_at_which_a_look_has_failed_is_looked_at_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from labkit.silent import watch as module

    errors = [ValueError('half known')]

    def look(scene: Scene) -> Iterator[Fault]:
        if errors:
            raise errors.pop()
        yield Fault(NO_STAMP, ('/robot',), '/odom', 'It is there.')

    monkeypatch.setattr(module, 'AT_GRAPH', (look,))
    scene, watch = Scene(Graph((), ()), {}), module.Watch()
    with pytest.raises(ValueError, match='half known'):
        watch._all(scene)
    assert [fault.text for fault in watch._all(scene)] == ['It is there.']


@pytest.mark.parametrize(
    ('one', 'two', 'how'),
    [
        ('/chatter', '/Chatter', 'case'),
        ('/cmd_vel', '/cmdVel', 'underscore'),
        ('/number', '/numbers', 'plural'),
        ('/box', '/boxes', 'plural'),
        ('/chater', '/chatter', 'spelling'),
        ('/chatetr', '/chatter', 'spelling'),
        ('/camera/image_raw', '/camera/imgae_rwa', 'spelling'),
        ('/chatter', '/chatter', ''),
        ('/chatter1', '/chatter2', ''),
        ('/chatter', '/chatter2', ''),
        ('/left', '/right', ''),
        ('/odds', '/adds', 'spelling'),
        ('/a', '/b', ''),
        ('/image_raw', '/image_gray', ''),
    ],
)
def test_which_names_are_alike(one: str, two: str, how: str) -> None:
    assert (alike(one, two), alike(two, one)) == (how, how)


def test_a_static_broadcaster_repeats_all_in_its_last_message() -> None:
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    wide = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    for topic, faults in (('/notices', ['qos.kept']), ('/tf_static', [])):
        pub = Publisher(topic, 'tf2_msgs/msg/TFMessage', latched, count=4, last=1.0)
        sub = Subscription(topic, pub.msg_type, wide, None, heard=1, since=2.0)
        nodes = (
            OwnNode('/sender', '/', publishers=(pub,)),
            OwnNode('/hearer', '/', subscriptions=(sub,)),
        )
        assert told(Scene(Graph((), ()), {topic: 1}, nodes)) == faults
