"""Completion candidates from the live graph."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING

from labkit import settings
from labkit.asking.discovery import poll_until
from labkit.background.runtime import runtime
from labkit.ros2.graph_queries import asking_node, known_names
from labkit.rosgraph import interfaces, listings

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    'action_names',
    'node_names',
    'service_names',
    'topic_names',
    'types_of_action',
    'types_of_service',
    'types_of_topic',
]

TypesOf = Callable[['Node', str], list[str]]

# A type that is not found within this time, s, is taken for missing.
COMPLETION_SEC = 3.0


def _names(kind: str, args: Namespace) -> Iterable[str]:
    return [name for name, _types in known_names(args, kind)] if _may_ask() else []


def _types(types_of: TypesOf, named: str, kind: str, args: Namespace) -> Iterable[str]:
    """Return the types of what is named earlier on the line, or all types of a kind."""
    if not _may_ask():
        return interfaces.names(kind)
    node, name = asking_node(args), getattr(args, named, '')
    # The process of a terminal has just joined the graph, and discovers it bit by bit.
    patience_sec = 0.0 if settings.in_kernel() else COMPLETION_SEC
    return poll_until(lambda: types_of(node, name), patience_sec) or interfaces.names(kind)


def _may_ask() -> bool:
    # In a notebook the Tab key must not start ROS.
    return runtime.started or not settings.in_kernel()


topic_names, service_names, action_names, node_names = (
    partial(_names, kind) for kind in ('topics', 'services', 'actions', 'nodes')
)
types_of_topic = partial(_types, listings.topic_types, 'topic_name', 'msg')
types_of_service = partial(_types, listings.service_types, 'service_name', 'srv')
types_of_action = partial(_types, listings.action_types, 'action_name', 'action')
