"""The quiz on the harbour: every answer is read off the live graph when it is judged."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from statistics import median
from typing import TYPE_CHECKING

from labkit.errors import LabError
from labkit.exercises import Probe, Quiz, words_of
from labkit.exercises.quiz import spelling
from labkit.lessons.command_line.harbour import (
    BOATS,
    FOGHORN,
    MEASURES,
    NODES,
    RATES_HZ,
)

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['HARBOUR']

WORDS = words_of(__file__)

LIGHTHOUSE = '/lighthouse'
MEASURE_SEC = 4.0


def _graph() -> Node:
    """Return the node to ask with.

    Raises:
        LabError: The harbour is closed.
    """
    from labkit.asking.discovery import asking_node, poll_until
    from labkit.rosgraph.snapshot import node_names

    node = asking_node()
    # After lab.stop() the harbour is still open, and has to be discovered again.
    if not poll_until(lambda: set(NODES) <= set(node_names(node))):
        raise _closed()
    return node


def _closed() -> LabError:
    return LabError('The harbour is closed.', todo='Run the cell with open_harbour() first.')


def _publishers(topic: str) -> Sequence[Endpoint]:
    """Return the publishers of a topic of the harbour; there is one at least."""
    from labkit.asking.discovery import poll_until
    from labkit.rosgraph.endpoints import publishers

    node = _graph()
    found = poll_until(lambda: [end for end in publishers(node, topic) if end.is_known])
    if not found:
        raise _closed()
    return found


def _topics() -> dict[str, list[str]]:
    return dict(_graph().get_topic_names_and_types())


# -- which node ---------------------------------------------------------------------------------


def _node_of_tide() -> list[str]:
    return [end.node for end in _publishers('/tide')]


def _no_node_of_tide(word: str) -> str:
    name = f'/{word}'
    if name in NODES:
        return f'{name} does not publish on /tide. ros2 node info {name} shows what it does.'
    if name in _topics():
        return f'{name} is a topic. The name of a node is asked for.'
    return ''


# -- which type, which field --------------------------------------------------------------------


def _type_of_water() -> list[str]:
    found = {end.msg_type for end in _publishers('/water')}
    return sorted(found & MEASURES.keys())


def _no_type_of_water(word: str) -> str:
    return _explain_type(word, _type_of_water()[0], 'msg')


def _explain_type(word: str, name: str, kind: str) -> str:
    """Say what is wrong about the name of a type, given the right one."""
    package, _, last = name.split('/')
    parts = re.split(r'[/.:]+', word)
    if parts in ([last], [kind, last]):
        return f'Its name has three parts: the package, the word {kind}, and {last!r}.'
    if parts == [package, kind, last]:
        return 'So it is called in a program. The command line writes it with slashes.'
    if parts[0] == package and parts[-1] == last:
        return f'The word in the middle says what it is: {kind}.'
    for topic, types in sorted(_topics().items()):
        if '/_' not in topic and word in map(spelling.type_name('msg'), types):
            return f'That is the type of the messages on {topic}.'
    return ''


def _field_of_water() -> str:
    return MEASURES[_type_of_water()[0]]


def _no_field_of_water(word: str) -> str:
    name = _type_of_water()[0]
    if word in (name, spelling.type_name('msg')(name), name.rsplit('/', 1)[-1]):
        return 'That is the type. A field is a part of a message: interface show lists them.'
    if word in MEASURES.values():
        return 'That is a field of another type. Which type has /water this time?'
    return ''


# -- how often, how many, how much --------------------------------------------------------------


def _rate_of_beacon() -> float:
    """Measure the rate of /beacon, in Hz."""
    _graph()
    # A node that nobody spins: the messages are for this function alone.
    with Probe('look_around') as probe:
        watch = probe.watch('/beacon', 'std_msgs/msg/Bool')
        probe.wait(lambda: len(watch) >= 5, MEASURE_SEC)
        if len(watch) < 2:
            raise LabError('/beacon is silent.', todo='Open the harbour again: open_harbour()')
        measured = 1 / median(watch.intervals)
        # The harbour chose one of these; a busy machine is not asked which.
        return min(RATES_HZ, key=lambda hz: abs(math.log(hz / measured)))


def _no_rate_of_beacon(number: float) -> str:
    if abs(number * _rate_of_beacon() - 1.0) < 0.1:
        return 'That is the time from one message to the next, in seconds. Divide 1 by it.'
    return ''


def _listeners() -> int:
    return _graph().count_subscribers('/radio')


def _no_listeners(number: float) -> str:
    if number == _graph().count_publishers('/radio'):
        return 'That is the number of publishers. Subscriptions are counted in another line.'
    if number == len(BOATS):
        return f'{len(BOATS)} boats are here, but not all of them listen.'
    return ''


def _parameter(name: str) -> int:
    from rcl_interfaces.srv import GetParameters

    from labkit.asking.service_calls import call_node

    request = GetParameters.Request(names=[name])
    response = call_node(_graph(), GetParameters, LIGHTHOUSE, 'get_parameters', request)
    if not response.values:
        raise _closed()
    return int(response.values[0].integer_value)


def _no_range(number: float) -> str:
    return 'That is height_m.' if number == _parameter('height_m') else ''


# -- quality of service, services ---------------------------------------------------------------


def _reliability() -> str:
    return str(_publishers('/camera')[0].qos.reliability.name)


def _no_reliability(word: str) -> str:
    if word in map(spelling.constant, ('RELIABLE', 'BEST_EFFORT')):
        return 'It is the other one. Use ros2 topic info --verbose /camera.'
    return ''


def _service_type() -> list[str]:
    from labkit.asking.discovery import poll_until

    node = _graph()
    found = poll_until(lambda: dict(node.get_service_names_and_types()).get(FOGHORN))
    if not found:
        raise _closed()
    return found


def _no_service_type(word: str) -> str:
    return _explain_type(word, _service_type()[0], 'srv')


HARBOUR = Quiz.of(
    WORDS,
    'harbour',
    cell_id='look-around',
    node_of_tide={'answer': _node_of_tide, 'explain': _no_node_of_tide},
    type_of_water={
        'answer': _type_of_water,
        'explain': _no_type_of_water,
        'form': spelling.type_name('msg'),
    },
    field_of_water={
        'answer': _field_of_water,
        'explain': _no_field_of_water,
        'form': spelling.field_name,
    },
    rate_of_beacon={'answer': _rate_of_beacon, 'explain': _no_rate_of_beacon},
    listeners={'answer': _listeners, 'explain': _no_listeners},
    range_km={'answer': lambda: _parameter('range_km'), 'explain': _no_range},
    reliability={'answer': _reliability, 'explain': _no_reliability, 'form': spelling.constant},
    service_type={
        'answer': _service_type,
        'explain': _no_service_type,
        'form': spelling.type_name('srv'),
    },
)
