"""The actions of the package `launch_ros`: nodes, and what holds for the nodes that follow."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import yaml

from labkit.files import read_limited
from labkit.launching.actions import TimerAction, setting
from labkit.launching.execute import ExecuteProcess, Written
from labkit.launching.model import (
    Action,
    Context,
    LaunchError,
    Substitution,
    Text,
    check_namespace,
    check_node_name,
    perform,
    pieces,
    placed,
)
from labkit.launching.parameter_types import SCALARS, coerce, is_value
from labkit.launching.templates import template
from labkit.rosgraph.packages import executable
from labkit.rosgraph.parameter_files import is_meant, sections_in
from labkit.rosgraph.yaml_loading import load_yaml

__all__ = [
    'Node',
    'Parameter',
    'ParameterFile',
    'ParameterValue',
    'PushROSNamespace',
    'ROSTimer',
    'SetParameter',
    'SetParametersFromFile',
    'SetROSLogDir',
    'SetRemap',
    'SetUseSimTime',
]


class ParameterValue:
    """A value of a parameter, of a type or by the rules of YAML."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value = value
        self.kind = value_type if isinstance(value_type, str) else kind_of(value_type)

    def evaluate(self, context: Context) -> Any:
        """Return the value."""
        value = self.value
        if is_text(value):
            return coerce(perform(context, pieces(value)), self.kind)
        if isinstance(value, list):
            item = self.kind.removeprefix('list_of_') if self.kind else ''
            value = [
                coerce(perform(context, pieces(one)), item) if is_text(one) else one
                for one in value
            ]
        if not is_value(value, self.kind):
            name = self.kind or 'parameters'
            raise LaunchError(f'{value!r} is no value of the type {name}.')
        return value


class Parameter(ParameterValue):
    """A parameter: name and value."""

    def __init__(self, name: Any, value: Any, *, value_type: Any = None) -> None:
        super().__init__(value, value_type=value_type)
        self.name = pieces(name)


class ParameterFile:
    """A file of parameters; with `allow_substs`, `$(...)` in it is replaced."""

    def __init__(self, param_file: Any, *, allow_substs: Any = False) -> None:
        self.path = pieces(param_file)
        self.allow_substs = allow_substs

    def word(self, context: Context, node: str) -> str | Written:
        """Return the path, or what is to be written.

        Args:
            context: The context.
            node: Full name of the node, `''` if it is not known.
        """
        path = perform(context, self.path)
        text = _read(path)
        if setting(context, self.allow_substs, 'bool'):
            text = perform(context, template(text))
        keys = _keys(text, path)
        if node and not any(is_meant(key, node) for key in keys):
            named = ', '.join(keys) or 'no node'
            context.say(
                'WARNING',
                'launch',
                f'{path} has parameters for {named}, and none for {node}: the node starts '
                'without them',
            )
        return Written(text) if setting(context, self.allow_substs, 'bool') else path


