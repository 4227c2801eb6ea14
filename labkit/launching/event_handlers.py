"""Event handlers: what is to be done when an event comes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from labkit.launching import events
from labkit.launching.model import Action, Context, LaunchError, placed

__all__ = [
    'BaseEventHandler',
    'EventHandler',
    'OnActionEventBase',
    'OnExecutionComplete',
    'OnShutdown',
    'event_named',
]


def event_named(name: str) -> Callable[[events.Event], bool]:
    """Return a function that chooses the events of a name."""
    return lambda event: event.name == name


class BaseEventHandler:
    """What to do when an event comes; subclasses say what, in `handle`.

    Args:
        matcher: Says whether an event is one to handle.
        handle_once: Whether only the first of them is.

    Attributes:
        files: The launch files in which it stands, the innermost last.
    """

    files: Sequence[str] = ()

    def __init__(
        self, *, matcher: Callable[[events.Event], bool], handle_once: bool = False
    ) -> None:
        self._matcher = matcher
        self.handle_once = handle_once

    def matches(self, event: events.Event) -> bool:
        """Return whether an event is one to handle."""
        return bool(self._matcher(event))

    def handle(self, event: events.Event, context: Context) -> Any:
        """Return what is to be visited: an action, several, or None."""
        context.extend_locals({'event': event})
        if self.handle_once:
            context.unregister_event_handler(self)
        return None

    @property
    def actions(self) -> Sequence[Action]:
        """The actions, as far as no function has to be called for them."""
        return ()


class EventHandler(BaseEventHandler):
    """Visit actions when an event comes that a function chooses."""

    def __init__(
        self, *, entities: Any = None, matcher: Callable[[events.Event], bool], **options: Any
    ) -> None:
        super().__init__(matcher=matcher, **options)
        self.entities = entities

    def handle(self, event: events.Event, context: Context) -> Any:
        super().handle(event, context)
        return self.entities

    @property
    def actions(self) -> Sequence[Action]:
        return entities_in(self.entities)


def entities_in(todo: Any) -> Sequence[Action]:
    """Return what a handler, or a function, gave to be visited, as a list."""
    if todo is None:
        return ()
    if isinstance(todo, Action):
        return [todo]
    return [one for one in todo if one is not None]


class OnActionEventBase(BaseEventHandler):
    """Handle an event about an action.

    Args:
        action_matcher: The action; None for any, or a function that chooses.
        on_event: What to visit, or a function of the event and the context that returns it.
        target_event_cls: The class of the events.
        target_action_cls: The class of the actions.
    """

    # The names of the arguments above, in this class.
    words = ('action_matcher', 'on_event')

    def __init__(
        self,
        *,
        action_matcher: Any,
        on_event: Any,
        target_event_cls: type[events.Event],
        target_action_cls: type[Action],
        **options: Any,
    ) -> None:
        self._todo = on_event
        if not (
            action_matcher is None
            or isinstance(action_matcher, target_action_cls)
            or callable(action_matcher)
        ):
            raise LaunchError(
                f'{self.words[0]} of {type(self).__name__} is an action of the class '
                f'{target_action_cls.__name__}, or a function, and this is {action_matcher!r}.',
                place=placed(),
            )
        if not callable(on_event):
            for one in on_event if isinstance(on_event, Iterable) else [on_event]:
                if not isinstance(one, Action):
                    raise LaunchError(
                        f'{self.words[1]} of {type(self).__name__} takes actions, and this is '
                        f'{one!r}.',
                        place=placed(),
                    )

        def matches(event: events.Event) -> bool:
            if not isinstance(event, target_event_cls):
                return False
            action = event.action  # type: ignore[attr-defined]
            if callable(action_matcher):
                return bool(action_matcher(action))
            return action_matcher is None or action is action_matcher

        super().__init__(matcher=matches, **options)

    def handle(self, event: events.Event, context: Context) -> Any:
        super().handle(event, context)
        return self._todo(event, context) if callable(self._todo) else self._todo

    @property
    def actions(self) -> Sequence[Action]:
        return () if callable(self._todo) else entities_in(self._todo)


class OnExecutionComplete(OnActionEventBase):
    """Handle that an action has ended."""

    words = ('target_action', 'on_completion')

    def __init__(self, *, target_action: Any = None, on_completion: Any, **options: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_completion,
            target_event_cls=events.ExecutionComplete,
            target_action_cls=Action,
            **options,
        )


class OnShutdown(BaseEventHandler):
    """Handle that the launch is to end."""

    def __init__(self, *, on_shutdown: Any, **options: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, events.Shutdown), **options)
        self._todo = on_shutdown

    def handle(self, event: events.Event, context: Context) -> Any:
        super().handle(event, context)
        return self._todo(event, context) if callable(self._todo) else self._todo

    @property
    def actions(self) -> Sequence[Action]:
        return () if callable(self._todo) else entities_in(self._todo)
