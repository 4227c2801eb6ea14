"""What the check of the exercise stop asks for."""

from __future__ import annotations

import signal
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labkit.exercises import Fail, expect
from labkit.exercises.clauses import (
    Clause,
    Evidence,
    Stream,
)
from labkit.lessons.turtlebot.drive import command_of

if TYPE_CHECKING:
    from labkit.exercises.watch import Watch

__all__ = ['NODE', 'SPEED', 'SaysStop', 'cruises']

NODE = '/cruiser'
SPEED = 0.1
# How far a speed may be off, m/s.
SAME = 1e-6
# How long the last command of another process may be on its way, s.
LATE_SEC = 0.3
# How long it is looked whether another node goes on, s: it sends ten commands a second.
GOES_ON_SEC = 0.5


def cruises(stream: Stream, wanted: float = SPEED) -> str:
    """Raise Fail if a command does not ask for the speed of the task."""
    for number, sample in enumerate(stream.samples, start=1):
        command = command_of(sample)
        if abs(command.v - wanted) < SAME and not (command.w or command.others):
            continue
        why = 'The task asks for another speed.'
        if command.stops:
            why = 'A robot that does not move need not be stopped.'
        elif command.w or command.others:
            why = 'linear.x is the speed ahead. The other numbers stay 0.0.'
        elif command.v == -wanted:
            why = 'A speed below 0 drives backwards.'
        raise Fail(
            f'linear.x = {wanted} m/s and 0.0 in all other numbers, while the node runs',
            f'command {number} says {command}',
            why=why,
            todo=f'msg.linear.x = {wanted}',
        )
    return ''


@dataclass(frozen=True)
class SaysStop(Clause):
    """The last command says stop."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return 'the last command says stop (all 0.0), whatever ends the node'

    def judge(self, evidence: Evidence) -> str:
        """Judge what was seen."""
        probe = evidence.probe
        source = evidence.publisher('/cmd_vel', NODE)
        is_script = not probe.in_this_process(source)
        lottery = is_script and _ends_ros_first(source.gid)
        watch = expect.ends_with_node(probe, source)
        probe.wait(lambda: command_of(watch.samples[-1]).stops, LATE_SEC)
        last = command_of(watch.samples[-1])
        if lottery:
            raise Fail(
                'a script whose last command always says stop',
                f'the last command says {last}; and rclpy.init() has put a handler of its own '
                'in the place of that for Ctrl-C',
                why='With Ctrl-C this handler shuts ROS down while your code is about to publish. '
                'Mostly it comes first, and the last command is lost.',
                todo='rclpy.init(signal_handler_options=SignalHandlerOptions.NO), from '
                'rclpy.signals; after the last publish(): publisher.wait_for_all_acked()',
            )
        self._refuse_others(evidence, watch)
        if not last.stops:
            raise Fail(
                'a last command with all numbers 0.0',
                f'the last command says {last}',
                why='The node ends without a word. The robot goes on with the last command until '
                'it gives up waiting, one second later.',
                todo='In finally: publish an empty Twist(), then wait until it is there: '
                'publisher.wait_for_all_acked()'
                if is_script
                else 'destroy_node() is called whatever ends the node. Publish an empty Twist() '
                'there, then call super().destroy_node().',
            )
        return 'The last command says stop.'

    def _refuse_others(self, evidence: Evidence, watch: Watch) -> None:
        """Raise Fail if another node of the learner's drives the robot on."""
        from labkit.background.patience import answer_sec

        probe = evidence.probe
        others = sorted({end.node for end in probe.publishers('/cmd_vel')})
        if not others:
            return
        count = len(watch)
        if not probe.wait(
            lambda: any(not command_of(sample).stops for sample in watch.samples[count:]),
            answer_sec(GOES_ON_SEC),
        ):
            return
        raise Fail(
            f'no commands when {NODE} has ended',
            f'more commands, and {", ".join(others)} publishes on /cmd_vel, too',
            why='The robot does what the newest command says, whoever has sent it.',
            todo=f'End what does not belong here: lab.remove({others[0]!r})',
        )


def _ends_ros_first(gid: bytes) -> bool:
    """Tell whether the process of an endpoint has the signal handlers of rclpy.

    rclpy has one for SIGTERM, too. Python by itself has none: so that one tells. Source: rclpy,
    src/rclpy/signal_handler.cpp; where there is no /proc, it is not known.
    """
    import psutil  # type: ignore[import-untyped]

    from labkit.rosgraph.whose import process_id

    for child in psutil.Process().children(recursive=True):
        status = Path(f'/proc/{child.pid}/status')
        if child.pid & 0xFFFF == process_id(gid) and status.exists():
            lines = dict(line.split(':', 1) for line in status.read_text().splitlines())
            return bool(int(lines['SigCgt'], 16) & 1 << signal.SIGTERM - 1)
    return False
