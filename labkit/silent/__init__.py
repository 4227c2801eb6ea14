"""Faults that ROS keeps to itself: what each one is, how it is seen, and what to do.

A look is a pure function of a `Scene`: a snapshot of the graph, and what this process knows of its
own nodes. `catalogue` has all looks and kinds, `watch` looks whenever something has changed, and
shows what it has found under the cell that made it.
"""

from __future__ import annotations

from labkit import settings

__all__ = ['register']


def register() -> None:
    """Watch each time ROS is started in this kernel."""
    if _start not in settings.after_start:
        settings.after_start.append(_start)


def _start() -> None:
    from labkit.silent.watch import watch

    watch.start()
