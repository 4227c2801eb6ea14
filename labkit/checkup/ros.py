"""ROS itself: middleware, domain, nodes, topics and callbacks, as seen from this process."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from labkit import domain_ids, settings
from labkit.checkup.found import Found
from labkit.errors import LabError, first_few
from labkit.rosgraph.names import is_hidden

if TYPE_CHECKING:
    from labkit.background.nodes import NodeEntry
    from labkit.background.runtime import Runtime

__all__ = ['callbacks', 'domain', 'middleware', 'nodes', 'topics']

RANGES = ('OFF', 'LOCALHOST', 'SUBNET', 'SYSTEM_DEFAULT')
# On Linux, the ports of these domains overlap with the system's ephemeral ports (docs.ros.org,
# "The ROS_DOMAIN_ID").
UNSAFE_DOMAIN_IDS = range(domain_ids.LAST_DOMAIN_ID + 1, 215)
TOPIC = f'_labkit/doctor_{os.getpid()}'
ARRIVAL_SEC = 2.0
# Python may start slowly on a busy machine; this is a limit, not an estimate.
PROCESS_SEC = 30.0

# In its own process: a library of another installation can crash a process.
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
    """Check that the middleware loads and delivers a message."""
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
    """Send a message through the background thread; return the middleware's name."""
    from rclpy.utilities import get_rmw_implementation_identifier
    from std_msgs.msg import String

    node = runtime.helper
    assert node is not None
    heard = threading.Event()
    # Not lab.wait_until(): nodes would print under this cell meanwhile.
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
    running = runtime.executor.running_for()
    if running is None or running[2] < ARRIVAL_SEC:
        raise LabError(
            f'A message did not arrive within {ARRIVAL_SEC:.0f} s.',
            todo='Maybe this machine, or the callbacks of this notebook, have too much to do. If '
            'it stays so, restart the kernel.',
        )
    entry, callback, seconds = running
    earlier = 'an earlier ' * runtime.executor.runs_for_an_ended_node()
    raise LabError(
        f'No message can arrive: the callback {callback} of {earlier}{entry.name} has been '
        f'running for {seconds:.0f} s, and while it runs no other callback can.',
        todo='Restart the kernel, and let that callback return soon: no endless loop, no sleep.',
    )


def _try_in_a_process() -> str:
    """Send a message in a new process; return the middleware's name."""
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
    late = f'Maybe this machine has too much to do: look again when it rests. {todo}'
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
            f'ROS was started, but did not answer within {PROCESS_SEC:.0f} s.', todo=late
        ) from None
    for line in done.stdout.splitlines():
        if line.startswith('doctor: '):
            _, name, count = line.split()
            if count == '1':
                return name
            raise LabError(f'A message did not arrive within {ARRIVAL_SEC:.0f} s.', todo=late)
    raise LabError(f'ROS does not start: {_reason(done)}', todo=todo)


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    """Return the line of a process's errors that says why it failed."""
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    for line in lines:
        if line.split(':')[0].endswith(('Error', 'Exception')):
            return line
    return lines[-1] if lines else f'it ended with exit code {done.returncode}.'


# --- Domain --------------------------------------------------------------------------------------


def domain() -> str:
    """Check who can communicate with this process: domain and discovery range."""
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
    return f'{runtime.domain_id} ({whose}), range {reach}{_elsewhere(runtime.domain_id)}'


def _elsewhere(own: int | None) -> str:
    """Return whose programs are in this domain, or where those of this user are, in words."""
    from labkit.background.domains import domains_of_programs, other_accounts_in

    accounts = other_accounts_in(own or 0)
    if accounts:
        return (
            f'; programs of {first_few(accounts)} are in it, too: what passes between two '
            'accounts may get lost'
        )
    others = [str(domain_id) for domain_id in domains_of_programs() if domain_id != own]
    if not others:
        return ''
    which = 'domain' if len(others) == 1 else 'domains'
    return f'; programs of yours in {which} {first_few(others)} are apart from it'


def _range() -> str:
    """Return the discovery range.

    Raises:
        LabError: The variable has a value that ROS does not know.
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
    """Check for nodes that are not spun, left over, or have a double."""
    runtime = _runtime()
    if runtime is None:
        return 'none'
    entries = [entry for entry in runtime.nodes() if not is_hidden(entry.name)]
    names = [*(entry.name for entry in entries), *_spun_elsewhere(runtime)]
    found = [*_unspun(runtime), *_left_behind(entries), *_doubles(runtime, entries)]
    states = _states(entries)
    _raise_for_faults('parameters', 'remap', 'life', besides=found, also=states)
    return '. '.join([first_few(names), *states]) if names else 'none'


def _spun_elsewhere(runtime: Runtime) -> list[str]:
    """Return the nodes that executors of the learner's own spin."""
    from labkit.background.nodes import full_name
    from labkit.background.own_executors import is_spun

    nodes = [node for node in runtime.unspun_nodes() if is_spun(node)]
    return [full_name(node) for node in nodes if not is_hidden(node.get_name())]


def _states(entries: list[NodeEntry]) -> list[str]:
    from labkit.background.nodes import state_of

    # A state is no fault, yet it may be why somebody has asked.
    states = ((entry.name, state_of(entry.node)[1]) for entry in entries)
    return [f'{name} {now}' for name, now in states if now]


