"""A solution as a script: one of the styles that every check must accept."""

from __future__ import annotations

from labkit.exercises import changed

__all__ = ['in_process']


def in_process(code: str, start: str, node: str) -> str:
    """Return a solution as a script for a process of its own.

    Args:
        code: The solution.
        start: The lines that start the node in a notebook.
        node: What makes the node.
    """
    main = f'def main():\n    rclpy.init()\n    rclpy.spin({node})\n\n\nmain()'
    return 'import rclpy\n' + changed(code, (start, main)).lstrip()
