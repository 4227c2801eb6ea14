"""Run a command as a background process: `%ros2 topic echo /odds &`, like a shell's `&`.

A stream can so be watched in one cell while other cells run, without a second terminal.
"""

from __future__ import annotations

import shlex
import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from labkit.asking.discovery import wait_until_announced
from labkit.background.wait import wait_for
from labkit.programs.child_processes import end_earlier, environment, start_process
from labkit.ros2.graph_queries import asking_node
from labkit.rosgraph.endpoints import publishers, subscriptions

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['start']

# Time for a command to begin. On a busy machine Python itself takes a while to start.
BEGIN_SEC = 15.0


def start(words: list[str], args: Namespace) -> int | None:
    """Start a command in the background, and wait until it has begun.

    Args:
        words: The words after `ros2`.
        args: The parsed words.

    Returns:
        Its exit code, if it has ended with an error.
    """
    node = asking_node(args)
    name = shlex.join(['ros2', *words])
    command = [sys.executable, '-m', 'labkit.ros2', *words]
    end_earlier(command)
    topic = getattr(args, 'topic_name', '')
    before = _ends(node, topic)
    variables = environment()
    variables.pop('LABKIT_HEADLESS', None)  # a background process can always be stopped
    process = start_process(name, command, variables)

    def has_come() -> bool:
        return bool(_ends(node, topic) - before)

    # It has begun when it has an endpoint on the topic, or some output.
    wait_for(lambda: process.output or not process.running or has_come(), BEGIN_SEC)
    if not process.output and has_come():
        wait_until_announced(node)
    if process.exit_code:
        print('\n'.join(process.output[-10:]))
        return process.exit_code
    print(f'{name} runs in the background. lab.processes() lists and stops it.')
    process.show_output()
    return None


def _ends(node: Node, topic: str) -> set[bytes]:
    """Return the GUIDs of the publishers and subscriptions of a topic."""
    if not topic:
        return set()
    name = topic if topic.startswith('/') else f'/{topic}'
    return {end.gid for end in (*publishers(node, name), *subscriptions(node, name))}
