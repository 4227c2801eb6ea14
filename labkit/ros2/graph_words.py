"""Words to offer for completion that are read off the live graph."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable

from labkit import settings
from labkit.background.runtime import runtime
from labkit.ros2.asking import asking_node
from labkit.rosgraph import interfaces, listings, snapshot
from labkit.rosgraph.names import is_hidden

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
    found = listings.topic_types(asking_node(args), name) if _may_ask() else []
    return found or interfaces.names('msg')


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
    found = listings.service_types(asking_node(args), name) if _may_ask() else []
    return found or interfaces.names('srv')


def action_names(args: Namespace) -> Iterable[str]:
    """Return the actions that there are."""
    return [name for name, _ in listings.actions(asking_node(args))] if _may_ask() else ()


def types_of_action(args: Namespace) -> Iterable[str]:
    """Return the type of the action that stands before, or all types."""
    name = getattr(args, 'action_name', '')
    found = listings.action_types(asking_node(args), name) if _may_ask() else []
    return found or interfaces.names('action')


def _may_ask() -> bool:
    # In a notebook the Tab key does not start ROS.
    return runtime.started or not settings.in_kernel()
