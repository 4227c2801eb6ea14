"""The picture of the graph: what it says of real nodes, and that names have no power over it."""

from __future__ import annotations

import pytest
from rclpy.qos import QoSProfile

from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.snapshot import Graph, GraphNode, GraphTopic
from labkit.views.graph import to_mermaid

NODES = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
lab.start()
talker, listener = lab.spin(Node('talker')), lab.spin(Node('listener'))
talker.create_publisher(String, 'chatter', 10)
listener.create_subscription(String, 'chatter', lambda msg: None, 10)
"""


def shown(result):
    assert not result.error, result.traceback
    return result.outputs[-1]['data']


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
    picture = data['text/vnd.mermaid'].splitlines()
    assert '  n1 --> t0' in picture
    assert '  t0 --> n0' in picture
    assert 'accDescr: Nodes /listener, /talker. Topics /chatter.' in data['text/vnd.mermaid']


def test_a_pair_that_does_not_match_has_a_cross_and_words(kernel):
    kernel.run(NODES + 'from rclpy.qos import qos_profile_sensor_data')
    kernel.run(
        'sonar = Node("sonar")\nsonar.create_publisher(String, "b", qos_profile_sensor_data)'
    )
    kernel.run('listener.create_subscription(String, "b", print, 10)')
    data = shown(kernel.run('lab.graph()'))
    reason = 'Best effort publisher and reliable subscription'
    assert f'    no match between /sonar and /listener: {reason}' in data['text/plain']
    picture = data['text/vnd.mermaid'].splitlines()
    # n0 is /listener, n1 is /sonar, t0 is /b.
    assert f'  t0 -. "does not hear /sonar: {reason}" .-x n0' in picture
    assert '  n1 --> t0' in picture
    assert '  t0 --> n0' not in picture
    assert f' /listener does not hear /sonar on /b: {reason}.' in data['text/vnd.mermaid']
    # Somebody else is heard: both are to be seen.
    kernel.run('talker.create_publisher(String, "b", 10)')
    picture = shown(kernel.run('lab.graph()'))['text/vnd.mermaid'].splitlines()
    assert '  t0 --> n0' in picture
    assert f'  t0 -. "does not hear /sonar: {reason}" .-x n0' in picture
    # And who hears them both, beside one that does not, has no cross.
    kernel.run('ear = lab.spin(Node("ear"))')
    kernel.run('ear.create_subscription(String, "b", print, qos_profile_sensor_data)')
    crosses = [
        line
        for line in shown(kernel.run('lab.graph()'))['text/vnd.mermaid'].splitlines()
        if '.-x' in line
    ]
    assert len(crosses) == 1


def test_services_and_hidden_names_are_shown_on_demand(kernel):
    kernel.run(NODES + 'from std_srvs.srv import Trigger\nimport rclpy')
    kernel.run('talker.create_service(Trigger, "fire", lambda request, response: response)')
    assert 'Services' not in shown(kernel.run('lab.graph()'))['text/plain']
    assert (
        '  /fire [std_srvs/srv/Trigger]\n    offered by /talker'
        in (shown(kernel.run('lab.graph(services=True)'))['text/plain'])
    )
    assert '/rosout' in shown(kernel.run('lab.graph(hidden=True)'))['text/plain']
    assert 'live must be True or False' in kernel.run('lab.graph(live=1)').error


def test_live_picture_follows_and_ends_when_closed(kernel):
    kernel.run(NODES)
    kernel.run('view = lab.graph(live=True)\nview')
    assert kernel.run('view').error == ''
    timers = (
        'from labkit.background.runtime import runtime\nprint(len(list(runtime.helper.timers)))'
    )
    before = int(kernel.run(timers).text)
    kernel.run('lab.spin(Node("extra"))\nlab.wait_until(lambda: "/extra" in repr(view))')
    assert 'extra' in kernel.run('print(view)').text
    kernel.run('view.close()')
    assert int(kernel.run(timers).text) == before - 1


def test_live_picture_says_that_ros_was_stopped(kernel):
    kernel.run(NODES)
    cell = kernel.run('view = lab.graph(live=True)\nview')
    assert '/talker' in shown(cell)['text/vnd.mermaid']
    # Else it would go on showing nodes that are gone.
    result = kernel.run('lab.stop()')
    assert not result.error
    updates = [
        message['content']['data']
        for message in kernel._messages[result.msg_id]
        if message['msg_type'] == 'update_display_data'
    ]
    assert updates == [{'text/plain': 'ROS was stopped. Run this cell to start it again.'}]
    # Shown again, it is the picture of then; ROS is not started by it.
    assert '/talker' in shown(kernel.run('view'))['text/vnd.mermaid']
    started = 'from labkit.background.runtime import runtime\nprint(runtime.started)'
    assert kernel.run(started).text == 'False\n'


@pytest.mark.parametrize(
    'name', ['/a"]); click n0 "javascript:1"', '/<img onerror=1>', '/x#quot;']
)
def test_names_have_no_power_over_the_picture(name):
    end = Endpoint(name, '/topic', 'std_msgs/msg/String', QoSProfile(depth=1), bytes(16))
    topic = GraphTopic(name, (name,), (end,), (end,))
    text = to_mermaid(Graph((GraphNode(name, own=False),), (topic,)))
    for line in text.splitlines():
        if 'img' in line or 'javascript' in line or 'quot' in line:
            assert '<img' not in line
            assert line.count('"') in (0, 2)
            assert 'quot;' not in line.replace('#59;', '')
