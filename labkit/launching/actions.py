"""The actions of the package `launch`."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from labkit.errors import did_you_mean
from labkit.launching import events
from labkit.launching.event_handlers import BaseEventHandler
from labkit.launching.model import (
    Action,
    Context,
    LaunchDescription,
    LaunchError,
    Text,
    Timer,
    perform,
    pieces,
)
from labkit.launching.parameter_types import coerce

__all__ = [
    'AppendEnvironmentVariable',
    'DeclareLaunchArgument',
    'EmitEvent',
    'GroupAction',
    'IncludeLaunchDescription',
    'LogInfo',
    'OpaqueFunction',
    'PopEnvironment',
    'PopLaunchConfigurations',
    'PushEnvironment',
    'PushLaunchConfigurations',
    'RegisterEventHandler',
    'ResetEnvironment',
    'ResetLaunchConfigurations',
    'SetEnvironmentVariable',
    'SetLaunchConfiguration',
    'Shutdown',
    'TimerAction',
    'UnregisterEventHandler',
    'UnsetEnvironmentVariable',
    'UnsetLaunchConfiguration',
]


def setting(context: Context, value: Any, kind: str) -> Any:
    """Return a number or a truth value that may be given as a text with substitutions."""
    if value is None or isinstance(value, (bool, int, float)):
        return float(value) if kind == 'float' and value is not None else value
    return coerce(perform(context, pieces(value)), kind)


class DeclareLaunchArgument(Action):
    """Let the launch file have an argument: `<arg>`."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Any = None,
        description: str | None = None,
        choices: Sequence[str] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.name = name
        self.default_value = None if default_value is None else pieces(default_value)
        if choices is not None and not (choices and all(isinstance(one, str) for one in choices)):
            raise LaunchError(
                f'choices are one or more texts, and these are {choices!r}.', place=self.place
            )
        self.choices = None if choices is None else list(choices)
        if description is None:
            description = f'One of: {self.choices}' if choices else 'no description given'
        elif choices:
            description += '.' * (not description.endswith('.'))
            description += f' Valid choices are: {self.choices}'
        self.description = description

    def execute(self, context: Context) -> None:
        known = context.launch_configurations
        if self.name not in known:
            if self.default_value is None:
                raise self.missing()
            known[self.name] = perform(context, self.default_value)
        if self.choices is not None and known[self.name] not in self.choices:
            raise LaunchError(
                f'Argument "{self.name}" provided value "{known[self.name]}" is not valid. Valid '
                f'options are: {self.choices}',
                todo=did_you_mean(known[self.name], self.choices),
            )

    def missing(self) -> LaunchError:
        """Return the error that it was given no value."""
        return LaunchError(
            f'Required launch argument "{self.name}" (description: "{self.description}") was not '
            'provided.',
            todo=f'Give it a value, {self.name}:=value on the command line or <let> in the '
            '<include> of this file, or a default here.',
            place=self.place,
        )

    def describe(self) -> str:
        return f'DeclareLaunchArgument({self.name!r})'


