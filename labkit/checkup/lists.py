"""What several checks need: paths, and lists as words."""

from __future__ import annotations

import os
from collections.abc import Sequence

__all__ = ['inside', 'some']


def inside(path: str, folder: str) -> bool:
    """Tell whether a path is in a folder, or is that folder."""
    path, folder = os.path.realpath(path), os.path.realpath(folder)
    return path == folder or path.startswith(folder.rstrip(os.sep) + os.sep)


def some(names: Sequence[str]) -> str:
    """Return the first few names as the beginning of a sentence."""
    shown = ', '.join(names[:3])
    return f'{shown} and {len(names) - 3} more' if len(names) > 3 else shown
