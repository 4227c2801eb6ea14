"""Substitutions: `$(var name)` and all others, for all three forms of launch files."""

from __future__ import annotations

import math
import os
import random
import shlex
import shutil
import socket
import subprocess
from collections.abc import Callable, Iterable
from typing import Any, ClassVar

from labkit.errors import did_you_mean, nearest, quoted
from labkit.files import read_limited
from labkit.launching.expressions import evaluate
from labkit.launching.model import (
    Context,
    LaunchError,
    Substitution,
    Text,
    perform,
    pieces,
)
from labkit.launching.parameter_types import coerce
from labkit.rosgraph.packages import executable, prefix_of

__all__ = [
    'REFUSED',
    'WORDS',
    'AllSubstitution',
    'AndSubstitution',
    'AnonName',
    'AnySubstitution',
    'Command',
    'EnvironmentVariable',
    'EqualsSubstitution',
    'ExecutableInPackage',
    'FileContent',
    'FindExecutable',
    'FindPackage',
    'FindPackagePrefix',
    'FindPackageShare',
    'IfElseSubstitution',
    'LaunchConfiguration',
    'LaunchLogDir',
    'LocalSubstitution',
    'NotEqualsSubstitution',
    'NotSubstitution',
    'OrSubstitution',
    'PathJoinSubstitution',
    'PathSubstitution',
    'PythonExpression',
    'ThisLaunchFile',
    'ThisLaunchFileDir',
    'substitution',
]


class _Path(Substitution):
    """A substitution that is a path, to which `/` adds a part."""

    def __truediv__(self, additional_path: Any) -> PathJoinSubstitution:
        return PathJoinSubstitution([self, additional_path])


class LaunchConfiguration(Substitution):
    """`$(var name default)`: the value of an argument, or of `let`."""

    def __init__(self, variable_name: Any, *, default: Any = None) -> None:
        self.variable_name = pieces(variable_name)
        self.default = None if default is None else pieces(_as_text(default))

    def perform(self, context: Context) -> str:
        name = perform(context, self.variable_name)
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self.default is not None:
            return perform(context, self.default)
        known = ', '.join(context.launch_configurations) or 'none'
        raise LaunchError(
            f'launch configuration {name!r} does not exist',
            todo=did_you_mean(name, context.launch_configurations, f'Those known here: {known}.'),
        )


class EnvironmentVariable(Substitution):
    """`$(env NAME default)`: an environment variable of the launch."""

    def __init__(self, name: Any, *, default_value: Any = None) -> None:
        self.name = pieces(name)
        self.default = None if default_value is None else pieces(default_value)

    def perform(self, context: Context) -> str:
        name = perform(context, self.name)
        if name in context.environment:
            return context.environment[name]
        if self.default is None:
            raise LaunchError(
                f'environment variable {name!r} does not exist',
                todo=f'Give a default: $(env {name} something)',
            )
        return perform(context, self.default)


class FindPackage(_Path):
    """A folder of a package; the classes below say which, in `find`."""

    def __init__(self, package: Any) -> None:
        self.package = pieces(package)

    def find(self, package_name: str) -> str:
        """Return the folder."""
        raise NotImplementedError

    def perform(self, context: Context) -> str:
        return self.find(perform(context, self.package))


class FindPackagePrefix(FindPackage):
    """`$(find-pkg-prefix name)`: the folder in which a package is installed."""

    def find(self, package_name: str) -> str:
        return str(prefix_of(package_name))


class FindPackageShare(FindPackage):
    """`$(find-pkg-share name)`: the folder with the shared files of a package."""

    def find(self, package_name: str) -> str:
        return str(prefix_of(package_name) / 'share' / package_name)


class Parameter(Substitution):
    """`$(param name default)`: a parameter that was set for all nodes, by `SetParameter`."""

    def __init__(self, name: Any, *, default: Any = None) -> None:
        self.name = pieces(name)
        self.default = None if default is None else pieces(_as_text(default))

    def perform(self, context: Context) -> str:
        name = perform(context, self.name)
        for one in context.launch_configurations.get('global_params', ()):
            if isinstance(one, tuple) and one[0] == name:
                return str(one[1])
        if self.default is None:
            raise LaunchError(
                f'parameter {name!r} not found', todo=f'Give a default: $(param {name} something)'
            )
        return perform(context, self.default)


