"""Calling a service, from the cell or terminal that waits for the answer."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from rcl_interfaces.srv import ListParameters
from rclpy.node import Node

from labkit.background.compat import RCLError
from labkit.background.discovery import soon
from labkit.background.nodes import callback_name
from labkit.background.patience import answer_sec
from labkit.background.runtime import runtime
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.interfaces import type_name

if TYPE_CHECKING:
    from labkit.background.console import CallbackError

__all__ = ['ServiceCalls', 'call_node', 'wait_until_spun']

POLL_SEC = 0.05
# As long as that, a service that the graph knows may take to be ready.
READY_SEC = 5.0
ANSWER_SEC = 5.0
# A request that may be made twice is made again when no answer has come for so long. One that sets
# something is given longer: the callback of the node may take its time.
AGAIN_SEC, SET_AGAIN_SEC = 0.5, 2.0
# As long as that, a node may take to be spun. Some programs never spin theirs.
SPUN_SEC = 1.0


class ServiceCalls:
    """A client of a service, for as long as a `with` block lasts.

    Args:
        node: The node that calls.
        srv_type: Class of the service.
        name: Name of the service.

    Raises:
        LabError: It is no name of a service, or the service has another type here.
    """

    def __init__(self, node: Node, srv_type: Any, name: str) -> None:
        self._node = node
        self.name = name
        try:
            self._client = node.create_client(srv_type, name)
        except (RCLError, ValueError, TypeError, LabError) as error:
            raise LabError(
                f'The service {name!r} can not be called with {type_name(srv_type)}: '
                f'{str(error).splitlines()[0]}'
            ) from error

    def __enter__(self) -> ServiceCalls:
        return self

    def __exit__(self, *_: object) -> None:
        self._node.destroy_client(self._client)

    def wait_until_ready(self, timeout_sec: float | None) -> bool:
        """Wait until the service can be called.

        Args:
            timeout_sec: Seconds to wait, None for no end.

        Returns:
            Whether it can.
        """
        end = None if timeout_sec is None else time.monotonic() + timeout_sec
        while not self._client.service_is_ready():
            if end is not None and time.monotonic() >= end:
                return False
            time.sleep(POLL_SEC / 5)
        return True

    def call(
        self, request: Any, timeout_sec: float | None, *, again_sec: float | None = None
    ) -> Any:
        """Call the service.

        Args:
            request: The request.
            timeout_sec: Seconds to wait for the answer, None for no end.
            again_sec: Seconds after which it is called once more, for what may be done twice. A
                server that has not found this client yet throws its answer away after 0.1 s
                (rmw_fastrtps, rmw_response.cpp).

        Returns:
            The response.

        Raises:
            LabTimeout: No answer came in time.
            LabError: No answer will come: the callback of this notebook's that serves it failed.
        """
        done = threading.Event()
        futures: list[Any] = []
        errors = self._errors()

        def ask() -> float:
            future = self._client.call_async(request)
            future.add_done_callback(lambda _: done.set())  # type: ignore[no-untyped-call]
            futures.append(future)
            return time.monotonic()

        asked = begun = ask()
        # In slices: between them the stop button is heard.
        while not done.wait(POLL_SEC):
            now = time.monotonic()
            try:
                self._refuse_failed(errors)
                self._refuse_late(now - begun, timeout_sec)
            except LabError:
                for future in futures:
                    future.cancel()
                raise
            if again_sec is not None and now >= asked + again_sec:
                asked = ask()
        return next(future.result() for future in futures if future.done())

    def _errors(self) -> list[tuple[CallbackError, int]]:
        """Return what callbacks of this notebook's that serve it have raised, and how often."""
        callbacks = {
            (entry.name, callback_name(service))
            for entry in runtime.nodes()
            for service in entry.node.services
            if service.service_name == self.name
        }
        return [
            (error, error.count)
            for error in tuple(runtime.console.errors)
            if (error.node_name, error.callback) in callbacks
        ]

    def _refuse_failed(self, before: list[tuple[CallbackError, int]]) -> None:
        found = self._errors()
        if found and found != before:
            error = found[-1][0]
            raise LabError(
                f'{self.name} gives no answer: {error.callback} of {error.node_name} has failed.',
                todo='Its error is shown above.',
            )

    def _refuse_late(self, seconds: float, timeout_sec: float | None) -> None:
        if timeout_sec is not None and seconds >= timeout_sec:
            raise LabTimeout(
                f'{self.name} did not answer within {timeout_sec:g} s.',
                todo='Is the node that offers it spinning, and do its callbacks return?',
            )


def call_node(node: Node, srv_type: Any, node_name: str, service: str, request: Any) -> Any:
    """Call one of the parameter services of a node.

    Args:
        node: The node that calls.
        srv_type: Class of the service.
        node_name: Full name of the node that is asked.
        service: Name of the service in that node, such as `list_parameters`.
        request: The request.

    Returns:
        The response.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    name = f'{node_name}/{service}'
    if not soon(lambda: name in dict(node.get_service_names_and_types())):
        raise LabError(f'{node_name} has no parameter services.')
    with ServiceCalls(node, srv_type, name) as service_calls:
        if not service_calls.wait_until_ready(READY_SEC):
            raise LabTimeout('Wait for service timed out')
        again_sec = SET_AGAIN_SEC if service.startswith('set_') else AGAIN_SEC
        return service_calls.call(request, answer_sec(ANSWER_SEC), again_sec=again_sec)


def wait_until_spun(node: Node, node_name: str, timeout_sec: float = SPUN_SEC) -> bool:
    """Wait until another node answers: it was made to its end then, and its callbacks are called.

    Args:
        node: The node that asks.
        node_name: Full name of the other one.
        timeout_sec: Seconds to wait.

    Returns:
        Whether it has answered. One without parameter services can't.
    """
    name = f'{node_name}/list_parameters'
    if name not in dict(node.get_service_names_and_types()):
        return False
    with ServiceCalls(node, ListParameters, name) as service:
        if not service.wait_until_ready(timeout_sec):
            return False
        try:
            service.call(ListParameters.Request(), timeout_sec, again_sec=AGAIN_SEC)
        except LabTimeout:
            return False
        return True
