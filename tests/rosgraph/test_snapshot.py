"""The computation graph as data."""

from __future__ import annotations

import json

from labkit.background.domains import claim_domain

# Nodes of this process; what `read_graph` says of them.
READ = """
import json
import labkit as lab
from labkit.rosgraph.snapshot import read_graph
from labkit.background.runtime import runtime
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Int16, String
from std_srvs.srv import Trigger

lab.start()
talker, listener = Node('talker'), Node('listener', namespace='ears')
talker.create_publisher(String, '/chatter', 10)
listener.create_subscription(String, '/chatter', lambda msg: None, 10)
talker.create_publisher(Int16, '/fast', qos_profile_sensor_data)
listener.create_subscription(Int16, '/fast', lambda msg: None, 10)
talker.create_service(Trigger, '/go', print)
listener.create_client(Trigger, '/go')
hidden = Node('_hidden')
hidden.create_publisher(String, '/_secret', 10)
for node in (talker, listener, hidden):
    lab.spin(node)
"""


def test_what_there_is_and_what_does_not_match(script):
    result = script(READ + 'print(read_graph(runtime.helper, include_services=True))')
    assert result.stdout == (
        'Nodes:\n'
        '  /ears/listener\n'
        '  /talker\n'
        'Topics:\n'
        '  /chatter [std_msgs/msg/String]\n'
        '    published by /talker\n'
        '    subscribed by /ears/listener\n'
        '  /fast [std_msgs/msg/Int16]\n'
        '    published by /talker\n'
        '    subscribed by /ears/listener\n'
        '    no match between /talker and /ears/listener: Best effort publisher and reliable '
        'subscription\n'
        'Services:\n'
        '  /go [std_srvs/srv/Trigger]\n'
        '    offered by /talker\n'
        '    called by /ears/listener\n'
    ), result.stderr


def test_hidden_ones_only_when_asked_for(script):
    result = script(
        READ
        + """
shown = read_graph(runtime.helper)
every = read_graph(runtime.helper, include_hidden=True, include_services=True)
print(json.dumps([
    [node.name for node in shown.nodes], [topic.name for topic in shown.topics],
    '/_hidden' in [node.name for node in every.nodes],
    '/_secret' in [topic.name for topic in every.topics],
    '/rosout' in [topic.name for topic in every.topics],
    '/talker/get_parameters' in [service.name for service in every.services],
]))
"""
    )
    assert json.loads(result.stdout) == [
        *(['/ears/listener', '/talker'], ['/chatter', '/fast']),
        *(True, True, True, True),
    ]


def test_two_pictures_are_equal_when_nothing_has_changed(script):
    result = script(
        READ
        + """
before = read_graph(runtime.helper)
print(before == read_graph(runtime.helper))
lab.remove('talker')
after = read_graph(runtime.helper)
print(before == after, [topic.name for topic in after.topics], after.mismatches)
"""
    )
    assert result.stdout == "True\nFalse ['/chatter', '/fast'] ()\n"


def test_nodes_of_other_processes_are_told_apart(script):
    claim = claim_domain()
    result = script(
        'import subprocess, sys\n'
        + READ
        + """
import rclpy
from rclpy.context import Context
second = Context()
rclpy.init(context=second)
guest = Node('guest', context=second)  # of this process, though of another participant
program = "import rclpy; rclpy.init(); rclpy.spin(rclpy.create_node('stranger'))"
process = subprocess.Popen([sys.executable, '-c', program])
names = ['/ears/listener', '/guest', '/stranger', '/talker']
seen = lambda: [node.name for node in read_graph(runtime.helper).nodes] == names
lab.wait_until(seen, timeout_sec=60)
graph = read_graph(runtime.helper)
process.kill()
print([(node.name, node.own, node.count) for node in graph.nodes])
print(str(graph).splitlines()[3])
guest.destroy_node()
rclpy.shutdown(context=second)
""",
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST',
        ROS_DOMAIN_ID=str(claim.domain_id),
    )
    claim.close()
    assert result.stdout == (
        "[('/ears/listener', True, 1), ('/guest', True, 1), ('/stranger', False, 1), "
        "('/talker', True, 1)]\n  /stranger (another process)\n"
    ), result.stderr


def test_an_empty_graph(script):
    result = script(
        'import labkit as lab\nfrom labkit.rosgraph.snapshot import read_graph\n'
        'from labkit.background.runtime import runtime\nlab.start()\n'
        'graph = read_graph(runtime.helper)\nprint(graph.nodes, graph.topics)\n'
    )
    assert result.stdout == '() ()\n'


def test_a_node_that_has_ended_but_is_still_listed_is_left_out(script):
    result = script(
        READ
        + """
from labkit.rosgraph.snapshot import node_names
class Haunted:
    def __getattr__(self, name):
        return getattr(runtime.helper, name)
    def get_node_names_and_namespaces(self):
        ended = [('ghost', '/'), ('talker', '/')]
        return [*runtime.helper.get_node_names_and_namespaces(), *ended]
silent = Node('_silent', start_parameter_services=False, enable_rosout=False)
print([name for name in node_names(Haunted()) if 'labkit' not in name])
"""
    )
    names = ['/_hidden', '/_silent', '/ears/listener', '/talker']
    assert result.stdout == f'{names}\n', result.stderr


def test_a_graph_is_whole_when_each_end_has_its_node(script):
    result = script(
        READ
        + """
from labkit.rosgraph.snapshot import is_whole
from labkit.rosgraph.names import UNKNOWN_NODE
class Half:
    node_name = UNKNOWN_NODE
class Early:
    def __getattr__(self, name):
        return getattr(runtime.helper, name)
    def get_subscriptions_info_by_topic(self, topic):
        infos = runtime.helper.get_subscriptions_info_by_topic(topic)
        return [*infos, Half()] if topic == '/fast' else infos
print(is_whole(runtime.helper), is_whole(Early()))
"""
    )
    assert result.stdout == 'True False\n', result.stderr


def test_a_node_whose_name_is_not_known_yet_is_waited_for(script):
    result = script(
        READ
        + """
from labkit.rosgraph.whose import all_are_named, foreign_nodes
from labkit.rosgraph.names import UNKNOWN_NODE
class Half:
    node_name, node_namespace, endpoint_gid = UNKNOWN_NODE, '/', bytes(16)
class Early:
    def __getattr__(self, name):
        return getattr(runtime.helper, name)
    def get_publishers_info_by_topic(self, topic):
        return [*runtime.helper.get_publishers_info_by_topic(topic), Half()]
early = Early()
print(all_are_named(runtime.helper), all_are_named(early), foreign_nodes(early))
"""
    )
    assert result.stdout == 'True False set()\n', result.stderr
