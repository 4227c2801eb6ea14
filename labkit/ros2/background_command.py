"""`%ros2 topic echo /odds &`: a command as a process of its own, as a shell's `&` does it.

So a stream can be watched in one cell while the next cells go on, without a second terminal.
"""

from __future__ import annotations

import shlex
import sys
import time
from argparse import Namespace
from typing import TYPE_CHECKING

from labkit.background.child_processes import end_earlier, environment, start_process
from labkit.background.discovery import calm
from labkit.ros2.asking import asking_node
from labkit.rosgraph.endpoints import publishers, subscriptions

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['start']

# How long a command may take to begin. On a busy machine Python itself takes a while.
BEGIN_SEC = 15.0
POLL_SEC = 0.02


def start(words: list[str], args: Namespace) -> int | None:
    """Start a command in the background, and wait until it has begun.

    Args:
        words: The words after `ros2`.
        args: The same, understood.

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
    variables.pop('LABKIT_HEADLESS', None)  # what runs in the background can always be stopped
    process = start_process(name, command, variables)
    end = time.monotonic() + BEGIN_SEC
    # It has begun when it is at the topic, or has something to say.
    while process.running and not process.output and time.monotonic() < end:
        if topic and _ends(node, topic) - before:
            calm(node)
            break
        time.sleep(POLL_SEC)
    if process.exit_code:
        print('\n'.join(process.output[-10:]))
        return process.exit_code
    print(f'{name} runs in the background. lab.processes() lists and stops it.')
    process.show_output()
    return None


def _ends(node: Node, topic: str) -> set[bytes]:
    """Return the ids of the publishers and subscriptions of a topic."""
    if not topic:
        return set()
    name = topic if topic.startswith('/') else f'/{topic}'
    return {end.gid for end in (*publishers(node, name), *subscriptions(node, name))}
