"""What a check may look at: the live graph, real messages, and what becomes of those it sends.

A probe is a hidden node for the time of one check. It looks on while the learner's nodes run as
they were started, and nothing of it is left when the check ends.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

from labkit import stop_button
from labkit.background.wait import wait_for
from labkit.exercises.callback_count import Callbacks, find_node, is_given
from labkit.exercises.messages_heard import Watch, build
from labkit.exercises.verdict import Fail, LearnerError
from labkit.exercises.what_is_asked import Scope
from labkit.progress_bar import ProgressBar
from labkit.rosgraph.names import EVERY_NODE_HAS, is_hidden

if TYPE_CHECKING:
    from labkit.exercises.observation import Life
    from labkit.rosgraph.endpoints import Endpoint
    from labkit.rosgraph.servers import Server

__all__ = ['Probe']

# Waits are for events, and end long before this.
TIMEOUT_SEC = 20.0
# How long something that is not there may still be on its way: from a thread of this process,
# because ROS itself was started by this check, or from a process that has come into the graph.
THREAD_GRACE_SEC = 0.15
DISCOVERY_SEC = 3.0
ENDPOINT_GRACE_SEC = 1.0
# How often it is looked whether a process is on its way: it costs some milliseconds.
LOOK_SEC = 0.25
# So long the learner's code may work for one check, s of real time: what it does in half a minute
# of its time has to be seen in a moment.
WORK_SEC = 4.0
# A node's name that was lost on the way is told again when Fast DDS asks, each 3 s.
NAMED_SEC = 10.0


class Probe:
    """The graph and the messages, for the time of a `with` block.

    Args:
        name: Name of the exercise.
        scope: What the exercise asks for.
        recorded: What was recorded before the check, by topic.
        timeout_sec: Seconds after which every wait ends.

    Attributes:
        node: The hidden node.
        callbacks: What the learner's callbacks do meanwhile.
        logs: The log messages of all nodes, from the start of the check.
        life: What was seen while time passed, the last time that it did; None before.
        lived_sec: How much virtual time has passed for nodes of the learner's, s.
        held_lines: How many lines they wrote meanwhile. They are not shown.
        lives_sec: How much of it is to pass just now, s.
        work_sec: How long the learner's code may still work for this check, s of real time.
        began: When the cell of the check began, ns since 1970.
        moved_clocks: Full names of the nodes of other processes whose clocks were ahead meanwhile.
    """

    def __init__(
        self,
        name: str,
        scope: Scope | None = None,
        *,
        recorded: Mapping[str, Watch] | None = None,
        timeout_sec: float = TIMEOUT_SEC,
    ) -> None:
        self.name = name
        self.scope = scope or Scope()
        self.recorded = dict(recorded or {})
        self._watches: list[Watch] = []
        self._publishers: list[Any] = []
        self._end = time.monotonic() + timeout_sec
        self._stopped: float | None = None
        self._begun = time.monotonic()
        self.began = time.time_ns()
        self._bar = ProgressBar('Checking')
        self.life: Life | None = None
        self.lived_sec = 0.0
        self.lives_sec = 1.0
        self.work_sec = WORK_SEC
        self.held_lines = 0
        self.moved_clocks: set[str] = set()
        # See `starting_children`.
        self._used: dict[int, float] = {}
        # Nodes of other processes that have answered.
        self._met: set[str] = set()

    def __enter__(self) -> Probe:
        with contextlib.ExitStack() as undo:
            undo.enter_context(stop_button.held())
            undo.callback(self._finish)
            self._begin()
            self._undo = undo.pop_all()
        return self

    def _begin(self) -> None:
        from labkit.background.nodes import helper_node
        from labkit.background.runtime import runtime

        self._fresh = not runtime.started
        runtime.start()
        self.began = runtime.console.cell_began or self.began
        self.callbacks = Callbacks()
        self.node = helper_node(f'_check_{self.name}')
        self._meet_others()
        self.logs = self.watch('/rosout', 'rcl_interfaces/msg/Log')

    def _meet_others(self) -> None:
        """Wait until the nodes of other processes answer: then all of their ends are known.

        A process tells its nodes' names later than what they publish.
        """
        from labkit.rosgraph.whose import all_are_named, foreign_nodes

        wait_for(lambda: all_are_named(self.node), NAMED_SEC)
        self._meet(foreign_nodes(self.node))

    def _meet(self, names: Iterable[str]) -> None:
        from labkit.asking.service_calls import wait_until_spun

        for name in sorted(names):
            ours = is_hidden(name) or is_given(name, self.scope)
            if not ours and wait_until_spun(self.spun_node, name):
                self._met.add(name)

    def __exit__(self, *_: object) -> None:
        self._undo.close()

    def _finish(self) -> None:
        self._bar.close()
        from rclpy.exceptions import InvalidHandle

        # A learner's thread may have shut ROS down.
        with contextlib.suppress(InvalidHandle):
            self.node.destroy_node()  # type: ignore[no-untyped-call]

    # -- time -----------------------------------------------------------------------------------

    @property
    def time_left(self) -> float:
        """Seconds until every wait of this check ends."""
        return max(0.0, self._end - (self._stopped or time.monotonic()))

    def allow(self, seconds: float) -> None:
        """Let so much time be left at least: no check needs less than its task allows.

        Args:
            seconds: What the task allows for what comes next, s.
        """
        self._end += max(0.0, seconds - self.time_left)

    @contextlib.contextmanager
    def uncounted(self) -> Iterator[None]:
        """Let the time of a `with` block not count: nodes need it, more on a busy machine."""
        if self._stopped is not None:
            yield
            return
        self._stopped = time.monotonic()
        try:
            yield
        finally:
            self._end += time.monotonic() - self._stopped
            self._stopped = None

    def wait(self, condition: Callable[[], object], timeout_sec: float | None = None) -> bool:
        """Wait until `condition()` is true, while messages are taken.

        Args:
            condition: A function without arguments.
            timeout_sec: Seconds to wait, cut to what is left for the check; all of it if None.

        Returns:
            Whether it became true.

        Raises:
            LearnerError: A callback of a node under test raised meanwhile.
        """

        def look() -> bool:
            for watch in self._watches:
                watch.pump()
            if condition():
                return True
            self.callbacks.raise_new_error(self.scope)
            seconds = time.monotonic() - self._begun
            self._bar.show(None, f'watching in real time, {seconds:.0f} s')
            return False

        left = self.time_left
        return wait_for(look, left if timeout_sec is None else min(timeout_sec, left))

    def wait_to_appear(self, condition: Callable[[], object]) -> bool:
        """Wait for something that is not there, as long as it may be on its way."""
        if self.wait(condition, THREAD_GRACE_SEC):
            return True
        if self._fresh and self.wait(condition, DISCOVERY_SEC):
            return True
        known = any(self._starting())
        with self.uncounted():
            end = time.monotonic() + self.time_left
            while (self._starting()[0] or self._unmet()) and time.monotonic() < end:
                if self.wait(condition, LOOK_SEC):
                    return True
                known = True
                self._meet(self._unmet())
        return self.wait(condition, ENDPOINT_GRACE_SEC if known else 0.0)

    def _unmet(self) -> set[str]:
        """Return the nodes of child processes that may answer, and have not done so yet.

        They may be on the way to what they publish and subscribe to. One that has the last
        service which rclpy makes, and not the parameter services before it, can't answer.
        """
        from labkit.programs.children import child_ids
        from labkit.rosgraph.whose import nodes_of

        nodes = nodes_of(child_ids().difference(self._settled()), self.node)
        services = dict(self.spun_node.get_service_names_and_types()) if nodes else {}

        def may_answer(name: str) -> bool:
            last, asked = f'{name}/get_type_description', f'{name}/list_parameters'
            return last not in services or asked in services

        return {
            name
            for name in nodes - self._met
            if may_answer(name) and not is_given(name, self.scope)
        }

    def _settled(self) -> set[int]:
        """Return the ids of the lesson's processes that say which nodes they have."""
        from labkit.programs.child_processes import processes

        return set().union(*(p.pids for p in processes() if p.announced is not None))

    def _starting(self) -> tuple[bool, bool]:
        """Tell whether something was started lately that is not, or is, in the graph yet."""
        if os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') == 'OFF':
            return False, False
        from labkit.background.runtime import runtime
        from labkit.domain_ids import ports
        from labkit.programs.children import starting_children

        # Every node publishes there.
        infos = self.node.get_publishers_info_by_topic('/parameter_events')
        gids = {bytes(info.endpoint_gid) for info in infos}
        assert runtime.domain_id is not None
        domain = ports(runtime.domain_id)
        return starting_children(gids, self._settled(), domain, self._used)

    def process_is_starting(self) -> bool:
        """Tell whether a process was started that is not, or not all, in the graph yet."""
        return self._starting()[0]

    def something_is_starting(self) -> bool:
        """Tell whether a process was started a moment ago."""
        return any(self._starting())

    # -- virtual time ---------------------------------------------------------------------------

    @property
    def spun_node(self) -> Any:
        """A hidden node that the background spins, for questions to other processes."""
        from labkit.background.runtime import runtime

        return runtime.helper

    def hold_output(self) -> AbstractContextManager[list[int]]:
        """Show nothing of what callbacks write meanwhile; gives how many lines that were."""
        from labkit.background.runtime import runtime

        return runtime.console.holding()

    def note_output(self, seconds: float, lines: Sequence[int]) -> None:
        """Note that so much virtual time has passed, and what was written meanwhile."""
        self.lived_sec += seconds
        self.held_lines += sum(lines)

    def look(self, seconds: float) -> None:
        """Look whether a callback has raised, and say how far the check is.

        Args:
            seconds: How much virtual time has passed, s.

        Raises:
            LearnerError: A callback of a node under test has raised.
        """
        stop_button.look()
        self.callbacks.raise_new_error(self.scope)
        self._bar.show(seconds / self.lives_sec, f'{seconds:.0f} s of the time of your nodes')

    def forget(self, watches: Iterable[Watch]) -> None:
        """Take no more messages of these."""
        gone = list(watches)
        self._watches = [watch for watch in self._watches if watch not in gone]

    # -- the graph ------------------------------------------------------------------------------

    def publishers(self, topic: str) -> list[Endpoint]:
        """Return the learner's publishers on a topic."""
        from labkit.rosgraph import endpoints

        return self._learners(endpoints.publishers(self.node, topic), commands=True)

    def subscriptions(self, topic: str) -> list[Endpoint]:
        """Return the learner's subscriptions to a topic."""
        from labkit.rosgraph import endpoints

        return self._learners(endpoints.subscriptions(self.node, topic))

    def all_publishers(self) -> list[Endpoint]:
        """Return the learner's publishers on all topics."""
        from labkit.rosgraph.endpoints import publishers

        found = (end for topic in self.topics() for end in publishers(self.node, topic))
        return self._learners(found, commands=True)

    def all_subscriptions(self) -> list[Endpoint]:
        """Return the learner's subscriptions to all topics."""
        from labkit.rosgraph.endpoints import subscriptions

        found = (end for topic in self.topics() for end in subscriptions(self.node, topic))
        return self._learners(found)

    def all_servers(self) -> list[Server]:
        """Return the services that the learner's nodes offer, without those of every node."""
        from labkit.rosgraph.servers import servers

        return [
            server
            for server in servers(self.node)
            if not is_hidden(server.node) and not is_given(server.node, self.scope)
        ]

    def topics(self) -> dict[str, list[str]]:
        """Return the topics that are not part of every node, with their types."""
        return {
            name: types
            for name, types in self.node.get_topic_names_and_types()
            if name not in EVERY_NODE_HAS and not is_hidden(name)
        }

    def node_names(self) -> list[str]:
        """Return the full names of the learner's nodes; one that runs twice is there twice."""
        from labkit.rosgraph.snapshot import node_names

        names = node_names(self.node)
        return [name for name in names if not is_hidden(name) and not is_given(name, self.scope)]

    def is_from_here(self, name: str) -> bool:
        """Tell whether a node is of this process, or of one that this process has started."""
        if self.node_object(name) is not None:
            return True
        from labkit.programs.children import is_of_child

        ends = [*self.all_publishers(), *self.all_subscriptions()]
        return any(end.node == name and is_of_child(end.gid) for end in ends)

    def node_object(self, name: str) -> Any:
        """Return the node of that name as an object, None if it runs in another process."""
        return find_node(name)

    def attempt(self) -> frozenset[str]:
        """Return the learner's nodes that show an attempt at this exercise, see `Scope`."""
        return self.scope.attempt(
            self.all_publishers(),
            self.all_subscriptions(),
            self.node_names(),
            self.all_servers(),
        )

    def fingerprint(self) -> frozenset[bytes]:
        """Return the ids of all of the learner's endpoints: they tell one run from another."""
        found = self.all_publishers() + self.all_subscriptions()
        return frozenset(endpoint.gid for endpoint in found)

    def in_this_process(self, endpoint: Endpoint) -> bool:
        """Tell whether an endpoint belongs to this notebook's process."""
        from labkit.rosgraph.whose import is_own

        return is_own(endpoint.gid, self.node)

    def place(self, endpoint: Endpoint) -> str:
        """Say where an endpoint runs, in words that follow its node's name."""
        from labkit.rosgraph import whose

        return whose.place(endpoint.gid, self.node)

    def _learners(self, found: Iterable[Endpoint], commands: bool = False) -> list[Endpoint]:
        """Leave out what is not the learner's. The hidden node of a command may be."""
        return [
            end
            for end in found
            if not is_given(end.node, self.scope)
            and (not is_hidden(end.node) or (commands and self._is_of_command(end)))
        ]

    def _is_of_command(self, end: Endpoint) -> bool:
        return end.is_known and not self.in_this_process(end)

    # -- messages -------------------------------------------------------------------------------

    def watch(self, topic: str, msg_type: str, *, latched: bool = False) -> Watch:
        """Start to collect the messages of a topic."""
        from rclpy.qos import ReliabilityPolicy

        infos = self.node.get_publishers_info_by_topic(topic)
        best_effort = ReliabilityPolicy.BEST_EFFORT
        reliable = all(info.qos_profile.reliability != best_effort for info in infos)
        watch = Watch(self.node, topic, msg_type, reliable=reliable, latched=latched)
        self._watches.append(watch)
        return watch

    def sender(self, topic: str, msg_type: str) -> Callable[[Mapping[str, Any]], float]:
        """Return a function that publishes; it waits for the subscriptions that are there now.

        Returns:
            A function of the fields (see `watch.build`) that publishes one message and returns
            when that was, in seconds of the clock that message stamps use.
        """
        from labkit.asking.delivery import wait_until_found
        from labkit.rosgraph.interfaces import message_class

        publisher = self.node.create_publisher(message_class(msg_type), topic, 10)
        self._publishers.append(publisher)
        wait_until_found(self.spun_node, [publisher])

        def send(fields: Mapping[str, Any]) -> float:
            now = time.time()
            publisher.publish(build(msg_type, fields))
            return now

        return send

    def stop_node(self, endpoint: Endpoint) -> None:
        """End the node of an endpoint, as the learner would: remove it, or press Ctrl-C.

        Raises:
            LearnerError: Its `destroy_node` raises. The node is gone all the same.
            Fail: It runs in a process that this notebook has not started.
        """
        node = self.node_object(endpoint.node) if self.in_this_process(endpoint) else None
        if node is not None:
            from labkit.background.runtime import runtime
            from labkit.background.tracebacks import short_traceback

            with stop_button.heard_at_once():
                error = runtime.destroy(node)
            if error is not None:
                where = f'destroy_node of {endpoint.node}'
                raise LearnerError(where, error, short_traceback(error))
        elif not _interrupt(endpoint.gid):
            raise Fail(
                f'{endpoint.node} runs in this notebook, so that the check can end it',
                f'it runs {self.place(endpoint)}',
                todo='End it there, start it here, and check again.',
            )


def _interrupt(gid: bytes) -> bool:
    from labkit.programs.children import interrupt_child

    return interrupt_child(gid)
