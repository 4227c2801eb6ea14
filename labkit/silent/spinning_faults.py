"""Life: nodes that nobody spins, calls that nobody answers, ends that are made again and again."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from labkit.settings import LONG_SEC
from labkit.silent.kinds import Fault, kind
from labkit.silent.scene import Scene

__all__ = [
    'look_at_calls',
    'look_at_ends',
    'look_at_executors',
    'look_at_making',
    'look_at_spinning',
]

SLEEPER = kind(
    'life.rate-unspun',
    'rate.sleep() never returns: nobody spins the node',
    'Spin the node in the background first: lab.spin(node), in a program a thread with '
    'rclpy.spin(node). A timer needs no rate at all.',
    'the node is spun',
)
UNSPUN = kind(
    'life.unspun',
    'Callbacks are never called: nobody spins the node',
    'Run it with lab.spin(node), in a program with rclpy.spin(node).',
    'the node has neither timers nor subscriptions nor services',
    aloud=False,
)
UNSPUN_CLIENT = kind(
    'life.client-unspun',
    'The future is never done: nobody spins the node of the client',
    'Run the node with lab.spin(node): the answer is taken when it is spun.',
    'the node is spun, or there was no request',
)
HELD = kind(
    'life.held-executor',
    'An executor of your own calls nothing any more: one of its callbacks does not return',
    'Let it return: no endless loop, call_async() instead of call(). In a MultiThreadedExecutor, '
    'what waits for another callback needs another callback group: '
    'callback_group=ReentrantCallbackGroup() for the client.',
    'the callback is alone in its callback group, or that is reentrant',
)
ENDLESS = kind(
    'life.endless-init',
    'The cell stays at [*]: __init__ of a node does not return',
    'The stop button ends it. In __init__ a node makes its timers and subscriptions, and returns: '
    'a timer calls again and again, without a loop. What waits there for another node needs that '
    'one first.',
    '__init__ returns within seconds',
)
NO_SERVER = kind(
    'life.no-server',
    'The future of a call is never done: no server was there',
    'Wait for the server first: client.wait_for_service(). What was sent before is lost.',
    'a server is there, or all requests were answered',
)
TWICE = kind(
    'life.subscribed-twice',
    'Each message comes twice: the node has subscribed twice with one callback',
    'Create it once, in __init__.',
    'the two subscriptions have different callbacks',
)
AGAIN = kind(
    'life.publisher-again',
    'Messages get lost, the node becomes slow: it makes a publisher anew for each message',
    'Create the publisher once, in __init__, and keep it: a new one has no subscriber yet.',
    'it is one publisher a topic, or a few',
)
TIMER_AGAIN = kind(
    'life.timer-again',
    'A timer fires faster and faster: it is created again, and the earlier one goes on',
    'Create it once, or cancel the earlier one (timer.cancel()).',
    'the earlier timers are cancelled',
)

# As many ends of one node alike are made by a loop or a callback, not by hand.
_MANY = 4


def look_at_spinning(scene: Scene) -> Iterator[Fault]:
    """Find nodes that nobody spins."""
    for one in scene.sleepers:
        text = f'{one.words} waits for {one.node}, which nobody spins: for ever.'
        yield Fault(SLEEPER, (one.node,), one.words, text, cell=one.cell)
    for node in scene.nodes:
        if node.is_spun:
            continue
        if node.timers or node.subscriptions or node.offers:
            yield Fault(
                UNSPUN,
                (node.name,),
                'spin',
                f'{node.name} is in an executor that nobody spins: its callbacks are not called.'
                if node.in_executor
                else f'{node.name} was made, but nobody spins it: its callbacks are never called.',
            )
        for client in node.clients:
            if client.pending and client.is_ready:
                yield Fault(
                    UNSPUN_CLIENT,
                    (node.name,),
                    client.service,
                    f'{node.name} has called {client.service}, but nobody spins it: the answer '
                    'is never taken.',
                )


def look_at_making(scene: Scene) -> Iterator[Fault]:
    """Find a node that the cell never gets to the end of making."""
    one = scene.making
    if one is not None and one.seconds >= 2 * LONG_SEC:
        yield Fault(
            ENDLESS,
            (one.node,),
            '__init__',
            f'This cell waits for {one.words} to return: for {one.seconds:.0f} s now.',
            cell=one.cell,
        )


def look_at_executors(scene: Scene) -> Iterator[Fault]:
    """Find callbacks that hold up an executor of the learner's own."""
    for one in scene.held:
        if one.seconds >= 2 * LONG_SEC:
            waits = f' It waits in {one.waits}, and what ends that is one of them.'
            yield Fault(
                HELD,
                (one.node,),
                one.callback,
                f'{one.callback} of {one.node} has been running for {one.seconds:.0f} s; until '
                f'it returns, no other callback {one.others} runs.{waits * bool(one.waits)}',
            )


def look_at_calls(scene: Scene) -> Iterator[Fault]:
    """Find requests that nobody answers."""
    # The server of one that is lost has another type, which is told.
    lost = {(name, service.name) for service in scene.graph.services for name in service.lost}
    for node in scene.nodes:
        for client in node.clients:
            if client.pending and not client.is_ready and (node.name, client.service) not in lost:
                yield Fault(
                    NO_SERVER,
                    (node.name,),
                    client.service,
                    f'{node.name} has called {client.service}, which nobody offers.',
                )


def look_at_ends(scene: Scene) -> Iterator[Fault]:
    """Find ends and timers of a node that were made more than once."""
    for node in scene.nodes:
        heard = Counter((sub.topic, sub.identity) for sub in node.subscriptions)
        for (topic, _), count in heard.items():
            if count > 1:
                yield Fault(
                    TWICE,
                    (node.name,),
                    topic,
                    f'{node.name} subscribes to {topic} {count} times with the same callback: '
                    'each message is handled as often.',
                )
        for topic, count in Counter(pub.topic for pub in node.publishers).items():
            if count >= _MANY:
                yield Fault(
                    AGAIN, (node.name,), topic, f'{node.name} has {count} publishers on {topic}.'
                )
        timers = Counter(
            (t.callback, t.identity, t.period) for t in node.timers if not t.is_canceled
        )
        for (callback, _, _), count in timers.items():
            if count >= _MANY:
                yield Fault(
                    TIMER_AGAIN,
                    (node.name,),
                    callback,
                    f'{node.name} has {count} timers that call {callback}.',
                )