class ExecutableInPackage(Substitution):
    """`$(exec-in-pkg executable package)`: the path of a program of a package."""

    def __init__(self, executable: Any, package: Any) -> None:
        self.executable, self.package = pieces(executable), pieces(package)

    def perform(self, context: Context) -> str:
        package, name = perform(context, self.package), perform(context, self.executable)
        return str(executable(package, name).path)


class FindExecutable(Substitution):
    """`$(find-exec name)`: the path of a program of this computer."""

    def __init__(self, *, name: Any) -> None:
        self.name = pieces(name)

    def perform(self, context: Context) -> str:
        name = perform(context, self.name)
        found = shutil.which(name, path=context.environment.get('PATH'))
        if found is None:
            raise LaunchError(f'executable {name!r} not found on the PATH')
        return found


class ThisLaunchFile(Substitution):
    """`$(filename)`: the path of the launch file."""

    def perform(self, context: Context) -> str:
        if not context.files:
            raise LaunchError('There is no launch file here.')
        return context.files[-1]

    def describe(self) -> str:
        return f'{type(self).__name__}()'


class ThisLaunchFileDir(ThisLaunchFile, _Path):
    """`$(dirname)`: the folder of the launch file."""

    def perform(self, context: Context) -> str:
        return os.path.dirname(super().perform(context))


class AnonName(Substitution):
    """`$(anon name)`: a name that is different in each launch, the same for the same name."""

    _names: ClassVar[dict[str, str]] = {}

    def __init__(self, name: Any) -> None:
        self.name = pieces(name)

    def perform(self, context: Context) -> str:
        name = perform(context, self.name)
        if name not in self._names:
            host = ''.join(c if c.isalnum() else '_' for c in socket.gethostname())
            number = random.randrange(2**31)
            self._names[name] = f'{name}_{host}_{os.getpid()}_{number}'
        return self._names[name]


class PythonExpression(Substitution):
    """`$(eval expression)`: the value of an expression, see `expressions`."""

    def __init__(self, expression: Any, python_modules: Any = ('math',)) -> None:
        self.expression = pieces(expression)
        modules = ''.join(part.describe() for part in pieces(python_modules))
        if modules.strip('\'"') not in ('math', ''):
            raise LaunchError(f'$(eval ...) takes no modules here, and this asks for {modules}.')

    def perform(self, context: Context) -> str:
        return evaluate(perform(context, self.expression))


class EqualsSubstitution(Substitution):
    """`$(equals left right)`: `true` or `false`."""

    def __init__(self, left: Any, right: Any) -> None:
        self.left, self.right = pieces(_as_text(left)), pieces(_as_text(right))

    def perform(self, context: Context) -> str:
        left, right = perform(context, self.left), perform(context, self.right)
        bools = {'true': True, '1': True, 'false': False, '0': False}
        if left.lower() in bools and right.lower() in bools:
            return _word(bools[left.lower()] == bools[right.lower()])
        try:
            return _word(math.isclose(float(left), float(right)))
        except ValueError:
            return _word(left == right)


class NotEqualsSubstitution(EqualsSubstitution):
    """`$(not-equals left right)`: `true` or `false`."""

    def perform(self, context: Context) -> str:
        return _word(super().perform(context) == 'false')


class NotSubstitution(Substitution):
    """`$(not value)`: `true` or `false`."""

    def __init__(self, value: Any) -> None:
        self.value = pieces(value)

    def perform(self, context: Context) -> str:
        return _word(not _bool(context, self.value))


class AllSubstitution(Substitution):
    """`$(all value ...)`: whether all are true."""

    def __init__(self, *values: Any) -> None:
        self.values = [pieces(value) for value in values]

    def perform(self, context: Context) -> str:
        return _word(all(_bool(context, value) for value in self.values))


