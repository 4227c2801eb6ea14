"""A rover that can drive behind a hill: a process that hears the same pictures on two topics.

`start_rover()` starts it. One subscription asks for best effort, the other one for reliable. Upon
each picture the rover answers with its number. Behind the hill its process is stopped, as Ctrl-Z
does it: nobody takes what is sent there meanwhile, as where a radio link is broken.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from labkit.lessons._companion import start_companion

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process

__all__ = ['NODE', 'TOPICS', 'behind_a_hill', 'start_rover']

NODE = '/rover'
KINDS = ('best_effort', 'reliable')
# What it hears, and what it answers.
TOPICS = tuple(f'/{word}_{kind}' for word in ('pictures', 'seen') for kind in KINDS)
DEPTH = 100
START_SEC = 25.0
POLL_SEC = 0.01

_process: Process | None = None


def start_rover() -> None:
    """Start the rover as a process, and wait until all of it is in the graph.

    One that runs already is ended first. `lab.processes()` lists and stops it.

    Raises:
        LabTimeout: It did not come.
    """
    global _process
    _process = start_companion('rover', __name__, _process)


@contextmanager
def behind_a_hill() -> Iterator[None]:
    """Let the rover be out of reach in a `with` block: its process stands still."""
    assert _process is not None and _process.output
    number = int(_process.output[0])
    # A publisher may find the rover before the rover finds it. What is sent then is lost.
    end = time.monotonic() + START_SEC
    while not _knows_its_publishers(_process.output) and time.monotonic() < end:
        time.sleep(POLL_SEC)
    os.kill(number, signal.SIGSTOP)
    while not _stands(number) and time.monotonic() < end:
        time.sleep(POLL_SEC)
    try:
        yield
    finally:
        os.kill(number, signal.SIGCONT)


def _knows_its_publishers(lines: Sequence[str]) -> bool:
    """Tell whether each subscription of the rover has said last that it has a publisher."""
    counts = dict(line.split() for line in lines[1:])
    return all(int(counts.get(kind, '0')) for kind in KINDS)


def _stands(number: int) -> bool:
    """Tell whether all threads of a process have stopped: the signal comes some time after."""
    states = [path.read_text() for path in Path(f'/proc/{number}/task').glob('*/stat')]
    return all(text.rpartition(')')[2].split()[0] == 'T' for text in states)


def main() -> None:
    """Hear and answer until it is interrupted."""
    import rclpy
    from rclpy.event_handler import SubscriptionEventCallbacks
    from rclpy.node import Node
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Int16, String

    from labkit.programs.program import publish_when_heard, spin_until_interrupted

    print(os.getpid(), flush=True)
    rclpy.init()
    rover = Node(NODE.lstrip('/'), start_parameter_services=False)

    def listen(kind: str, reliability: ReliabilityPolicy) -> None:
        answers = rover.create_publisher(Int16, f'seen_{kind}', DEPTH)
        profile = QoSProfile(depth=DEPTH, reliability=reliability)  # type: ignore[no-untyped-call]

        def on_picture(msg: String) -> None:
            publish_when_heard(answers, Int16(data=int(msg.data)))

        tell = SubscriptionEventCallbacks(
            matched=lambda event: print(kind, event.current_count, flush=True)  # type: ignore[attr-defined]
        )
        topic = f'pictures_{kind}'
        rover.create_subscription(String, topic, on_picture, profile, event_callbacks=tell)

    listen('best_effort', ReliabilityPolicy.BEST_EFFORT)
    listen('reliable', ReliabilityPolicy.RELIABLE)
    spin_until_interrupted(rover)
