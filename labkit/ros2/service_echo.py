"""`ros2 service echo`: show the requests and responses of a service with introspection."""

from __future__ import annotations

import re
from argparse import Namespace
from typing import Any

from labkit.asking.discovery import poll_until
from labkit.errors import LabError
from labkit.ros2.graph_completion import service_names, types_of_service
from labkit.ros2.graph_queries import add_discovery_options, asking_node, full_name, unknown
from labkit.ros2.parser import Parser, Verb
from labkit.ros2.streams import Arrivals, Stop, add_stop_options, subscribed, tell
from labkit.ros2.topic_echo import add_form_options, text_of
from labkit.rosgraph import interfaces
from labkit.rosgraph.listings import service_types, services
from labkit.rosgraph.qos_profiles import make_profile

__all__ = ['ECHO']

# Constants of service_msgs/msg/ServiceEventInfo.
_NAMES = ('REQUEST_SENT', 'REQUEST_RECEIVED', 'RESPONSE_SENT', 'RESPONSE_RECEIVED')
_HOW = (
    'A server or client publishes them after service.configure_introspection(node.get_clock(), '
    'QoSProfile(depth=10), ServiceIntrospectionState.CONTENTS).'
)


def echo(args: Namespace) -> str | None:
    """Show events until a count, a timeout, or the stop button."""
    stop = Stop(args.count, args.timeout)
    node = asking_node(args)
    name = full_name(args.service_name, node)
    types = (
        [args.service_type] if args.service_type else poll_until(lambda: service_types(node, name))
    )
    if not types:
        names = [other for other, _ in services(node)]
        raise LabError(
            f"Unknown service '{args.service_name}'", todo=unknown(name, names, 'service')
        )
    event_type = interfaces.service_class(types[0]).Event
    topic = f'{name}/_service_event'
    arrivals = Arrivals()
    seen = []

    def arrived(event: Any) -> None:
        arrivals.put(lambda: show(event))

    def show(event: Any) -> None:
        if not stop.reached:
            seen.append(event)
            stop.count_one()
            text, end = text_of(event, args)
            # A number says nothing; the real one replaces it, too, but not in CSV.
            tell(
                re.sub(r'(?m)(?<=^  event_type: )[0-3]$', lambda m: _NAMES[int(m[0])], text),
                end=end,
            )

    if not poll_until(lambda: node.count_publishers(topic)):
        print(
            f"No publishers on topic '{topic}'; is service introspection on the client or server "
            f'enabled?\n{_HOW}',
            flush=True,
        )
    with subscribed(node, topic, event_type, make_profile('services_default'), arrived):
        arrivals.show_until(stop)
    return None if seen else 'No event came.'


def _arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add(
        'service_name',
        help="Name of the ROS service to echo (e.g. '/add_two_ints')",
        complete=service_names,
    )
    parser.add(
        'service_type',
        nargs='?',
        help="Type of the ROS service (e.g. 'std_srvs/srv/SetBool')",
        complete=types_of_service,
    )
    add_form_options(parser)
    add_stop_options(parser, 'events')


ECHO = Verb('echo', 'Echo a service', echo, _arguments)
