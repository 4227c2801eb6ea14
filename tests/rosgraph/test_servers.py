"""Services by the nodes that offer them."""

from __future__ import annotations

import json

SERVERS = """
import json
from dataclasses import astuple
import labkit as lab
from labkit.background.runtime import runtime
from labkit.rosgraph.servers import servers
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger

lab.start()
lamp, door = Node('lamp', namespace='hall'), Node('door', start_parameter_services=False)
lamp.create_service(SetBool, 'switch', print)
lamp.create_service(Trigger, '~/test', print)
door.create_service(Trigger, '/open', print)
door.create_service(Trigger, '_secret', print)
door.create_client(Trigger, '/ring')
print(json.dumps([astuple(server) for server in servers(runtime.helper)]))
"""


def test_servers_are_listed_without_the_services_of_every_node(script):
    result = script(SERVERS)
    assert json.loads(result.stdout) == [
        ['/door', '/open', 'std_srvs/srv/Trigger'],
        ['/hall/lamp', '/hall/lamp/test', 'std_srvs/srv/Trigger'],
        ['/hall/lamp', '/hall/switch', 'std_srvs/srv/SetBool'],
    ], result.stderr


ACTION = """
import json
from dataclasses import astuple
import labkit as lab
from labkit.background.runtime import runtime
from labkit.rosgraph.servers import servers
from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci

lab.start()
counter = Node('counter', start_parameter_services=False)
ActionServer(counter, Fibonacci, '/count', print)
found = servers(runtime.helper)
print(json.dumps([[*astuple(server), server.is_action] for server in found]))
"""


def test_an_action_is_one_server(script):
    result = script(ACTION)
    wanted = ['/counter', '/count', 'test_msgs/action/Fibonacci', True]
    assert json.loads(result.stdout) == [wanted], result.stderr
