"""Virtual time for nodes of other processes: the parameter `use_sim_time` and the topic `/clock`.

They are told the time in steps. A step is over when a node has answered twice: the first answer
says that it has heard of the new time, the second one that it has done what was due then. What it
published has arrived by then, too. A timer that is due more than once within a step is called
once.

Two things are not as they would be. Afterwards the clock of such a node goes back to the
computer's time; the next check begins where the last one has ended. And what a process does
without its clock, such as a loop that sleeps, goes on in real time meanwhile: one that needs more
of it than is told is left in real time. A node that follows `/clock` already and has nobody who
tells it the time stands still in reality, too. Where there is one, nobody is told the time, or it
would hear that.
"""

from __future__ import annotations

import contextlib
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit import stop_button
from labkit.background.wait import wait_for
from labkit.exercises.time.fair_clock import FairClock

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['RemoteTime']

GUARD = Path(__file__).with_name('time_guard.py')
# How long a node may take to answer, s of real time. One that does not is not spun, or at work for
# long: it is left in real time, and not asked again.
ANSWER_SEC = 3.0
# How often it is looked whether an answer has come, s.
LOOK_SEC = 0.01
# The first question of a client is asked again when no answer has come for so long, s.
AGAIN_SEC = 0.5
# How long a question is kept that nobody waits for, s of real time: it has to be on its way.
UNDERWAY_SEC = 0.1