class AnySubstitution(AllSubstitution):
    """`$(any value ...)`: whether one is true."""

    def perform(self, context: Context) -> str:
        return _word(any(_bool(context, value) for value in self.values))


class AndSubstitution(AllSubstitution):
    """`$(and left right)`: whether both are true."""

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """`$(or left right)`: whether one is true."""

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(left, right)


class IfElseSubstitution(Substitution):
    """`$(if condition value other)`: one of two texts."""

    def __init__(self, condition: Any, if_value: Any = '', else_value: Any = '') -> None:
        if '' == if_value == else_value:
            raise LaunchError('IfElseSubstitution has neither if_value nor else_value.')
        self.condition = pieces(condition)
        self.if_value, self.else_value = pieces(if_value), pieces(else_value)

    def perform(self, context: Context) -> str:
        chosen = self.if_value if _bool(context, self.condition) else self.else_value
        return perform(context, chosen)


class FileContent(Substitution):
    """`$(file-content path)`: the text of a file."""

    def __init__(self, path: Any) -> None:
        self.path = pieces(path)

    def perform(self, context: Context) -> str:
        path = perform(context, self.path)
        try:
            return read_limited(path).decode()
        except (OSError, UnicodeDecodeError) as error:
            raise LaunchError(f'{path} can not be read: {error}') from error


class Command(Substitution):
    """`$(command words on_stderr)`: what a program prints.

    Args:
        command: The words of its command line; no shell reads them.
        on_stderr: What to do if it writes to standard error: `fail`, `warn`, `ignore`, or
            `capture` that too.
    """

    def __init__(self, command: Any, *, on_stderr: Any = 'fail') -> None:
        self.command, self.on_stderr = pieces(command), pieces(on_stderr)

    def perform(self, context: Context) -> str:
        line, on_stderr = perform(context, self.command), perform(context, self.on_stderr)
        known = ('fail', 'ignore', 'warn', 'capture')
        if on_stderr not in known:
            raise LaunchError(
                f'on_stderr is one of {", ".join(known)}, and this is {on_stderr!r}.'
            )
        if context.rehearsing:
            return ''
        to = subprocess.STDOUT if on_stderr == 'capture' else subprocess.PIPE
        try:
            words = shlex.split(line)
            done = subprocess.run(words, stdout=subprocess.PIPE, stderr=to, text=True, check=False)
        except (OSError, ValueError) as error:
            raise LaunchError(f'The command {quoted(line)} can not be run: {error}') from error
        if done.returncode != 0:
            raise LaunchError(
                f'The command {quoted(line)} has failed: exit code {done.returncode}.',
                todo=(done.stderr or '').strip(),
            )
        if done.stderr and on_stderr == 'fail':
            raise LaunchError(
                f'The command {quoted(line)} has written to standard error: {done.stderr.strip()}',
                todo="If that is no failure: on_stderr='warn'",
            )
        if done.stderr and on_stderr == 'warn':
            context.say('WARNING', 'launch', f'{line} writes: {done.stderr.strip()}')
        return done.stdout


class PathJoinSubstitution(_Path):
    """Parts of a path, joined by `/`; each part is a text, which may be of several pieces."""

    def __init__(self, substitutions: Iterable[Any]) -> None:
        self.substitutions = [pieces(part) for part in substitutions]

    def perform(self, context: Context) -> str:
        return os.path.join(*(perform(context, part) for part in self.substitutions))


class PathSubstitution(PathJoinSubstitution):
    """A path; of several texts each is a part."""

    def __init__(self, path: Any) -> None:
        super().__init__(pieces(path))


class LocalSubstitution(Substitution):
    """What the event that is being handled says: `LocalSubstitution('event.reason')`."""

    def __init__(self, expression: str, description: str = '') -> None:
        self.expression = expression

    def perform(self, context: Context) -> str:
        if context.rehearsing:
            return ''
        value: Any = context.locals
        for part in self.expression.split('.'):
            if part.startswith('_') or not hasattr(value, part):
                raise LaunchError(f'There is no {self.expression!r} here.')
            value = getattr(value, part)
        return str(value)


