"""Types and QoS: two ends of one name that do not match."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from labkit.silent.kinds import Fault, Kind, kind
from labkit.silent.scene import OwnNode, Publisher, Scene, Subscription

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['look_at_history', 'look_at_pairs', 'look_at_servers']

_SAME_TYPE = 'Give both ends the same type.'
_ONE_TYPE = 'all ends of the name have one type'
_WARNS = 'rclpy warns at both ends, without the other one'

STAMPED = kind(
    'types.stamped',
    'The robot does not move: Twist where TwistStamped is expected',
    'Send the type that the other end expects: the stamped one has a header and, inside, the '
    'plain one.',
    _ONE_TYPE,
    others='ros2 topic list -t shows two types',
)
PACKAGE = kind(
    'types.package',
    'No message arrives: a type of the same name from another package',
    _SAME_TYPE,
    _ONE_TYPE,
    others='ros2 topic list -t shows two types',
)
SIZE = kind(
    'types.size',
    'No message arrives: Int32 and Int16, Float64 and Float32 are two types',
    _SAME_TYPE,
    _ONE_TYPE,
    others='ros2 topic list -t shows two types',
)
OTHER = kind(
    'types.other',
    'No message arrives: publisher and subscriber have different types',
    _SAME_TYPE,
    _ONE_TYPE,
    others='ros2 topic list -t shows two types',
)
VERSION = kind(
    'types.version',
    'Garbled messages or none: the two ends were built from two versions of a message',
    'Build the package of the message again at both ends, and start both anew.',
    'both ends know the same definition',
)
SERVICE_TYPE = kind(
    'types.service',
    'The service is never available: client and server have different types',
    'Give the client and the server the same type.',
    _ONE_TYPE,
)
ACTION_TYPE = kind(
    'types.action',
    'The action server is never available: client and server have different types',
    'Give the client and the server the same type.',
    _ONE_TYPE,
)
RELIABILITY = kind(
    'qos.reliability',
    'No messages: the subscription asks for reliable, the publisher offers best effort',
    'Make the subscription best effort, or the publisher reliable.',
    'the publisher offers more than is asked for',
    others=_WARNS,
)
DURABILITY = kind(
    'qos.durability',
    'No messages: the subscription asks for transient local, the publisher is volatile',
    'Make the publisher transient local, or the subscription volatile.',
    'the publisher offers more than is asked for',
    others=_WARNS,
)
DEADLINE = kind(
    'qos.deadline',
    'No messages: the publisher offers no deadline, or a longer one than is asked for',
    'Take the deadline of the subscription away, or give the publisher one that is as short.',
    'the publisher offers a shorter one',
    others=_WARNS,
)
LIVELINESS = kind(
    'qos.liveliness',
    'No messages: the subscription asks for liveliness by topic, the publisher is automatic',
    'Give both ends the same liveliness.',
    'the publisher offers more than is asked for',
    others=_WARNS,
)
LEASE = kind(
    'qos.lease',
    'No messages: the lease duration of the publisher is longer than is asked for',
    'Give the publisher a lease duration that is as short, or ask for none.',
    'the publisher offers a shorter one',
    others=_WARNS,
)
DEPTH = kind(
    'qos.depth',
    'Messages get lost although both ends are reliable: the queue is too short for the burst',
    'Give the subscription a depth as large as the burst, or publish more slowly: what is pushed '
    'out of a full queue is gone, reliable or not.',
    'all messages were got, or the two ends do not match at all',
)
LATE = kind(
    'qos.late',
    'The message was published before the subscriber was there, and is not kept',
    'Wait until the subscriber is there (lab.wait_for_subscribers), or make both ends transient '
    'local: then the last messages are kept for those who come later.',
    'something was published since, or a message was got',
    aloud=False,
)
KEPT = kind(
    'qos.kept',
    'A late subscriber gets only the last message: the publisher keeps fewer than it has sent',
    'Give the publisher a depth as large as the number of messages to keep.',
    'the subscription does not ask for more messages than are kept, or the topic is /tf_static, '
    'where the last message of a broadcaster has all of its transforms',
    aloud=False,
)
LIFESPAN = kind(
    'qos.lifespan',
    'A late subscriber gets nothing: messages expire before the next one is published',
    'Make the lifespan longer than the period, or leave it away.',
    'the lifespan is longer than the period',
)
MISSED = kind(
    'qos.deadline-missed',
    'The publisher is slower than the deadline that it offers, and nobody is told',
    'Publish more often, or offer a longer deadline. An event callback tells when one is missed.',
    'it publishes in time',
)

# The graph reports a duration that is not set as one that is about so long.
_INFINITE_NS = 2**62


def look_at_pairs(scene: Scene) -> Iterator[Fault]:
    """Find pairs of a publisher and a subscription that do not match."""
    from labkit.rosgraph.matching import how_to_match, why_apart

    for topic in scene.graph.topics:
        seen = set()
        for sub in topic.subscriptions:
            for pub in topic.publishers:
                if not (sub.is_known and pub.is_known) or (sub.node, pub.node) in seen:
                    continue
                reason = why_apart(pub, sub)
                what = _why(pub, sub) if reason else _versions(pub, sub)
                if what is None:
                    continue
                seen.add((sub.node, pub.node))
                if what is VERSION:
                    reason = f'{sub.msg_type} has two definitions here'
                yield Fault(
                    what,
                    scene.mended_first(sub.node, pub.node),
                    topic.name,
                    f'{sub.node} does not hear {pub.node} on {topic.name}: '
                    f'{reason[:1].lower()}{reason[1:]}.',
                    '' if what in _SAID else how_to_match(pub, sub),
                )


_SAID = (STAMPED, VERSION)


def _why(pub: Endpoint, sub: Endpoint) -> Kind | None:
    """Return the kind of fault of two ends that do not match."""
    if pub.msg_type != sub.msg_type:
        return _difference(pub.msg_type, sub.msg_type)
    asked, offered = sub.qos, pub.qos
    for policy, strong, what in (
        ('reliability', 'RELIABLE', RELIABILITY),
        ('durability', 'TRANSIENT_LOCAL', DURABILITY),
        ('liveliness', 'MANUAL_BY_TOPIC', LIVELINESS),
    ):
        wanted, given = getattr(asked, policy).name, getattr(offered, policy).name
        if wanted == strong != given:
            return what
    wanted, given = asked.deadline.nanoseconds, offered.deadline.nanoseconds
    return DEADLINE if 0 < wanted < _INFINITE_NS and not 0 < given <= wanted else LEASE


def _difference(one: str, two: str) -> Kind:
    """Return the kind of fault of two types."""
    (package, _, name), (other_package, _, other) = one.split('/'), two.split('/')
    if name == other:
        return PACKAGE
    if package == other_package and {f'{name}Stamped', f'{other}Stamped'} & {name, other}:
        return STAMPED
    if package == other_package and name.rstrip('0123456789') == other.rstrip('0123456789'):
        return SIZE
    return OTHER


def _versions(pub: Endpoint, sub: Endpoint) -> Kind | None:
    """Return the fault if the definitions of one type differ, as far as the graph knows them."""
    known = pub.type_hash and sub.type_hash
    return VERSION if known and pub.type_hash != sub.type_hash else None


def look_at_servers(scene: Scene) -> Iterator[Fault]:
    """Find clients and servers of one name with different types."""
    for ends, what, word in (
        (scene.graph.services, SERVICE_TYPE, 'service'),
        (scene.graph.actions, ACTION_TYPE, 'action'),
    ):
        for end in ends:
            for client in end.lost:
                server = end.servers[0]
                yield Fault(
                    what,
                    scene.mended_first(client, server),
                    end.name,
                    f'The {word} {end.name} has two types, {" and ".join(end.types)}: {client} '
                    f'never finds the server {server}.',
                )


def look_at_history(scene: Scene) -> Iterator[Fault]:
    """Find messages of this process that its own subscriptions did not get."""
    from labkit.rosgraph.matching import qos_mismatch

    sent: dict[str, list[tuple[OwnNode, Publisher]]] = {}
    for node in scene.nodes:
        for pub in node.publishers:
            sent.setdefault(pub.topic, []).append((node, pub))
            yield from _in_time(node, pub)
    for node in scene.nodes:
        for sub in node.subscriptions:
            pubs = sent.get(sub.topic, [])
            if not pubs or len(pubs) != scene.publishers.get(sub.topic):
                continue
            found = list(_got(scene, node, sub, pubs))
            # What does not match has lost nothing in a queue: `look_at_pairs` tells it. Two
            # profiles take long to compare, and there is something to tell hardly ever.
            if found and not any(qos_mismatch(pub.qos, sub.qos) for _, pub in pubs):
                yield from found


def _got(
    scene: Scene, node: OwnNode, sub: Subscription, pubs: list[tuple[OwnNode, Publisher]]
) -> Iterator[Fault]:
    count = sum(pub.count for _, pub in pubs)
    names = scene.mended_first(node.name, *(other.name for other, _ in pubs))
    keeps = all(pub.qos.durability.name == 'TRANSIENT_LOCAL' for _, pub in pubs)
    asks = sub.qos.durability.name == 'TRANSIENT_LOCAL'
    if sub.missed:
        yield Fault(
            DEPTH,
            names,
            sub.topic,
            f'{node.name} has missed {sub.missed} messages on {sub.topic}: more came at a time '
            f'than its queue holds, {sub.qos.depth}.',
        )
    elif (
        count
        and not sub.heard
        and not (keeps and asks)
        and max(p.last for _, p in pubs) < sub.since
    ):
        yield Fault(
            LATE,
            names,
            sub.topic,
            f'{count} messages were published on {sub.topic} before {node.name} subscribed, and '
            'none since. Messages are kept for those who come later only if both ends are '
            'transient local.',
        )
    wanted = min(count, sub.qos.depth)
    kept = sum(pub.qos.depth for _, pub in pubs)
    merged = sub.topic == '/tf_static'
    late = max(p.last for _, p in pubs) < sub.since
    if keeps and asks and kept < wanted and late and not merged:
        yield Fault(
            KEPT,
            names,
            sub.topic,
            f'{count} messages were published on {sub.topic} before {node.name} subscribed, and '
            f'{kept} of them kept: that is the depth of the publisher.',
        )


def _in_time(node: OwnNode, pub: Publisher) -> Iterator[Fault]:
    """Find promises of a publisher that it does not keep."""
    period, life = pub.interval, pub.qos.lifespan.nanoseconds * 1e-9
    promised = pub.qos.deadline.nanoseconds * 1e-9
    if not period:
        return
    if 0 < life < period and pub.qos.durability.name == 'TRANSIENT_LOCAL':
        yield Fault(
            LIFESPAN,
            (node.name,),
            pub.topic,
            f'Messages of {node.name} on {pub.topic} are kept for {life:g} s, and one is '
            f'published each {period:.2g} s: who comes in between gets nothing.',
        )
    if 0 < promised < period:
        yield Fault(
            MISSED,
            (node.name,),
            pub.topic,
            f'{node.name} offers a deadline of {promised:g} s on {pub.topic}, and publishes each '
            f'{period:.2g} s.',
        )
