"""Words to offer for completion that are read off the live graph."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable

from labkit import settings
from labkit.background.runtime import runtime
from labkit.ros2.asking import asking_node
from labkit.rosgraph.names import is_hidden
from labkit.rosgraph.snapshot import node_names as names_of_nodes

__all__ = ['node_names', 'service_names', 'service_types', 'topic_names', 'topic_types']


def topic_names(args: Namespace) -> Iterable[str]:
    """Return the topics that there are."""
    return (name for name, _ in _topics(args) if not is_hidden(name))


def topic_types(args: Namespace) -> Iterable[str]:
    """Return the type of the topic that stands before, or all types."""
    from labkit.rosgraph import interfaces

    return dict(_topics(args)).get(getattr(args, 'topic_name', '')) or interfaces.names('msg')


def node_names(args: Namespace) -> Iterable[str]:
    """Return the nodes that there are."""
    if not _may_ask():
        return ()
    return (name for name in names_of_nodes(asking_node(args)) if not is_hidden(name))


def service_names(args: Namespace) -> Iterable[str]:
    """Return the services that there are."""
    return (name for name, _ in _services(args) if not is_hidden(name))


def service_types(args: Namespace) -> Iterable[str]:
    """Return the type of the service that stands before, or all types."""
    from labkit.rosgraph import interfaces

    return dict(_services(args)).get(getattr(args, 'service_name', '')) or interfaces.names('srv')


def _topics(args: Namespace) -> list[tuple[str, list[str]]]:
    return asking_node(args).get_topic_names_and_types() if _may_ask() else []


def _services(args: Namespace) -> list[tuple[str, list[str]]]:
    return asking_node(args).get_service_names_and_types() if _may_ask() else []


def _may_ask() -> bool:
    # In a notebook the Tab key does not start ROS.
    return runtime.started or not settings.in_kernel()
