"""Enter another domain than the notebook's, as a guest: with a context and a node of its own.

How far ROS looks for others, and whom it asks, it reads from variables of the environment when a
context is made. They are set for that moment only.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions

from labkit.background.domains import number_for_ros
from labkit.background.nodes import helper_node
from labkit.background.notebook_rclpy import ORIGINALS

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['enter']

_environment_lock = threading.Lock()


def enter(domain_id: int, name: str, variables: dict[str, str]) -> tuple[Context, Node]:
    """Take part in a domain with a node that has nothing yet.

    Args:
        domain_id: The domain.
        name: The node's name.
        variables: What ROS is to read in its environment meanwhile, such as how far to look for
            others; one that is empty is not there for it.

    Returns:
        The context in that domain, which has no handler of signals, and the node.
    """
    context = Context()
    with _environment(variables):
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
    """Set variables while ROS reads them; one that is empty is taken away."""
    with _environment_lock:
        before = {name: os.environ.get(name) for name in variables}
        try:
            _set(variables)
            yield
        finally:
            _set({name: value or '' for name, value in before.items()})


def _set(variables: dict[str, str]) -> None:
    for name, value in variables.items():
        if value:
            os.environ[name] = value
        else:
            os.environ.pop(name, None)
