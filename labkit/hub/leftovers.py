"""What accounts have left in a folder of root's: removed without trust in what it is."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

__all__ = ['ASIDE', 'remove']

ASIDE = '.removed'
"""The folder beside the removed ones for what resists; nobody but root passes it."""

# No server waits longer for this. What is left then is tried again with the next removal.
_MOST_SEC = 5.0


def remove(place: Path) -> str:
    """Make a name free, and remove what had it.

    It is renamed first, to where no account can go. So the name is free at once, whatever a
    program of its owner goes on writing there. Then `rm` removes it: it follows no link, takes
    folders in folders to any depth, where Python's own function recurses, and does not leave the
    file system.

    Args:
        place: A file, folder or link in a folder in which only root can write.

    Returns:
        A sentence about what could not be removed, '' if nothing is left.
    """
    aside = place.parent / ASIDE
    aside.mkdir(exist_ok=True)
    aside.chmod(0o700)
    if os.path.lexists(place):
        place.rename(Path(tempfile.mkdtemp(dir=aside), place.name))
    command = ['rm', '-rf', '--one-file-system', '--', *map(str, aside.iterdir())]
    try:
        subprocess.run(command, capture_output=True, timeout=_MOST_SEC, check=False)
    except subprocess.TimeoutExpired:
        pass
    left = sum(1 for _ in aside.iterdir())
    return f'{left} could not be removed; what is left is in {str(aside)!r}.' if left else ''
