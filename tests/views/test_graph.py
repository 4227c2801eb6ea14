"""The picture of the graph: what it says of real nodes, and that names have no power over it."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from labkit.rosgraph.snapshot import Graph, GraphService
from labkit.views.graph import GraphView
from labkit.views.graph_fold import fold, spaces_of
from labkit.views.graph_picture import Picture
from labkit.views.graph_words import description, in_lines
from tests.views.graphs import ALL, APART, EYES, INT16, OFFERS, ROBOTS, STRING, graph, topic

SVG = '{http://www.w3.org/2000/svg}'
NODES = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
lab.start()
talker, listener = lab.spin(Node('talker')), lab.spin(Node('listener'))
talker.create_publisher(String, 'chatter', 10)
listener.create_subscription(String, 'chatter', lambda msg: None, 10)
"""
# Each part of an SVG that is an arrow: kind, node, name of the other end.
ARROWS = """
from labkit.views.graph_picture import Picture
def arrows(data):
    lines = Picture(data).lines
    return sorted((line.kind, line.node, line.other, ' '.join(line.words)) for line in lines)
"""


def shown(result):
    assert not result.error, result.traceback
    return result.outputs[0]['data']


def lines(data: Graph) -> list[tuple[str, str, str]]:
    return [(line.kind, line.node, line.other) for line in Picture(data).lines]


def parsed(data: Graph) -> ElementTree.Element:
    return ElementTree.fromstring(Picture(data).svg())


def words(root: ElementTree.Element) -> list[str]:
    return [''.join(text.itertext()) for text in root.iter(f'{SVG}text')]


def test_what_a_fault_is_told_about_has_a_sign() -> None:
    names = [EYES.nodes[0].name, EYES.topics[0].name]
    drawn = Picture(EYES, wrong=names)
    assert [shape.name for shape in drawn.shapes if shape.wrong] == names
    assert drawn.svg().count('class="sign"') == 2
    assert 'class="sign"' not in Picture(EYES).svg()


# -- namespaces ---------------------------------------------------------------------------------


def test_a_folded_namespace_is_one_node() -> None:
    assert spaces_of(ROBOTS) == ['/robot1', '/robot1/arm', '/robot2']
    one = fold(ROBOTS, {'/robot1'})
    names = ['/boss', '/robot1/*', '/robot2/pilot', '/robot2/turtlebot', '/robot3/turtlebot']
    assert [node.name for node in one.nodes] == names
    assert [node.count for node in one.nodes] == [1, 4, 1, 1, 1]
    # What only its own nodes use is inside: /robot1/cmd_vel, and that of the arm.
    assert [each.name for each in one.topics] == [
        '/robot1/odom',
        '/robot1/arm/odom',
        '/robot2/cmd_vel',
        '/robot2/odom',
        '/go',
    ]
    assert ('hears', '/robot1/*', '/go') in lines(one)
    assert '4 nodes' in words(parsed(one))
    # The outer one counts.
    assert fold(ROBOTS, {'/robot1', '/robot1/arm'}) == one
    assert fold(ROBOTS, set()) == ROBOTS


def test_a_namespace_that_holds_all_or_one_is_not_folded() -> None:
    assert spaces_of(graph(alone=['/a/one', '/a/two'])) == []
    assert spaces_of(graph(alone=['/a/one', '/b/one', '/two'])) == []


def test_services_of_a_folded_namespace_stay_where_others_call_them() -> None:
    offers = [
        GraphService('/a/inside', ('T',), ('/a/one',), ('/a/two',)),
        GraphService('/a/called', ('T',), ('/a/one',), ('/b', '/a/two'), ('/b',)),
    ]
    found = fold(graph(services=offers), {'/a'}).services
    assert found == (GraphService('/a/called', ('T',), ('/a/*',), ('/b', '/a/*'), ('/b',)),)


# -- real nodes ---------------------------------------------------------------------------------


def test_nodes_and_topics_are_drawn_and_told(kernel):
    assert (
        'No node is running'
        in shown(kernel.run('import labkit as lab\nlab.graph()'))['text/plain']
    )
    assert not kernel.run(NODES).error
    data = shown(kernel.run('lab.graph()'))
    assert data['text/plain'].splitlines() == [
        'Nodes:',
        '  /listener',
        '  /talker',
        'Topics:',
        '  /chatter [std_msgs/msg/String]',
        '    published by /talker',
        '    subscribed by /listener',
    ]
    root = ElementTree.fromstring(data['image/svg+xml'])
    assert words(root) == ['/listener', '/talker', '/chatter', 'std_msgs/msg/String']
    told = root.find(f'{SVG}desc').text
    assert told == (
        'Nodes: /listener, /talker. /talker → /chatter [std_msgs/msg/String] → /listener.'
    )


