"""Calling a service, from the cell or terminal that waits for the answer."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rcl_interfaces.srv import ListParameters
from rclpy.node import Node

from labkit.asking.discovery import poll_until
from labkit.asking.silence import why_unanswered
from labkit.background.compat import RCLError
from labkit.background.nodes import callback_name, existing_nodes, full_name
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabError, LabTimeout, quoted
from labkit.rosgraph.interfaces import type_name

if TYPE_CHECKING:
    from labkit.background.console import CallbackError
    from labkit.background.nodes import NodeEntry

__all__ = ['ServiceCalls', 'call_node', 'wait_until_spun']

# How long a service in the graph may take to be ready.
READY_SEC = 5.0
# Fast DDS tells a new process of each publisher and subscription that this one ever had, also of
# those that are gone, and answers arrive only afterwards: measured, 7 ms a node with the usual 14.
# So this bounds a hopeless wait, and is enough for a session with a thousand nodes.
ANSWER_SEC = 10.0
# An idempotent request is repeated when no answer has come for so long. One that sets something is
# given longer: the callback of the node may take its time.
AGAIN_SEC, SET_AGAIN_SEC = 0.5, 2.0
# How long a node may take to be spun. Some programs never spin theirs.
SPUN_SEC = 1.0


class ServiceCalls:
    """A client of a service, for a `with` block.

    Raises:
        LabError: The name is invalid, or the service has another type in this process.
    """

    def __init__(self, node: Node, srv_type: Any, name: str) -> None:
        self._node = node
        self.name = name
        try:
            self._client = node.create_client(srv_type, name)
        except (RCLError, ValueError, TypeError, LabError) as error:
            raise LabError(
                f'The service {quoted(name)} can not be called with {type_name(srv_type)}: '
                f'{str(error).splitlines()[0]}'
            ) from error

    def __enter__(self) -> ServiceCalls:
        return self

    def __exit__(self, *_: object) -> None:
        self._node.destroy_client(self._client)

    def wait_until_ready(self, timeout_sec: float | None) -> bool:
        """Wait until the service can be called, and return whether it can."""
        return bool(wait_for(self._client.service_is_ready, timeout_sec))

    def call(
        self, request: Any, timeout_sec: float | None, *, again_sec: float | None = None
    ) -> Any:
        """Call the service.

        Args:
            request: The request.
            timeout_sec: Seconds to wait for the answer, None for no limit.
            again_sec: Seconds after which to repeat an idempotent request. A server that has not
                discovered this client yet drops its answer after 0.1 s (rmw_fastrtps,
                rmw_response.cpp).

        Returns:
            The response.

        Raises:
            LabTimeout: No answer came in time.
            LabError: No answer will come: in this notebook the callback that serves it has failed,
                or its node has ended.
        """
        futures: list[Any] = [self._client.call_async(request)]
        errors, servers = self._errors(), self._servers()
        last_call = begun = time.monotonic()

        def answered() -> Any:
            nonlocal last_call
            for future in futures:
                if future.done():
                    return future
            now = time.monotonic()
            found = self._errors()
            if found and found != errors:
                error = found[-1][0]
                raise LabError(
                    f'{self.name} gives no answer: {error.callback} of {error.node_name} has '
                    'failed.',
                    todo='Its error is shown above.',
                )
            ended = [server.name for server in servers if not server.alive]
            if ended:
                raise LabError(
                    f'{self.name} gives no answer: {ended[0]} has ended.',
                    todo='Run the cell that has started it again.',
                )
            if timeout_sec is not None and now >= begun + timeout_sec:
                raise LabTimeout(
                    f'{self.name} did not answer within {timeout_sec:g} s.',
                    todo=self._why_unanswered(),
                )
            if again_sec is not None and now >= last_call + again_sec:
                futures.append(self._client.call_async(request))
                last_call = now
            return None

        try:
            return wait_for(answered, None).result()
        finally:
            for future in futures:
                future.cancel()

    def _why_unanswered(self) -> str:
        """Return why no answer has come; a question where that can't be seen."""
        if not self._node.count_services(self.name):
            return 'No node offers it any more.'
        return why_unanswered(
            {
                full_name(node)
                for node in existing_nodes()
                if any(service.service_name == self.name for service in node.services)
            }
        )

    def _servers(self) -> list[NodeEntry]:
        """Return the nodes of this notebook that serve it."""
        return [
            entry
            for entry in runtime.nodes()
            if any(service.service_name == self.name for service in entry.node.services)
        ]

    def _errors(self) -> list[tuple[CallbackError, int]]:
        """Return errors of this notebook's callbacks that serve it, with their counts."""
        callbacks = {
            (entry.name, callback_name(service))
            for entry in self._servers()
            for service in entry.node.services
            if service.service_name == self.name
        }
        return [
            (error, error.count)
            for error in tuple(runtime.console.errors)
            if (error.node_name, error.callback) in callbacks
        ]


def call_node(node: Node, srv_type: Any, node_name: str, service: str, request: Any) -> Any:
    """Call one of the parameter services of a node, and return the response.

    Args:
        node: The client's node.
        srv_type: Class of the service.
        node_name: Full name of the server's node.
        service: Name of the service in that node, such as `list_parameters`.
        request: The request.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    name = f'{node_name}/{service}'
    if not poll_until(lambda: name in dict(node.get_service_names_and_types())):
        raise LabError(f'{node_name} has no parameter services.')
    with ServiceCalls(node, srv_type, name) as service_calls:
        if not service_calls.wait_until_ready(READY_SEC):
            raise LabTimeout('Wait for service timed out')
        again_sec = SET_AGAIN_SEC if service.startswith('set_') else AGAIN_SEC
        return service_calls.call(request, ANSWER_SEC, again_sec=again_sec)


def wait_until_spun(node: Node, node_name: str, timeout_sec: float = SPUN_SEC) -> bool:
    """Wait until another node answers: it is then complete, and its callbacks are called.

    Args:
        node: The client's node.
        node_name: Full name of the other node.
        timeout_sec: Seconds to wait.

    Returns:
        Whether it has answered. A node without parameter services can't.
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