class LaunchLogDir(_Path):
    """`$(log_dir)`: the folder of this launch's log file."""

    def perform(self, context: Context) -> str:
        return context.log_dir

    def describe(self) -> str:
        return 'LaunchLogDir()'


# Word -> how to make it, and how many arguments it takes.
WORDS: dict[str, tuple[Callable[..., Substitution], range]] = {
    'all': (AllSubstitution, range(1, 100)),
    'and': (AndSubstitution, range(2, 3)),
    'anon': (AnonName, range(1, 2)),
    'any': (AnySubstitution, range(1, 100)),
    'command': (
        lambda line, *rest: Command(line, on_stderr=_first(rest) or 'fail'),
        range(1, 3),
    ),
    'dirname': (ThisLaunchFileDir, range(1)),
    'env': (
        lambda name, *rest: EnvironmentVariable(name, default_value=_first(rest)),
        range(1, 3),
    ),
    'equals': (EqualsSubstitution, range(2, 3)),
    'eval': (PythonExpression, range(1, 3)),
    'exec-in-pkg': (ExecutableInPackage, range(2, 3)),
    'file-content': (FileContent, range(1, 2)),
    'filename': (ThisLaunchFile, range(1)),
    'find-exec': (lambda name: FindExecutable(name=name), range(1, 2)),
    'find-pkg-prefix': (FindPackagePrefix, range(1, 2)),
    'find-pkg-share': (FindPackageShare, range(1, 2)),
    'if': (IfElseSubstitution, range(2, 4)),
    'launch_log_dir': (LaunchLogDir, range(1)),
    'log_dir': (LaunchLogDir, range(1)),
    'not': (NotSubstitution, range(1, 2)),
    'not-equals': (NotEqualsSubstitution, range(2, 3)),
    'or': (OrSubstitution, range(2, 3)),
    'param': (lambda name, *rest: Parameter(name, default=_first(rest)), range(1, 3)),
    'var': (lambda name, *rest: LaunchConfiguration(name, default=_first(rest)), range(1, 3)),
}
# Those of the real one that this course leaves out, and why.
REFUSED = {
    # ROS 1.
    'arg': 'that is ROS 1; ROS 2 writes $(var name)',
    'find': 'that is ROS 1; ROS 2 writes $(find-pkg-share package)',
    'optenv': 'that is ROS 1; ROS 2 writes $(env NAME default)',
}


def substitution(word: str, arguments: list[Text]) -> Substitution:
    """Return `$(word argument ...)`.

    Raises:
        LaunchError: There is none of that name, or it takes other arguments.
    """
    if word in REFUSED:
        raise LaunchError(f'$({word} ...) is not supported here: {REFUSED[word]}.')
    if word not in WORDS:
        near = nearest(word, WORDS)
        raise LaunchError(
            f'There is no substitution $({word}).',
            todo=f'Did you mean $({near})?' if near else f'There are: {", ".join(WORDS)}.',
        )
    make, counts = WORDS[word]
    if len(arguments) not in counts:
        most = f' to {counts[-1]}' if len(counts) > 1 else ''
        raise LaunchError(
            f'$({word} ...) takes {counts[0]}{most} argument{"s" * (counts[-1] != 1)}, and has '
            f'{len(arguments)}.',
            todo="Several words are one argument in quotation marks: $(eval '1 + 2')",
        )
    return make(*arguments)


def _first(rest: tuple[Text, ...]) -> Text | None:
    return rest[0] if rest else None


def _as_text(value: Any) -> Any:
    """Return numbers and truth values as the texts that the real one makes of them."""
    if isinstance(value, (bool, int, float)):
        return str(value)
    return [_as_text(one) for one in value] if isinstance(value, (list, tuple)) else value


def _word(value: bool) -> str:
    return 'true' if value else 'false'


def _bool(context: Context, text: Text) -> bool:
    value = coerce(perform(context, text), 'bool')
    assert isinstance(value, bool)
    return value
