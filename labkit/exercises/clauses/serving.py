"""Clauses on services: who offers one, and what it answers to each call."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import common_mistakes, expect
from labkit.exercises.clauses.base import Evidence, GraphClause
from labkit.exercises.observation import LIFE_SEC
from labkit.exercises.verdict import Fail
from labkit.exercises.what_is_asked import SERVICE, Role
from labkit.exercises.words import words_of

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Call', 'Responds', 'Serves']

WORDS = words_of(__file__)

# How long a client may take to find its server, and a response to come, s of real time.
READY_SEC = 5.0
RESPONSE_SEC = 5.0
# After so long it is looked whether a callback hangs, s.
PATIENCE_SEC = 1.0


@dataclass(frozen=True)
class Serves(GraphClause):
    """A node offers a service or an action.

    Attributes:
        service: Full name of the service.
        srv_type: Name of the type.
        by: Full name of the node; any node if empty.
    """

    service: str
    srv_type: str
    by: str = ''

    @property
    def text(self) -> str:
        """What is asked for."""
        what = 'serves-action' if '/action/' in self.srv_type else 'serves'
        return WORDS.of(service=self.service, srv_type=self.srv_type).clause(what)

    @property
    def roles(self) -> dict[Role, str]:
        """It serves."""
        return {(SERVICE, self.service): self.srv_type}

    def find(self, evidence: Evidence) -> None:
        """Look for the server, and whether its node is spun."""
        found = expect.server(evidence.probe, self.service)
        expect.that(
            self.by in ('', found.node),
            expected=f'{self.by} serves {self.service}',
            seen=f'{found.node} serves it',
            mistake=common_mistakes.OTHER_SERVER.of(service=self.service, node=self.by),
        )


@dataclass(frozen=True)
class Call:
    """A call of a service: what was asked, and what was answered.

    Attributes:
        request: The fields of the request.
        response: The response.
    """

    request: Mapping[str, Any]
    response: Any


@dataclass(frozen=True, eq=False)
class Responds(GraphClause):
    """A service answers every call, also two at once, and answers rightly.

    Attributes:
        service: Full name of the service. A clause `Serves` stands before this one.
        words: What is asked for, in words of the task.
        draw: Draws the requests: groups of fields. Those of a group are sent at once, by several
            clients.
        rule: Gets all calls in the order of their responses, and raises Fail if one was answered
            wrongly.
    """

    service: str
    words: str
    draw: Callable[[], Sequence[Sequence[Mapping[str, Any]]]]
    rule: Callable[[Sequence[Call]], None]

    def judge(self, evidence: Evidence) -> str:
        """Call the service, and judge the responses."""
        from labkit.rosgraph.interfaces import service_class

        probe = evidence.probe
        srv_type = service_class(probe.scope.serves[self.service])
        groups = self.draw()
        node = probe.spun_node
        clients = [
            node.create_client(srv_type, self.service) for _ in range(max(map(len, groups)))
        ]
        calls: list[Call] = []
        try:
            probe.wait(lambda: all(client.service_is_ready() for client in clients), READY_SEC)
            for group in groups:
                calls += self._ask(probe, clients, srv_type, group)
                self._let_time_pass(evidence, LIFE_SEC / len(groups))
        finally:
            for client in clients:
                node.destroy_client(client)
        self.rule(calls)
        return f'{self.service} has answered {len(calls)} calls.'

    def _let_time_pass(self, evidence: Evidence, seconds: float) -> None:
        """Let the server's own time pass between two calls; in another process it is not moved."""
        ends = evidence.probe.all_servers()
        server = next((end.node for end in ends if end.service == self.service), '')
        if evidence.probe.node_object(server) is not None:
            life = evidence.live({}, seconds, [self], nodes=[server])
            replace(evidence, life=life).refuse_trouble(())

    def _ask(
        self, probe: Probe, clients: Sequence[Any], srv_type: Any, group: Sequence[Any]
    ) -> list[Call]:
        """Send some requests at once; return the calls in the order of their responses."""
        found: list[Call] = []
        for client, fields in zip(clients, group, strict=False):
            future = client.call_async(srv_type.Request(**fields))
            future.add_done_callback(
                lambda done, fields=fields: found.append(Call(fields, done.result()))
            )
        began = time.monotonic()

        def all_there() -> bool:
            return len(found) == len(group)

        if not probe.wait(all_there, PATIENCE_SEC):
            expect.hanging()
        if not probe.wait(all_there, RESPONSE_SEC):
            self._refuse_silence(probe, group, len(found), time.monotonic() - began)
        return found

    def _refuse_silence(
        self, probe: Probe, group: Sequence[Any], count: int, seconds: float
    ) -> NoReturn:
        expect.hanging()
        names = {server.node for server in probe.all_servers() if server.service == self.service}
        mistake = common_mistakes.SOME_UNANSWERED if count else common_mistakes.SERVICE_SILENT
        if not names:
            mistake = common_mistakes.SERVER_ENDED.of(service=self.service)
        raise Fail(
            f'a response of {self.service} to each of {len(group)} requests',
            f'{count} responses in {seconds:.0f} s',
            mistake,
        )
