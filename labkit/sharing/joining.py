"""Share one topic with other computers, and nothing else: `join`.

A notebook has its own ROS domain, which does not leave the machine. `join` takes part in a second,
shared domain and relays the messages of one topic in both directions, as the package domain_bridge
does. Other topics, services and parameters stay where they are.

Each side also hears its own messages, which must not be sent back. Messages do not name their
sender, but each publisher numbers them: a message is our own if number and bytes match.
"""

from __future__ import annotations

import os
import secrets
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from typing import TYPE_CHECKING, Any

from rclpy.context import Context
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.exceptions import InvalidNodeNameException
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions
from rclpy.validate_node_name import validate_node_name

from labkit.background.domains import DomainClaim, claim_domain, number_for_ros, opened
from labkit.background.nodes import destroy_node, helper_node
from labkit.background.notebook_rclpy import ORIGINALS
from labkit.background.runtime import runtime
from labkit.background.session import Session, end_earlier, going_on
from labkit.domain_ids import check_shared_domain_id, read_shared_domain_id, stays_here
from labkit.errors import LabError, LabTimeout, did_you_mean, quoted
from labkit.rosgraph.endpoints import Endpoint, publishers, subscriptions
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.whose import is_own
from labkit.settings import audience

if TYPE_CHECKING:
    from rclpy.node import Node

    from labkit.programs.child_processes import Process

__all__ = ['Joined', 'join']

NODE_NAME = 'domain_bridge'
RANGES = ('SUBNET', 'LOCALHOST', 'OFF', 'SYSTEM_DEFAULT')
# How many of our own messages to remember: one that is lost on its way back is never looked up.
REMEMBERED = 10_000
SPIN_SEC = 0.1
# Environment variables that ROS reads when a context is made.
_RANGE, _PEERS = 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_STATIC_PEERS'
_SERVER = 'ROS_DISCOVERY_SERVER'
_environment_lock = threading.Lock()


class Joined(Session):
    """A topic that is shared with others. Made by `join`; a context manager.

    Attributes:
        topic: Full name of the topic.
        domain_id: The shared domain.
        name: Full name of the node that others see there.
        sent: Number of messages relayed to the others.
        received: Number of messages from the others.
        programs: Programs of this notebook in the shared domain. They end with it, so that the
            next notebook to claim the domain finds it empty.
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
            self._context, self._guest = _enter(domain_id, name, variables)
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
        """Return the full names of other nodes on the topic in the shared domain."""
        return sorted({end.node for end in (*self._publishers(), *self._subscriptions())})

    def wait_for_others(self, count: int = 1, *, timeout_sec: float | None = 10.0) -> None:
        """Wait until messages pass in both directions between this notebook and other nodes.

        A publisher and a subscription of one node are discovered one after the other, so it
        waits until at least one of each is known.

        Args:
            count: Number of other nodes.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: Fewer came. The message says what to check.
        """

        def complete() -> bool:
            both = self._publishers() and self._subscriptions()
            return bool(both) and len(self.others) >= count and self._is_matched()

        if runtime.wait(complete, timeout_sec):
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
        """Leave the shared domain: others see nothing of this notebook any more."""
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

    # -- relaying messages ----------------------------------------------------------------------

    def _to_others(self, data: bytes) -> None:
        self.sent += 1
        self._there.publish(data)

    def _from_others(self, data: bytes) -> None:
        self.received += 1
        self._here.publish(data)

    def _work(self) -> None:
        with ExitStack() as ending:  # a failing step does not keep the others from running
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

    # -- other nodes ----------------------------------------------------------------------------

    def _publishers(self) -> list[Endpoint]:
        return self._foreign(publishers)

    def _subscriptions(self) -> list[Endpoint]:
        return self._foreign(subscriptions)

    def _other_type(self) -> str:
        """Describe a node that has another type on the topic, if there is one."""
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
        """Return whether messages pass in both directions; earlier ones are lost."""
        hear = len(self._subscriptions()) < self._there.publisher.get_subscription_count()
        heard = len(self._publishers()) < self._there.subscription.get_publisher_count()
        return hear and heard


class _Side:
    """The publisher and subscription in one of the two domains.

    Args:
        node: The node in that domain.
        topic: Full name of the topic.
        msg_type: Class of the messages.
        qos_profile: QoS profile of both.
        on_message: Called with the serialized messages of others.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        msg_type: Any,
        qos_profile: QoSProfile,
        on_message: Callable[[bytes], None],
    ) -> None:
        self._on_message = on_message
        self._number = 0
        # Sequence number -> hash of the bytes, oldest first.
        self._own: dict[int, int] = {}
        self._remembered = REMEMBERED + 2 * qos_profile.depth
        self._lock = threading.Lock()
        self.publisher = node.create_publisher(msg_type, topic, qos_profile)
        take: Callable[..., None] = self._take  # rclpy's annotation lacks the second argument
        self.subscription = node.create_subscription(
            msg_type,
            topic,
            take,
            qos_profile,
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
            raw=True,
        )

    def publish(self, data: bytes) -> None:
        """Publish a serialized message."""
        with self._lock:
            self._number += 1
            self._own[self._number] = hash(data)
            if len(self._own) > self._remembered:
                del self._own[next(iter(self._own))]
            self.publisher.publish(data)

    def _take(self, data: bytes, info: dict[str, int]) -> None:
        number = info['publication_sequence_number']
        with self._lock:
            if self._own.get(number) == hash(data):
                del self._own[number]
                return
        self._on_message(data)


