"""Names: two ends that were meant for each other, and are called differently."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from labkit.silent.kinds import Fault, Kind, kind
from labkit.silent.scene import Scene

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint
    from labkit.rosgraph.snapshot import GraphAction, GraphService

__all__ = ['alike', 'look_at_kinds', 'look_at_names', 'look_at_nodes', 'nearest_of']

_SAME_NAME = 'If the two are meant for each other, write the name the same way at both ends.'
_BOTH_LONELY = 'either end has a partner of its own, or the two belong to one node'

NAMESPACE = kind(
    'names.namespace',
    'The subscriber gets nothing: the publisher is in a namespace',
    'If the two are meant for each other, give both nodes the same namespace, or name the topic '
    'from its first slash at both ends.',
    'each of the two has a namespace of its own, as robots of a fleet do',
)
ABSOLUTE = kind(
    'names.absolute',
    'The namespace has no effect: the name of the topic begins with a slash',
    'Leave the leading slash away: then the namespace of the node is put before the name.',
    'there is nobody at the name with the namespace',
)
PRIVATE = kind(
    'names.private',
    'The topic has the name of its node in front: the name begins with ~',
    'Write the name without ~ at that end, or with the name of the node at the other one.',
    'somebody uses the private name',
)
CASE = kind(
    'names.case',
    'No message arrives: the two names differ in capital and small letters',
    _SAME_NAME,
    _BOTH_LONELY,
)
UNDERSCORE = kind(
    'names.underscore',
    'No message arrives: one of the two names has an underscore, cmdvel and cmd_vel',
    _SAME_NAME,
    _BOTH_LONELY,
)
PLURAL = kind(
    'names.plural',
    'No message arrives: one name is singular, the other one plural',
    _SAME_NAME,
    _BOTH_LONELY,
)
SPELLING = kind(
    'names.spelling',
    'No message arrives, although there is a publisher: a letter of the name is wrong',
    _SAME_NAME,
    'the names differ in a digit, or the two belong to one node',
)
SERVICE = kind(
    'names.service',
    'service not available, waiting again: the server has a similar name',
    _SAME_NAME,
    'the client has a server, or the server has a client',
)
ACTION = kind(
    'names.action',
    'The action server is not available: it has a similar name',
    _SAME_NAME,
    'the client has a server, or the server has a client',
)
TOPIC_OF_SERVICE = kind(
    'names.topic-of-service',
    'The subscriber gets nothing: the name is that of a service',
    'Call it with create_client, or subscribe to another name: services and topics are apart.',
    'somebody publishes on a topic of that name as well',
)
SERVICE_OF_TOPIC = kind(
    'names.service-of-topic',
    'The service is never available: the name is that of a topic',
    'Subscribe or publish instead: services and topics are apart.',
    'a service of that name is there as well',
)
DOUBLE = kind(
    'names.double',
    'Two nodes have the same name',
    'Give each a name of its own.',
    'a cell is run again: the earlier node ends first',
    others='ros2 node list warns',
    aloud=False,
)

# Only so many ends without a partner are compared: a graph of that many is no lesson.
_MOST = 40


def look_at_names(scene: Scene) -> Iterator[Fault]:
    """Find a subscription without publisher and a publisher without subscription, alike."""
    silent: list[Endpoint] = []
    unheard: list[Endpoint] = []
    # Who has got a message has the right name: somebody published, and has ended.
    heard = {
        (node.name, sub.topic) for node in scene.nodes for sub in node.subscriptions if sub.heard
    }
    for topic in scene.graph.topics:
        if topic.publishers and not topic.subscriptions:
            unheard += topic.publishers
        elif topic.subscriptions and not scene.publishers.get(topic.name):
            silent += [end for end in topic.subscriptions if (end.node, end.topic) not in heard]
    for end in silent[:_MOST]:
        pairs = [
            (found, other)
            for other in unheard[:_MOST]
            if other.msg_type == end.msg_type and other.node != end.node
            for found in [_likeness(end, other)]
            if found is not None
        ]
        if pairs:
            what, other = min(pairs, key=lambda pair: _ORDER.index(pair[0]))
            yield _apart(scene, what, end, other)


_ORDER = (PRIVATE, ABSOLUTE, NAMESPACE, CASE, UNDERSCORE, PLURAL, SPELLING)
_HOW = {
    'case': CASE,
    'underscore': UNDERSCORE,
    'plural': PLURAL,
    'spelling': SPELLING,
}


def _apart(scene: Scene, what: Kind, end: Endpoint, other: Endpoint) -> Fault:
    text = (
        f'{end.node} waits on {end.topic}, where nobody publishes; {other.topic} has a publisher '
        f'of that type, {other.node}, which nobody hears.'
    )
    if what is ABSOLUTE:
        slashed = end if not end.topic.startswith(_space(end.node)) else other
        text += f' {slashed.node} names {slashed.topic} with a slash in front.'
    elif what is PRIVATE:
        private = end if end.topic.startswith(f'{end.node}/') else other
        text += f' The name of {private.node} is in front of {private.topic}.'
    return Fault(what, scene.mended_first(end.node, other.node), end.topic, text)


def _likeness(end: Endpoint, other: Endpoint) -> Kind | None:
    """Return in which way the names of two ends are alike, None if they are not."""
    both = ((end, other), (other, end))
    for one, two in both:
        if one.topic == f'{one.node}/{_last(one.topic)}' and _last(one.topic) == _last(two.topic):
            return PRIVATE
        space = _space(one.node)
        if space and not one.topic.startswith(space) and two.topic == f'{space[:-1]}{one.topic}':
            return ABSOLUTE
    if any(one.topic.endswith(two.topic) for one, two in both):
        return NAMESPACE
    return _HOW.get(alike(end.topic, other.topic))


def alike(one: str, two: str) -> str:
    """Return in which way two different names are alike, '' if they are not."""
    if one == two or re.findall(r'\d+', one) != re.findall(r'\d+', two):
        return ''  # two that differ in a number are meant to be two
    if one.lower() == two.lower():
        return 'case'
    if one.replace('_', '').lower() == two.replace('_', '').lower():
        return 'underscore'
    short, long = sorted((one, two), key=len)
    if long in (f'{short}s', f'{short}es'):
        return 'plural'
    most = 2 if len(short) > 10 else 1 if len(short) > 4 else 0
    return 'spelling' if abs(len(one) - len(two)) <= most and _edits(one, two) <= most else ''


def nearest_of(name: str, names: Iterator[str] | list[str]) -> str:
    """Return the name that is alike, with any namespace; '' if there is none."""
    known = list(dict.fromkeys(names))
    for other in known:
        if alike(name, other) or (other != name and _last(other) == _last(name)):
            return other
    return next((other for other in known if alike(_last(name), _last(other))), '')


def _edits(one: str, two: str) -> int:
    """Return how many letters to add, leave out, replace or swap make one name of another."""
    two_above: list[int] = []
    above: list[int] = []
    row = list(range(len(two) + 1))
    for i, char in enumerate(one, 1):
        two_above, above, row = above, row, [i]
        for j, other in enumerate(two, 1):
            least = min(above[j] + 1, row[j - 1] + 1, above[j - 1] + (char != other))
            if two_above and j > 1 and char == two[j - 2] and one[i - 2] == other:
                least = min(least, two_above[j - 2] + 1)
            row.append(least)
    return row[-1]


def _last(name: str) -> str:
    return name.rpartition('/')[2]


def _space(node: str) -> str:
    """Return the namespace of a node with a slash behind it, '' for the root."""
    return node.rpartition('/')[0] and f'{node.rpartition("/")[0]}/'


def look_at_kinds(scene: Scene) -> Iterator[Fault]:
    """Find clients and subscriptions that look for the right thing in the wrong place."""
    graph = scene.graph
    offered = {service.name: service for service in graph.services if service.servers}
    published = {topic.name: topic for topic in graph.topics if topic.publishers}
    for topic in graph.topics:
        service = offered.get(topic.name)
        if service and topic.subscriptions and not scene.publishers.get(topic.name):
            end = topic.subscriptions[0]
            yield Fault(
                TOPIC_OF_SERVICE,
                scene.mended_first(end.node, *service.servers),
                topic.name,
                f'{end.node} subscribes to {topic.name}, where nobody publishes: '
                f'{service.servers[0]} offers a service of that name.',
            )
    for ends, what, word in ((graph.services, SERVICE, 'service'), (graph.actions, ACTION, '')):
        for lonely in ends:
            if lonely.clients and not lonely.servers:
                same = published.get(lonely.name) if word else None
                if same is not None:
                    yield Fault(
                        SERVICE_OF_TOPIC,
                        scene.mended_first(lonely.clients[0], same.publishers[0].node),
                        lonely.name,
                        f'{lonely.clients[0]} has a client of the service {lonely.name}, which '
                        f'nobody offers: {same.publishers[0].node} publishes on a topic of that '
                        'name.',
                    )
                yield from _server_elsewhere(scene, lonely, what, word or 'action')


def _server_elsewhere(
    scene: Scene, lonely: GraphService | GraphAction, what: Kind, word: str
) -> Iterator[Fault]:
    services, actions = scene.graph.services, scene.graph.actions
    for other in services if what is SERVICE else actions:
        near = alike(lonely.name, other.name) or lonely.name.endswith(other.name)
        near = near or other.name.endswith(lonely.name)
        free = other.servers and not other.clients and other.name != lonely.name
        if near and free and set(lonely.types) == set(other.types):
            yield Fault(
                what,
                scene.mended_first(lonely.clients[0], other.servers[0]),
                lonely.name,
                f'{lonely.clients[0]} has a client of the {word} {lonely.name}, which nobody '
                f'offers; {other.servers[0]} offers {other.name}.',
            )
            return


def look_at_nodes(scene: Scene) -> Iterator[Fault]:
    """Find nodes of one name."""
    for node in scene.graph.nodes:
        if node.count > 1:
            yield Fault(
                DOUBLE,
                (node.name,),
                node.name,
                f'{node.count} nodes are called {node.name}. ROS allows it, but tools and people '
                'mix them up.',
            )
