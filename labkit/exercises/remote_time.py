"""Virtual time for nodes of other processes: the parameter `use_sim_time` and the topic `/clock`.

A step is over when a node has answered twice: the first answer says that it has heard of the new
time, the second one that it has done what was due then. A timer that is due more than once within
a step is called once.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['RemoteTime']

GUARD = Path(__file__).with_name('time_guard.py')
# How long a node may take to answer for the first time, s of real time. One that does not is not
# spun, or at work for long, and is left in real time.
FIRST_ANSWER_SEC = 1.2
# How long the services of a node may take to come into the graph after its name, s of real time.
SERVICES_SEC = 1.0
# And how long later on. One that does not answer then is not asked again.
ANSWER_SEC = 3.0
# The first question of a client is asked again when no answer has come for so long, s.
AGAIN_SEC = 0.5
# How long a question is kept that nobody waits for, s of real time: it has to be on its way.
LATE_SEC = 0.1
# How long a clock may take to be found by a node, s of real time.
MATCH_SEC = 5.0
POLL_SEC = 0.001


class RemoteTime:
    """The time of some nodes of other processes, for a `with` block.

    Args:
        node: A spun node of this process, which asks.
        names: Full names of the nodes. Those without parameter services can't be told a time.

    Attributes:
        names: Full names of the nodes that follow.
    """

    def __init__(self, node: Node, names: Sequence[str]) -> None:
        self._node = node
        self.names = list(names)
        self._clients: dict[str, Any] = {}
        self._told: dict[str, bool] = {}
        self._guard: subprocess.Popen[bytes] | None = None
        self._clock: Any = None

    def __enter__(self) -> RemoteTime:
        from rcl_interfaces.srv import GetParameters
        from rclpy.qos import QoSProfile, ReliabilityPolicy
        from rosgraph_msgs.msg import Clock

        from labkit.background.patience import answer_sec

        if self._node.count_publishers('/clock'):
            self.names = []  # somebody else tells the time
        _wait(lambda: all(map(self._has_parameters, self.names)), SERVICES_SEC)
        self.names = [name for name in self.names if self._has_parameters(name)]
        if not self.names:
            return self
        profile = QoSProfile(  # type: ignore[no-untyped-call]
            depth=10, reliability=ReliabilityPolicy.RELIABLE
        )
        self._clock = self._node.create_publisher(Clock, '/clock', profile)
        self._guard = _start_guard(self.names)
        patience = answer_sec(FIRST_ANSWER_SEC)
        self._told = {name: self._use_sim_time(name, True, patience) for name in self.names}
        self.names = [name for name, follows in self._told.items() if follows]
        self._clients = {
            name: self._node.create_client(GetParameters, f'{name}/get_parameters')
            for name in self.names
        }
        _wait(lambda: self._clock.get_subscription_count() >= len(self.names), MATCH_SEC)
        for client in self._clients.values():
            _wait(client.service_is_ready, ANSWER_SEC)
            # The node may find this client later than this client the node: `ServiceCalls.call`.
            request = GetParameters.Request(names=['use_sim_time'])
            _wait(lambda: _answer(client, request).wait(AGAIN_SEC), patience)  # noqa: B023
        return self

    def __exit__(self, *_: object) -> None:
        for name, follows in self._told.items():
            # Who has not answered may still do what was asked, and has to take it back then.
            self._use_sim_time(name, False, ANSWER_SEC if follows else LATE_SEC)
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

        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(nanoseconds, 1_000_000_000)
        self._clock.publish(message)
        self.settle()

    def settle(self) -> None:
        """Wait until the nodes have done what has reached them."""
        from rcl_interfaces.srv import GetParameters

        request = GetParameters.Request(names=['use_sim_time'])
        # A node takes one request of a service each time it looks what is ready, timers first. So
        # both may be sent at once.
        answers = [
            (name, _answer(self._clients[name], request)) for name in self.names for _ in range(2)
        ]
        end = time.monotonic() + ANSWER_SEC
        silent = {
            name for name, done in answers if not done.wait(max(0.0, end - time.monotonic()))
        }
        self.names = [name for name in self.names if name not in silent]

    def _has_parameters(self, name: str) -> bool:
        services = dict(self._node.get_service_names_and_types())
        return {f'{name}/set_parameters', f'{name}/get_parameters'} <= services.keys()

    def _use_sim_time(self, name: str, value: bool, timeout_sec: float) -> bool:
        """Set the parameter of a node; tell whether it has taken it in time."""
        from rcl_interfaces.srv import SetParameters
        from rclpy.parameter import Parameter

        from labkit.background.service_calls import ServiceCalls
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


def _answer(client: Any, request: Any) -> threading.Event:
    """Ask a service; return what is set when it has answered."""
    done = threading.Event()
    client.call_async(request).add_done_callback(lambda _: done.set())
    return done


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


def _wait(condition: Any, timeout_sec: float) -> bool:
    end = time.monotonic() + timeout_sec
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(POLL_SEC)
    return True
