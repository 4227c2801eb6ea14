"""Matchers for the graph: is it there, of the right type, once, and by whom.

What is missing is looked for under the names that beginners give it, and a wrong name is told
from no attempt at all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from labkit.errors import nearest
from labkit.exercises.probe import Probe
from labkit.exercises.scope import PUBLISHER, SUBSCRIPTION
from labkit.exercises.verdict import Fail, NotAttempted

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
        other = nearest(name, names)
        raise Fail(
            f'a node called {name}',
            f'{_list(names) or "no node"}',
            why=name_trouble(name, other) if other else '',
            todo=f'The name is what super().__init__() gets: {name.rsplit("/", 1)[-1]!r}.',
        )
    copies = probe.node_names().count(name)
    if copies > 1:
        raise Fail(
            f'one node called {name}',
            f'{copies} nodes of that name',
            why='Two copies of the node run at once. Each does its work, so everything happens '
            'twice.',
            todo='End one of them: lab.remove(...), or stop the other process or notebook.',
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
        raise Fail(
            expected,
            seen,
            why=f'{found[0].node} makes a publisher again and again: create_publisher() is called '
            'in a callback or in a loop.',
            todo='Make the publisher once, in __init__, keep it as self.publisher, and only '
            'publish in the callback.',
        )
    if len(nodes) == 1:
        raise Fail(
            expected,
            seen,
            why='Two copies of the node run at once, and their messages mix on the topic.',
            todo='End one of them: stop the other process, or shut the other notebook down.',
        )
    raise Fail(
        expected,
        seen,
        why='Another node publishes on the same topic. A subscriber hears both, and cannot tell '
        'them apart.',
        todo="End the one that does not belong here, such as lab.remove('name'); "
        'a node of another notebook ends there.',
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
            raise Fail(
                f'{endpoint.topic} with {policy} {wanted}',
                f'{endpoint.node} uses {policy} {seen}',
                why='A number alone as the last argument is the depth; everything else is then '
                'the default: reliable and volatile.'
                if seen in ('reliable', 'volatile')
                else '',
                todo=f'Pass a QoSProfile with {policy}={policy.title()}Policy.{wanted.upper()}.',
            )


def _find(
    probe: Probe, kind: str, topic: str, by: str, deadline_sec: float = math.inf
) -> Endpoint:
    ask = probe.publishers if kind == PUBLISHER else probe.subscriptions
    msg_type = probe.scope.msg_type((kind, topic))

    def matching() -> list[Endpoint]:
        return [endpoint for endpoint in ask(topic) if by in ('', endpoint.node)]

    # A node of an earlier exercise may be there already, and this one's still on its way.
    if not probe.wait_to_appear(lambda: matching() and probe.attempt()):
        _explain_missing(probe, kind, topic, msg_type, by)
    for endpoint in matching():
        if endpoint.msg_type != msg_type:
            _refuse_type(endpoint, kind, msg_type)
        if kind == SUBSCRIPTION:
            _refuse_qos(endpoint, deadline_sec)
        elif topic in probe.scope.reliable:
            _refuse_best_effort(endpoint)
    return matching()[0]


def _refuse_type(endpoint: Endpoint, kind: str, msg_type: str) -> NoReturn:
    raise Fail(
        f'{endpoint.topic} with messages of type {msg_type}',
        f'{endpoint.node} {_KINDS[kind][1]} {endpoint.msg_type} there',
        why='A topic carries one type of message. Two sides with different types never hear each '
        'other, and nobody says so.',
        todo=f'Import {msg_type.rsplit("/", 1)[-1]} from {msg_type.split("/")[0]}.msg and use it '
        'for this topic.',
    )


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
            why='A publisher offers, and a subscription asks. Where it asks for more than is '
            'offered, no message passes.',
            todo='Ask for less in the profile of the subscription.',
        )
    if reason:
        raise Fail(
            f'a subscription to {subscription.topic} that hears a usual publisher',
            f'the QoS profile of {subscription.node} does not match that of a usual publisher: '
            f'{reason}',
            why='No message goes from one side to the other where QoS profiles do not match, and '
            'nobody says so.',
            todo='Ask for less in the profile of the subscription. A number alone, the depth, '
            'asks for what is usual.',
        )


def _refuse_best_effort(publisher: Endpoint) -> None:
    """Raise Fail if who asks for reliable delivery hears nothing of a publisher."""
    from rclpy.qos import ReliabilityPolicy

    if publisher.qos.reliability == ReliabilityPolicy.BEST_EFFORT:
        raise Fail(
            f'a publisher on {publisher.topic} that a usual subscription hears, as the robot has '
            'one',
            f'{publisher.node} offers best effort, and who listens there asks for reliable',
            why='A publisher offers, and a subscription asks. Where it asks for more than is '
            'offered, no message passes.',
            todo='Offer reliable delivery. A number alone, the depth, offers it.',
        )


def _explain_missing(probe: Probe, kind: str, topic: str, msg_type: str, by: str) -> NoReturn:
    """Raise Fail with the likeliest reason why an endpoint is missing, or NotAttempted."""
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
            why=name_trouble(topic, meant),
            todo=f'Write the topic as {topic!r}.',
        )
    mine = [other for other in others if other.node in nodes]
    if kind == PUBLISHER:
        _explain_echo(probe, expected, mine)
    strange = [other for other in unknown if other.node in nodes and other.msg_type == msg_type]
    if strange:
        raise Fail(
            expected,
            f'{strange[0].node} {_KINDS[kind][1]} on {strange[0].topic}',
            why='The node works with a topic of another name, so nobody who looks for '
            f'{topic} finds it.',
            todo=f'Write the topic as {topic!r}.',
        )
    seen = _list([f'{other.node} {_KINDS[kind][1]} {other.topic}' for other in mine])
    names = probe.node_names()
    if by and by not in names:
        near = nearest(by, [other.node for other in mine])
        raise Fail(
            expected,
            seen or f'{_list(names)}, and no node called {by}',
            why=name_trouble(by, near) if near else f'There is no node called {by}.',
            todo=f'The name is what super().__init__() gets: {by.rsplit("/", 1)[-1]!r}. '
            'Each node has to be made, and handed over with lab.spin.',
        )
    raise Fail(
        expected,
        seen or f'{_list(sorted(nodes))} without any {kind}',
        why=f'create_{kind}() for this topic has not been called, or not yet.',
        todo=f'Call it in __init__ with {msg_type.rsplit("/", 1)[-1]} and {topic!r}.',
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
                why='The node hears what it says itself, answers that too, and so on for ever.',
                todo='Publish on a topic of its own.',
            )


def name_trouble(wanted: str, seen: str) -> str:
    """Say how a name differs from the one that is asked for."""
    if wanted.lower() == seen.lower():
        return f'Capital and small letters differ in names: {seen} and {wanted} are two names.'
    if wanted.rsplit('/', 1)[-1] == seen.rsplit('/', 1)[-1]:
        return (
            'The last part is right, but it lies in another namespace: names must be equal from '
            'the first slash to the last letter. A "~" puts the name of the node before it. '
        ).strip()
    if wanted.lower().replace('_', '') == seen.lower().replace('_', ''):
        return 'The names differ in an underscore; names must be equal to the last character.'
    return f'{seen} is not {wanted}: names must be equal to the last letter. A slip of the pen?'


def _list(names: Sequence[str]) -> str:
    return ', '.join(names)
