"""The `ros2` command line: `%ros2 topic list` in a notebook, `ros2` in a terminal.

Words, options and output are those of the real `ros2` of ROS 2 Jazzy, so that what is learnt here
is true elsewhere. What is wrong is explained, except to scripts: see `parser.real_one`. Verbs that
would run for ever end after a count, after a `--timeout`, or with the stop button; no input is
evaluated as Python.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

__all__ = ['main']


def main(argv: Sequence[str] | None = None) -> int:
    """Run one `ros2` command in a terminal.

    Args:
        argv: The words after `ros2`; those of the command line if None.

    Returns:
        The exit code: 1 if it failed, 2 if the words can't be parsed.
    """
    from labkit.ros2.terminal import run

    return run(list(sys.argv[1:] if argv is None else argv))