class RemoteTime:
    """The time of some nodes of other processes, for a `with` block.

    Args:
        node: A spun node of this process, which asks.
        names: Full names of the nodes. Those without parameter services can't be told a time.

    Attributes:
        names: Full names of the nodes that follow.
        slow: Whether they were given up, for they need more time than they are told.
    """

    def __init__(self, node: Node, names: Sequence[str]) -> None:
        self._node = node
        self.names = list(names)
        self.slow = False
        self._first = self._now = 0
        self._waited = 0.0
        self._deaf: set[str] = set()
        self._pids: dict[str, int] = {}
        self._clients: dict[str, Any] = {}
        self._told: dict[str, bool] = {}
        self._guard: subprocess.Popen[bytes] | None = None
        self._clock: Any = None

    def __enter__(self) -> RemoteTime:
        with contextlib.ExitStack() as undo:
            undo.push(self)
            self._begin()
            undo.pop_all()
        return self

    def _begin(self) -> None:
        from rcl_interfaces.srv import GetParameters
        from rosgraph_msgs.msg import Clock

        from labkit.asking.delivery import wait_until_found
        from labkit.programs.children import child_of
        from labkit.rosgraph.endpoints import publishers, subscriptions
        from labkit.rosgraph.names import is_hidden

        if self._node.count_publishers('/clock'):
            self.names = []  # somebody else tells the time
        wait_for(lambda: all(map(self._has_parameters, self.names)), AGAIN_SEC)
        self.names = [name for name in self.names if self._has_parameters(name)]
        for end in publishers(self._node, '/parameter_events'):
            child = child_of(end.gid) if end.node in self.names else None
            if child is not None:
                self._pids[end.node] = child.pid
        for name in self.names:
            service = f'{name}/get_parameters'
            self._clients[name] = self._node.create_client(GetParameters, service)
        self.names = [name for name in self.names if self._goes_by_real_time(name)]
        others = {end.node for end in subscriptions(self._node, '/clock')} - {*self.names}
        if not self.names or not all(map(is_hidden, others)):
            self.names = []
            return
        self._clock = self._node.create_publisher(Clock, '/clock', 10)
        self._guard = _start_guard(self.names)
        for name in self.names:
            # Asked is as good as told: it may have taken it when this is stopped.
            self._told[name] = False
            self._told[name] = self._use_sim_time(name, True, ANSWER_SEC)
        self.names = [name for name, follows in self._told.items() if follows]
        wait_for(lambda: self._clock.get_subscription_count() >= len(self.names), ANSWER_SEC)
        wait_until_found(self._node, [self._clock])

    def __exit__(self, *_: object) -> None:
        with stop_button.undoing():
            self._end()

    def _end(self) -> None:
        for name, follows in self._told.items():
            # Who has not answered may still do what was asked, and has to take it back then.
            answers = follows and name not in self._deaf
            self._use_sim_time(name, False, ANSWER_SEC if answers else UNDERWAY_SEC)
        for client in self._clients.values():
            self._node.destroy_client(client)
        if self._clock is not None:
            self._node.destroy_publisher(self._clock)
        if self._guard is not None and self._guard.stdin is not None:
            self._guard.stdin.write(b'done')
            self._guard.stdin.close()
            self._guard.wait()

    def set(self, nanoseconds: int) -> None:
        """Tell the time, and wait until what is due then is done.

        Args:
            nanoseconds: The time, in nanoseconds since 1970.
        """
        if not self.names:
            return
        from rosgraph_msgs.msg import Clock

        self._first, self._now = self._first or nanoseconds, nanoseconds
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(nanoseconds, 1_000_000_000)
        self._clock.publish(message)
        self.settle()

    def settle(self) -> None:
        """Wait until the nodes have done what has reached them."""
        # A node takes one request of a service each time it looks what is ready, timers first. So
        # both may be sent at once.
        asked = [(name, self._ask(name)) for name in self.names for _ in range(2)]
        silent = {name for name, (done, _) in asked if not self._answers_in_time(name, done)}
        # One that has ended is gone from the graph, and was not slow.
        self.slow |= any(map(self._has_parameters, silent))
        self.names = [name for name in self.names if name not in silent]

    def catch_up(self) -> None:
        """Wait until the nodes that do not follow have done what has reached them.

        One may be seconds behind: a MultiThreadedExecutor that has much to do hands each callback
        that waits to its threads again and again.
        """
        late = self._clients.keys() - {*self.names, *self._deaf}
        asked = [(name, self._ask(name)[0]) for name in late]
        self._deaf |= {name for name, done in asked if not self._answers(name, done)}

    @property
    def is_deaf(self) -> bool:
        """Whether each node that was told the time has stopped to answer for good."""
        return bool(self._clients) and self._clients.keys() <= self._deaf

    def _answers_in_time(self, name: str, done: threading.Event) -> bool:
        """Wait for an answer; tell whether it came within the time that the node has in all."""
        waited, limit = self._waited, ANSWER_SEC + (self._now - self._first) * 1e-9

        def has_time(seconds: float) -> bool:
            self._waited = waited + seconds
            return self._waited <= limit

        return self._answers(name, done, has_time)

    def _answers(
        self,
        name: str,
        done: threading.Event,
        has_time: Callable[[float], bool] = lambda seconds: seconds <= ANSWER_SEC,
    ) -> bool:
        """Wait for an answer while a node has time; tell whether it came."""
        clock = FairClock(self._pids.get(name))
        while not stop_button.wait(done, LOOK_SEC):
            if not has_time(clock.seconds):
                return False
        return True

    def _has_parameters(self, name: str) -> bool:
        services = dict(self._node.get_service_names_and_types())
        return {f'{name}/set_parameters', f'{name}/get_parameters'} <= services.keys()

    def _goes_by_real_time(self, name: str) -> bool:
        """Tell whether a node answers, and its time is the computer's."""
        wait_for(self._clients[name].service_is_ready, ANSWER_SEC)
        for _ in range(int(ANSWER_SEC / AGAIN_SEC)):
            # The node may find this client later than this client the node: `ServiceCalls.call`.
            done, future = self._ask(name)
            if self._answers(name, done, lambda seconds: seconds <= AGAIN_SEC):
                return not any(value.bool_value for value in future.result().values)
        return False

    def _ask(self, name: str) -> tuple[threading.Event, Any]:
        """Ask a node for its `use_sim_time`; return what is set when it has answered."""
        from rcl_interfaces.srv import GetParameters

        done = threading.Event()
        future = self._clients[name].call_async(GetParameters.Request(names=['use_sim_time']))
        future.add_done_callback(lambda _: done.set())
        return done, future

    def _use_sim_time(self, name: str, value: bool, timeout_sec: float) -> bool:
        """Set the parameter of a node; tell whether it has taken it in time."""
        from rcl_interfaces.srv import SetParameters
        from rclpy.parameter import Parameter

        from labkit.asking.service_calls import ServiceCalls
        from labkit.errors import LabError

        parameter: Any = Parameter('use_sim_time', value=value)  # type: ignore[no-untyped-call]
        request = SetParameters.Request(parameters=[parameter.to_parameter_msg()])
        try:
            with ServiceCalls(self._node, SetParameters, f'{name}/set_parameters') as service:
                if not service.wait_until_ready(ANSWER_SEC):
                    return False
                response = service.call(request, timeout_sec, again_sec=AGAIN_SEC)
        except LabError:
            return False
        return all(result.successful for result in response.results)


def _start_guard(names: Sequence[str]) -> subprocess.Popen[bytes]:
    """Start what gives the nodes their time back should this process be killed meanwhile."""
    return subprocess.Popen(
        # As long as nothing happens it costs nothing: neither site-packages nor ROS are loaded.
        [sys.executable, '-I', '-S', str(GUARD), sys.executable, *names],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
