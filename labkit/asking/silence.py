"""Why nothing comes, and why nobody answers: what is seen in this notebook, then in the graph.

A callback that does not return, a node that nobody spins and a callback that fails look the same
from the cell that waits as a publisher that publishes nothing.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from lifecycle_msgs.srv import GetState

from labkit.asking.traffic import sent_by
from labkit.background import own_executors
from labkit.background.nodes import existing_nodes, full_name, half_made
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabError
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.matching import why_deaf
from labkit.rosgraph.names import EVERY_NODE_OFFERS
from labkit.rosgraph.whose import is_missing
from labkit.settings import LONG_SEC

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__all__ = ['Failures', 'offers_service', 'stuck_callback', 'why_silent', 'why_unanswered']

GET_STATE = 'lifecycle_msgs/srv/GetState'
# Two requests, since one may be lost (`AGAIN_SEC`), s. A node that answers later is not told to be
# inactive: the next reason is said in its place, and no verdict hangs on that.
STATE_SEC = 1.0


class Failures:
    """The callbacks of this process that fail from now on."""

    def __init__(self) -> None:
        self._before = {id(error): error.count for error in runtime.console.errors}

    def seen(self, names: Collection[str] | None = None) -> str:
        """Return the last one that has failed since, in words; '' if none has.

        Args:
            names: Full names of the nodes to look at; all if None.
        """
        for error in reversed(tuple(runtime.console.errors)):
            is_new = error.count > self._before.get(id(error), 0)
            if is_new and (names is None or error.node_name in names):
                return (
                    f'Meanwhile the callback {error.callback} of {error.node_name} failed: '
                    f'{type(error.error).__name__}: {error.error}'
                )
        return ''


def stuck_callback(patience_sec: float = LONG_SEC) -> str:
    """Return which callback keeps all others of this process from running, '' if none does.

    Args:
        patience_sec: Seconds to wait for a running callback to return.
    """

    def returns() -> bool:
        running = runtime.executor.running_for()
        return running is None or running[2] >= LONG_SEC

    wait_for(returns, patience_sec)
    running = runtime.executor.running_for()
    if running is None or running[2] < LONG_SEC:
        return ''
    entry, callback, _ = running
    earlier = 'an earlier ' * runtime.executor.runs_for_an_ended_node()
    return (
        f'The callback {callback} of {earlier}{entry.name} is still running; while it runs, no '
        'other callback can. Let callbacks return soon.'
    )


def _unspun(names: Collection[str], *, offers: bool = False) -> str:
    """Return which of some nodes is of this process, and nobody spins it; '' if none is.

    Args:
        names: Full names of the nodes.
        offers: Whether they offer what is asked for. Else one without callbacks of its own is as
            good as spun.
    """
    for node in existing_nodes():
        name = full_name(node)
        idle = runtime.entry_of(node) is None and not own_executors.is_spun(node)
        if name in names and node in half_made:
            return f'{name} is half made: an error has ended its __init__.'
        if name in names and idle and (offers or _has_callbacks(node)):
            return f'{name} is not spun: lab.spin(...) does that.'
        if name in names and (running := _held(node)):
            return running
    return ''


def _held(node: Node) -> str:
    """Return which callback keeps an executor of the learner's own; '' if none does."""
    executor = node.executor
    if executor is None or executor is runtime.executor:
        return ''
    for call in own_executors.calls_in(executor):
        if call.node is node and call.seconds >= LONG_SEC:
            return (
                f'The callback {call.callback} of {full_name(node)} has been running for '
                f'{call.seconds:.0f} s. Let callbacks return soon.'
            )
    return ''


def _has_callbacks(node: Node) -> bool:
    """Return whether a node has callbacks of its own, besides those of its parameters."""
    return bool([*node.timers, *node.subscriptions]) or offers_service(node)


def offers_service(node: Node) -> bool:
    """Return whether a node offers a service of its own, besides those of its parameters."""
    return any(
        service.srv_name.rpartition('/')[2] not in EVERY_NODE_OFFERS for service in node.services
    )


def why_silent(
    node: Node,
    topic: str,
    msg_type: Any,
    qos_profile: QoSProfile,
    *,
    heard: int = 0,
    failures: Failures | None = None,
    patience_sec: float = LONG_SEC,
    guess: bool = True,
) -> str:
    """Return in a sentence or two why no message of a topic arrives.

    Args:
        node: The node to ask the graph with.
        topic: Full name of the subscribed topic.
        msg_type: Type of the subscription.
        qos_profile: QoS profile of the subscription.
        heard: Number of messages that did arrive.
        failures: The callbacks that have failed since they were waited for.
        patience_sec: Seconds to wait for a running callback to return.
        guess: Whether to say what may be the reason; not where it is told beside this.

    Returns:
        What is seen, and the fix. If nothing is: what may be the reason, as that.
    """
    why = stuck_callback(patience_sec) or why_deaf(node, topic, msg_type, qos_profile)
    if why:
        return why
    found = publishers(node, topic)
    names = sorted({end.node for end in found})
    if found and all(is_missing(end.gid, node) for end in found):
        return (
            f'No process of this machine has the number of the one in which {", ".join(names)} '
            'ran. Maybe it was killed: the graph forgets it only after 20 s.'
        )
    if seen := (failures.seen(names) if failures else '') or _unspun(names):
        return seen
    if seen := _inactive(node, names):
        return seen
    if heard:
        return 'Maybe they come more slowly than that.'
    seen = (
        f'{", ".join(names)} has a publisher on {topic} with the right type and QoS, but nothing '
        'came from it in that time.'
    )
    if _has_published(names, topic):
        return f'{seen} It has published before.'
    return f'{seen} Maybe its timer does not run, or publish() is not reached.' if guess else seen


def _inactive(node: Node, names: Collection[str]) -> str:
    """Return which of some nodes has a life cycle and is not active; '' if none is."""
    from labkit.asking.service_calls import AGAIN_SEC, ServiceCalls

    if runtime.called_by_callback():
        return ''
    offered = dict(node.get_service_names_and_types())
    for name in names:
        if GET_STATE not in offered.get(f'{name}/get_state', ()):
            continue
        with ServiceCalls(node, GetState, f'{name}/get_state') as service:
            try:
                answer = service.call(GetState.Request(), STATE_SEC, again_sec=AGAIN_SEC)
            except LabError:  # who does not answer is not told to be inactive
                continue
        label = answer.current_state.label
        if label != 'active':
            to_do = {'unconfigured': '{id: 1}, then {id: 3}', 'inactive': '{id: 3}'}.get(label)
            todo = f' Its service {name}/change_state does that: transition {to_do}.'
            return (
                f'{name} has a life cycle, and its state is {label}: it publishes only while it '
                f'is active.{todo if to_do else ""}'
            )
    return ''


def _has_published(names: Collection[str], topic: str) -> bool:
    """Return whether one of some nodes is of this process, and has published on a topic."""
    return any(
        sent_by(publisher).count
        for node in existing_nodes()
        if full_name(node) in names
        for publisher in node.publishers
        if publisher.topic_name == topic
    )


def why_unanswered(names: Collection[str]) -> str:
    """Return why a service or an action gives no answer.

    Args:
        names: Full names of the nodes that offer it.

    Returns:
        What is seen. If nothing is: a question.
    """
    return (
        stuck_callback()
        or _unspun(names, offers=True)
        or 'Is the node that offers it spinning, and do its callbacks return?'
    )