class SetLaunchConfiguration(Action):
    """Give a launch configuration a value: `<let>`."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(**options)
        self.name, self.value = pieces(name), pieces(value)

    def execute(self, context: Context) -> None:
        name = perform(context, self.name)
        context.launch_configurations[name] = perform(context, self.value)


class UnsetLaunchConfiguration(Action):
    """Take the value of a launch configuration away."""

    def __init__(self, name: Any, **options: Any) -> None:
        super().__init__(**options)
        self.name = pieces(name)

    def execute(self, context: Context) -> None:
        context.launch_configurations.pop(perform(context, self.name), None)


class ResetLaunchConfigurations(Action):
    """Take all launch configurations away but those given: `<reset>`."""

    def __init__(
        self, launch_configurations: Mapping[Any, Any] | None = None, **options: Any
    ) -> None:
        super().__init__(**options)
        self.kept = pairs_in(launch_configurations)

    def execute(self, context: Context) -> None:
        kept = {perform(context, name): perform(context, value) for name, value in self.kept}
        context.launch_configurations = kept


class SetEnvironmentVariable(SetLaunchConfiguration):
    """Set an environment variable for what follows: `<set_env>`."""

    def execute(self, context: Context) -> None:
        context.environment[perform(context, self.name)] = perform(context, self.value)


class UnsetEnvironmentVariable(UnsetLaunchConfiguration):
    """Take an environment variable away: `<unset_env>`."""

    def execute(self, context: Context) -> None:
        context.environment.pop(perform(context, self.name), None)


class AppendEnvironmentVariable(SetLaunchConfiguration):
    """Add to an environment variable, at its end or its beginning: `<append_env>`."""

    def __init__(
        self,
        name: Any,
        value: Any,
        prepend: Any = False,
        separator: Any = os.pathsep,
        **options: Any,
    ) -> None:
        super().__init__(name, value, **options)
        self.prepend, self.separator = prepend, pieces(separator)

    def execute(self, context: Context) -> None:
        name, value = perform(context, self.name), perform(context, self.value)
        both = [context.environment[name], value] if name in context.environment else [value]
        if setting(context, self.prepend, 'bool'):
            both.reverse()
        context.environment[name] = perform(context, self.separator).join(both)


class ResetEnvironment(Action):
    """Go back to the environment variables of the terminal: `<reset_env>`."""

    def execute(self, context: Context) -> None:
        context.reset_environment()


class PushEnvironment(Action):
    """Note the environment variables, for `PopEnvironment`."""

    def execute(self, context: Context) -> None:
        context.push_environment()


class PopEnvironment(Action):
    """Go back to the environment variables that were noted last."""

    def execute(self, context: Context) -> None:
        context.pop_environment()


class PushLaunchConfigurations(Action):
    """Note the launch configurations, for `PopLaunchConfigurations`."""

    def execute(self, context: Context) -> None:
        context.push_configurations()


class PopLaunchConfigurations(Action):
    """Go back to the launch configurations that were noted last."""

    def execute(self, context: Context) -> None:
        context.pop_configurations()


class LogInfo(Action):
    """Show a line: `<log>`."""

    def __init__(self, *, msg: Any, **options: Any) -> None:
        super().__init__(**options)
        self.msg = pieces(msg)

    def execute(self, context: Context) -> None:
        context.say('INFO', 'launch.user', perform(context, self.msg))

    def describe(self) -> str:
        return f'LogInfo({" + ".join(part.describe() for part in self.msg)})'


class _Step(Action):
    """A part of another action that is done in its turn."""

    def __init__(self, step: Callable[[Context], None]) -> None:
        super().__init__()
        self._step = step

    def execute(self, context: Context) -> None:
        self._step(context)


class GroupAction(Action):
    """Actions that belong together; what they set ends with them: `<group>`."""

    def __init__(
        self,
        actions: Iterable[Action],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.actions = list(actions)
        self.scoped, self.forwarding = scoped, forwarding
        self.kept = dict(launch_configurations or {})

    def execute(self, context: Context) -> Sequence[Action]:
        kept = [SetLaunchConfiguration(name, value) for name, value in self.kept.items()]
        if not self.scoped:
            return [*kept, *self.actions]
        begin: list[Action] = [PushLaunchConfigurations(), PushEnvironment()]
        if self.forwarding:
            begin += kept
        else:
            begin += [ResetEnvironment(), ResetLaunchConfigurations(self.kept)]
        return [*begin, *self.actions, PopEnvironment(), PopLaunchConfigurations()]

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        return [(self.actions, self.condition is not None)]


class IncludeLaunchDescription(Action):
    """Visit another launch file: `<include>`.

    Args:
        launch_description_source: Its path, or a source of `launch_description_sources`.
        launch_arguments: Pairs of name and value.
    """

    def __init__(
        self,
        launch_description_source: Any,
        *,
        launch_arguments: Iterable[tuple[Any, Any]] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if isinstance(launch_arguments, Mapping):
            raise LaunchError(
                'launch_arguments are pairs, and this is a dictionary.',
                todo='launch_arguments={...}.items()',
                place=self.place,
            )
        source = launch_description_source
        self.source = source if isinstance(source, Source) else Source(source)
        self.launch_arguments = list(launch_arguments or ())

    def execute(self, context: Context) -> Sequence[Action]:
        path = os.path.abspath(perform(context, self.source.path))
        if path in context.files:
            circle = [*context.files[context.files.index(path) :], path]
            names = ' includes '.join(os.path.basename(file) for file in circle)
            raise LaunchError(
                f'The file includes itself: {names}.', todo='Take one of the <include> out.'
            )
        description = self.source.load(context, path)
        self._check_arguments(context, description)
        arguments = [SetLaunchConfiguration(*pair) for pair in self.launch_arguments]
        for argument in arguments:
            argument.place = self.place
        if not self.source.is_file:
            return [*arguments, description]
        return [
            *arguments,
            _Step(lambda context: context.files.append(path)),
            description,
            _Step(Context.leave_file),
        ]

    def _check_arguments(self, context: Context, description: LaunchDescription) -> None:
        """Raise a LaunchError if an argument that the file must be given is not given here."""
        given = {perform(context, pieces(name)) for name, _ in self.launch_arguments}
        known: set[str] = set()
        for argument, includes in declared(context, [description]):
            if argument.name in known or argument.default_value is not None:
                known.add(argument.name)
                continue
            # Best effort, as in the real one: those given further inside count too.
            inside = {name for one in includes for name in one.argument_names()}
            if argument.name not in given | inside:
                raise argument.missing()

    def argument_names(self) -> set[str]:
        """Return the names of the arguments that it gives, as far as they are known already."""
        try:
            return {perform(Context(), pieces(name)) for name, _ in self.launch_arguments}
        except LaunchError:
            return set()

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        try:
            path = os.path.abspath(perform(Context(), self.source.path))
            return [([self.source.load(context, path)], self.condition is not None)]
        except LaunchError:  # known only when it is visited
            return ()


class Source:
    """The path of a launch file, and in which form it is; by default as its name says."""

    form = ''
    is_file = True

    def __init__(self, launch_file_path: Any) -> None:
        self.path = pieces(launch_file_path)
        self._loaded: dict[str, LaunchDescription] = {}

    def load(self, context: Context, path: str) -> LaunchDescription:
        """Return the description in a file; it is read once."""
        if path not in self._loaded:
            self._loaded[path] = context.load(path, self.form)
        return self._loaded[path]


class OpaqueFunction(Action):
    """Call a function of the launch file with the context; it may return actions."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] = (),
        kwargs: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self._call = (function, list(args), dict(kwargs or {}))

    def execute(self, context: Context) -> Sequence[Action] | None:
        if context.rehearsing:
            return None
        function, args, kwargs = self._call
        return function(context, *args, **kwargs)  # type: ignore[no-any-return]