def test_a_pair_that_does_not_match_has_a_cross_and_words(kernel):
    kernel.run(NODES + ARROWS + 'from rclpy.qos import qos_profile_sensor_data')
    kernel.run(
        'sonar = Node("sonar")\nsonar.create_publisher(String, "b", qos_profile_sensor_data)'
    )
    kernel.run('listener.create_subscription(String, "b", print, 10)')
    data = shown(kernel.run('lab.graph()'))
    reason = 'Best effort publisher and reliable subscription'
    assert f'    no match between /sonar and /listener: {reason}' in data['text/plain']
    assert data['image/svg+xml'].count('class="cross"') == 1
    assert f'/listener does not hear /sonar on /b: {reason}' in data['image/svg+xml']
    on_b = 'print(*[each for each in arrows(lab.graph().data) if each[2] == "/b"], sep="\\n")'
    apart = f"('apart', '/listener', '/b', 'does not hear /sonar: {reason}')"
    assert kernel.run(on_b).text.splitlines() == [apart, "('publishes', '/sonar', '/b', '')"]
    # Somebody else is heard: both are to be seen.
    kernel.run('talker.create_publisher(String, "b", 10)')
    heard = kernel.run(on_b).text.splitlines()
    assert apart in heard and "('hears', '/listener', '/b', '')" in heard
    # And who hears them both, beside one that does not, has no cross.
    kernel.run('ear = lab.spin(Node("ear"))')
    kernel.run('ear.create_subscription(String, "b", print, qos_profile_sensor_data)')
    assert shown(kernel.run('lab.graph()'))['image/svg+xml'].count('class="cross"') == 1


def test_services_and_hidden_names_are_shown_on_demand(kernel):
    kernel.run(NODES + 'from std_srvs.srv import Trigger\nimport rclpy')
    kernel.run('talker.create_service(Trigger, "fire", lambda request, response: response)')
    assert 'Services' not in shown(kernel.run('lab.graph()'))['text/plain']
    data = shown(kernel.run('lab.graph(services=True)'))
    assert '  /fire [std_srvs/srv/Trigger]\n    offered by /talker' in data['text/plain']
    assert '<g class="service"' in data['image/svg+xml']
    assert '/rosout' in shown(kernel.run('lab.graph(hidden=True)'))['text/plain']
    assert 'live must be True or False' in kernel.run('lab.graph(live=1)').error


def test_a_program_that_runs_the_lesson_gets_the_picture_alone(run_kernel_still):
    data = shown(run_kernel_still(NODES + 'lab.graph()'))
    assert sorted(data) == ['image/svg+xml', 'text/plain']
    again = shown(run_kernel_still('lab.graph(live=True)'))
    assert again == data == shown(run_kernel_still('lab.graph(live=False)'))


def test_a_script_prints_the_words(script):
    result = script(NODES + 'print(lab.graph())')
    assert result.stdout.startswith('Nodes:\n  /listener\n  /talker\nTopics:\n'), result.stderr


@pytest.fixture
def run_kernel_still(start_kernel):
    return start_kernel(LABKIT_HEADLESS='1').run


# -- the drawing --------------------------------------------------------------------------------


@pytest.mark.parametrize('data', ALL.values(), ids=ALL)
def test_it_is_an_svg_that_tells_what_it_shows(data: Graph):
    text = Picture(data).svg()
    assert text == Picture(data).svg()
    root = parsed(data)
    assert root.get('role') == 'img'
    ids = {element.get('id') for element in root.iter()} - {None}
    assert set(root.get('aria-labelledby').split()) < ids
    assert root.find(f'{SVG}title').text and root.find(f'{SVG}desc').text
    for element in root.iter():
        assert element.tag.removeprefix(SVG) in (
            *('svg', 'title', 'desc', 'defs', 'marker', 'g', 'path', 'rect', 'text'),
        )
        assert not [name for name in element.attrib if name.startswith('on') or 'href' in name]
    # A ground of its own, on which it can be read whatever the page's is.
    ground = root.find(f'{SVG}rect')
    assert (ground.get('class'), ground.get('fill')) == ('ground', '#ffffff')
    assert float(ground.get('width', '')) == float(root.get('width', '')) - 1
    # What leads where is told in arrows.
    told = root.find(f'{SVG}desc').text
    for each in data.topics:
        assert f' → {each.name} [' in told or f'{each.name} [' in told


