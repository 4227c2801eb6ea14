"""Questions to other nodes: the graph, services, parameters, actions, what comes on a topic."""

from __future__ import annotations

from labkit import settings

__all__ = ['register']


def register() -> None:
    """Answer questions of terminals each time ROS has been started in this kernel."""
    if _start not in settings.after_start:
        settings.after_start.append(_start)


def _start() -> None:
    from labkit.asking.notebook_graph import serve

    serve()
