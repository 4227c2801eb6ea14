"""The basis of all actions and substitutions: places, the context, visiting."""

from __future__ import annotations

import os
import re
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError

if TYPE_CHECKING:
    from labkit.launching.event_handlers import BaseEventHandler

__all__ = [
    'Action',
    'Condition',
    'Context',
    'LaunchDescription',
    'LaunchError',
    'Place',
    'Substitution',
    'Text',
    'Timer',
    'at',
    'perform',
    'placed',
    'python_files',
    'raised',
    'truth',
]

python_files: set[str] = set()
"""The launch files in Python that were loaded."""


@dataclass(frozen=True)
class Place:
    """A line of a launch file."""

    file: str
    line: int

    def __str__(self) -> str:
        near = os.path.relpath(self.file)
        return f'{self.file if near.startswith("..") else near}, line {self.line}'


class LaunchError(LabError):
    """Report a fault in a launch file, with its place as soon as that is known."""

    def __init__(self, message: str, *, todo: str = '', place: Place | None = None) -> None:
        super().__init__(f'{place}: {message}' if place else message, todo=todo)
        self.plain = message
        self.place = place


def at(error: LabError, place: Place | None) -> LaunchError:
    """Return an error with a place; one that it has already is nearer to the fault."""
    if isinstance(error, LaunchError):
        return LaunchError(error.plain, todo=error.todo, place=error.place or place)
    return LaunchError(error.message, todo=error.todo, place=place)


def too_deep() -> LaunchError:
    """Return the error of what Python can't follow any further."""
    return LaunchError('It is nested too deep, or leads to itself.')


def placed() -> Place | None:
    """Return the line of the launch file, in Python, that is running."""
    frame = sys._getframe(1) if python_files else None
    while frame is not None and frame.f_code.co_filename not in python_files:
        frame = frame.f_back
    return None if frame is None else Place(frame.f_code.co_filename, frame.f_lineno)


class Substitution:
    """A piece of text that is known only when the description is visited."""

    def perform(self, context: Context) -> str:
        """Return the text."""
        raise NotImplementedError

    def describe(self) -> str:
        """Return how it is written in Python."""
        inner = [
            ' + '.join(part.describe() for part in value)
            for value in vars(self).values()
            if isinstance(value, list) and all(isinstance(part, Substitution) for part in value)
        ]
        return f'{type(self).__name__}({", ".join(inner)})'