def test_nothing_is_told_by_colour_alone():
    root = parsed(OFFERS)
    outlines = {
        part.get('class'): [(child.tag.removeprefix(SVG), child.get('rx')) for child in part][:2]
        for part in root.iter(f'{SVG}g')
        if part.get('data-part', 'a').startswith('b')
    }
    assert outlines['node'][0] == ('rect', '24')
    assert outlines['topic'][0] == ('rect', '4')
    assert outlines['service'][0] == ('path', None)
    assert outlines['action'] == [('rect', '4'), ('path', None)]
    widths = {
        part.get('class'): part[0].get('stroke-width')
        for part in root.iter(f'{SVG}g')
        if 'arrow' in (part.get('class') or '')
    }
    assert widths['arrow action'] > widths['arrow publishes']
    dashed = [shape.name for shape in Picture(APART).shapes if not shape.own]
    assert dashed == ['/referee']
    assert Picture(APART).svg().count('stroke-dasharray="6 4"') == 1


def test_an_action_is_one_thing():
    assert [each for each in lines(OFFERS) if each[0] == 'action'] == [
        ('action', '/watcher', '/walk'),
        ('action', '/leg', '/walk'),
    ]


def test_crosses_say_whom_and_why():
    found = {line.node: line.words for line in Picture(APART).lines if line.words}
    assert found == {
        '/pilot': ['does not hear /sonar:', 'Best effort publisher and', 'reliable subscription'],
        '/announcer': ['does not hear /referee:', f'{INT16} is not', STRING],
    }
    # The pilot hears somebody else; the announcer hears nobody.
    heard = [line for line in lines(APART) if line[0] == 'hears']
    assert heard == [('hears', '/pilot', '/range')]


def test_of_many_that_are_not_heard_some_are_named():
    many = topic('/a', [(f'/n{number}', INT16) for number in range(9)], [('/ear', STRING)])
    (line,) = [line for line in Picture(graph(many)).lines if line.words]
    assert 'and 7 more:' in ' '.join(line.words)
    assert all(f'/n{number}' in description(graph(many)) for number in range(9))


@pytest.mark.parametrize(
    ('text', 'limit', 'expected'),
    [
        ('/chatter', 10, ['/chatter']),
        ('std_msgs/msg/Float64', 12, ['std_msgs/', 'msg/Float64']),
        ('one two three', 8, ['one two', 'three']),
        ('/a_long_name/of_parts', 8, ['/a_long_', 'name/of_', 'parts']),
        ('x' * 20, 8, ['x' * 12, 'x' * 8]),
        ('Fibonacci', 6, ['Fibonacci']),
    ],
)
def test_a_word_is_not_broken(text: str, limit: int, expected: list[str]):
    assert in_lines(text, limit) == expected


HOSTILE = [
    '/a"]); alert(1)',
    '/<img onerror=1>',
    '/x&quot;',
    '/]]><script>alert(1)</script>',
    '/\x00\x1b',
]


@pytest.mark.parametrize('name', HOSTILE)
def test_names_have_no_power_over_the_picture(name: str):
    data = graph(topic(name, [(name, name)], [(name, STRING)]))
    root = parsed(data)
    told = words(root)
    plain = ''.join(char if char.isprintable() else '?' for char in name)
    assert plain in told or ''.join(told).startswith(plain.replace(' ', ''))
    assert not list(root.iter(f'{SVG}script')) and not list(root.iter(f'{SVG}img'))


def test_no_picture_of_nothing():
    assert GraphView(graph())._repr_mimebundle_() == {
        'text/plain': 'No node is running. Start one with lab.spin(node) and look again.'
    }
    assert 'image/svg+xml' in GraphView(graph(alone=['/a']))._repr_mimebundle_()


def test_two_pictures_in_one_page_share_no_names():
    ids = [set(re.findall(r' id="([^"]+)"', Picture(data).svg())) for data in (EYES, APART)]
    assert ids[0] and not ids[0] & ids[1]
