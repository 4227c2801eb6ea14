"""Share a topic with other computers, and nothing else: `join`.

A notebook has a ROS domain of its own, which does not leave the machine. `join` stands with one
foot in there and with the other one in a domain that is shared on purpose, and carries the
messages of one topic over, in both directions, as the package domain_bridge does with the domains
of two robots. All else, the other topics, services and parameters, stays where it is.

Each side hears what it has published itself, which must not go back. Messages do not say who has
sent them; but each publisher numbers its own, so an own one is known by its number and its bytes.
"""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.exceptions import InvalidNodeNameException
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from rclpy.validate_node_name import validate_node_name

from labkit.background.domains import DomainClaim, claim_domain
from labkit.background.guest import enter
from labkit.background.nodes import destroy_node
from labkit.background.notebook_rclpy import ORIGINALS
from labkit.background.runtime import runtime
from labkit.background.session import Session, end_earlier, going_on
from labkit.domain_ids import check_shared_domain_id, read_shared_domain_id
from labkit.errors import LabError, LabTimeout, nearest
from labkit.rosgraph.endpoints import Endpoint, publishers, subscriptions
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.whose import is_own
from labkit.settings import audience

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.background.child_processes import Process

__all__ = ['Joined', 'join']

NODE_NAME = 'domain_bridge'
RANGES = ('SUBNET', 'LOCALHOST', 'OFF', 'SYSTEM_DEFAULT')
# Of so many own messages it is known that they are own, at least: one that was lost on its way
# back is never asked for.
KNOWN = 10_000
SPIN_SEC = 0.1
# Variables that ROS reads when it takes part in a domain.
_RANGE, _PEERS = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_STATIC_PEERS'
_SERVER = 'ROS_DISCOVERY_SERVER'


