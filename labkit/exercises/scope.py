"""What an exercise asks for on the graph, as data, and what of it shows an attempt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from labkit.errors import nearest

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint
    from labkit.rosgraph.servers import Server

__all__ = ['PUBLISHER', 'SERVICE', 'SUBSCRIPTION', 'Role', 'Scope']

PUBLISHER, SUBSCRIPTION, SERVICE = 'publisher', 'subscription', 'service'
# What a node does: one of the three words above, and the name of the topic or service.
Role = tuple[str, str]


@dataclass(frozen=True, kw_only=True)
class Scope:
    """What an exercise asks for, and what its lesson has besides.

    Attributes:
        publishes: Topics on which the learner's nodes publish, with their types.
        subscribes: Topics to which they subscribe, with their types.
        serves: Services that they offer, with their types.
        nodes: Full names of nodes that the task asks for.
        shared: Topics on which others may publish too.
        reliable: Topics on which those who listen ask for reliable delivery, as the robot does.
        given: Full names of nodes that the lesson itself leaves running, and the ids of the cells
            that make them. A node of such a name that another cell has made is the learner's.
        known: All topics of the lesson. What the learner does on others has a wrong name.
        earlier: Roles that earlier exercises of the lesson ask for: their nodes may still run.
        of_lesson: Roles that all exercises of the lesson ask for.
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
        """What the learner's nodes do, with the type of the topic or service."""
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
        """The topics that the learner's nodes work with, and the services that they offer."""
        return tuple(dict.fromkeys(topic for _, topic in self.roles))

    @property
    def sole(self) -> frozenset[str]:
        """The topics that have one publisher at most."""
        return frozenset(self.publishes) - self.shared

    def msg_type(self, role: Role) -> str:
        """Return the type that a role is about.

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
        """Return which nodes show an attempt at the exercise.

        Args:
            publishers: All publishers of the learner's.
            subscriptions: All subscriptions of the learner's.
            nodes: Full names of all nodes of the learner's.
            servers: All services of the learner's.

        Returns:
            The nodes with a role that is this exercise's own. If there are none, those that may
            mean one, under another name. Names of nodes count where no role is asked for.
        """
        ends = [(PUBLISHER, end.node, end.topic, end.msg_type) for end in publishers]
        ends += [(SUBSCRIPTION, end.node, end.topic, end.msg_type) for end in subscriptions]
        ends += [(SERVICE, server.node, server.service, server.srv_type) for server in servers]
        if not self.roles:
            return frozenset(
                name for wanted in self.nodes for name in nodes if nearest(wanted, [name])
            )
        exact = frozenset(node for kind, node, name, _ in ends if (kind, name) in self.own)
        return exact or frozenset(node for kind, node, *end in ends if self._may_mean(kind, *end))

    def _may_mean(self, kind: str, name: str, type_name: str) -> bool:
        """Tell whether an endpoint looks like one that is asked for, under another name."""
        if name in self.known:
            return False
        wanted = {other: asked for (what, other), asked in self.own.items() if what == kind}
        return type_name in wanted.values() or any(nearest(other, [name]) for other in wanted)
