"""Clauses on services: who offers one, and what it answers to each call."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises import expect
from labkit.exercises.clauses.base import Clause, Evidence
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Call', 'Responds', 'Serves']

# How long a client may take to find its server, and a response to come, s of real time.
READY_SEC = 5.0
RESPONSE_SEC = 5.0
# After so long it is looked whether a callback hangs, s.
PATIENCE_SEC = 1.0


@dataclass(frozen=True)
class Serves(Clause):
    """A node offers a service or an action.

    Attributes:
        service: Full name of the service. Its type is in the `serves` of the exercise.
        srv_type: Name of the type, for the words of the task.
    """

    service: str
    srv_type: str

    @property
    def text(self) -> str:
        """What is asked for."""
        what = 'serve the action' if '/action/' in self.srv_type else 'serve'
        return f'{what} `{self.service}` (`{self.srv_type}`)'

    def find(self, evidence: Evidence) -> None:
        """Look for the server, and whether its node is spun."""
        expect.server(evidence.probe, self.service)


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
class Responds(Clause):
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

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

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
        finally:
            for client in clients:
                node.destroy_client(client)
        self.rule(calls)
        return f'{self.service} has answered {len(calls)} calls.'

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
        why = 'The callback of the service has not returned, or it has raised an error.'
        todo = 'Let the callback fill in the response, return it, and wait for nothing.'
        if not names:
            why = f'The server of {self.service} has ended meanwhile.'
            todo = 'Look at the output of its program: a callback may have raised an error.'
        elif count:
            why = 'Of several requests at once, not all are answered.'
        raise Fail(
            f'a response of {self.service} to each of {len(group)} requests',
            f'{count} responses in {seconds:.0f} s',
            why=why,
            todo=todo,
        )
