"""Graphs as data, to be drawn without ROS running."""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.qos import QoSProfile, qos_profile_sensor_data

from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.snapshot import Graph, GraphAction, GraphNode, GraphService, GraphTopic

STRING = 'std_msgs/msg/String'
INT16 = 'std_msgs/msg/Int16'
RELIABLE = QoSProfile(depth=10)
BEST_EFFORT = qos_profile_sensor_data

# A node, and perhaps type and QoS of its end.
End = str | tuple[str, str] | tuple[str, str, QoSProfile]


def topic(
    name: str, publishers: Sequence[End] = (), subscriptions: Sequence[End] = ()
) -> GraphTopic:
    """Return a topic with its ends; of type String and reliable if nothing else is said."""

    def made(ends: Sequence[End]) -> tuple[Endpoint, ...]:
        found = []
        for end in ends:
            node, msg_type, qos = (*((end,) if isinstance(end, str) else end), None, None)[:3]
            found.append(Endpoint(node, name, msg_type or STRING, qos or RELIABLE, bytes(16)))
        return tuple(found)

    senders, hearers = made(publishers), made(subscriptions)
    types = sorted({end.msg_type for end in (*senders, *hearers)})
    return GraphTopic(name, tuple(types), senders, hearers)


def graph(
    *topics: GraphTopic,
    alone: Sequence[str] = (),
    foreign: Sequence[str] = (),
    services: Sequence[GraphService] = (),
    actions: Sequence[GraphAction] = (),
) -> Graph:
    """Return a graph with the nodes that its topics, services and actions name, and others."""
    names = {end.node for each in topics for end in (*each.publishers, *each.subscriptions)}
    offers: list[GraphService | GraphAction] = [*services, *actions]
    for offer in offers:
        names |= {*offer.servers, *offer.clients}
    nodes = [GraphNode(name, name not in foreign) for name in sorted(names | set(alone))]
    return Graph(tuple(nodes), topics, tuple(services), tuple(actions))


EYES = graph(
    topic('/sight', ['/left_eye', '/right_eye'], ['/brain']),
    topic('/move', ['/brain'], ['/left_leg', '/right_leg']),
)
ROBOT = graph(
    topic('/cmd_vel', ['/controller', '/teleop'], ['/turtlebot']),
    topic('/odom', ['/turtlebot'], ['/controller']),
    topic('/scan', ['/turtlebot'], ['/controller']),
    topic('/joint_states', ['/turtlebot']),
)
ROBOTS = graph(
    *(
        each
        for name in ('robot1', 'robot1/arm', 'robot2')
        for each in (
            topic(f'/{name}/cmd_vel', [f'/{name}/pilot'], [f'/{name}/turtlebot']),
            topic(f'/{name}/odom', [f'/{name}/turtlebot'], [f'/{name}/pilot', '/boss']),
        )
    ),
    topic('/go', ['/boss'], ['/robot1/pilot', '/robot2/pilot']),
    alone=['/robot3/turtlebot'],
)
LOOP = graph(
    topic('/ab', ['/a'], ['/b']), topic('/bc', ['/b'], ['/c']), topic('/ca', ['/c'], ['/a'])
)
ECHO = graph(topic('/me', ['/echo'], ['/echo']), alone=['/lonely'])
CHAT = graph(topic('/chat', ['/ada', '/bob'], ['/ada', '/bob', '/eve']))
APART = graph(
    topic('/range', [('/sonar', INT16, BEST_EFFORT), ('/lidar', INT16)], [('/pilot', INT16)]),
    topic('/goals', [('/referee', INT16)], [('/announcer', STRING)]),
    foreign=['/referee'],
)
OFFERS = graph(
    topic('/move', ['/brain'], ['/leg']),
    services=[GraphService('/sneeze', ('std_srvs/srv/Trigger',), ('/brain',), ('/leg',))],
    actions=[GraphAction('/walk', ('test_msgs/action/Fibonacci',), ('/leg',), ('/watcher',))],
)
FORTY = graph(
    *(
        topic(
            f'/topic_{number}',
            [f'/node_{5 * number + each:02}' for each in range(5)],
            [f'/node_{(7 * each + number) % 40:02}' for each in range(3)],
        )
        for number in range(8)
    )
)
STAR = graph(topic('/all', [f'/node_{number:02}' for number in range(40)], ['/hub']))
CHAIN = graph(*(topic(f'/name_{n}', [f'/stage_{n}'], [f'/stage_{n + 1}']) for n in range(6)))
LONG = graph(
    topic(
        '/a_topic_with/many_parts_in_its_name/and_some_more_of_them',
        ['/' + 'x' * 120, '/a_node_with/many_parts_in_its_name/and_some_more_of_them'],
        ['/short'],
    )
)
SCATTERED = graph(alone=[f'/node_{"abc" * number}' for number in range(8)])
ALL = {name.lower(): data for name, data in list(globals().items()) if isinstance(data, Graph)}
