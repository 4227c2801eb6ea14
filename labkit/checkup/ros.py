"""ROS itself: middleware, domain, nodes, topics, callbacks; in this process and seen from it."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections import Counter
from typing import TYPE_CHECKING

from labkit import domain_ids, settings
from labkit.errors import LabError, first_few
from labkit.rosgraph.names import is_hidden

if TYPE_CHECKING:
    from labkit.background.nodes import NodeEntry
    from labkit.background.runtime import Runtime

__all__ = ['callbacks', 'domain', 'middleware', 'nodes', 'topics']

RANGES = ('OFF', 'LOCALHOST', 'SUBNET', 'SYSTEM_DEFAULT')
# On Linux, the ports of these domains overlap with those that the system hands out by itself
# (docs.ros.org, "The ROS_DOMAIN_ID").
UNSAFE_DOMAIN_IDS = range(domain_ids.LAST_DOMAIN_ID + 1, 215)
TOPIC = f'_labkit/doctor_{os.getpid()}'
ARRIVAL_SEC = 2.0
# A busy machine may take long to start Python; it is a limit, not a measure.
PROCESS_SEC = 30.0

# In a process of its own: a library of another installation can end a process without a word.
_TRY = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init(args=['--ros-args', '--disable-external-lib-logs'])
node = Node('_labkit_doctor', enable_rosout=False, start_parameter_services=False)
heard = []
node.create_subscription(String, TOPIC, heard.append, 10)
publisher = node.create_publisher(String, TOPIC, 10)
publisher.publish(String(data='hello'))
rclpy.spin_once(node, timeout_sec=ARRIVAL_SEC)
print('doctor:', rclpy.get_rmw_implementation_identifier(), len(heard))
node.destroy_node()
rclpy.shutdown()
"""


# --- Middleware ----------------------------------------------------------------------------------


def middleware() -> str:
    """Look whether the middleware loads, and a message really passes through it."""
    runtime = _runtime()
    if runtime is not None and runtime.started and not runtime.executor.in_callback():
        name = _try_here(runtime)
    else:
        name = _try_in_a_process()
    if name != 'rmw_fastrtps_cpp':
        raise LabError(
            f'The middleware is {name!r}, but the course is made for rmw_fastrtps_cpp.',
            todo='unset RMW_IMPLEMENTATION',
        )
    return f'{name}, a message passed'


def _try_here(runtime: Runtime) -> str:
    """Pass a message through the background thread; return the middleware's name."""
    from rclpy.utilities import get_rmw_implementation_identifier
    from std_msgs.msg import String

    node = runtime.helper
    assert node is not None
    heard = threading.Event()
    # Not lab.wait_until(): nodes would show their output under this cell meanwhile.
    subscription = node.create_subscription(String, TOPIC, lambda _: heard.set(), 10)
    publisher = node.create_publisher(String, TOPIC, 10)
    try:
        publisher.publish(String(data='hello'))
        arrived = heard.wait(ARRIVAL_SEC)
    finally:
        node.destroy_publisher(publisher)
        node.destroy_subscription(subscription)
    if arrived:
        return str(get_rmw_implementation_identifier())
    running = runtime.executor.running_callback()
    if running is None:
        raise LabError(
            f'A message did not arrive within {ARRIVAL_SEC:.0f} s.', todo='Restart the kernel.'
        )
    raise LabError(
        f'No message can arrive: the callback {running[1]} of {running[0]} has been running for '
        f'more than {ARRIVAL_SEC:.0f} s, and while it runs no other callback can.',
        todo='Restart the kernel, and let that callback return soon: no endless loop, no sleep.',
    )


