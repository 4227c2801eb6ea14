"""Matchers for services and actions: is it offered, of the right type, once, and by whom."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from labkit.errors import nearest
from labkit.exercises import common_mistakes
from labkit.exercises.expect.endpoints import name_trouble
from labkit.exercises.expect.spinning import hanging, how_to_spin, runs
from labkit.exercises.probe import Probe
from labkit.exercises.verdict import Fail, NotAttempted
from labkit.exercises.what_is_asked import SERVICE

if TYPE_CHECKING:
    from labkit.rosgraph.servers import Server

__all__ = ['asks', 'only_given', 'server']

# How long a server that has ended may still be counted, s.
GONE_SEC = 1.0


def server(probe: Probe, service: str) -> Server:
    """Expect a server of the learner's, of the type that the exercise asks for, and its node spun.

    Args:
        probe: The probe of the check.
        service: Full name of the service; the exercise has it in `serves`.

    Returns:
        The server.

    Raises:
        NotAttempted: Nothing of the learner's shows an attempt, see `Scope`.
        Fail: It is missing, misnamed, of another type, not the only one, or not spun.
    """
    srv_type = probe.scope.msg_type((SERVICE, service))

    def matching() -> list[Server]:
        return [other for other in probe.all_servers() if other.service == service]

    seen: list[Server] = []  # kept, for it may end at any time

    def is_there() -> list[Server]:
        seen[:] = matching()
        return seen

    if not probe.wait_to_appear(is_there):
        _explain_missing(probe, service, srv_type)
    found = seen[0]
    if found.srv_type != srv_type:
        raise Fail(
            f'{service} with the type {srv_type}',
            f'{found.node} offers it with the type {found.srv_type}',
            common_mistakes.SERVICE_TYPE.of(maker=_maker(srv_type), **_parts(srv_type)),
        )
    counted = f'{service}/_action/send_goal' if found.is_action else service
    if not probe.wait(lambda: probe.node.count_services(counted) < 2, GONE_SEC):
        names = [other.node for other in matching()]
        raise Fail(
            f'one server of {service}',
            f'{probe.node.count_services(counted)} servers: {", ".join(names)}',
            common_mistakes.TWO_SERVERS,
        )
    hanging()
    if not runs(probe, found.node):
        raise Fail(
            f'{found.node} answers requests',
            f'{found.node} is there, but it is not spun',
            common_mistakes.NOT_ANSWERED.of(spin=how_to_spin(probe, found.node)),
        )
    return found


def only_given(probe: Probe, service: str, given: str) -> None:
    """Raise Fail if a node of the learner's serves what a node of the lesson does.

    Args:
        probe: The probe of the check.
        service: Full name of the service or action.
        given: Full name of the node of the lesson.
    """
    found = [other.node for other in probe.all_servers() if other.service == service]
    if found:
        raise Fail(
            f'one server of {service}: {given}',
            f'{", ".join(found)} serves {service} as well',
            common_mistakes.TWO_SERVERS,
        )


def asks(probe: Probe, node: str, service: str) -> None:
    """Raise Fail if a node has a client for something else, and none for a service or action."""
    from labkit.rosgraph.listings import ends_of_node

    ends = ends_of_node(probe.node, node)
    found = [name for name, _ in (*ends.service_clients, *ends.action_clients)]
    if found and service not in found:
        raise Fail(
            f'{node} asks {service}',
            f'it asks {", ".join(found)}',
            name_trouble(service, nearest(service, found) or found[0]).then(
                f'Write the name as {service!r}.'
            ),
        )


def _explain_missing(probe: Probe, service: str, srv_type: str) -> NoReturn:
    """Raise Fail with the likeliest reason why a server is missing, or NotAttempted."""
    nodes = probe.attempt()
    if not nodes or probe.process_is_starting():
        raise NotAttempted
    expected = f'a node that serves {service} ({srv_type})'
    others = [other for other in probe.all_servers() if other.service not in probe.scope.known]
    meant = nearest(service, [other.service for other in others])
    typed = [other.service for other in others if other.srv_type == srv_type]
    name = meant or next(iter(typed), '')
    if name:
        other = next(other for other in others if other.service == name)
        raise Fail(
            expected,
            f'{other.node} serves {name} ({other.srv_type})',
            name_trouble(service, name).then(f'Write the name as {service!r}.'),
        )
    raise Fail(
        expected,
        f'{", ".join(sorted(nodes))} without a service of this name',
        common_mistakes.NO_SERVER.of(maker=_maker(srv_type), service=service, **_parts(srv_type)),
    )


def _maker(srv_type: str) -> str:
    return 'ActionServer()' if '/action/' in srv_type else 'create_service()'


def _parts(srv_type: str) -> dict[str, str]:
    return dict(zip(('package', 'kind', 'name'), srv_type.split('/'), strict=True))
