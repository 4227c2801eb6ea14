"""Matchers for services and actions: is it offered, of the right type, once, and by whom."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from labkit.errors import nearest
from labkit.exercises.expect.endpoints import name_trouble
from labkit.exercises.expect.spinning import hanging, how_to_spin, runs
from labkit.exercises.probe import Probe
from labkit.exercises.scope import SERVICE
from labkit.exercises.verdict import Fail, NotAttempted

if TYPE_CHECKING:
    from labkit.rosgraph.servers import Server

__all__ = ['server']

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

    if not probe.wait_to_appear(matching):
        _explain_missing(probe, service, srv_type)
    found = matching()[0]
    if found.srv_type != srv_type:
        raise Fail(
            f'{service} with the type {srv_type}',
            f'{found.node} offers it with the type {found.srv_type}',
            why='The type says what a request and a response hold. A client of one type does not '
            'reach a server of another one.',
            todo=_how_to_import(srv_type),
        )
    counted = f'{service}/_action/send_goal' if found.is_action else service
    if not probe.wait(lambda: probe.node.count_services(counted) < 2, GONE_SEC):
        names = [other.node for other in matching()]
        raise Fail(
            f'one server of {service}',
            f'{probe.node.count_services(counted)} servers: {", ".join(names)}',
            why='Each of them answers each request. Which response a client gets is a matter of '
            'luck.',
            todo='End the one that does not belong here: lab.remove(...), or stop the other '
            'process or notebook.',
        )
    hanging()
    if not runs(probe, found.node):
        raise Fail(
            f'{found.node} answers requests',
            f'{found.node} is there, but it is not spun',
            why='Requests come and wait. Nobody calls the callback.',
            todo=how_to_spin(probe, found.node),
        )
    return found


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
            why=name_trouble(service, name),
            todo=f'Write the name as {service!r}.',
        )
    raise Fail(
        expected,
        f'{", ".join(sorted(nodes))} without a service of this name',
        why=f'{_maker(srv_type)} for it has not been called, or not yet.',
        todo=f'Call it in __init__ with {srv_type.rsplit("/", 1)[-1]} and {service!r}.',
    )


def _maker(srv_type: str) -> str:
    return 'ActionServer()' if '/action/' in srv_type else 'create_service()'


def _how_to_import(srv_type: str) -> str:
    package, kind, name = srv_type.split('/')
    return f'Import {name} from {package}.{kind} and pass it to {_maker(srv_type)}.'
