"""Programs: the actions that start them, and the handlers of what happens to them."""

from __future__ import annotations

import os
import re
import shlex
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from labkit.errors import did_you_mean
from labkit.launching import events
from labkit.launching.actions import not_below_0, pairs_in, setting
from labkit.launching.event_handlers import OnActionEventBase, entities_in
from labkit.launching.model import (
    Action,
    Condition,
    Context,
    LaunchError,
    at,
    perform,
    pieces,
    placed,
)

__all__ = [
    'Executable',
    'ExecuteLocal',
    'ExecuteProcess',
    'OnProcessExit',
    'OnProcessIO',
    'OnProcessStart',
    'Start',
    'Written',
]

OUTPUTS = ('log', 'screen', 'both', 'own_log', 'full')


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

    action: ExecuteLocal
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
    """Options of `ExecuteLocal` by the names of the real one."""

    shell: Any = False
    output: Any = 'log'
    respawn: Any = False
    respawn_delay: Any = 0.0
    respawn_max_retries: Any = -1
    sigterm_timeout: Any = None
    sigkill_timeout: Any = None
    log_cmd: bool = False
    # Without effect here: output comes at once, is not kept twice, and has one form.
    emulate_tty: Any = False
    cached_output: bool = False
    output_format: Any = None


class Executable:
    """A program: what `ExecuteLocal` starts.

    Args:
        cmd: Its words, each a text; with `shell` often one text.
        prefix: Words before them; by default those of the launch configuration `launch-prefix`,
            for programs that match the pattern `launch-prefix-filter`.
        name: What its output is marked with; by default the name of the program.
        cwd: The folder in which it runs.
        env: All of its environment variables.
        additional_env: More of them.
        arguments: More words.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[Any],
        prefix: Any = None,
        name: Any = None,
        cwd: Any = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        arguments: Iterable[Any] | None = None,
    ) -> None:
        if isinstance(cmd, str):
            raise LaunchError(
                f'cmd is a list of words, and this is {cmd!r}.',
                todo=f'cmd={shlex.split(cmd)!r}',
                place=placed(),
            )
        self.cmd = [pieces(word) for word in [*cmd, *(arguments or ())]]
        self.prefix = None if prefix is None else pieces(prefix)
        self.name = None if name is None else pieces(name)
        self.cwd = None if cwd is None else pieces(cwd)
        self.env, self.additional_env = env, additional_env

    def environment(self, context: Context) -> dict[str, str]:
        """Return its environment variables."""
        found = dict(context.environment) if self.env is None else {}
        for name, text in [*pairs_in(self.env), *pairs_in(self.additional_env)]:
            found[perform(context, name)] = perform(context, text)
        return found

    def words_before(self, context: Context, program: str) -> list[str]:
        """Return the words of its prefix."""
        if self.prefix is not None:
            return shlex.split(perform(context, self.prefix))
        known = context.launch_configurations
        meant = re.match(known.get('launch-prefix-filter', ''), os.path.basename(program))
        return shlex.split(known.get('launch-prefix', '')) if meant else []


class ExecuteLocal(Action):
    """Start a program.

    Args:
        process_description: The program.
        on_exit: Actions, or a function that returns some, for its end.
        condition: Whether it is started.
        options: See `_Options`.

    Attributes:
        process_details: What is known of the program: name, cmd, cwd, env, and pid once it runs.
    """

    is_node = False

    def __init__(
        self,
        *,
        process_description: Executable,
        on_exit: Any = None,
        condition: Condition | None = None,
        **options: Any,
    ) -> None:
        super().__init__(condition=condition)
        wrong = next((word for word in options if word not in _Options.__dataclass_fields__), None)
        if wrong is not None:
            known = [*_Options.__dataclass_fields__, *_OF_EXECUTABLE, 'on_exit', 'condition']
            raise LaunchError(
                f'{type(self).__name__} has no argument {wrong!r}.',
                todo=did_you_mean(wrong, known),
                place=self.place,
            )
        self.process_description = process_description
        self.options = _Options(**options)
        if isinstance(self.options.respawn, str):
            raise LaunchError(
                f'respawn is True, False or a substitution, and this is {self.options.respawn!r}.',
                place=self.place,
            )
        self.on_exit = on_exit
        self.process_details: dict[str, Any] | None = None
        self._executed = False

    def execute(self, context: Context) -> Sequence[Action] | None:
        start = self._start(context, *self.words(context))
        missing = self._missing(start)
        if context.rehearsing:
            return None
        if missing is not None:
            # As with the real one, the others start all the same.
            context.say('ERROR', start.name, f'can not be started: {at(missing, self.place)}')
            context.emit_event_sync(events.ExecutionComplete(self))
            return None
        if self._executed:
            raise LaunchError(f'{start.name} was started already: one action, one process.')
        self._executed = True
        if self.on_exit is not None:
            handler = OnProcessExit(target_action=self, on_exit=self.on_exit)
            context.register_event_handler(handler)
        self.process_details = {
            'name': start.name,
            'cmd': [str(word) for word in start.command],
            'cwd': start.cwd,
            'env': start.environment,
        }
        context.starts.append(start)
        return None

    def words(self, context: Context) -> tuple[str, list[str | Written]]:
        """Return the name of the program, and the words of its command."""
        words: list[str | Written] = [
            perform(context, word) for word in self.process_description.cmd
        ]
        if not words:
            raise LaunchError('cmd is empty.')
        return os.path.basename(str(words[0])), words

    def _start(self, context: Context, name: str, command: list[str | Written]) -> Start:
        options, program = self.options, self.process_description
        before = program.words_before(context, str(command[0]))
        if before:
            name = os.path.basename(before[0])
        if program.name is not None:
            name = perform(context, program.name)
        context.counter += 1
        delay = setting(context, options.respawn_delay, 'float') or 0.0
        configured = context.launch_configurations
        return Start(
            self,
            f'{name}-{context.counter}',
            [*before, *command],
            None if program.cwd is None else perform(context, program.cwd),
            program.environment(context),
            shell=setting(context, options.shell, 'bool'),
            output=self._output(context),
            is_node=self.is_node,
            respawn=setting(context, options.respawn, 'bool'),
            respawn_delay=not_below_0('respawn_delay', delay),
            retries=setting(context, options.respawn_max_retries, 'int'),
            sigterm=self._timeout(context, options.sigterm_timeout, 'sigterm_timeout', configured),
            sigkill=self._timeout(context, options.sigkill_timeout, 'sigkill_timeout', configured),
            log_command=options.log_cmd,
        )

    def _timeout(
        self, context: Context, value: Any, name: str, configured: Mapping[str, str]
    ) -> float:
        chosen = configured.get(name, 5.0) if value is None else value
        return not_below_0(name, setting(context, chosen, 'float'))

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

    def _missing(self, start: Start) -> LaunchError | None:
        """Return why the program can't be started, None if nothing is known against it."""
        program = start.command[0]
        if start.cwd is not None and not os.path.isdir(start.cwd):
            return LaunchError(f'cwd is no folder: {start.cwd!r}')
        if start.shell or not isinstance(program, str):
            return None
        folder = start.cwd or '.'
        path = os.path.join(folder, program) if '/' in program else program
        if shutil.which(path, path=start.environment.get('PATH', os.defpath)) is None:
            return LaunchError(
                f'There is no program {program!r}.',
                todo='A line of a shell needs shell="true".' if ' ' in program else '',
            )
        return None

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        if self.on_exit is None or callable(self.on_exit):
            return ()
        return [(entities_in(self.on_exit), True)]

    def describe(self) -> str:
        words = ' '.join(
            ''.join(part.describe().strip("'") for part in word)
            for word in self.process_description.cmd
        )
        return f'{type(self).__name__}({words})'