class TimerAction(Action):
    """Visit actions after a time: `<timer>`."""

    def __init__(
        self,
        *,
        period: Any,
        actions: Iterable[Action],
        cancel_on_shutdown: Any = True,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        if isinstance(period, int):
            raise LaunchError(
                f'The period of a timer is a float, and this is {period!r}.',
                todo=f'period={float(period)}',
                place=self.place,
            )
        self.period, self.cancel_on_shutdown = period, cancel_on_shutdown
        self.actions = list(actions)

    def execute(self, context: Context) -> None:
        seconds = not_below_0('The period of a timer', setting(context, self.period, 'float'))
        cancelled = setting(context, self.cancel_on_shutdown, 'bool')
        context.timers.append(
            Timer(
                seconds,
                self.actions,
                cancelled,
                list(context.files),
                dict(context.launch_configurations),
            )
        )

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        return [(self.actions, True)]


class RegisterEventHandler(Action):
    """Let a handler handle events from now on."""

    def __init__(self, event_handler: BaseEventHandler, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(event_handler, BaseEventHandler):
            raise LaunchError(
                f'RegisterEventHandler takes an event handler, and this is {event_handler!r}.',
                place=self.place,
            )
        if isinstance(getattr(event_handler, 'entities', None), Action):
            raise LaunchError('entities of an EventHandler is a list.', place=self.place)
        self.event_handler = event_handler

    def execute(self, context: Context) -> None:
        context.register_event_handler(self.event_handler)

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        return [(self.event_handler.actions, True)]

    def describe(self) -> str:
        return f'{type(self).__name__}({type(self.event_handler).__name__})'


class UnregisterEventHandler(RegisterEventHandler):
    """Let a handler handle no more events."""

    def execute(self, context: Context) -> None:
        context.unregister_event_handler(self.event_handler)

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        return ()


class EmitEvent(Action):
    """Let an event happen."""

    def __init__(self, *, event: Any, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(event, events.Event):
            raise LaunchError(
                f'EmitEvent takes an event, and this is {event!r}.', place=self.place
            )
        self.event = event

    def execute(self, context: Context) -> None:
        event = self.event
        if isinstance(event, events.Shutdown):
            event = events.Shutdown(perform(context, pieces(event.reason)))
        context.emit_event_sync(event)


class Shutdown(EmitEvent):
    """End the launch: `<shutdown>`."""

    def __init__(self, *, reason: Any = 'reason not given', **options: Any) -> None:
        super().__init__(event=events.Shutdown(reason), **options)

    def execute(self, context: Context) -> None:
        event = context.get_locals_as_dict().get('event')
        if isinstance(event, events.ProcessExited):
            context.say(
                'INFO',
                'launch',
                f'process[{event.process_name}] was required: shutting down launched system',
            )
        super().execute(context)


def declared(
    context: Context,
    actions: Iterable[Action],
    includes: tuple[IncludeLaunchDescription, ...] = (),
) -> Iterator[tuple[DeclareLaunchArgument, tuple[IncludeLaunchDescription, ...]]]:
    """Yield the arguments that do not depend on a condition, and the includes around each."""
    for action in actions:
        if isinstance(action, ResetLaunchConfigurations):
            return  # what follows can not be given from outside
        if not isinstance(action, Action) or action.condition is not None:
            continue  # what is no action is told when its turn comes
        if isinstance(action, DeclareLaunchArgument):
            yield action, includes
        around = (*includes, action) if isinstance(action, IncludeLaunchDescription) else includes
        for inner, open_one in action.inside(context):
            if not open_one:
                yield from declared(context, inner, around)


def not_below_0(name: str, value: float) -> float:
    """Return a number of seconds, unless it is none."""
    if not 0 <= value < math.inf:
        raise LaunchError(f'{name} is {value}; it can not be below 0, nor without end.')
    return value


def pairs_in(
    value: Mapping[Any, Any] | Iterable[tuple[Any, Any]] | None,
) -> list[tuple[Text, Text]]:
    """Return pairs of texts, of a dictionary or of pairs."""
    items = value.items() if isinstance(value, Mapping) else value or ()
    return [(pieces(name), pieces(text)) for name, text in items]