def _enter(domain_id: int, name: str, variables: dict[str, str]) -> tuple[Context, Node]:
    """Make a context without signal handlers in another domain, and a node in it.

    Args:
        domain_id: The domain.
        name: Name of the node.
        variables: Environment variables for ROS, set only meanwhile; an empty one is unset.
    """
    context = Context()
    with _environment(variables), nullcontext() if stays_here() else opened():
        ORIGINALS['init'](
            context=context,
            domain_id=number_for_ros(domain_id),
            args=['--ros-args', '--disable-external-lib-logs', '--disable-stdout-logs'],
            signal_handler_options=SignalHandlerOptions.NO,
        )
        try:
            return context, helper_node(name, context=context)
        except BaseException:
            ORIGINALS['try_shutdown'](context=context)
            raise


@contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    with _environment_lock:
        before = {name: os.environ.get(name, '') for name in variables}
        try:
            _set(variables)
            yield
        finally:
            _set(before)


def _set(variables: dict[str, str]) -> None:
    for name, value in variables.items():
        if value:
            os.environ[name] = value
        else:
            os.environ.pop(name, None)


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
    """Share one topic with others in an agreed domain, and nothing else.

    The nodes of this notebook stay in its own domain. Messages on the topic are relayed to the
    shared domain, and back. This ends with `leave()`, at the end of a `with` block, at
    `lab.stop()`, with the kernel, and when the cell is run again.

    Args:
        topic: The topic's name, such as `'/shared_chatter'`.
        msg_type: The class of its messages.
        domain_id: The domain to share, 0 to 101. By default `LABKIT_SHARED_DOMAIN_ID`, which a
            teacher sets for a class; else one that no notebook on this machine has: read it in
            the result, and tell it to the others.
        discovery_range: `'SUBNET'` to discover nodes on this network, `'LOCALHOST'` on this
            machine only.
        static_peers: Addresses of computers to discover where multicast does not pass.
        discovery_server: Address and port of a Fast DDS discovery server, such as
            `'10.0.0.1:11811'`.
        name: Name of the node that others see; random if empty.
        qos_profile: QoS profile or queue depth, on both sides.

    Returns:
        An object with `others`, `wait_for_others(...)` and `leave()`.

    Raises:
        LabError: This notebook is in that domain already, or an argument is invalid.
    """
    check_shared_domain_id(domain_id)
    if discovery_range not in RANGES:
        raise LabError(
            f'discovery_range must be one of {", ".join(map(repr, RANGES))}, but it is '
            f'{quoted(discovery_range)}.',
            todo=did_you_mean(str(discovery_range), RANGES),
        )
    if isinstance(static_peers, str):
        raise LabError(
            f'static_peers must be a list of addresses, but it is {quoted(static_peers)}.',
            todo=f'Write static_peers=[{quoted(static_peers)}].',
        )
    if not hasattr(msg_type, 'get_fields_and_field_types'):
        raise LabError(
            f'msg_type must be a class of messages, but it is {quoted(msg_type)}.',
            todo='Import it: from std_msgs.msg import String',
        )
    name = name or f'guest_{secrets.token_hex(3)}'
    try:
        validate_node_name(name)
    except InvalidNodeNameException as error:
        raise LabError(
            f'{quoted(name)} can not be the name of a node.',
            todo="Use letters, digits and underscores, and begin with a letter: name='ada'",
        ) from error
    runtime.start()
    end_earlier(Joined)
    wanted = domain_id if domain_id is not None else read_shared_domain_id()
    _refuse_own_domain(wanted, topic)
    # A script has not claimed its own domain, so it must be excluded by its number.
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