def _unspun(runtime: Runtime) -> list[tuple[str, str]]:
    from labkit.background.nodes import full_name, half_made
    from labkit.background.own_executors import is_spun

    nodes = [
        node
        for node in runtime.unspun_nodes()
        if not is_spun(node) and not is_hidden(node.get_name())
    ]
    lost = {full_name(node) for node in nodes if node.executor is not None}
    found = [
        (
            f'{name} is half made: an error has ended its __init__.',
            'Mend what the error of its cell says, and run the cell again.',
        )
        for name in sorted({full_name(node) for node in nodes if node in half_made})
    ]
    counts = Counter(full_name(node) for node in nodes if node not in half_made)
    for name, count in sorted(counts.items()):
        made = f'{name} was made{f" {count} times" if count > 1 else ""}'
        found.append(
            (
                f'{name} is in an executor that nobody spins: its callbacks are not called.'
                if name in lost
                else f'{made}, but nobody spins it: its callbacks are never called.',
                'Start it with lab.spin(node), or end it with lab.remove(node).',
            )
        )
    return found


def _left_behind(entries: list[NodeEntry]) -> list[tuple[str, str]]:
    """Find nodes of a cell, or of a class, that has been edited and run again."""
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
    """Return whether a node's class has been redefined in the notebook since the node was made."""
    kind = type(node)
    if kind.__module__ != '__main__' or '.' in kind.__qualname__:
        return False
    current = getattr(sys.modules['__main__'], kind.__name__, kind)
    return isinstance(current, type) and current is not kind


def _doubles(runtime: Runtime, entries: list[NodeEntry]) -> list[tuple[str, str]]:
    from labkit.rosgraph.whose import missing_nodes

    foreign = runtime.foreign_nodes()
    missing = missing_nodes(runtime.helper) if runtime.helper is not None else set()
    return [
        (
            f'Another process has a node called {entry.name}, too.',
            'Give each node a name of its own.',
        )
        if entry.name not in missing
        else (
            f'The graph has another node called {entry.name}, but this machine has no process '
            'with its number.',
            'Maybe it was killed: the graph forgets it after 20 s. Look again then.',
        )
        for entry in entries
        if entry.name in foreign
    ]


def topics() -> str:
    """Check for endpoints that can't communicate, and actions served twice."""
    runtime = _runtime()
    if runtime is None or runtime.helper is None:
        return 'none'
    from labkit.asking.discovery import poll_until
    from labkit.rosgraph.snapshot import is_whole, read_graph

    node = runtime.helper
    poll_until(lambda: is_whole(node))
    graph = read_graph(node)
    apart = [
        (
            f'On {pair.topic}, {pair.subscription} does not hear {pair.publisher}: '
            f'{pair.reason[:1].lower()}{pair.reason[1:]}.',
            pair.todo,
        )
        for pair in graph.mismatches
    ]
    said = {pair.topic for pair in graph.mismatches}
    twice = [
        (
            f'The action {action.name} is served by {len(action.servers)} nodes: '
            f'{", ".join(action.servers)}. Each of them answers each goal.',
            'End the server that does not belong there.',
        )
        for action in graph.actions
        if len(action.servers) > 1
    ]
    _raise_for_faults(
        'names', 'types', 'qos', 'messages', 'frames', besides=[*apart, *twice], said=said
    )
    actions = [f'{action.name} (action)' for action in graph.actions]
    names = [*(topic.name for topic in graph.topics), *actions]
    return first_few(names) if names else 'none'


def callbacks() -> str:
    """Check for exceptions in callbacks of this process's nodes."""
    runtime = _runtime()
    errors = runtime.console.errors if runtime is not None else []
    if runtime is None:
        return 'no errors'
    # A restarted node has another cell, or another execution of the same one.
    running = {(entry.name, id(entry.cell)) for entry in runtime.nodes()}
    failed = [
        (
            f'{error.callback} of {error.node_name} failed'
            f'{f" {error.count} times" if error.count > 1 else ""}: '
            f'{type(error.error).__name__}: {error.error}',
            'Mend the callback, and run its cells again.',
        )
        for error in errors
        if (error.node_name, id(error.cell)) in running
    ]
    _raise_for_faults('time', besides=failed)
    return 'no errors but of nodes that are gone' if errors else 'no errors'


def _raise_for_faults(
    *groups: str,
    besides: Sequence[tuple[str, str]] = (),
    said: Collection[str] = (),
    also: Sequence[str] = (),
) -> None:
    """Raise a LabError if there are silent faults of some groups of kinds.

    Args:
        groups: The groups.
        besides: What else was found, with what to do.
        said: Topics of which it was said that their ends do not match.
        also: What is no fault, and is told beside one.
    """
    from labkit.silent.watch import faults

    found = [fault for fault in faults() if fault.kind.id.partition('.')[0] in groups]
    # Others that the doctor has looked for already are told in its own words.
    known = ('life.unspun', 'names.double', 'time.stuck-callback')
    told = [
        *besides,
        *(
            (str(fault), fault.advice)
            for fault in found
            if fault.kind.id not in known
            and not (fault.kind.id.startswith(('types.', 'qos.')) and fault.about in said)
        ),
    ]
    if told:
        raise Found([*told, *((text, '') for text in also)])


def _runtime() -> Runtime | None:
    """Return the runtime of this process, None if ROS is not loaded."""
    if 'rclpy.node' not in sys.modules:
        return None
    from labkit.background.runtime import runtime

    return runtime
