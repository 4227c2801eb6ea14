"""Words to offer for completion that are read off the live graph."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from labkit import settings
from labkit.background.discovery import SOON_SEC, alone, soon
from labkit.background.patience import answer_sec
from labkit.background.runtime import runtime
from labkit.ros2.asking import asking_node
from labkit.rosgraph import interfaces, listings, snapshot
from labkit.rosgraph.names import is_hidden

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


def topic_names(args: Namespace) -> Iterable[str]:
    """Return the topics that there are."""
    return [name for name, _ in listings.topics(asking_node(args))] if _may_ask() else ()


def types_of_topic(args: Namespace) -> Iterable[str]:
    """Return the type of the topic that stands before, or all types."""
    name = getattr(args, 'topic_name', '')
    return _found(listings.topic_types, args, name) or interfaces.names('msg')


def node_names(args: Namespace) -> Iterable[str]:
    """Return the nodes that there are."""
    found = snapshot.node_names(asking_node(args)) if _may_ask() else []
    return (name for name in found if not is_hidden(name))


def service_names(args: Namespace) -> Iterable[str]:
    """Return the services that there are."""
    return [name for name, _ in listings.services(asking_node(args))] if _may_ask() else ()


def types_of_service(args: Namespace) -> Iterable[str]:
    """Return the type of the service that stands before, or all types."""
    name = getattr(args, 'service_name', '')
    return _found(listings.service_types, args, name) or interfaces.names('srv')


def action_names(args: Namespace) -> Iterable[str]:
    """Return the actions that there are."""
    return [name for name, _ in listings.actions(asking_node(args))] if _may_ask() else ()


def types_of_action(args: Namespace) -> Iterable[str]:
    """Return the type of the action that stands before, or all types."""
    name = getattr(args, 'action_name', '')
    return _found(listings.action_types, args, name) or interfaces.names('action')


def _found(types_of: Callable[[Node, str], list[str]], args: Namespace, name: str) -> list[str]:
    if not _may_ask():
        return []
    node = asking_node(args)
    # A terminal's process has just come into the graph, and hears of it piece by piece.
    patience = 0.0 if settings.in_kernel() or alone() else answer_sec(SOON_SEC)
    return soon(lambda: types_of(node, name), patience)


def _may_ask() -> bool:
    # In a notebook the Tab key does not start ROS.
    return runtime.started or not settings.in_kernel()