class Node(ExecuteProcess):
    """Start a node: `<node>`.

    Args:
        executable: The program in the package, or a path without a package.
        package: The package.
        name: The name of the node; by default that in its code.
        namespace: Its namespace, within that of `PushROSNamespace`.
        exec_name: What its output is marked with.
        parameters: Files and dictionaries of parameters; later ones win.
        remappings: Pairs: what a name in the code is to be.
        ros_arguments: Words after `--ros-args`.
        arguments: Words for the program.
    """

    is_node = True

    def __init__(
        self,
        *,
        executable: Any,
        package: Any = None,
        name: Any = None,
        namespace: Any = None,
        exec_name: Any = None,
        parameters: list[Any] | None = None,
        remappings: Iterable[tuple[Any, Any]] | None = None,
        ros_arguments: list[Any] | None = None,
        arguments: Iterable[Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(cmd=[], name=exec_name, **options)
        if not isinstance(ros_arguments or [], list):
            raise LaunchError('ros_arguments is a list of texts.', place=self.place)
        self.node_executable, self.node_package = executable, package
        self._executable = pieces(executable)
        self._package = None if package is None else pieces(package)
        self._name = None if name is None else pieces(name)
        self._namespace = None if namespace is None else pieces(namespace)
        self._full_name = ''
        self.parameters = _parameters(parameters or [], self)
        self.remappings = [self._pair(one) for one in remappings or ()]
        self.ros_arguments = [pieces(word) for word in ros_arguments or ()]
        self.arguments = [pieces(word) for word in arguments or ()]

    @property
    def node_name(self) -> str:
        """Its full name, once it was started."""
        if not self._executed:
            raise LaunchError("cannot access 'node_name' before executing action", place=placed())
        return self._full_name

    def _pair(self, given: Any) -> tuple[Text, Text]:
        if not isinstance(given, tuple) or len(given) != 2:
            raise LaunchError(
                f'remappings are pairs of texts, and one is {given!r}.',
                todo="remappings=[('old', 'new'), ...], with round brackets",
                place=self.place,
            )
        return pieces(given[0]), pieces(given[1])

    def words(self, context: Context) -> tuple[str, list[str | Written]]:
        namespace = joined_namespace(
            context.launch_configurations.get('ros_namespace'),
            None if self._namespace is None else perform(context, self._namespace),
        )
        name = '' if self._name is None else perform(context, self._name)
        if self._name is not None:
            check_node_name(name)
        full = f'{namespace or "/"}/{name}'.replace('//', '/') if name else ''
        self._full_name = full
        # A node without a namespace of its own may be in any that its program is given.
        key = full if namespace is not None and name else '/**'
        program, command = self._program(context)
        command += [perform(context, word) for word in self.arguments]
        if self.ros_arguments:
            command += ['--ros-args', *(perform(context, word) for word in self.ros_arguments)]
        command += ['--ros-args']
        if name:
            command += ['-r', f'__node:={name}']
        if namespace is not None:
            check_namespace(namespace)
            command += ['-r', f'__ns:={namespace}']
        command += self._parameter_words(context, full, key)
        remaps = [
            *context.launch_configurations.get('ros_remaps', ()),
            *((perform(context, old), perform(context, new)) for old, new in self.remappings),
        ]
        for old, new in remaps:
            command += ['-r', f'{old}:={new}']
        self._note_name(context, full if namespace is not None else '')
        return program, command

    def _program(self, context: Context) -> tuple[str, list[str | Written]]:
        """Return the name of the program, and how to start it."""
        name = perform(context, self._executable)
        if self._package is None:
            return os.path.basename(name), [name]
        found = executable(perform(context, self._package), name)
        return name, list(found.command)

    def _parameter_words(self, context: Context, full: str, key: str) -> Iterable[str | Written]:
        words: list[str | Written] = []
        for one in context.launch_configurations.get('global_params', ()):
            if isinstance(one, tuple):
                words += ['-p', f'{one[0]}:={one[1]}']
            else:
                words += ['--params-file', one.word(context, full)]
        for parameter in self.parameters:
            if isinstance(parameter, ParameterFile):
                words += ['--params-file', parameter.word(context, full)]
            elif isinstance(parameter, Parameter):
                value = _flow(parameter.evaluate(context))
                words += ['-p', f'{perform(context, parameter.name)}:={value}']
            else:
                values = dict(_evaluated(context, parameter))
                tree = {key: {'ros__parameters': values}}
                text = yaml.safe_dump(tree, default_flow_style=False)
                words += ['--params-file', Written(text)]
        return words

    def _note_name(self, context: Context, full: str) -> None:
        if not full:
            return
        context.node_names.append(full)
        count = context.node_names.count(full)
        if count > 1:
            context.say(
                'WARNING',
                'launch',
                f'there are now at least {count} nodes with the name {full} created within this '
                'launch context',
            )

    def describe(self) -> str:
        shown = {'package': self._package, 'executable': self._executable, 'name': self._name}
        words = [
            f'{word}={"".join(part.describe() for part in text)}'
            for word, text in shown.items()
            if text is not None
        ]
        return f'{type(self).__name__}({", ".join(words)})'


def joined_namespace(base: str | None, namespace: str | None) -> str | None:
    """Return a namespace within another one, absolute; None if there is none."""
    if namespace is None:
        whole = base
    elif not base or namespace.startswith('/'):
        whole = namespace
    else:
        whole = f'{base.rstrip("/")}/{namespace}'
    if whole is None:
        return None
    whole = whole if whole == '/' else whole.rstrip('/')
    return whole if whole.startswith('/') else f'/{whole}'


class PushROSNamespace(Action):
    """Put the nodes that follow into a namespace: `<push_ros_namespace>`."""

    def __init__(self, namespace: Any, **options: Any) -> None:
        super().__init__(**options)
        self.namespace = pieces(namespace)

    def execute(self, context: Context) -> None:
        pushed = perform(context, self.namespace)
        namespace = joined_namespace(context.launch_configurations.get('ros_namespace'), pushed)
        assert namespace is not None
        check_namespace(namespace)
        context.launch_configurations['ros_namespace'] = namespace


class SetParameter(Action):
    """Give the nodes that follow a parameter: `<set_parameter>`."""

    def __init__(self, name: Any, value: Any, **options: Any) -> None:
        super().__init__(**options)
        self._values = {tuple(pieces(name)): value}

    def execute(self, context: Context) -> None:
        for name, value in _evaluated(context, self._values):
            # As the real one has it: as Python writes it, a list as a tuple.
            kept = tuple(value) if isinstance(value, list) else value
            _add(context, 'global_params', (name, kept))


class SetParametersFromFile(Action):
    """Give the nodes that follow the parameters of a file: `<set_parameters_from_file>`."""

    def __init__(self, filename: Any, **options: Any) -> None:
        super().__init__(**options)
        self.file = ParameterFile(filename)

    def execute(self, context: Context) -> None:
        path = os.path.abspath(perform(context, self.file.path))
        _keys(_read(path), path)
        _add(context, 'global_params', ParameterFile(path))


class SetRemap(Action):
    """Give the nodes that follow a remapping: `<set_remap>`."""

    def __init__(self, src: Any, dst: Any, **options: Any) -> None:
        super().__init__(**options)
        self.src, self.dst = pieces(src), pieces(dst)

    def execute(self, context: Context) -> None:
        _add(context, 'ros_remaps', (perform(context, self.src), perform(context, self.dst)))


class SetROSLogDir(Action):
    """Set where programs that follow write their log files; within the folder until now."""

    def __init__(self, new_log_dir: Any, **options: Any) -> None:
        super().__init__(**options)
        self.log_dir = pieces(new_log_dir)

    def execute(self, context: Context) -> None:
        home = context.environment.get('ROS_HOME') or os.path.expanduser('~/.ros')
        folder = context.environment.get('ROS_LOG_DIR') or os.path.join(home, 'log')
        new = perform(context, self.log_dir)
        context.environment['ROS_LOG_DIR'] = os.path.join(folder, new)


class SetUseSimTime(Action):
    """Let `ROSTimer` go by the time of a simulator."""

    def __init__(self, value: bool, **options: Any) -> None:
        super().__init__(**options)
        self.value = value

    def execute(self, context: Context) -> None:
        if self.value is not True:
            raise LaunchError('SetUseSimTime takes True.')
        context.uses_sim_time = True


class ROSTimer(TimerAction):
    """Visit actions after a time of ROS, which here is that of the clock: `<ros_timer>`."""

    def execute(self, context: Context) -> None:
        if context.uses_sim_time:
            raise LaunchError(
                'A ROSTimer that goes by the time of a simulator is not supported here.',
                todo='Take TimerAction, or leave SetUseSimTime out.',
            )
        super().execute(context)


def _add(context: Context, name: str, *values: Any) -> None:
    held = context.launch_configurations
    held[name] = (*held.get(name, ()), *values)


def is_text(value: Any) -> bool:
    """Return whether a value is made of substitutions, so that it is known only later."""
    if isinstance(value, (list, tuple)):
        parts = [isinstance(one, Substitution) for one in value]
        return any(parts) and all(isinstance(one, (str, Substitution)) for one in value)
    return isinstance(value, Substitution)


def kind_of(value_type: Any) -> str:
    """Return the name of a type of parameters, `''` of None."""
    if value_type is None:
        return ''
    name = getattr(value_type, '__name__', '')
    if name in SCALARS and value_type is SCALARS[name]:
        return name
    items = getattr(value_type, '__args__', ())
    if items and getattr(value_type, '__origin__', None) is list:
        return f'list_of_{kind_of(items[0])}'
    raise LaunchError(f'{value_type!r} is no type of a parameter.')


def _parameters(given: Any, node: Action) -> list[Any]:
    if not isinstance(given, list):
        items = list(given) if isinstance(given, tuple) else [given]
        raise LaunchError(
            'parameters is a list of dictionaries and files.',
            todo=f'parameters={items!r}',
            place=node.place,
        )
    known = (ParameterFile, Parameter, Mapping)
    return [one if isinstance(one, known) else ParameterFile(one) for one in given]


def _evaluated(context: Context, values: Mapping[Any, Any], start: str = '') -> Iterable[Any]:
    """Yield name and value of each parameter; dots join the names of groups."""
    for key, value in values.items():
        name = start + perform(context, pieces(key))
        try:
            if isinstance(value, Mapping):
                yield from _evaluated(context, value, f'{name}.')
            elif isinstance(value, ParameterValue):
                yield name, value.evaluate(context)
            elif isinstance(value, (list, tuple)) and not is_text(value):
                yield name, _list(context, value)
            else:
                yield name, ParameterValue(value).evaluate(context)
        except LaunchError as error:
            raise LaunchError(
                f'parameter {name}: {error.plain}', todo=error.todo, place=error.place
            ) from error


def _list(context: Context, values: Sequence[Any]) -> list[Any]:
    """Return a list as the value of a parameter: whole numbers among others become others."""
    found: list[Any] = [
        coerce(perform(context, pieces(one))) if isinstance(one, (list, tuple)) else one
        for one in values
    ]
    if {type(one) for one in found} == {int, float}:
        found = [float(one) for one in found]
    if not found or not is_value(found):
        raise LaunchError(
            f'{found!r} is no value of a parameter.',
            todo='A list has one or more items, all of one type: numbers, true and false, texts.',
        )
    return found


def _flow(value: Any) -> str:
    """Return a value as YAML in one line."""
    text: str = yaml.safe_dump(value, default_flow_style=True, width=10**6)
    return text.strip().removesuffix('...').strip()


def _read(path: str) -> str:
    try:
        return read_limited(path).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise LaunchError(
            f'The file of parameters {path} can not be read: {reason}.',
            todo='A file beside the launch file is found by $(dirname)/, one of a package by '
            '$(find-pkg-share package)/config/',
        ) from error


def _keys(text: str, path: str) -> list[str]:
    """Return the names of the nodes in a file of parameters.

    Raises:
        LaunchError: It is no such file.
    """
    try:
        tree = load_yaml(text)
    except ValueError as error:
        raise LaunchError(f'{path} is no file of parameters: {error}.') from error
    sections = sections_in(tree) if isinstance(tree, Mapping) else ()
    found = [name for name, values in sections if values is not None]
    if not found:
        raise LaunchError(
            f'{path} is no file of parameters: it has no key ros__parameters below the name of '
            'a node.',
            todo='Such a file begins with the name of a node, or /**, and below it, with two '
            'spaces before it, ros__parameters:',
        )
    return found