class Joined(Session):
    """A topic that is shared with others. Made by `join`; a context manager.

    Attributes:
        topic: Full name of the topic.
        domain_id: The domain that is shared.
        name: Full name of the node that others see there.
        sent: How many messages were carried to the others.
        received: How many came from them.
        programs: Programs of this notebook in the domain. They end with it: whoever claims the
            domain afterwards is to find it empty.
    """

    def __init__(
        self,
        topic: str,
        msg_type: Any,
        domain_id: int,
        *,
        name: str,
        variables: dict[str, str],
        qos_profile: QoSProfile,
        claim: DomainClaim | None,
    ) -> None:
        super().__init__(NODE_NAME)
        self.domain_id, self._msg_type, self._claim = domain_id, msg_type, claim
        self._variables = variables
        self.sent = self.received = 0
        self.programs: list[Process] = []
        self.topic = full_topic_name(topic, self._node)
        try:
            self._context, self._guest = enter(domain_id, name, variables)
        except BaseException:
            self._end_node()
            raise
        try:
            self.name = self._guest.get_fully_qualified_name()
            here = _Side(self._node, self.topic, msg_type, qos_profile, self._to_others)
            there = _Side(self._guest, self.topic, msg_type, qos_profile, self._from_others)
            self._here, self._there = here, there
        except BaseException:
            self._end_node()
            self._end_guest()
            raise
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._guest)
        self._go()

    @property
    def others(self) -> list[str]:
        """Return the full names of the others' nodes that have the topic in the shared domain."""
        return sorted({end.node for end in (*self._publishers(), *self._subscriptions())})

    def wait_for_others(self, count: int = 1, *, timeout_sec: float | None = 10.0) -> None:
        """Wait until so many others are there, and hear and are heard.

        Args:
            count: How many nodes.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: Fewer came. It says what to look at.
        """
        if runtime.wait(lambda: len(self.others) >= count and self._is_matched(), timeout_sec):
            return
        found = ', '.join(self.others) or 'nobody'
        raise LabTimeout(
            f'Waited for {count} in domain {self.domain_id} on {self.topic}, and found {found}.',
            todo=self._other_type()
            or 'Do the others use the same domain and the same name of the topic? Between '
            'computers the discovery range has to be SUBNET; where a network lets no multicast '
            'pass, as in many schools, each needs the address of the other: static_peers=[...].',
        )

    def leave(self) -> None:
        """End it: nothing of this notebook is seen by others any more."""
        self.stop()

    def __repr__(self) -> str:
        if self.done:
            return f'Left: {self.topic} is not shared any more.'
        where = f'domain {self.domain_id}'
        if audience().same_each_time and self._claim is not None:
            where = 'a domain of its own'
        reach = self._variables[_RANGE]
        parts = [
            f'Joined {where} ({reach}): {self.topic} [{type_name(self._msg_type)}] is shared.'
        ]
        parts += [f'Others see the node {self.name}, and nothing else of this notebook.']
        parts += [f'There now: {", ".join(self.others)}'] if self.others else []
        return '\n'.join(parts)

    # -- carrying messages ----------------------------------------------------------------------

    def _to_others(self, data: bytes) -> None:
        self.sent += 1
        self._there.publish(data)

    def _from_others(self, data: bytes) -> None:
        self.received += 1
        self._here.publish(data)

    def _work(self) -> None:
        # Whatever fails at the end, the rest of it is done.
        with ExitStack() as ending:
            if self._claim is not None:
                ending.callback(self._claim.close)
            ending.callback(self._stop_programs)
            ending.callback(self._end_guest)
            ending.callback(self._executor.shutdown)
            while not self._stopping.is_set():
                self._executor.spin_once(timeout_sec=SPIN_SEC)

    def _stop_programs(self) -> None:
        for program in self.programs:
            program.stop()

    def _end_guest(self) -> None:
        destroy_node(self._guest)
        ORIGINALS['try_shutdown'](context=self._context)

    # -- who is there ---------------------------------------------------------------------------

    def _publishers(self) -> list[Endpoint]:
        return self._foreign(publishers)

    def _subscriptions(self) -> list[Endpoint]:
        return self._foreign(subscriptions)

    def _other_type(self) -> str:
        """Say who has another type on the topic; '' if nobody has."""
        mine = type_name(self._msg_type)
        for end in (*self._publishers(), *self._subscriptions()):
            if end.msg_type != mine:
                return (
                    f'{end.node} has the type {end.msg_type} there, and here it is {mine}. Agree '
                    'on one.'
                )
        return ''

    def _foreign(self, ask: Callable[[Node, str], Sequence[Endpoint]]) -> list[Endpoint]:
        if self.done or self._stopping.is_set():
            return []
        found = ask(self._guest, self.topic)
        return [end for end in found if end.is_known and not is_own(end.gid, self._guest)]

    def _is_matched(self) -> bool:
        """Tell whether messages pass in both directions; what is sent before that is lost."""
        hear = len(self._subscriptions()) < self._there.publisher.get_subscription_count()
        heard = len(self._publishers()) < self._there.subscription.get_publisher_count()
        return hear and heard


