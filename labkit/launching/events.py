"""Events of a running launch: what has happened, and what is asked of programs that run."""

from __future__ import annotations

import signal
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from labkit.launching.model import Action, LaunchError, Timer, placed

__all__ = [
    'Event',
    'ExecutionComplete',
    'ProcessExited',
    'ProcessIO',
    'ProcessStarted',
    'ProcessStderr',
    'ProcessStdin',
    'ProcessStdout',
    'ProcessTargetedEvent',
    'RunningProcessEvent',
    'Shutdown',
    'ShutdownProcess',
    'SignalProcess',
    'TimerEvent',
    'matches_action',
    'matches_executable',
    'matches_name',
    'matches_pid',
]

Matcher = Callable[[Any], bool]
"""Which actions of programs are meant."""


class Event:
    """Something that has happened, or is to happen."""

    name: ClassVar[str] = 'launch.Event'


@dataclass
class Shutdown(Event):
    """The launch is to end."""

    name: ClassVar[str] = 'launch.events.Shutdown'
    reason: Any = 'reason not given'
    due_to_sigint: bool = False


@dataclass
class ExecutionComplete(Event):
    """An action has done all that it does."""

    name: ClassVar[str] = 'launch.events.ExecutionComplete'
    action: Action


@dataclass
class TimerEvent(Event):
    """The time of a timer has come."""

    name: ClassVar[str] = 'launch.events.TimerEvent'
    timer: Timer


@dataclass
class RunningProcessEvent(Event):
    """Something that has happened to a program.

    Attributes:
        process_name: What its output is marked with, such as `'talker-1'`.
        cmd: The words of its command.
        cwd: The folder in which it runs; None for that of the launch.
        env: Its environment variables.
    """

    name: ClassVar[str] = 'launch.events.process.RunningProcessEvent'
    action: Action
    process_name: str
    pid: int
    cmd: Sequence[str] = ()
    cwd: str | None = None
    env: Mapping[str, str] = field(default_factory=dict)

    execute_process_action = property(lambda self: self.action)


@dataclass
class ProcessStarted(RunningProcessEvent):
    """A program was started."""

    name: ClassVar[str] = 'launch.events.process.ProcessStarted'


@dataclass
class ProcessExited(RunningProcessEvent):
    """A program has ended."""

    name: ClassVar[str] = 'launch.events.process.ProcessExited'
    returncode: int = 0


@dataclass
class ProcessIO(RunningProcessEvent):
    """A program has written something."""

    name: ClassVar[str] = 'launch.events.process.ProcessIO'
    fd: ClassVar[int] = 1
    text: bytes = b''

    from_stdin = property(lambda self: self.fd == 0)
    from_stdout = property(lambda self: self.fd == 1)
    from_stderr = property(lambda self: self.fd == 2)


@dataclass
class ProcessStdin(ProcessIO):
    """A program is to read something; no program of a launch does."""

    name: ClassVar[str] = 'launch.events.process.ProcessStdin'
    fd: ClassVar[int] = 0


@dataclass
class ProcessStdout(ProcessIO):
    """A program has written something to its standard output."""

    name: ClassVar[str] = 'launch.events.process.ProcessStdout'


@dataclass
class ProcessStderr(ProcessIO):
    """A program has written something to its standard error."""

    name: ClassVar[str] = 'launch.events.process.ProcessStderr'
    fd: ClassVar[int] = 2


class ProcessTargetedEvent(Event):
    """Something that is asked of the programs that a function chooses."""

    name: ClassVar[str] = 'launch.events.process.ProcessTargetedEvent'

    def __init__(self, *, process_matcher: Matcher) -> None:
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """Programs are to end, first by SIGINT."""

    name: ClassVar[str] = 'launch.events.process.ShutdownProcess'


class SignalProcess(ProcessTargetedEvent):
    """Programs are sent a signal."""

    name: ClassVar[str] = 'launch.events.process.SignalProcess'

    def __init__(self, *, signal_number: str | signal.Signals, process_matcher: Matcher) -> None:
        super().__init__(process_matcher=process_matcher)
        self.signal_name = getattr(signal_number, 'name', str(signal_number))
        if self.signal_name not in signal.Signals.__members__:
            raise LaunchError(
                f'signal_number is a signal, and this is {signal_number!r}.',
                todo='signal.SIGINT, of the module signal',
                place=placed(),
            )
        self.signal = signal_number


def matches_action(target_action: Action) -> Matcher:
    """Return a function that chooses one action."""
    return lambda action: action is target_action


def matches_pid(pid: int) -> Matcher:
    """Return a function that chooses the program with a process id."""
    return lambda action: action.process_details and action.process_details.get('pid') == pid


def matches_name(name: str) -> Matcher:
    """Return a function that chooses the program with a name, such as `'talker-1'`."""
    return lambda action: action.process_details and action.process_details['name'] == name


def matches_executable(executable: str) -> Matcher:
    """Return a function that chooses the programs whose path ends so."""
    return lambda action: (
        action.process_details and action.process_details['cmd'][0].endswith(executable)
    )
