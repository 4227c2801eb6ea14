"""Events of a running launch, and what is done when they come."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from labkit.launching.model import Action, Context, LaunchError

__all__ = [
    'Event',
    'EventHandler',
    'ExecutionComplete',
    'OnExecutionComplete',
    'OnProcessExit',
    'OnProcessIO',
    'OnProcessStart',
    'OnShutdown',
    'ProcessExited',
    'ProcessIO',
    'ProcessStarted',
    'Shutdown',
]


class Event:
    """Something that has happened."""


@dataclass
class Shutdown(Event):
    """The launch is to end."""

    reason: str = 'reason not given'
    due_to_sigint: bool = False


@dataclass
class ProcessEvent(Event):
    """Something that has happened to a process."""

    action: Action
    process_name: str
    pid: int


@dataclass
class ProcessStarted(ProcessEvent):
    """A process was started."""


@dataclass
class ProcessExited(ProcessEvent):
    """A process has ended."""

    returncode: int = 0


@dataclass
class ProcessIO(ProcessEvent):
    """A process has written something."""

    text: bytes = b''
    fd: int = 1

    from_stdout = property(lambda self: self.fd == 1)
    from_stderr = property(lambda self: self.fd == 2)


@dataclass
class ExecutionComplete(Event):
    """An action has done all that it does."""

    action: Action


class EventHandler:
    """What to do when an event comes.

    Attributes:
        kind: The class of the events.
        target: The action that they are about; None for any, or a function that chooses.
        todo: The actions, or a function that returns some.
        files: The launch files in which it stands, the innermost last.
    """

    kind: type[Event] = Event
    # Name of the argument with what is to be done.
    word = 'entities'

    def __init__(
        self, *, target_action: Any = None, handle_once: bool = False, **todo: Any
    ) -> None:
        name = type(self).__name__
        if set(todo) != {self.word}:
            wrong = next(iter(set(todo) - {self.word}), None)
            raise LaunchError(
                f'{name} has no argument {wrong!r}.' if wrong else f'{name} has nothing to do.',
                todo=f'{name}(target_action=..., {self.word}=[...])',
            )
        self.target = target_action
        self.todo = todo[self.word]
        self.files: list[str] = []
        self._once = handle_once
        self._done = False

    def matches(self, event: Event) -> bool:
        """Return whether an event is one to handle."""
        if not isinstance(event, self.kind) or (self._once and self._done):
            return False
        if self.target is None or self.target is getattr(event, 'action', None):
            return True
        return not isinstance(self.target, Action) and bool(self.target(event.action))  # type: ignore[attr-defined]

    def handle(self, event: Event, context: Context) -> Sequence[Action]:
        """Return what is to be visited."""
        self._done = True
        todo = self.todo
        if callable(todo) and not isinstance(todo, Action):
            todo = _called(todo, event, context)
        return _actions(todo)

    @property
    def actions(self) -> Sequence[Action]:
        """The actions, as far as no function has to be called for them."""
        return () if callable(self.todo) else _actions(self.todo)


def _called(function: Callable[..., Any], event: Event, context: Context) -> Any:
    """Call a function of a launch file, which takes the event, and the context if it wants to."""
    import inspect

    count = len(inspect.signature(function).parameters)
    return function(*(event, context)[:count])


def _actions(todo: Any) -> Sequence[Action]:
    if todo is None:
        return ()
    return [todo] if isinstance(todo, Action) else [one for one in todo if one is not None]


class OnProcessStart(EventHandler):
    """Handle the start of a process."""

    kind = ProcessStarted
    word = 'on_start'


class OnProcessExit(EventHandler):
    """Handle the end of a process."""

    kind = ProcessExited
    word = 'on_exit'


class OnExecutionComplete(EventHandler):
    """Handle that an action has ended."""

    kind = ExecutionComplete
    word = 'on_completion'


class OnShutdown(EventHandler):
    """Handle that the launch is to end."""

    kind = Shutdown
    word = 'on_shutdown'


class OnProcessIO(EventHandler):
    """Handle what a process writes."""

    kind = ProcessIO

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **options: Any,
    ) -> None:
        super().__init__(target_action=target_action, entities=[], **options)
        self._by_fd = {1: on_stdout, 2: on_stderr}

    def handle(self, event: Event, context: Context) -> Sequence[Action]:
        assert isinstance(event, ProcessIO)
        function = self._by_fd[event.fd]
        return () if function is None else _actions(_called(function, event, context))
