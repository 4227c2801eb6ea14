"""Matchers for the graph: is it there, of the right type, once, and by whom.

What is missing is looked for under the names that beginners give it, and a wrong name is told
from no attempt at all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from labkit.errors import nearest
from labkit.exercises import common_mistakes
from labkit.exercises.mistakes import Mistake
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail, NotAttempted
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['alone', 'name_trouble', 'node', 'publisher', 'qos', 'subscription']

_KINDS = {
    PUBLISHER: ('publisher on', 'publishes'),
    SUBSCRIPTION: ('subscription to', 'subscribes'),
}


def publisher(probe: Probe, topic: str, *, by: str = '') -> Endpoint:
    """Expect a publisher of the learner's on a topic, of the type that the exercise asks for.

    Args:
        probe: The probe of the check.
        topic: Full name of the topic, such as `'/odds'`.
        by: Full name of the node it must belong to; any node if empty.

    Returns:
        The publisher.

    Raises:
        NotAttempted: Nothing of the learner's shows an attempt, see `Scope`.
        Fail: It is missing, misnamed, of another type, or not the only one.
    """
    found = _find(probe, PUBLISHER, topic, by)
    if topic in probe.scope.sole:
        alone(probe, topic)
    return found


def subscription(
    probe: Probe, topic: str, *, by: str = '', deadline_sec: float = math.inf
) -> Endpoint:
    """Expect a subscription of the learner's to a topic. Other arguments as for `publisher`.

    Args:
        probe: The probe of the check.
        topic: Full name of the topic.
        by: Full name of the node it must belong to; any node if empty.
        deadline_sec: The deadline that publishers offer there, s; a usual one offers none.
    """
    return _find(probe, SUBSCRIPTION, topic, by, deadline_sec)


def node(probe: Probe, name: str) -> str:
    """Expect exactly one node of a name.

    Args:
        probe: The probe of the check.
        name: Full name of the node, such as `'/odd_publisher'`; the exercise has it in `nodes`.

    Returns:
        The name.

    Raises:
        NotAttempted: Nothing of the learner's shows an attempt, see `Scope`.
        Fail: There is none of that name, or more than one.
    """
    if name not in probe.scope.nodes:
        raise LookupError(f'This exercise asks for no node {name}.')
    if not probe.wait_to_appear(lambda: name in probe.node_names()):
        if not probe.attempt():
            raise NotAttempted
        names = probe.node_names()
        same = (each for each in names if _bare(each) == _bare(name))
        other = next(same, '') or nearest(name, names)
        raise Fail(
            f'a node called {name}',
            f'{_list(names) or "no node"}',
            _named(name_trouble(name, other) if other else None, common_mistakes.NODE_NAME, name),
        )
    copies = probe.node_names().count(name)
    if copies > 1:
        raise Fail(
            f'one node called {name}',
            f'{copies} nodes of that name',
            common_mistakes.TWO_NODES,
        )
    return name


def alone(probe: Probe, topic: str) -> None:
    """Expect one publisher on a topic at most, and name who else publishes there.

    When the check ends, all topics are looked at that are not shared: a second one may be late.

    Raises:
        Fail: There are several.
    """
    found = probe.publishers(topic)
    if len(found) < 2:
        return
    nodes = {endpoint.node for endpoint in found}
    places = [probe.place(endpoint) for endpoint in found]
    listed = [f'{e.node} {place}' for e, place in zip(found, places, strict=True)]
    seen = f'{len(found)} publishers on {topic}: {_list(listed)}'
    expected = f'one publisher on {topic}'
    _explain_echo(probe, expected, found)
    if len(nodes) == 1 and len(set(places)) == 1 and probe.node_names().count(found[0].node) == 1:
        raise Fail(expected, seen, common_mistakes.MADE_AGAIN.of(node=found[0].node))
    raise Fail(
        expected,
        seen,
        common_mistakes.TWO_COPIES if len(nodes) == 1 else common_mistakes.SECOND_PUBLISHER,
    )


def qos(endpoint: Endpoint, *, reliability: str = '', durability: str = '') -> None:
    """Expect a QoS profile. The graph does not know the depth, so it can't be asked for.

    Args:
        endpoint: What `publisher` or `subscription` returned.
        reliability: `'reliable'` or `'best_effort'`; not looked at if empty.
        durability: `'volatile'` or `'transient_local'`; not looked at if empty.

    Raises:
        Fail: The profile is another one.
    """
    for policy, wanted in (('reliability', reliability), ('durability', durability)):
        seen = getattr(endpoint.qos, policy).name.lower()
        if wanted and seen != wanted:
            default = seen in ('reliable', 'volatile')
            mistake = common_mistakes.DEFAULT_QOS if default else common_mistakes.OTHER_QOS
            raise Fail(
                f'{endpoint.topic} with {policy} {wanted}',
                f'{endpoint.node} uses {policy} {seen}',
                mistake.of(policy=policy, name=policy.title(), wanted=wanted.upper()),
            )


def _find(
    probe: Probe, kind: str, topic: str, by: str, deadline_sec: float = math.inf
) -> Endpoint:
    ask = probe.publishers if kind == PUBLISHER else probe.subscriptions
    msg_type = probe.scope.msg_type((kind, topic))

    found: list[Endpoint] = []  # kept, for it may end at any time

    def is_there() -> object:
        found[:] = [endpoint for endpoint in ask(topic) if by in ('', endpoint.node)]
        return found and probe.attempt()

    # A node of an earlier exercise may be there already, and this one's still on its way.
    if not probe.wait_to_appear(is_there):
        _explain_missing(probe, kind, topic, msg_type, by)
    for endpoint in found:
        if endpoint.msg_type != msg_type:
            _refuse_type(endpoint, kind, msg_type)
        if kind == SUBSCRIPTION:
            _refuse_qos(endpoint, deadline_sec)
        elif topic in probe.scope.reliable:
            _refuse_best_effort(endpoint)
    return found[0]


def _refuse_type(endpoint: Endpoint, kind: str, msg_type: str) -> NoReturn:
    fail = Fail(
        f'{endpoint.topic} with messages of type {msg_type}',
        f'{endpoint.node} {_KINDS[kind][1]} {endpoint.msg_type} there',
        common_mistakes.OTHER_TYPE.of(package=msg_type.split('/')[0], msg_type=_bare(msg_type)),
    )
    # Whether a callback that has the wrong type to fill has raised by now is luck.
    fail.made_so = True
    raise fail


def _refuse_qos(subscription: Endpoint, deadline_sec: float) -> None:
    """Raise Fail if a subscription asks for more than publishers usually offer."""
    from rclpy.duration import Duration, Infinite
    from rclpy.qos import LivelinessPolicy, QoSProfile

    from labkit.rosgraph.matching import qos_mismatch

    has_deadline = deadline_sec < math.inf
    # What a depth alone is in the graph.
    usual = QoSProfile(  # type: ignore[no-untyped-call]
        depth=10,
        deadline=Duration(seconds=deadline_sec) if has_deadline else Infinite,
        liveliness=LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Infinite,
    )
    reason = qos_mismatch(usual, subscription.qos)
    if reason and has_deadline:
        raise Fail(
            f'a subscription to {subscription.topic} that matches what is published there',
            f'the QoS profile of {subscription.node} asks for more: '
            f'{reason[:1].lower()}{reason[1:]}',
            common_mistakes.OFFER_AND_REQUEST.of(
                todo='Ask for less in the profile of the subscription.'
            ),
        )
    if reason:
        raise Fail(
            f'a subscription to {subscription.topic} that hears a usual publisher',
            f'the QoS profile of {subscription.node} does not match that of a usual publisher: '
            f'{reason}',
            common_mistakes.UNUSUAL_QOS,
        )


def _refuse_best_effort(publisher: Endpoint) -> None:
    """Raise Fail if a subscription that asks for reliable delivery would hear nothing."""
    from rclpy.qos import ReliabilityPolicy

    if publisher.qos.reliability == ReliabilityPolicy.BEST_EFFORT:
        raise Fail(
            f'a publisher on {publisher.topic} that a usual subscription hears, as the robot has '
            'one',
            f'{publisher.node} offers best effort, and the subscription there asks for reliable',
            common_mistakes.OFFER_AND_REQUEST.of(
                todo='Offer reliable delivery. A number alone, the depth, offers it.'
            ),
        )


def _explain_missing(probe: Probe, kind: str, topic: str, msg_type: str, by: str) -> NoReturn:
    """Raise Fail with the likeliest reason why an endpoint is missing, or NotAttempted."""
    from labkit.exercises.attempts import replaced_class

    nodes = probe.attempt()
    if not nodes or probe.process_is_starting():
        raise NotAttempted
    expected = f'{by or "a node"} with a {_KINDS[kind][0]} {topic} ({msg_type})'
    others = probe.all_publishers() if kind == PUBLISHER else probe.all_subscriptions()
    unknown = [other for other in others if other.topic not in probe.scope.known]
    meant = nearest(topic, [other.topic for other in unknown])
    if meant:
        other = next(other for other in unknown if other.topic == meant)
        raise Fail(
            expected,
            f'{other.node} {_KINDS[kind][1]} on {meant}'
            if kind == PUBLISHER
            else f'{other.node} {_KINDS[kind][1]} to {meant}',
            name_trouble(topic, meant).then(f'Write the topic as {topic!r}.'),
        )
    mine = [other for other in others if other.node in nodes]
    if kind == PUBLISHER:
        _explain_echo(probe, expected, mine)
    strange = [other for other in unknown if other.node in nodes and other.msg_type == msg_type]
    if strange:
        raise Fail(
            expected,
            f'{strange[0].node} {_KINDS[kind][1]} on {strange[0].topic}',
            common_mistakes.STRANGE_TOPIC.of(topic=topic),
        )
    seen = _list([f'{other.node} {_KINDS[kind][1]} {other.topic}' for other in mine])
    names = probe.node_names()
    if by and by not in names:
        near = nearest(by, [other.node for other in mine])
        raise Fail(
            expected,
            seen or f'{_list(names)}, and no node called {by}',
            _named(name_trouble(by, near) if near else None, common_mistakes.NO_NODE, by),
        )
    ended = replaced_class(kind, topic)
    mistake = common_mistakes.REPLACED.of(name=ended) if ended else common_mistakes.NOT_MADE
    raise Fail(
        expected,
        seen or f'{_list(sorted(nodes))} without any {kind}',
        mistake.of(kind=kind, msg_type=_bare(msg_type), topic=topic),
    )


def _explain_echo(probe: Probe, expected: str, publishers: Sequence[Endpoint]) -> None:
    """Raise Fail if a node publishes on a topic that it has to subscribe to."""
    for other in publishers:
        if other.topic not in probe.scope.subscribes:
            continue
        if other.node in {end.node for end in probe.subscriptions(other.topic)}:
            raise Fail(
                expected,
                f'{other.node} publishes on {other.topic}, the topic that it subscribes to',
                common_mistakes.HEARS_ITSELF,
            )


def name_trouble(wanted: str, seen: str) -> Mistake:
    """Return how a name differs from the one that is asked for."""
    if wanted.lower() == seen.lower():
        found = common_mistakes.CAPITALS
    elif wanted.rsplit('/', 1)[-1] == seen.rsplit('/', 1)[-1]:
        found = common_mistakes.NAMESPACE
    elif wanted.lower().replace('_', '') == seen.lower().replace('_', ''):
        found = common_mistakes.UNDERSCORE
    else:
        found = common_mistakes.OTHER_NAME
    return found.of(seen=seen, wanted=wanted)


def _named(found: Mistake | None, usual: Mistake, name: str) -> Mistake:
    """Return what is wrong with the name of a node, with what to do about it."""
    usual = usual.of(node=name, bare=_bare(name))
    if found is None or found.id == common_mistakes.NAMESPACE.id:
        return found or usual
    return found.then(usual.step)


def _bare(name: str) -> str:
    """Return the last part of the name of a node or a type."""
    return name.rsplit('/', 1)[-1]


def _list(names: Sequence[str]) -> str:
    return ', '.join(names)
