"""The tree of frames: who publishes what, what is wrong with it in words, and what a page gets."""

from __future__ import annotations

import pytest

from labkit.background.domains import claim_domain
from labkit.transforms.cache import Sample
from labkit.transforms.tree import Tree
from labkit.views.frames_picture import FramesPicture, parts
from labkit.views.frames_tree import FrameEdge, FrameTree, grown, place_lines

STAGE = """
import labkit as lab
from geometry_msgs.msg import TransformStamped
from labkit.background.runtime import runtime
from rclpy.node import Node
from tf2_msgs.msg import TFMessage
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

class Says(Node):
    # Publishes where a frame is, again and again or once for ever.
    def __init__(self, name, parent, child, static=False):
        super().__init__(name)
        kind = StaticTransformBroadcaster if static else TransformBroadcaster
        self.broadcaster, self.pair = kind(self), (parent, child)
        if static:
            self.say()
        else:
            self.create_timer(0.05, self.say)

    def say(self, x=1.0):
        message = TransformStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id, message.child_frame_id = self.pair
        message.transform.translation.x, message.transform.rotation.w = x, 1.0
        self.broadcaster.sendTransform(message)

class Page:
    # What a page would get, and what it would say.
    def __init__(self, view):
        self.widget, self.known = view._widget, {}
        self.widget.send = lambda content, buffers=None: self.known.update(content)
        self.say(view='seen')

    def say(self, **content):
        self.widget._handle_custom_msg(content, [])

    def wait(self, condition):
        lab.wait_until(lambda: condition(self.known), timeout_sec=20)
"""
EYE = 'lab.spin(Says("driver", "odom", "base"))\nlab.spin(Says("mast", "base", "eye", True))'
ROBOT = """
odom
└─ base_footprint: moving, from /turtlebot
   └─ base_link: static, from /turtlebot
      ├─ base_scan: static, from /turtlebot
      ├─ camera_link: static, from /turtlebot
      │  └─ camera_rgb_frame: static, from /turtlebot
      │     └─ camera_rgb_optical_frame: static, from /turtlebot
      ├─ caster_back_link: static, from /turtlebot
      ├─ imu_link: static, from /turtlebot
      ├─ wheel_left_link: moving, from /turtlebot
      └─ wheel_right_link: moving, from /turtlebot
""".strip()
APART = (
    "Could not find a connection between '{}' and '{}' because they are not part of the same "
    'tree.Tf has two or more unconnected trees.'
)


def edge(parent: str, child: str, *authors: str, static: bool = False) -> FrameEdge:
    return FrameEdge(parent, child, static, authors or ('/a',))


