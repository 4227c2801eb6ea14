"""The workspace of the lesson: a folder of its own, gone when the kernel ends."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from pathlib import Path

from labkit import settings

__all__ = ['make_workspace', 'workspace']

_made: list[Path] = []


def make_workspace() -> Path:
    """Return an empty workspace, `ros2_ws` with a folder `src`; the same one when asked again."""
    # colcon warns at each call of an environment that is not a workspace of its own making.
    os.environ.setdefault('COLCON_LOG_LEVEL', 'error')
    if not (_made and _made[-1].is_dir()):
        if settings.audience().same_each_time:
            folder = Path(tempfile.gettempdir())  # which is of this run alone
        else:
            folder = Path(tempfile.mkdtemp(prefix='labkit-'))
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
        _made.append(folder / 'ros2_ws')
        (_made[-1] / 'src').mkdir(parents=True, exist_ok=True)
    return _made[-1]


def workspace() -> Path | None:
    """Return the workspace, None if none has been made."""
    return _made[-1] if _made else None