class _Side:
    """The topic in one of the two domains.

    Args:
        node: The node there.
        topic: Full name of the topic.
        msg_type: Class of its messages.
        qos_profile: For both ends.
        came: Called with the bytes of each message that somebody else has published.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        msg_type: Any,
        qos_profile: QoSProfile,
        came: Callable[[bytes], None],
    ) -> None:
        self._came = came
        self._number = 0
        # Number -> hash of its bytes, oldest first.
        self._own: dict[int, int] = {}
        self._known = KNOWN + 2 * qos_profile.depth
        self._publishing = threading.Lock()
        self.publisher = node.create_publisher(msg_type, topic, qos_profile)
        take: Callable[..., None] = self._take  # rclpy's own type knows of no second argument
        self.subscription = node.create_subscription(
            msg_type,
            topic,
            take,
            qos_profile,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
            raw=True,
        )

    def publish(self, data: bytes) -> None:
        """Publish a message as it came."""
        with self._publishing:
            self._number += 1
            self._own[self._number] = hash(data)
            if len(self._own) > self._known:
                del self._own[next(iter(self._own))]
            self.publisher.publish(data)

    def _take(self, data: bytes, info: dict[str, int]) -> None:
        number = info['publication_sequence_number']
        with self._publishing:
            if self._own.get(number) == hash(data):
                del self._own[number]
                return
        self._came(data)


def join(
    topic: str,
    msg_type: Any,
    *,
    domain_id: int | None = None,
    discovery_range: str = 'SUBNET',
    static_peers: Sequence[str] = (),
    discovery_server: str = '',
    name: str = '',
    qos_profile: QoSProfile | int = 10,
) -> Joined:
    """Share a topic with others, in a domain that you have agreed on, and nothing else.

    The nodes of this notebook stay in its own domain. What is published on the topic there is
    published in the shared domain, too, and the other way round. It ends with `leave()`, at the
    end of a `with` block, at `lab.stop()`, with the kernel, and when the cell is run again.

    Args:
        topic: The topic's name, such as `'/shared_chatter'`.
        msg_type: The class of its messages.
        domain_id: The domain to share, 0 to 101. By default `LABKIT_SHARED_DOMAIN_ID`, which a
            teacher sets for a class; else one that no notebook on this machine has: read it in
            the result, and tell it to the others.
        discovery_range: How far others are looked for, and let in: `'SUBNET'` for this network,
            `'LOCALHOST'` for this machine.
        static_peers: Addresses of computers that are looked for by their address, where multicast
            does not pass.
        discovery_server: Address and port of a discovery server of Fast DDS, such as
            `'10.0.0.1:11811'`: it tells all who ask who is there.
        name: Name of the node that others see; one made at random if empty.
        qos_profile: QoS profile or queue depth, on both sides.

    Returns:
        What you have joined: its `others`, `wait_for_others(...)`, `leave()`.

    Raises:
        LabError: This notebook is in that domain already, or an argument is not what it should be.
    """
    check_shared_domain_id(domain_id)
    if discovery_range not in RANGES:
        near = nearest(str(discovery_range), RANGES)
        raise LabError(
            f'discovery_range must be one of {", ".join(map(repr, RANGES))}, but it is '
            f'{discovery_range!r}.',
            todo=f'Did you mean {near!r}?' if near else '',
        )
    if isinstance(static_peers, str):
        raise LabError(
            f'static_peers must be a list of addresses, but it is {static_peers!r}.',
            todo=f'Write static_peers=[{static_peers!r}].',
        )
    if not hasattr(msg_type, 'get_fields_and_field_types'):
        raise LabError(
            f'msg_type must be a class of messages, but it is {msg_type!r}.',
            todo='Import it: from std_msgs.msg import String',
        )
    name = name or f'guest_{secrets.token_hex(3)}'
    try:
        validate_node_name(name)
    except InvalidNodeNameException as error:
        raise LabError(
            f'{name!r} can not be the name of a node.',
            todo="Use letters, digits and underscores, and begin with a letter: name='ada'",
        ) from error
    runtime.start()
    end_earlier(Joined)
    wanted = domain_id if domain_id is not None else read_shared_domain_id()
    _refuse_own_domain(wanted, topic)
    # A script is in a domain that nobody has claimed.
    own = runtime.domain_id
    claim = claim_domain(shared=True, other_than=own) if wanted is None else None
    shared = claim.domain_id if claim is not None else wanted
    assert shared is not None
    profile = QoSProfile(depth=qos_profile) if isinstance(qos_profile, int) else qos_profile  # type: ignore[no-untyped-call]
    variables = {
        _RANGE: discovery_range,
        _PEERS: ';'.join(static_peers),
        _SERVER: discovery_server,
    }
    try:
        return Joined(
            topic,
            msg_type,
            shared,
            name=name,
            variables=variables,
            qos_profile=profile,
            claim=claim,
        )
    except BaseException:
        if claim is not None:
            claim.close()
        raise


def _refuse_own_domain(domain_id: int | None, topic: str) -> None:
    if domain_id is not None and domain_id == runtime.domain_id:
        raise LabError(
            f'This notebook is in domain {domain_id} itself, so there is nothing to join.',
            todo='Choose another domain for what you share. The nodes of this notebook keep '
            'theirs.',
        )
    assert runtime.helper is not None
    name = full_topic_name(topic, runtime.helper)
    for other in going_on(Joined):
        if other.topic == name and other.domain_id == domain_id:
            raise LabError(
                f'{name} is shared in domain {domain_id} already.',
                todo='End that first with its leave().',
            )
