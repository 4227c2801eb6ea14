"""Topics and services by name and type, and what one node has of them."""

from __future__ import annotations

import json

LAMP = """
import json
from dataclasses import asdict
import labkit as lab
from labkit.background.runtime import runtime
from labkit.rosgraph import listings
from rclpy.node import Node, NodeNameNonExistentError
from std_msgs.msg import Int16, String
from std_srvs.srv import Trigger

lab.start()
lamp = Node('lamp', namespace='hall', start_parameter_services=False)
lamp.create_publisher(String, '/chatter', 10)
lamp.create_publisher(String, '_secret', 10)
lamp.create_subscription(Int16, '/odds', print, 10)
lamp.create_service(Trigger, '/go', print)
lamp.create_client(Trigger, '/come')
lab.spin(lamp)
node = runtime.helper
"""
LIST = (
    LAMP
    + """
print(json.dumps({
    'topics': listings.topics(node),
    'own': listings.own_topics(node),
    'types': [listings.topic_types(node, name) for name in ('/odds', '/evens')],
    'services': [name for name, _ in listings.services(node)],
    'service_types': [listings.service_types(node, name) for name in ('/go', '/stay')],
    'hidden': [name for name, _ in listings.topics(node, include_hidden=True)],
    'ends': asdict(listings.ends_of_node(node, '/hall/lamp')),
    'all': [len(ends) for ends in asdict(
        listings.ends_of_node(node, '/hall/lamp', include_hidden=True)).values()],
}))
"""
)


def test_what_there_is_by_name_and_type(script):
    result = script(LIST)
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert ['/chatter', ['std_msgs/msg/String']] in found['topics']
    assert found['own'] == ['/chatter', '/odds']
    assert found['types'] == [['std_msgs/msg/Int16'], []]
    assert {'/come', '/go'} <= set(found['services'])
    assert found['service_types'] == [['std_srvs/srv/Trigger'], []]
    assert '/hall/_secret' in found['hidden']
    assert not [name for name, _ in found['topics'] if '/_' in name]
    ends = found['ends']
    assert ends['subscribers'] == [['/odds', ['std_msgs/msg/Int16']]]
    assert ['/chatter', ['std_msgs/msg/String']] in ends['publishers']
    assert ['/go', ['std_srvs/srv/Trigger']] in ends['service_servers']
    assert ends['service_clients'] == [['/come', ['std_srvs/srv/Trigger']]]
    assert (ends['action_servers'], ends['action_clients']) == ([], [])
    assert found['all'][1] == len(ends['publishers']) + 1


HAUNTED = """
from test_msgs.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from labkit.rosgraph.servers import servers

class Haunted:
    # A node of the same name has ended: it is the one of which ROS speaks.
    def __getattr__(self, name):
        if name.endswith('_by_node'):
            return lambda *whose: []
        return getattr(node, name)

    @property
    def handle(self):
        raise NodeNameNonExistentError

ActionServer(lamp, Fibonacci, 'count', print)
ActionClient(lamp, Fibonacci, '/add')
nobody = Node('stranger', start_parameter_services=False)
for name in ('/hall/lamp', '/stranger', '/nobody'):
    for hidden in (False, True):
        seen = listings.ends_of_node(Haunted(), name, include_hidden=hidden)
        there = listings.ends_of_node(node, name, include_hidden=hidden)
        print(name, hidden, seen == there)
print(listings.has_ends(node, '/hall/lamp'), listings.has_ends(Haunted(), '/hall/lamp'))
print([server.service for server in servers(Haunted())])
"""


def test_of_two_nodes_of_a_name_the_one_that_lives_is_looked_at(script):
    result = script(LAMP + HAUNTED)
    assert result.stdout.splitlines() == [
        '/hall/lamp False True',
        '/hall/lamp True True',
        '/stranger False True',
        '/stranger True True',
        '/nobody False True',
        '/nobody True True',
        'True False',
        "['/go', '/hall/count']",
    ], result.stderr
