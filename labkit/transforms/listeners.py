"""The transform listeners of this process, for those who look for faults."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakSet

if TYPE_CHECKING:
    from labkit.transforms.transform_listener import TransformListener

__all__ = ['listeners']

listeners: WeakSet[TransformListener] = WeakSet()
"""All that were made and not unregistered."""
