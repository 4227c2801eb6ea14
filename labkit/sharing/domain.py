"""The domain of this notebook, and the line with which a terminal joins it: `domain`."""

from __future__ import annotations

from dataclasses import dataclass

from labkit import domain_ids
from labkit.background.runtime import runtime
from labkit.settings import audience

__all__ = ['Domain', 'domain']


@dataclass(frozen=True)
class Domain:
    """The domain of a notebook. Shown, it is the line to type in a terminal.

    Attributes:
        domain_id: Its number.
    """

    domain_id: int

    def __repr__(self) -> str:
        if audience().same_each_time:
            return 'export ROS_DOMAIN_ID=...'
        return domain_ids.how_to_join(self.domain_id)


def domain() -> Domain:
    """Return the domain of this notebook, shown as the line with which a terminal joins it.

    A program that is started in that terminal afterwards finds the nodes of this notebook. `ros2`
    does so without the line. It starts ROS.
    """
    runtime.start()
    return Domain(runtime.domain_id or 0)
