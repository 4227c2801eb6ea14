"""Completion candidates from the live graph."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from labkit import settings
from labkit.asking.discovery import poll_until
from labkit.background.runtime import runtime
from labkit.ros2.asking import asking_node, known_names
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

# A type that is not found within this time, s, is taken for missing.
COMPLETION_SEC = 3.0


def topic_names(args: Namespace) -> Iterable[str]:
    """Return the topics in the graph."""
    return _names(args, 'topics')


def types_of_topic(args: Namespace) -> Iterable[str]:
    """Return the type of the topic named earlier on the line, or all types."""
    name = getattr(args, 'topic_name', '')
    return _found(listings.topic_types, args, name) or interfaces.names('msg')


def node_names(args: Namespace) -> Iterable[str]:
    """Return the nodes in the graph."""
    return _names(args, 'nodes')


def service_names(args: Namespace) -> Iterable[str]:
    """Return the services in the graph."""
    return _names(args, 'services')


def types_of_service(args: Namespace) -> Iterable[str]:
    """Return the type of the service named earlier on the line, or all types."""
    name = getattr(args, 'service_name', '')
    return _found(listings.service_types, args, name) or interfaces.names('srv')


def action_names(args: Namespace) -> Iterable[str]:
    """Return the actions in the graph."""
    return _names(args, 'actions')


def types_of_action(args: Namespace) -> Iterable[str]:
    """Return the type of the action named earlier on the line, or all types."""
    name = getattr(args, 'action_name', '')
    return _found(listings.action_types, args, name) or interfaces.names('action')


def _names(args: Namespace, kind: str) -> list[str]:
    return [name for name, _types in known_names(args, kind)] if _may_ask() else []


def _found(types_of: Callable[[Node, str], list[str]], args: Namespace, name: str) -> list[str]:
    if not _may_ask():
        return []
    node = asking_node(args)
    # The process of a terminal has just joined the graph, and discovers it bit by bit.
    patience_sec = 0.0 if settings.in_kernel() else COMPLETION_SEC
    return poll_until(lambda: types_of(node, name), patience_sec)


def _may_ask() -> bool:
    # In a notebook the Tab key must not start ROS.
    return runtime.started or not settings.in_kernel()