# The arguments of `ExecuteProcess` that are those of its program.
_OF_EXECUTABLE = ('cmd', 'prefix', 'name', 'cwd', 'env', 'additional_env')


class ExecuteProcess(ExecuteLocal):
    """Start a program: `<executable>`.

    Args:
        cmd: Its words; see `Executable` for this and others.
        options: See `ExecuteLocal`.
    """

    def __init__(self, *, cmd: Iterable[Any], **options: Any) -> None:
        of_program = {word: options.pop(word) for word in _OF_EXECUTABLE if word in options}
        super().__init__(process_description=Executable(cmd=cmd, **of_program), **options)

    @property
    def name(self) -> Any:
        """What its output is marked with; before it was started what that is made of."""
        details = self.process_details
        return details['name'] if details else self.process_description.name

    @property
    def cmd(self) -> Any:
        """The words of its command, with the substitutions in them."""
        return self.process_description.cmd

    @property
    def cwd(self) -> Any:
        """The folder in which it runs."""
        return self.process_description.cwd

    @property
    def env(self) -> Any:
        """All of its environment variables, None for those of the launch."""
        return self.process_description.env

    @property
    def additional_env(self) -> Any:
        """Environment variables besides those of the launch."""
        return self.process_description.additional_env


class OnProcessStart(OnActionEventBase):
    """Handle the start of a program."""

    words = ('target_action', 'on_start')

    def __init__(self, *, target_action: Any = None, on_start: Any, **options: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_start,
            target_event_cls=events.ProcessStarted,
            target_action_cls=ExecuteLocal,
            **options,
        )


class OnProcessExit(OnActionEventBase):
    """Handle the end of a program."""

    words = ('target_action', 'on_exit')

    def __init__(self, *, target_action: Any = None, on_exit: Any, **options: Any) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_exit,
            target_event_cls=events.ProcessExited,
            target_action_cls=ExecuteLocal,
            **options,
        )


class OnProcessIO(OnActionEventBase):
    """Handle what a program writes; the functions take the event alone."""

    words = ('target_action', 'on_stdout')

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **options: Any,
    ) -> None:
        functions = {0: on_stdin, 1: on_stdout, 2: on_stderr}

        def on_event(event: events.ProcessIO, _: Context) -> Any:
            function = functions[event.fd]
            return None if function is None else function(event)

        super().__init__(
            action_matcher=target_action,
            on_event=on_event,
            target_event_cls=events.ProcessIO,
            target_action_cls=ExecuteLocal,
            **options,
        )