def _try_in_a_process() -> str:
    """Pass a message in a process of its own; return the middleware's name."""
    env = dict(os.environ)
    env.pop('ROS_DOMAIN_ID', None)
    if domain_ids.counts_ports():
        del env[domain_ids.PROFILES_FILE]
    env['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'OFF'
    code = _TRY.replace('TOPIC', repr(TOPIC)).replace('ARRIVAL_SEC', repr(ARRIVAL_SEC))
    todo = (
        'Mend the other red lines first. If this one stays: delete the environment, and run '
        'python3 -m labkit lab.'
    )
    try:
        done = subprocess.run(
            [sys.executable, '-c', code],
            env=env,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding='utf-8',
            errors='replace',
            timeout=PROCESS_SEC,
        )
    except subprocess.TimeoutExpired:
        raise LabError(
            f'ROS was started, but did not answer within {PROCESS_SEC:.0f} s.', todo=todo
        ) from None
    for line in done.stdout.splitlines():
        if line.startswith('doctor: '):
            _, name, count = line.split()
            if count == '1':
                return name
            raise LabError(f'A message did not arrive within {ARRIVAL_SEC:.0f} s.', todo=todo)
    raise LabError(f'ROS does not start: {_reason(done)}', todo=todo)


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    """Return the line that says why a process failed."""
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    for line in lines:
        if line.split(':')[0].endswith(('Error', 'Exception')):
            return line
    return lines[-1] if lines else f'it ended with exit code {done.returncode}.'


# --- Domain --------------------------------------------------------------------------------------


def domain() -> str:
    """Look at who can hear this process: the domain, and the range in which others are found."""
    wanted = domain_ids.read_domain_id()
    if wanted in UNSAFE_DOMAIN_IDS:
        raise LabError(
            f'ROS_DOMAIN_ID is {wanted}; the system may give the ports of domains '
            f'{UNSAFE_DOMAIN_IDS[0]} to {UNSAFE_DOMAIN_IDS[-1]} to other programs.',
            todo=f'Choose a number from 0 to {domain_ids.LAST_DOMAIN_ID}.',
        )
    if wanted is not None:
        domain_ids.check_profile(wanted)
    reach = _range()
    runtime = _runtime()
    if runtime is None or not runtime.started:
        if wanted is not None:
            return f'{wanted} (from ROS_DOMAIN_ID), range {reach}'
        default = 'one of its own, once ROS starts' if settings.in_kernel() else '0, the default'
        return f'{default}, range {reach}'
    if (wanted or 0) != runtime.domain_id:
        raise LabError(
            f'ROS runs in domain {runtime.domain_id}, but ROS_DOMAIN_ID is '
            f'{os.environ.get("ROS_DOMAIN_ID", "")!r} now: processes that this one starts are in '
            'another domain.',
            todo='Call lab.stop(), then start the nodes again.',
        )
    whose = "this notebook's own" if runtime.own_domain else 'shared'
    return f'{runtime.domain_id} ({whose}), range {reach}'


def _range() -> str:
    """Return how far ROS looks for other nodes.

    Raises:
        LabError: The variable that says so has a value that ROS does not know.
    """
    value = os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') or 'LOCALHOST'
    if value not in RANGES:
        raise LabError(
            f'ROS_AUTOMATIC_DISCOVERY_RANGE must be one of {", ".join(RANGES)}, but it is '
            f'{value!r}.',
            todo='Unset it: then ROS looks for nodes on this machine. Restart the kernel.',
        )
    return value


# --- Nodes, topics and callbacks -----------------------------------------------------------------


def nodes() -> str:
    """Look for nodes that nobody spins, that nobody means any more, or that have a double."""
    runtime = _runtime()
    if runtime is None:
        return 'none'
    entries = [entry for entry in runtime.nodes() if not is_hidden(entry.name)]
    found = [*_unspun(runtime), *_left_behind(entries), *_doubles(runtime, entries)]
    if found:
        raise LabError(
            ' '.join(text for text, _ in found),
            todo=' '.join(dict.fromkeys(todo for _, todo in found)),
        )
    return first_few([entry.name for entry in entries]) if entries else 'none'


def _unspun(runtime: Runtime) -> list[tuple[str, str]]:
    names = [
        node.get_fully_qualified_name()
        for node in runtime.unspun_nodes()
        # A node on another executor is spun by whoever made that.
        if node.executor is None and not is_hidden(node.get_name())
    ]
    counts = Counter(names)
    return [
        (
            f'{name} was made{f" {count} times" if count > 1 else ""}, but nobody spins it: its '
            'callbacks are never called.',
            'Start it with lab.spin(node), or end it with lab.remove(node).',
        )
        for name, count in sorted(counts.items())
    ]


def _left_behind(entries: list[NodeEntry]) -> list[tuple[str, str]]:
    """Find nodes of a cell, or of a class, that was edited and run again since."""
    found = []
    for position, entry in enumerate(entries):
        later = [other for other in entries[position + 1 :] if other.cell is not entry.cell]
        cell_id = entry.cell.cell_id
        successors = [other.name for other in later if cell_id and other.cell.cell_id == cell_id]
        if successors:
            text = f'{entry.name} still runs, though its cell starts {successors[0]} now.'
        elif _is_of_an_older_class(entry.node):
            text = (
                f'{entry.name} runs an earlier version of its class {type(entry.node).__name__}.'
            )
        else:
            continue
        found.append(
            (
                text,
                f'End it with lab.remove({entry.name!r}), or run the cell that starts it again.',
            )
        )
    return found


def _is_of_an_older_class(node: object) -> bool:
    """Tell whether a node's class was defined anew in the notebook since the node was made."""
    kind = type(node)
    if kind.__module__ != '__main__' or '.' in kind.__qualname__:
        return False
    current = getattr(sys.modules['__main__'], kind.__name__, kind)
    return isinstance(current, type) and current is not kind


def _doubles(runtime: Runtime, entries: list[NodeEntry]) -> list[tuple[str, str]]:
    foreign = runtime.foreign_nodes()
    return [
        (
            f'Another process has a node called {entry.name}, too.',
            'Give each node a name of its own. (A process that was killed stays in the graph for '
            '20 s: then wait, and look again.)',
        )
        for entry in entries
        if entry.name in foreign
    ]


def topics() -> str:
    """Look for ends of topics that can never exchange a message, and actions served twice."""
    runtime = _runtime()
    if runtime is None or runtime.helper is None:
        return 'none'
    from labkit.background.discovery import soon
    from labkit.rosgraph.snapshot import is_whole, read_graph

    node = runtime.helper
    soon(lambda: is_whole(node))
    graph = read_graph(node)
    pairs = graph.mismatches
    if pairs:
        raise LabError(
            ' '.join(
                f'On {pair.topic}, {pair.subscription} does not hear {pair.publisher}: '
                f'{pair.reason[:1].lower()}{pair.reason[1:]}.'
                for pair in pairs
            ),
            todo=' '.join(dict.fromkeys(pair.todo for pair in pairs)),
        )
    twice = [action for action in graph.actions if len(action.servers) > 1]
    if twice:
        raise LabError(
            ' '.join(
                f'The action {action.name} is served by {len(action.servers)} nodes: '
                f'{", ".join(action.servers)}. Each of them answers each goal.'
                for action in twice
            ),
            todo='End the server that does not belong there.',
        )
    actions = [f'{action.name} (action)' for action in graph.actions]
    names = [*(topic.name for topic in graph.topics), *actions]
    return first_few(names) if names else 'none'


def callbacks() -> str:
    """Look for exceptions that callbacks of this process's nodes have raised."""
    runtime = _runtime()
    errors = runtime.console.errors if runtime is not None else []
    if runtime is None or not errors:
        return 'no errors'
    # A node that was started anew since has another cell, or another execution of the same one.
    running = {(entry.name, id(entry.cell)) for entry in runtime.nodes()}
    texts = [
        f'{error.callback} of {error.node_name} failed'
        f'{f" {error.count} times" if error.count > 1 else ""}: '
        f'{type(error.error).__name__}: {error.error}'
        for error in errors
        if (error.node_name, id(error.cell)) in running
    ]
    if texts:
        raise LabError('; '.join(texts), todo='Mend the callback, and run its cells again.')
    return 'no errors but of nodes that are gone'


def _runtime() -> Runtime | None:
    """Return the runtime of this process, None if ROS was not loaded into it."""
    if 'rclpy.node' not in sys.modules:
        return None
    from labkit.background.runtime import runtime

    return runtime