def tree_of(*edges: FrameEdge) -> FrameTree:
    """Return what is found of edges, with what our tf2 says of the ways between them."""
    tree = Tree(10_000_000_000)
    for one in edges:
        place = Sample(one.parent, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
        tree.insert(one.child, 1, place, authority='', is_static=one.is_static)
    return grown(edges, lambda target, source: tree.why_not(target, source, 0))


def texts(tree: FrameTree) -> list[str]:
    return [trouble.text for trouble in tree.troubles]


# -- what is wrong, in words ----------------------------------------------------------------------


def test_a_tree_that_is_whole_has_no_trouble() -> None:
    tree = tree_of(edge('map', 'odom'), edge('odom', 'base', static=True))
    assert str(tree) == 'map\n└─ odom: moving, from /a\n   └─ base: static, from /a'
    assert (tree.roots, tree.frames) == (('map',), ('map', 'odom', 'base'))


def test_trees_that_are_not_connected_are_told_in_the_words_of_tf2() -> None:
    tree = tree_of(edge('odom', 'base'), edge('map', 'shelf'), edge('map', 'door'))
    assert texts(tree) == [APART.format('map', 'odom')]
    assert "frame_id 'map' and child_frame_id 'odom'" in tree.troubles[0].todo
    assert str(tree).endswith(f'✗ {tree.troubles[0].text}\n  → {tree.troubles[0].todo}')


def test_a_frame_with_two_parents_is_told_with_who_says_so() -> None:
    tree = tree_of(edge('map', 'base', '/b'), edge('odom', 'base'), edge('base', 'scan'))
    (told,) = texts(tree)
    assert told == (
        'base has two parents: map (from /b) and odom (from /a). A frame has one: the last that '
        'tf2 has heard counts, so the tree changes all the time.'
    )
    assert str(tree).count('scan') == 1
    assert 'base (see above): moving, from /a' in str(tree)


def test_two_parents_of_a_static_frame_do_not_take_turns() -> None:
    (told,) = texts(tree_of(edge('map', 'lamp', static=True), edge('odom', 'lamp', static=True)))
    assert told.endswith('the last that tf2 has heard is all that counts.')


def test_a_loop_is_told_once_and_ends() -> None:
    tree = tree_of(edge('a', 'b'), edge('b', 'c'), edge('c', 'a'), edge('map', 'odom'))
    assert texts(tree) == ['The tf tree is invalid because it contains a loop.']
    assert tree.frames == ('a', 'b', 'c', 'map', 'odom')
    assert 'a (see above)' in str(tree)


def test_two_nodes_that_say_the_same_are_told_but_not_if_either_may() -> None:
    (told,) = texts(tree_of(edge('odom', 'base', '/a', '/b')))
    assert told.startswith('/a and /b both publish where base is in odom')
    unsure = FrameEdge('odom', 'base', authors=('/a', '/b'), is_certain=False)
    assert not tree_of(unsure).troubles
    assert str(tree_of(unsure)) == 'odom\n└─ base: moving, from /a or /b'


def test_nothing_at_all_is_an_empty_tree() -> None:
    assert (str(tree_of()), tree_of().roots) == ('', ())


@pytest.mark.parametrize(
    ('turn', 'told'),
    [
        ((0.0, 0.0, 0.0, 1.0), ['yaw = 0.0°']),
        ((0.0, 0.0, 0.7071068, 0.7071068), ['yaw = 90.0°']),
        ((0.7071068, 0.0, 0.0, 0.7071068), ['roll = 90.0°', 'pitch = 0.0°', 'yaw = 0.0°']),
    ],
)
def test_a_place_is_told_in_metres_and_degrees(turn, told) -> None:
    assert place_lines(((1.0, -0.00001, 0.5), turn)) == [
        *('x = 1.000 m', 'y = 0.000 m', 'z = 0.500 m'),
        *told,
    ]


# -- the drawing ----------------------------------------------------------------------------------


def test_each_part_of_the_drawing_tells_who_publishes_it_and_what_is_wrong() -> None:
    tree = tree_of(edge('odom', 'base'), edge('base', 'scan', static=True), edge('map', 'door'))
    picture = FramesPicture(tree)
    told = parts(picture, tree)
    lines = [line.kind for line in picture.lines]
    assert sorted(lines) == ['apart', 'holds', 'holds', 'holds']
    assert ['Frame scan', 'In base, static', 'Published by /a on /tf_static'] in told.values()
    apart = told[f'a{lines.index("apart")}']
    assert apart[0] == 'odom and map'
    assert apart[1] == f'✗ {APART.format("odom", "map")}'
    drawn = picture.svg()
    assert 'class="cross"' in drawn
    assert 'not connected' in drawn
    assert [shape.name for shape in picture.shapes if shape.wrong] == ['odom', 'map']


def test_the_drawing_of_a_frame_with_two_parents_crosses_both_ways() -> None:
    tree = tree_of(edge('map', 'base', '/b'), edge('odom', 'base'))
    picture = FramesPicture(tree)
    assert [(line.kind, line.words[-1]) for line in picture.lines] == [
        ('apart', 'from /b'),
        ('apart', 'from /a'),
    ]
    assert len(picture.shapes) == 3
    assert picture.svg() == FramesPicture(tree).svg()


def test_names_of_others_are_text_in_the_drawing() -> None:
    drawn = FramesPicture(tree_of(edge('<b>', 'x"&'))).svg()
    assert '<b>' not in drawn
    assert '&lt;b&gt;' in drawn


# -- what is heard --------------------------------------------------------------------------------


def test_the_text_form_has_all_frames_and_is_the_same_each_time(run_still) -> None:
    run_still('robot = lab.spin(lab.Turtlebot())')
    data = run_still('lab.frames()').outputs[0]['data']
    assert set(data) == {'text/plain', 'image/svg+xml'}
    assert data['text/plain'] == ROBOT
    assert run_still('lab.frames()').outputs[0]['data'] == data
    assert run_still('print(lab.frames())').text.strip() == ROBOT
    # Who has looked has left nothing behind.
    topics = 'print([s.topic_name for s in runtime.helper.subscriptions if "tf" in s.topic_name])'
    assert run_still(topics).text.strip() == '[]'


def test_without_any_transform_it_says_what_to_do(run_still) -> None:
    data = run_still('lab.frames()').outputs[0]['data']
    assert set(data) == {'text/plain'}
    assert 'Start a robot with lab.spin(lab.Turtlebot())' in data['text/plain']


def test_each_publisher_of_this_process_is_named(run_still) -> None:
    run_still(EYE)
    assert run_still('print(lab.frames())').text.strip() == (
        'odom\n└─ base: moving, from /driver\n   └─ eye: static, from /mast'
    )
    # A static transform of a node that is gone is not there any more.
    run_still('lab.remove("mast")')
    assert 'eye' not in run_still('print(lab.frames())').text


def test_two_parents_are_both_there_with_their_nodes(run_still) -> None:
    run_still('lab.spin(Says("driver", "odom", "base"))\nlab.spin(Says("thief", "map", "base"))')
    text = run_still('print(lab.frames())').text
    assert 'base has two parents: map (from /thief) and odom (from /driver).' in text


def test_what_tf2_does_not_take_is_told_in_its_words(run_still) -> None:
    run_still('lab.spin(Says("driver", "odom", "base"))\nlab.spin(Says("narcissus", "me", "me"))')
    text = run_still('print(lab.frames())').text
    assert '✗ TF_SELF_TRANSFORM: Ignoring transform' in text
    assert 'because they are the same' in text


def test_the_way_between_two_frames_has_numbers(run_still) -> None:
    run_still(EYE)
    data = run_still('lab.frames("odom", "eye")').outputs[0]['data']
    assert data['text/plain'] == (
        'eye in odom: x = 2.000 m, y = 0.000 m, z = 0.000 m, yaw = 0.0°\nodom\n'
        '└─ base: moving, from /driver: x = 1.000 m, y = 0.000 m, z = 0.000 m, yaw = 0.0°\n'
        '   └─ eye: static, from /mast: x = 1.000 m, y = 0.000 m, z = 0.000 m, yaw = 0.0°'
    )
    assert 'eye in odom: x = 2.000 m' in data['image/svg+xml']
    # One frame: in the root of its tree; the other way round: the inverse.
    assert run_still('print(lab.frames("eye"))').text.startswith('eye in odom: x = 2.000 m')
    assert run_still('print(lab.frames("eye", "odom"))').text.startswith('odom in eye: x = -2.0')


def test_a_way_that_is_not_there_is_told_in_the_words_of_tf2(run_still) -> None:
    run_still('lab.spin(Says("driver", "odom", "base"))')
    text = run_still('print(lab.frames("odom", "bsae"))').text
    assert '"bsae" passed to lookupTransform argument source_frame does not exist.' in text
    assert "Did you mean 'base'?" in text
    assert '└─ base: moving, from /driver' in text


def test_names_that_are_none_are_refused(kernel) -> None:
    result = kernel.run('import labkit as lab\nlab.frames("a", "b", "c")')
    assert 'takes up to two names' in result.traceback
    assert 'LabError' in kernel.run('lab.frames(3)').traceback


# -- the page -------------------------------------------------------------------------------------


def test_the_page_gets_rate_and_age_and_the_stored_form_does_not(run) -> None:
    run(EYE)
    run('view = lab.frames()\npage = Page(view)')
    run('page.wait(lambda known: any(" Hz, " in rate for rate in known["rates"].values()))')
    assert run('print(sorted(known[0] for known in page.known["parts"].values()))') == (
        "['Frame base', 'Frame eye', 'Frame odom', 'base in odom', 'eye in base']"
    )
    small = run('print([line for lines in page.known["small"].values() for line in lines])')
    assert small.count(' Hz, ') == 1
    assert "'static'" in small
    assert ' Hz' not in run('print(view._stored_form())')
    # It ends with the view, and leaves nothing.
    run('view.close()')
    topics = 'print([s.topic_name for s in runtime.helper.subscriptions if "tf" in s.topic_name])'
    assert run(topics) == '[]'


@pytest.mark.slow('waits in real time')
def test_the_page_follows_what_comes_and_goes(run) -> None:
    run('page = Page(lab.frames())')
    assert 'Start a robot' in run('print(page.known["empty"])')
    run('lab.spin(Says("driver", "odom", "base"))')
    run('page.wait(lambda known: "base in odom" in known["told"])')
    assert run('print(repr(page.known["empty"]))') == "''"
    run('lab.spin(Says("thief", "map", "base"))')
    run('page.wait(lambda known: "two parents" in known["told"])')
    run('lab.remove("thief")\npage.wait(lambda known: "two parents" not in known["told"])')
    run('lab.remove("driver")\npage.wait(lambda known: not known["svg"])')
    assert 'Start a robot' in run('print(page.known["empty"])')


def test_when_ros_is_stopped_the_last_picture_stays(run) -> None:
    run('lab.spin(Says("driver", "odom", "base"))\nview = lab.frames()\npage = Page(view)')
    run('page.wait(lambda known: known["svg"])\nlab.stop()')
    assert run('print(page.known["ended"])').startswith('ROS was stopped.')
    assert run('print(view._stored_form()["text/plain"])') == (
        'odom\n└─ base: moving, from /driver'
    )
    assert run('page.say(view="seen")\nprint("base in odom" in page.known["told"])') == 'True'
    assert run('print(runtime.started)') == 'False'


def test_who_looks_is_hidden_from_the_graph(run) -> None:
    run('lab.spin(Says("driver", "odom", "base"))\npage = Page(lab.frames())')
    run('page.wait(lambda known: known["svg"])')
    assert run('print(lab.graph(live=False))') == (
        'Nodes:\n  /driver\nTopics:\n  /tf [tf2_msgs/msg/TFMessage]\n    published by /driver'
    )


# -- other processes ------------------------------------------------------------------------------


@pytest.mark.slow('starts three kernels')
def test_publishers_of_other_processes_are_told_apart_as_far_as_they_can_be(start_kernel) -> None:
    claim = claim_domain()
    env = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_DOMAIN_ID': str(claim.domain_id)}
    here = start_kernel(LABKIT_HEADLESS='1', **env)

    def until(words: str) -> None:
        # Each look waits until nothing new has come for a second.
        found = f'next(text for text in looks if {words!r} in text)'
        looked = here.run(f'looks = (str(lab.frames()) for _ in range(40))\nprint({found})')
        assert words in looked.text

    assert not here.run(STAGE + 'lab.spin(Says("driver", "odom", "base"))').error
    first, second = start_kernel(**env), start_kernel(**env)
    assert not first.run(STAGE + 'lab.spin(Says("first", "base", "eye", True))').error
    until('eye: static')
    assert 'eye: static, from /first\n' in here.run('print(lab.frames())').text
    # Of two, each may have sent each: nothing is made up, and it is no fault.
    assert not second.run(STAGE + 'lab.spin(Says("second", "base", "ear", True))').error
    until('ear: static')
    text = here.run('print(lab.frames())').text
    assert 'eye: static, from /first or /second' in text
    assert 'base: moving, from /driver\n' in text
    assert '✗' not in text
    # Another node says where base is, too.
    assert not second.run('lab.spin(Says("third", "odom", "base"))').error
    until('/driver and /third both publish')
    claim.close()
