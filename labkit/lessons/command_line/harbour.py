"""A harbour to look around in: nodes of a process of their own, other ones each time.

`open_harbour()` starts it. Which pier measures the tide, what the messages are, how often they
come and who listens is drawn by lot, so the answers are in the graph and nowhere else.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

from labkit.lessons._companion import start_companion

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.programs.child_processes import Process

__all__ = ['MEASURES', 'NODES', 'TOPICS', 'open_harbour']

PIERS = ('/pier_east', '/pier_north', '/pier_south')
BOATS = ('/boat_a', '/boat_b', '/boat_c', '/boat_d')
NODES = (*BOATS, '/lighthouse', *PIERS)
HIDDEN_NODE = '/_night_watch'
DIARY = '/_diary'
FOGHORN = '/foghorn'
TOPICS = ('/beacon', '/camera', '/radio', '/tide', '/water', '/wind')
# Type of the messages on /water -> the field that holds what is measured.
MEASURES = {
    'sensor_msgs/msg/FluidPressure': 'fluid_pressure',
    'sensor_msgs/msg/Illuminance': 'illuminance',
    'sensor_msgs/msg/RelativeHumidity': 'relative_humidity',
    'sensor_msgs/msg/Temperature': 'temperature',
}
# So far apart that what is measured on a busy machine tells one from another.
RATES_HZ = (3, 5, 8, 12)

_process: Process | None = None


def open_harbour() -> None:
    """Start the harbour as a process, and wait until all of it is in the graph.

    One that is open already is closed first. `lab.processes()` lists and stops it.

    Raises:
        LabTimeout: Its nodes did not come.
    """
    global _process
    _process = start_companion('harbour', __name__, _process)
    print(f'The harbour is open: {len(NODES)} nodes in a process of their own.')


def main() -> None:
    """Run the harbour until it is interrupted."""
    import rclpy
    from rclpy.node import Node

    from labkit.programs.program import spin_until_interrupted

    rclpy.init()
    # Parameters are asked for at the lighthouse only; services cost time at the start.
    nodes = {
        name: Node(name.lstrip('/'), start_parameter_services=name == '/lighthouse')
        for name in (*NODES, HIDDEN_NODE)
    }
    _furnish_piers([nodes[name] for name in PIERS])
    _furnish_boats([nodes[name] for name in BOATS])
    _furnish_lighthouse(nodes['/lighthouse'])
    _furnish_watch(nodes[HIDDEN_NODE])
    spin_until_interrupted(*nodes.values())


def _furnish_piers(piers: list[Node]) -> None:
    """Let one pier measure the tide, one the water, and each of them the wind."""
    from std_msgs.msg import Float32

    from labkit.rosgraph.interfaces import message_class

    for pier in piers:
        _publish(pier, '/wind', Float32(data=7.5), 1)
    tide, water, _ = random.sample(piers, 3)
    _publish(tide, '/tide', Float32(data=1.25), 2)
    msg_type, field = random.choice(sorted(MEASURES.items()))
    _publish(water, '/water', message_class(msg_type)(**{field: 12.5}), 2)


def _furnish_boats(boats: list[Node]) -> None:
    """Let some of the boats listen to the radio."""
    from std_msgs.msg import String

    for boat in random.sample(boats, random.choice((2, 3))):
        boat.create_subscription(String, '/radio', lambda message: None, 10)


def _furnish_lighthouse(lighthouse: Node) -> None:
    """Give the lighthouse a radio, a beacon, a camera, a fog horn and parameters."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import CompressedImage
    from std_msgs.msg import Bool, String
    from std_srvs.srv import Empty, SetBool, Trigger

    for name, low, high in (('height_m', 30, 60), ('range_km', 11, 29)):
        lighthouse.declare_parameter(name, random.randint(low, high))
    _publish(lighthouse, '/radio', String(data='All is well.'), 1)
    _publish(lighthouse, '/beacon', Bool(data=True), random.choice(RATES_HZ))
    reliability = random.choice((ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE))
    profile = QoSProfile(depth=1, reliability=reliability)  # type: ignore[no-untyped-call]
    _publish(lighthouse, '/camera', CompressedImage(format='jpeg'), 2, profile)
    service = random.choice((Empty, SetBool, Trigger))
    lighthouse.create_service(service, FOGHORN, lambda request, response: response)


def _furnish_watch(watch: Node) -> None:
    from std_msgs.msg import String

    _publish(watch, DIARY, String(data='A quiet night.'), 1)


def _publish(node: Node, topic: str, message: Any, hz: float, profile: Any = 10) -> None:
    publisher = node.create_publisher(type(message), topic, profile)
    node.create_timer(1 / hz, lambda: publisher.publish(message))
