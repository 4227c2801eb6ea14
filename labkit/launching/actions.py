"""The actions of the package `launch`."""

from __future__ import annotations

import math
import os
import shlex
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from labkit.errors import did_you_mean
from labkit.launching import events
from labkit.launching.model import (
    Action,
    Condition,
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
    'ExecuteProcess',
    'GroupAction',
    'IncludeLaunchDescription',
    'LogInfo',
    'OpaqueFunction',
    'RegisterEventHandler',
    'ResetEnvironment',
    'ResetLaunchConfigurations',
    'SetEnvironmentVariable',
    'SetLaunchConfiguration',
    'Shutdown',
    'Start',
    'TimerAction',
    'UnregisterEventHandler',
    'UnsetEnvironmentVariable',
    'UnsetLaunchConfiguration',
    'Written',
]

OUTPUTS = ('log', 'screen', 'both', 'own_log', 'full')


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
        self.choices = None if choices is None else [str(choice) for choice in choices]
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
                raise LaunchError(
                    f'Required launch argument "{self.name}" (description: '
                    f'"{self.description}") was not provided.',
                    todo=f'Give it a value, {self.name}:=value on the command line or <arg> in '
                    'an <include>, or a default here.',
                )
            known[self.name] = perform(context, self.default_value)
        if self.choices is not None and known[self.name] not in self.choices:
            raise LaunchError(
                f'Argument "{self.name}" provided value "{known[self.name]}" is not valid. Valid '
                f'options are: {self.choices}',
                todo=did_you_mean(known[self.name], self.choices),
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
        self.kept = _pairs(launch_configurations)

    def execute(self, context: Context) -> None:
        kept = {perform(context, name): perform(context, value) for name, value in self.kept}
        context.launch_configurations = kept
        context.settings = {}


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
        context.environment = dict(os.environ)


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
        begin: list[Action] = [_Step(Context.open_scope)]
        if self.forwarding:
            begin += kept
        else:
            begin += [ResetEnvironment(), ResetLaunchConfigurations(self.kept)]
        return [*begin, *self.actions, _Step(Context.close_scope)]

    def inside(self) -> Iterable[tuple[Sequence[Action], bool]]:
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
        launch_arguments: Mapping[Any, Any] | Iterable[tuple[Any, Any]] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        source = launch_description_source
        self.source = source if isinstance(source, Source) else Source(source)
        self.launch_arguments = _pairs(launch_arguments)

    def execute(self, context: Context) -> Sequence[Action]:
        path = os.path.abspath(perform(context, self.source.path))
        if path in context.files:
            circle = [*context.files[context.files.index(path) :], path]
            names = ' includes '.join(os.path.basename(file) for file in circle)
            raise LaunchError(
                f'The file includes itself: {names}.', todo='Take one of the <include> out.'
            )
        description = self.source.load(path)
        arguments = [SetLaunchConfiguration(*pair) for pair in self.launch_arguments]
        for argument in arguments:
            argument.place = self.place
        return [
            *arguments,
            _Step(lambda context: context.files.append(path)),
            description,
            _Step(Context.leave_file),
        ]

    def inside(self) -> Iterable[tuple[Sequence[Action], bool]]:
        try:
            path = os.path.abspath(perform(Context(), self.source.path))
            return [([self.source.load(path)], self.condition is not None)]
        except LaunchError:  # known only when it is visited
            return ()


class Source:
    """The path of a launch file, and in which form it is; by default as its name says."""

    form = ''

    def __init__(self, launch_file_path: Any) -> None:
        self.path = pieces(launch_file_path)

    def load(self, path: str) -> LaunchDescription:
        """Return the description in a file."""
        from labkit.launching.launch_files import load

        return load(path, self.form)


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
        self.period, self.cancel_on_shutdown = period, cancel_on_shutdown
        self.actions = list(actions)

    def execute(self, context: Context) -> None:
        seconds = _not_below_0('The period of a timer', setting(context, self.period, 'float'))
        cancelled = setting(context, self.cancel_on_shutdown, 'bool')
        context.timers.append(Timer(seconds, self.actions, cancelled, list(context.files)))

    def inside(self) -> Iterable[tuple[Sequence[Action], bool]]:
        return [(self.actions, True)]


class RegisterEventHandler(Action):
    """Let a handler handle events from now on."""

    def __init__(self, event_handler: events.EventHandler, **options: Any) -> None:
        super().__init__(**options)
        self.handler = event_handler

    def execute(self, context: Context) -> None:
        self.handler.files = list(context.files)
        context.handlers.insert(0, self.handler)

    def inside(self) -> Iterable[tuple[Sequence[Action], bool]]:
        return [(self.handler.actions, True)]

    def describe(self) -> str:
        return f'RegisterEventHandler({type(self.handler).__name__})'


class UnregisterEventHandler(RegisterEventHandler):
    """Let a handler handle no more events."""

    def execute(self, context: Context) -> None:
        if self.handler in context.handlers:
            context.handlers.remove(self.handler)

    def inside(self) -> Iterable[tuple[Sequence[Action], bool]]:
        return ()


class EmitEvent(Action):
    """Let an event happen; here the event `Shutdown`."""

    def __init__(self, *, event: Any, **options: Any) -> None:
        super().__init__(**options)
        if not isinstance(event, events.Shutdown):
            raise LaunchError(f'EmitEvent takes Shutdown(...) here, and this is {event!r}.')
        self.event = event

    def execute(self, context: Context) -> None:
        reason = perform(context, pieces(self.event.reason))
        context.events.append(events.Shutdown(reason))


class Shutdown(EmitEvent):
    """End the launch: `<shutdown>`."""

    def __init__(self, *, reason: Any = 'reason not given', **options: Any) -> None:
        super().__init__(event=events.Shutdown(reason), **options)

    def execute(self, context: Context) -> None:
        event = context.locals.event
        if isinstance(event, events.ProcessExited):
            context.say(
                'INFO',
                'launch',
                f'process[{event.process_name}] was required: shutting down launched system',
            )
        super().execute(context)


@dataclass(frozen=True)
class Written:
    """A word of a command that is the path of a file which has yet to be written."""

    text: str


@dataclass
class Start:
    """A process that is to be started.

    Attributes:
        command: Its words. With `shell` they are joined and given to a shell.
        is_node: Whether a node is expected to appear.
        sigterm: Seconds from SIGINT to SIGTERM.
        sigkill: Seconds from then to SIGKILL.
        retries: How often it may be started again; below 0 without end.
    """

    action: ExecuteProcess
    name: str
    command: list[str | Written]
    cwd: str | None
    environment: dict[str, str]
    shell: bool = False
    output: str = 'log'
    is_node: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    retries: int = -1
    sigterm: float = 5.0
    sigkill: float = 5.0
    log_command: bool = False


@dataclass
class _Options:
    """Options of `ExecuteProcess` by the names of the real one."""

    shell: Any = False
    output: Any = 'log'
    cwd: Any = None
    env: Mapping[Any, Any] | None = None
    additional_env: Mapping[Any, Any] | None = None
    respawn: Any = False
    respawn_delay: Any = 0.0
    respawn_max_retries: Any = -1
    sigterm_timeout: Any = None
    sigkill_timeout: Any = None
    log_cmd: bool = False
    # Without effect here: output comes at once, and is not kept twice.
    emulate_tty: Any = False
    cached_output: bool = False
    refused: dict[str, Any] = field(default_factory=dict)


class ExecuteProcess(Action):
    """Start a program: `<executable>`.

    Args:
        cmd: Its words, each a text; with `shell` often one text.
        name: What its output is marked with; by default the name of the program.
        on_exit: Actions, or a function that returns some, for its end.
        condition: Whether it is started.
        options: See `_Options`.
    """

    is_node = False

    def __init__(
        self,
        *,
        cmd: Iterable[Any],
        name: Any = None,
        on_exit: Any = None,
        condition: Condition | None = None,
        **options: Any,
    ) -> None:
        super().__init__(condition=condition)
        for word in ('prefix', 'output_format'):
            if options.pop(word, None) is not None:
                shown = 'launch-prefix' if word == 'prefix' else word
                raise LaunchError(
                    f'{shown} is not supported here: programs are started as they are.',
                    place=self.place,
                )
        known = set(_Options.__dataclass_fields__) - {'refused'}
        wrong = next((word for word in options if word not in known), None)
        if wrong is not None:
            raise LaunchError(
                f'{type(self).__name__} has no argument {wrong!r}.',
                todo=did_you_mean(wrong, [*known, 'cmd', 'name', 'on_exit', 'condition']),
                place=self.place,
            )
        if isinstance(cmd, str):
            raise LaunchError(
                f'cmd is a list of words, and this is {cmd!r}.',
                todo=f'cmd={shlex.split(cmd)!r}',
                place=self.place,
            )
        self.command = [pieces(word) for word in cmd]
        self.label = None if name is None else pieces(name)
        self.options = _Options(**options)
        self.on_exit = on_exit
        self._executed = False

    def execute(self, context: Context) -> None:
        name, words = self.words(context)
        start = self._start(context, words, name)
        self._check(start)
        if context.rehearsing:
            return
        if self._executed:
            raise LaunchError(f'{start.name} was started already: one action, one process.')
        self._executed = True
        if self.on_exit is not None:
            handler = events.OnProcessExit(target_action=self, on_exit=self.on_exit)
            handler.files = list(context.files)
            context.handlers.insert(0, handler)
        context.starts.append(start)

    def words(self, context: Context) -> tuple[str, list[str | Written]]:
        """Return the name of the program, and the words of its command."""
        words: list[str | Written] = [perform(context, word) for word in self.command]
        if not words:
            raise LaunchError('cmd is empty.')
        return os.path.basename(str(words[0])), words

    def _start(self, context: Context, command: list[str | Written], name: str) -> Start:
        options = self.options
        if self.label is not None:
            name = perform(context, self.label)
        context.counter += 1
        environment = dict(context.environment)
        if options.env is not None:
            environment = _texts(context, options.env)
        environment.update(_texts(context, options.additional_env or {}))
        delay = setting(context, options.respawn_delay, 'float') or 0.0
        configured = context.launch_configurations
        return Start(
            self,
            f'{name}-{context.counter}',
            command,
            None if options.cwd is None else perform(context, pieces(options.cwd)),
            environment,
            shell=setting(context, options.shell, 'bool'),
            output=self._output(context),
            is_node=self.is_node,
            respawn=setting(context, options.respawn, 'bool'),
            respawn_delay=_not_below_0('respawn_delay', delay),
            retries=setting(context, options.respawn_max_retries, 'int'),
            sigterm=self._timeout(context, options.sigterm_timeout, 'sigterm_timeout', configured),
            sigkill=self._timeout(context, options.sigkill_timeout, 'sigkill_timeout', configured),
            log_command=options.log_cmd,
        )

    def _timeout(
        self, context: Context, value: Any, name: str, configured: Mapping[str, str]
    ) -> float:
        chosen = configured.get(name, 5.0) if value is None else value
        return _not_below_0(name, setting(context, chosen, 'float'))

    def _output(self, context: Context) -> str:
        chosen = self.options.output
        if isinstance(chosen, Mapping):  # by stream: here both are shown, or none
            chosen = 'screen' if 'screen' in str(chosen) else 'log'
        output = context.environment.get('OVERRIDE_LAUNCH_PROCESS_OUTPUT') or perform(
            context, pieces(chosen)
        )
        if output not in OUTPUTS:
            raise LaunchError(
                f'output is one of {", ".join(OUTPUTS)}, and this is {output!r}.',
                todo=did_you_mean(output, OUTPUTS),
            )
        return output

    def _check(self, start: Start) -> None:
        """Raise a LaunchError if the program can't be found."""
        program = start.command[0]
        if start.shell or not isinstance(program, str):
            return
        folder = start.cwd or '.'
        path = os.path.join(folder, program) if '/' in program else program
        if shutil.which(path, path=start.environment.get('PATH', os.defpath)) is None:
            raise LaunchError(
                f'There is no program {program!r}.',
                todo='A line of a shell needs shell="true".' if ' ' in program else '',
            )
        if start.cwd is not None and not os.path.isdir(start.cwd):
            raise LaunchError(f'cwd is no folder: {start.cwd!r}')

    def inside(self) -> Iterable[tuple[Sequence[Action], bool]]:
        if self.on_exit is None or callable(self.on_exit):
            return ()
        return [([self.on_exit] if isinstance(self.on_exit, Action) else self.on_exit, True)]

    def describe(self) -> str:
        words = ' '.join(
            ''.join(part.describe().strip("'") for part in word) for word in self.command
        )
        return f'{type(self).__name__}({words})'


def _not_below_0(name: str, value: float) -> float:
    if not 0 <= value < math.inf:
        raise LaunchError(f'{name} is {value}; it can not be below 0, nor without end.')
    return value


def _pairs(value: Mapping[Any, Any] | Iterable[tuple[Any, Any]] | None) -> list[tuple[Text, Text]]:
    items = value.items() if isinstance(value, Mapping) else value or ()
    return [(pieces(name), pieces(text)) for name, text in items]


def _texts(context: Context, values: Mapping[Any, Any]) -> dict[str, str]:
    return {perform(context, name): perform(context, text) for name, text in _pairs(values)}
