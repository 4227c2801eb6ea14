"""The nodes, topics and services that an exercise asks for, and which nodes are an attempt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from labkit.errors import nearest

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint
    from labkit.rosgraph.servers import Server

__all__ = ['NODE', 'PUBLISHER', 'SERVICE', 'SUBSCRIPTION', 'Role', 'Scope']

PUBLISHER, SUBSCRIPTION, SERVICE = 'publisher', 'subscription', 'service'
NODE = 'node'
Role = tuple[str, str]
"""One of the words above, and the name of the topic, service or node."""


@dataclass(frozen=True, kw_only=True)
class Scope:
    """The roles that an exercise asks for, and the rest of its lesson.

    Attributes:
        publishes: Topics on which the learner's nodes publish, with their types.
        subscribes: Topics to which they subscribe, with their types.
        serves: Services that they offer, with their types.
        nodes: Full names of nodes that the task asks for.
        shared: Topics on which others may publish too.
        reliable: Topics whose subscribers request reliable delivery, as the robot does.
        given: Full names of nodes that the lesson itself leaves running, with the ids of the cells
            that make them. A node of such a name that another cell has made is the learner's.
        known: All topics of the lesson. The learner's use of other topics is a wrong name.
        earlier: Roles that earlier exercises of the lesson ask for: their nodes may still run.
        of_lesson: Roles of all exercises of the lesson.
    """

    publishes: Mapping[str, str] = field(default_factory=dict)
    subscribes: Mapping[str, str] = field(default_factory=dict)
    serves: Mapping[str, str] = field(default_factory=dict)
    nodes: tuple[str, ...] = ()
    shared: frozenset[str] = frozenset()
    reliable: frozenset[str] = frozenset()
    given: Mapping[str, str] = field(default_factory=dict)
    known: frozenset[str] = frozenset()
    earlier: frozenset[Role] = frozenset()
    of_lesson: frozenset[Role] = frozenset()

    @property
    def roles(self) -> dict[Role, str]:
        """The roles of the learner's nodes, with the types of topics and services."""
        kinds = (
            (PUBLISHER, self.publishes),
            (SUBSCRIPTION, self.subscribes),
            (SERVICE, self.serves),
        )
        return {(kind, topic): name for kind, asked in kinds for topic, name in asked.items()}

    @property
    def own(self) -> dict[Role, str]:
        """The roles that no earlier exercise asks for; all of them if there are none."""
        own = {role: name for role, name in self.roles.items() if role not in self.earlier}
        return own or self.roles

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics and services of the roles."""
        return tuple(dict.fromkeys(topic for _, topic in self.roles))

    @property
    def sole(self) -> frozenset[str]:
        """The topics with at most one publisher."""
        return frozenset(self.publishes) - self.shared

    def msg_type(self, role: Role) -> str:
        """Return the type of a role's topic or service.

        Raises:
            LookupError: The exercise does not ask for this role.
        """
        if role not in self.roles:
            raise LookupError(f'This exercise asks for no {role[0]} on {role[1]}.')
        return self.roles[role]

    def attempt(
        self,
        publishers: Sequence[Endpoint],
        subscriptions: Sequence[Endpoint],
        nodes: Sequence[str],
        servers: Sequence[Server] = (),
    ) -> frozenset[str]:
        """Return the names of the learner's nodes that are an attempt at the exercise.

        They have one of this exercise's own roles or, if there are none, a similar one under
        another name. Without roles the names of nodes count. Where earlier exercises ask for all
        of its roles, those nodes are none that have another role of these.

        Args:
            publishers: The learner's publishers.
            subscriptions: The learner's subscriptions.
            nodes: Full names of the learner's nodes.
            servers: The learner's services.
        """
        ends = [(PUBLISHER, end.node, end.topic, end.msg_type) for end in publishers]
        ends += [(SUBSCRIPTION, end.node, end.topic, end.msg_type) for end in subscriptions]
        ends += [(SERVICE, server.node, server.service, server.srv_type) for server in servers]
        if not self.roles:
            return frozenset(
                name for wanted in self.nodes for name in nodes if nearest(wanted, [name])
            )
        if self.roles.keys() <= self.earlier:
            others = self.earlier - self.roles.keys()
            done = {node for kind, node, name, _ in ends if (kind, name) in others}
            ends = [end for end in ends if end[1] not in done]
        exact = frozenset(node for kind, node, name, _ in ends if (kind, name) in self.own)
        return exact or frozenset(node for kind, node, *end in ends if self._may_mean(kind, *end))

    def _may_mean(self, kind: str, name: str, type_name: str) -> bool:
        """Return whether an endpoint is similar to one of the exercise's, under another name."""
        if name in self.known:
            return False
        wanted = {other: asked for (what, other), asked in self.own.items() if what == kind}
        return type_name in wanted.values() or any(nearest(other, [name]) for other in wanted)