class TextSubstitution(Substitution):
    """Text as it stands."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise LaunchError(f'TextSubstitution takes a text, and this is {text!r}.')
        self.text = text

    def perform(self, context: Context) -> str:
        return self.text

    def describe(self) -> str:
        return repr(self.text)


Text = list[Substitution]
"""What the classes of this package keep for a text: pieces that are joined."""


def pieces(value: Any) -> Text:
    """Return what a launch file gave as a text, as a list of substitutions.

    Raises:
        LaunchError: It is neither a text, a substitution, nor several of them.
    """
    if isinstance(value, Substitution):
        return [value]
    if isinstance(value, (str, Path)):
        return [TextSubstitution(text=str(value))]
    if isinstance(value, Iterable) and not isinstance(value, dict):
        return [part for one in value for part in pieces(one)]
    raise LaunchError(
        f'A text or a substitution is expected, and this is {value!r}.',
        todo=f"Write it as a text: '{value}'",
    )


# Most characters of a text; a launch file has no more than bytes.
LONGEST = 1_000_000


def perform(context: Context, text: Text) -> str:
    """Return a text with its substitutions made.

    Raises:
        LaunchError: It would be too long, as of a variable that is set to itself twice, 40 times.
    """
    made = ''.join(part.perform(context) for part in text)
    if len(made) > LONGEST:
        raise LaunchError(
            f'A text has {len(made)} characters, and at most {LONGEST} are possible.'
        )
    return made


def truth(text: str) -> bool:
    """Return what a condition says.

    Raises:
        LaunchError: It is none of `true`, `false`, `1` and `0`.
    """
    word = text.strip().lower()
    if word in ('true', '1', 'false', '0'):
        return word in ('true', '1')
    raise LaunchError(
        f'A condition is true, false, 1 or 0, and this one is {text!r}.',
        todo="To compare two texts: $(equals ...), or $(eval \"'$(var name)' == 'value'\")",
    )


class Condition:
    """Whether an action is done. Any callable of one argument, the context, is one too."""

    def __init__(self, predicate: Callable[[Context], bool] | None = None) -> None:
        self._predicate = predicate

    def evaluate(self, context: Context) -> bool:
        """Return whether it holds."""
        return bool(self._predicate is None or self._predicate(context))

    __call__ = evaluate


class Action:
    """Something that a description asks for.

    Args:
        condition: Whether it is done.
    """

    def __init__(self, *, condition: Condition | None = None, **others: Any) -> None:
        if others:
            raise LaunchError(
                f'{type(self).__name__} has no argument {next(iter(others))!r} here.',
                place=placed(),
            )
        self.condition = condition
        self.place = placed()

    def visit(self, context: Context) -> Sequence[Action]:
        """Do it if its condition holds, and return what is to be visited next."""
        if self.condition is not None and not self.condition.evaluate(context):
            return ()
        return self.execute(context) or ()

    def execute(self, context: Context) -> Sequence[Action] | None:
        """Do it, and return what is to be visited next."""
        raise NotImplementedError

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        """Return the actions in it, and whether it is open if they will be visited.

        Args:
            context: Loads the files that it includes; nothing else of it is looked at.
        """
        return ()

    def get_sub_entities(self) -> list[Action]:
        """Return the actions in it."""
        return [action for inner, _ in self.inside(Context()) for action in inner]

    def describe(self) -> str:
        """Return one line for `--print-description`."""
        return type(self).__name__


class LaunchDescription(Action):
    """A list of actions: what `generate_launch_description()` returns."""

    def __init__(self, initial_entities: Iterable[Action] | None = None, **options: Any) -> None:
        options.pop('deprecated_reason', None)
        super().__init__(**options)
        self.entities = list(initial_entities or ())

    def add_action(self, action: Action) -> None:
        """Add an action at its end."""
        self.entities.append(action)

    add_entity = add_action

    def execute(self, context: Context) -> Sequence[Action]:
        return self.entities

    def inside(self, context: Context) -> Iterable[tuple[Sequence[Action], bool]]:
        return [(self.entities, False)]


@dataclass
class Timer:
    """Actions that are visited after a time, as if they stood in these files.

    Attributes:
        configurations: The launch configurations that hold for them.
    """

    seconds: float
    actions: Sequence[Action]
    cancel_on_shutdown: bool = True
    files: Sequence[str] = ()
    configurations: Mapping[str, Any] = field(default_factory=dict)


def _nothing_loads(path: str, form: str) -> LaunchDescription:
    raise LaunchError(f'Nothing here loads {path}.')


@dataclass
class Context:
    """What is known while a description is visited, and what it has asked for.

    Environment variables are those of this process, so that what a file in Python sets in
    `os.environ` is seen by substitutions and by programs.

    Attributes:
        launch_configurations: Values by name, for `$(var name)`. What holds for all nodes that
            follow is among them: `ros_namespace`, `ros_remaps`, `global_params`.
        argv: Arguments of the command line.
        files: The launch files that are being visited, the innermost last.
        starts: Processes that are to be started.
        managed: Actions of nodes with a life cycle, whose states are to be listened to.
        uses_sim_time: Whether timers of ROS are to go by the time of a simulator.
        rehearsing: Whether nothing is to happen, because only faults are looked for.
        say: Shows a line: level, who, text.
        load: Returns the description in a launch file: its path, and its form, `''` if that is
            to be seen. It is handed in, because the forms are made of the actions that include.
    """

    launch_configurations: dict[str, Any] = field(default_factory=dict)
    argv: list[str] = field(default_factory=list)
    noninteractive: bool = False
    files: list[str] = field(default_factory=list)
    starts: list[Any] = field(default_factory=list)
    managed: list[Any] = field(default_factory=list)
    timers: list[Timer] = field(default_factory=list)
    handlers: list[BaseEventHandler] = field(default_factory=list)
    events: list[Any] = field(default_factory=list)
    uses_sim_time: bool = False
    rehearsing: bool = False
    is_shutdown: bool = False
    say: Callable[[str, str, str], None] = lambda level, who, text: None
    load: Callable[[str, str], LaunchDescription] = _nothing_loads
    counter: int = 0
    node_names: list[str] = field(default_factory=list)
    log_dir: str = ''
    _locals: dict[str, Any] = field(default_factory=dict)
    _configurations: list[dict[str, Any]] = field(default_factory=list)
    _environments: list[dict[str, str]] = field(default_factory=list)
    _first_environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))

    def visit(self, actions: Iterable[Action]) -> None:
        """Visit actions in order, each with all that it leads to.

        Raises:
            LaunchError: One is wrong, with its place.
        """
        for action in actions:
            if not isinstance(action, Action):
                raise LaunchError(f'An action is expected, and this is {action!r}.')
            if self.rehearsing and not type(action).__module__.startswith('labkit.'):
                continue  # of somebody's own class, which may do anything
            place = getattr(action, 'place', None)
            try:
                self.visit(action.visit(self) or ())
            except LabError as error:
                raise at(error, place) from error
            except RecursionError:
                raise at(too_deep(), place) from None
            except Exception as error:  # a function, or a class, of a launch file
                raise at(raised(error), place) from error

    @property
    def environment(self) -> MutableMapping[str, str]:
        """Environment variables, for `$(env name)` and for processes."""
        return os.environ

    def reset_environment(self) -> None:
        """Go back to the environment variables with which this began."""
        _become(self._first_environment)

    def push_environment(self) -> None:
        """Note the environment variables, for `pop_environment`."""
        self._environments.append(dict(os.environ))

    def pop_environment(self) -> None:
        """Go back to the environment variables that were noted last."""
        if not self._environments:
            raise LaunchError('There is no PushEnvironment before this PopEnvironment.')
        _become(self._environments.pop())

    def push_configurations(self) -> None:
        """Note the launch configurations, for `pop_configurations`."""
        self._configurations.append(self.launch_configurations)
        self.launch_configurations = dict(self.launch_configurations)

    def pop_configurations(self) -> None:
        """Go back to the launch configurations that were noted last."""
        if not self._configurations:
            raise LaunchError(
                'There is no PushLaunchConfigurations before this PopLaunchConfigurations.'
            )
        self.launch_configurations = self._configurations.pop()

    def leave_file(self) -> None:
        """End the visit of the innermost launch file."""
        self.files.pop()

    def rehearsal(self) -> Context:
        """Return a context in which nothing happens."""
        return Context(
            dict(self.launch_configurations),
            files=list(self.files),
            rehearsing=True,
            log_dir=self.log_dir,
            load=self.load,
        )

    @property
    def locals(self) -> SimpleNamespace:
        """What is known here only: the event that is being handled, the launch file."""
        return SimpleNamespace(**self.get_locals_as_dict())

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Return what `locals` has."""
        found = dict(self._locals)
        if self.files:
            found['current_launch_file_path'] = self.files[-1]
            found['current_launch_file_directory'] = os.path.dirname(self.files[-1])
        return found

    def extend_locals(self, extensions: Mapping[str, Any]) -> None:
        """Add to `locals`."""
        self._locals.update(extensions)

    extend_globals = extend_locals

    def clear_locals(self) -> None:
        """Forget what `locals` had for an event."""
        self._locals.clear()

    def register_event_handler(self, handler: BaseEventHandler, append: bool = False) -> None:
        """Let a handler handle events from now on, before the others or after them."""
        handler.files = list(self.files)
        self.handlers.insert(len(self.handlers) if append else 0, handler)

    def unregister_event_handler(self, handler: BaseEventHandler) -> None:
        """Let a handler handle no more events."""
        if handler in self.handlers:
            self.handlers.remove(handler)

    def emit_event_sync(self, event: Any) -> None:
        """Let an event happen."""
        self.events.append(event)

    def perform_substitution(self, substitution: Substitution) -> str:
        """Return the text of a substitution; for functions of a launch file."""
        return substitution.perform(self)


def _become(environment: Mapping[str, str]) -> None:
    os.environ.clear()
    os.environ.update(environment)


def raised(error: BaseException) -> LaunchError:
    """Return what the code of a launch file has raised, with its last line there."""
    places = [
        Place(frame.filename, frame.lineno)
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename in python_files and frame.lineno
    ]
    return LaunchError(f'{type(error).__name__}: {error}', place=places[-1] if places else None)


_NAME = re.compile(r'[A-Za-z_][A-Za-z0-9_]*')


def check_node_name(name: str) -> None:
    """Raise a LaunchError unless a node can have a name."""
    if not _NAME.fullmatch(name):
        raise LaunchError(
            f'{name!r} can not be the name of a node.',
            todo='Use letters, digits and underscores; the namespace has an attribute of its own.',
        )


def check_namespace(namespace: str) -> None:
    """Raise a LaunchError unless a full namespace is valid."""
    if namespace != '/' and not all(map(_NAME.fullmatch, namespace[1:].split('/'))):
        raise LaunchError(
            f'{namespace!r} can not be a namespace.',
            todo='Use names of letters, digits and underscores, with / between them: /robot1/arm',
        )
