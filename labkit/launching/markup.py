"""Launch files in XML and YAML: the same entities, and the actions that they stand for."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import yaml

from labkit.errors import LabError, did_you_mean, nearest
from labkit.launching import actions, execute, ros_actions
from labkit.launching.conditions import IfCondition, UnlessCondition
from labkit.launching.lifecycle_nodes import LifecycleNode
from labkit.launching.model import (
    Action,
    LaunchDescription,
    LaunchError,
    Place,
    Text,
    TextSubstitution,
    at,
)
from labkit.launching.parameter_types import coerce, is_value, type_named
from labkit.launching.templates import template, unescaped
from labkit.rosgraph.xml_loading import Element, XmlError, load_xml
from labkit.rosgraph.yaml_loading import load_yaml

__all__ = ['from_xml', 'from_yaml']

# Nested tags that are a part of their action, and not an action in it.
_PARTS = {
    'arg': ('choice',),
    'group': ('keep',),
    'include': ('arg', 'let'),
    'executable': ('env',),
    'node': ('env', 'param', 'remap'),
    'lifecycle_node': ('env', 'param', 'remap'),
    'param': ('param',),
    'reset': ('keep',),
}
# Attributes of ROS 1, and what ROS 2 writes.
_OF_ROS_1 = {
    'node': {
        'ns': 'ROS 2 writes it as namespace="...".',
        'type': 'ROS 2 writes the program as exec="..."',
        'required': 'ROS 2 writes on_exit="shutdown".',
    },
    'group': {'ns': 'ROS 2 writes <push_ros_namespace namespace="..."/> in the group.'},
    'include': {
        'ns': 'ROS 2 writes <push_ros_namespace namespace="..."/> in a <group> around it.'
    },
}
# Tags with actions in them.
_WITH_ACTIONS = ('launch', 'group', 'ros_timer', 'timer')
# Numbers that YAML has to write with a point.
_FLOATS = ('period', 'respawn_delay', 'sigkill_timeout', 'sigterm_timeout')
_COMPONENTS = 'nodes that share a process are in C++; take a <node> for each, if it has a program'
_REFUSED = {
    'node_container': _COMPONENTS,
    'composable_node': _COMPONENTS,
    'composable_lifecycle_node': _COMPONENTS,
    'load_composable_node': _COMPONENTS,
    'set_use_sim_time': 'take <set_parameter name="use_sim_time" value="true"/>',
    # ROS 1.
    'rosparam': 'that is ROS 1; ROS 2 writes <param from="file.yaml"/> in a <node>',
    'machine': 'that is ROS 1; ROS 2 starts nodes on its own computer',
    'test': 'that is ROS 1; ROS 2 has launch_testing',
}


@dataclass
class Entity:
    """An element of XML, or a mapping of YAML.

    Attributes:
        tag: Its name.
        values: Attributes that are texts, numbers, truth values or lists.
        parts: Nested entities.
        typed: Whether values have types, as in YAML; in XML all are texts.
    """

    tag: str
    place: Place
    values: dict[str, Any] = field(default_factory=dict)
    parts: list[Entity] = field(default_factory=list)
    typed: bool = False
    _asked: set[str] = field(default_factory=set)

    def has(self, name: str) -> bool:
        """Return whether it has an attribute."""
        self._asked.add(name)
        return name in self.values

    def text(self, name: str) -> str:
        """Return an attribute as a text.

        Raises:
            LaunchError: It is missing, or is no text.
        """
        if not self.has(name):
            raise self.wrong(f'has no {name!r}, and needs one')
        value = self.values[name]
        if not isinstance(value, str):
            shown = 'true' if value is True else 'false' if value is False else value
            raise self.wrong(
                f'has {name}: {shown}, and a text is needed',
                todo=f"In YAML a text of this kind has quotation marks: {name}: '{shown}'",
            )
        return value

    def pieces(self, name: str) -> Text:
        """Return an attribute as a text with substitutions."""
        return template(self.text(name))

    def plain(self, name: str) -> str:
        """Return an attribute that takes no substitutions."""
        return unescaped(self.text(name))

    def setting(self, name: str) -> Any:
        """Return an attribute that is a number or a truth value."""
        if not self.has(name) or isinstance(self.values[name], str):
            return self.pieces(name)
        value = self.values[name]
        if name in _FLOATS and not isinstance(value, float):
            raise self.wrong(
                f'has {name}: {value}, and a float is needed', todo=f'{name}: {value}.0'
            )
        return value

    def named(self, tag: str) -> list[Entity]:
        """Return the nested entities with a tag."""
        self._asked.add(tag)
        return [part for part in self.parts if part.tag == tag]

    def finish(self) -> None:
        """Raise a LaunchError if it has something that nobody has asked for."""
        parts = {part.tag for part in self.parts}
        inner = parts if self.tag in _WITH_ACTIONS else set[str]()
        left = [*self.values, *(tag for tag in parts if tag not in inner)]
        wrong = next((name for name in left if name not in self._asked), None)
        if wrong is None:
            return
        place = next((part.place for part in self.parts if part.tag == wrong), self.place)
        known = ', '.join(sorted(name for name in self._asked if not name.endswith('-sep')))
        raise LaunchError(
            f'{self.shown} has no {wrong!r}.',
            todo=did_you_mean(wrong, self._asked, f'It may have: {known or "nothing"}.'),
            place=place,
        )

    def wrong(self, what: str, *, todo: str = '') -> LaunchError:
        """Return an error about it."""
        return LaunchError(f'{self.shown} {what}.', todo=todo, place=self.place)

    @contextlib.contextmanager
    def located(self) -> Iterator[None]:
        """Give errors without a place the place of this entity."""
        try:
            yield
        except LabError as error:
            raise at(error, self.place) from error

    @property
    def shown(self) -> str:
        """Its name as it stands in the file."""
        return f'{self.tag}:' if self.typed else f'<{self.tag}>'


def from_xml(text: str, path: str) -> LaunchDescription:
    """Return the description in a text of XML.

    Raises:
        LaunchError: It is no XML, or says something that is unknown.
    """
    try:
        root = load_xml(text)
    except XmlError as error:
        raise LaunchError(
            f'This is no XML: {error}.',
            todo='Each tag ends with /> or has an end tag, and in a value & is written &amp;, '
            '< is written &lt;.',
            place=Place(path, error.line),
        ) from error
    return _description(_of_element(root, path))


def _of_element(element: Element, path: str) -> Entity:
    return Entity(
        element.tag,
        Place(path, element.line),
        element.attributes,
        [_of_element(child, path) for child in element.children],
    )


class _Located(dict[Any, Any]):
    """A mapping of YAML, and the line in which it begins."""

    line = 0


class _Loader(yaml.SafeLoader):
    """The safe loader, with the lines of mappings."""


def _mapping(loader: _Loader, node: yaml.MappingNode) -> _Located:
    found = _Located(loader.construct_mapping(node, deep=True))
    found.line = node.start_mark.line + 1
    return found


_Loader.add_constructor('tag:yaml.org,2002:map', _mapping)


def from_yaml(text: str, path: str) -> LaunchDescription:
    """Return the description in a text of YAML.

    Raises:
        LaunchError: It is no YAML, or says something that is unknown.
    """
    try:
        tree = load_yaml(text, _Loader)
    except ValueError as error:
        mark = getattr(error.__cause__, 'problem_mark', None)
        raise LaunchError(
            f'This is no YAML: {error}.',
            todo='Each level is two spaces further in, never a tab, and a text with a colon or '
            'braces in it has quotation marks.',
            place=Place(path, mark.line + 1 if mark is not None else 1),
        ) from error
    if not isinstance(tree, _Located) or len(tree) != 1:
        raise LaunchError(
            'A launch file in YAML has one key at its beginning, launch:', place=Place(path, 1)
        )
    ((tag, content),) = tree.items()
    return _description(_entity(str(tag), content, Place(path, tree.line)))


def _entity(tag: str, content: Any, place: Place) -> Entity:
    """Return the entity of a key and its content in YAML."""
    entity = Entity(tag, place, typed=True)
    if isinstance(content, _Located):
        entity.place = Place(place.file, content.line)
        if tag in _WITH_ACTIONS and 'children' not in content:
            raise entity.wrong("has no 'children', the list of what is in it")
        for name, value in content.items():
            if name == 'children':
                entity.parts += _children(entity, value)
            elif isinstance(value, list) and value and isinstance(value[0], Mapping):
                entity.parts += [_entity(str(name), one, entity.place) for one in value]
            else:
                entity.values[str(name)] = value
    elif tag in _WITH_ACTIONS:
        entity.parts += _children(entity, content)
    elif content is not None:
        raise entity.wrong(f'takes names with values, and this is {content!r}')
    return entity


def _children(entity: Entity, content: Any) -> Iterable[Entity]:
    if not isinstance(content, list):
        raise entity.wrong(
            'takes a list of actions', todo='Each begins with a hyphen: - node: {pkg: ..., ...}'
        )
    for one in content:
        if not isinstance(one, _Located) or len(one) != 1:
            raise entity.wrong(
                f'has {one!r} in its list, and each item is one name and what belongs to it',
                todo='What belongs to it stands four spaces further in than the hyphen.',
            )
        ((tag, inner),) = one.items()
        yield _entity(str(tag), inner, Place(entity.place.file, one.line))


def _description(root: Entity) -> LaunchDescription:
    if root.tag != 'launch':
        raise root.wrong('is at the beginning, and launch is expected')
    root.has('version')
    root.has('deprecated')
    found = LaunchDescription(_actions(root))
    root.finish()
    found.place = root.place
    return found


def _actions(entity: Entity) -> list[Action]:
    parts = _PARTS.get(entity.tag, ()) if entity.tag != 'launch' else ()
    return [_action(part) for part in entity.parts if part.tag not in parts]


def _action(entity: Entity) -> Action:
    """Return the action of an entity.

    Raises:
        LaunchError: It is unknown, or has something wrong, with its place.
    """
    tag = entity.tag.replace('push-ros-namespace', 'push_ros_namespace')
    if tag in _REFUSED:
        raise entity.wrong(f'is not supported here: {_REFUSED[tag]}')
    if tag not in _BUILDERS:
        near = nearest(tag, _BUILDERS)
        parents = [parent for parent, names in _PARTS.items() if tag in names]
        todo = f'Did you mean {near}?' if near else f'There are: {", ".join(_BUILDERS)}.'
        if parents:
            todo = f'It belongs into {" or ".join(parents)}.'
        raise entity.wrong('is no action', todo=todo)
    for name, todo in _OF_ROS_1.get(tag, {}).items():
        if name in entity.values:
            raise entity.wrong(f'has {name!r}, which is ROS 1', todo=todo)
    with entity.located():
        condition = _condition(entity)
        action = _BUILDERS[tag](entity)
        action.condition = condition
        entity.finish()
    action.place = entity.place
    return action


def _condition(entity: Entity) -> IfCondition | None:
    wanted, unwanted = entity.has('if'), entity.has('unless')
    if wanted and unwanted:
        raise entity.wrong('has if and unless; it takes one of them')
    if wanted:
        return IfCondition(entity.pieces('if'))
    return UnlessCondition(entity.pieces('unless')) if unwanted else None


def _given(entity: Entity, **names: str) -> dict[str, Any]:
    """Return the texts that an entity has: argument of the action -> attribute."""
    return {argument: entity.pieces(name) for argument, name in names.items() if entity.has(name)}


def _settings(entity: Entity, *names: str) -> dict[str, Any]:
    return {name: entity.setting(name) for name in names if entity.has(name)}


def _pairs(entity: Entity, tag: str, first: str = 'name', second: str = 'value') -> list[Any]:
    found = []
    for part in entity.named(tag):
        with part.located():
            found.append((tuple(part.pieces(first)), part.pieces(second)))
            part.finish()
    return found


def _arg(entity: Entity) -> Action:
    choices = [choice.plain('value') for choice in entity.named('choice')]
    for choice in entity.named('choice'):
        choice.finish()
    return actions.DeclareLaunchArgument(
        entity.plain('name'),
        description=entity.plain('description') if entity.has('description') else None,
        choices=choices or None,
        **_given(entity, default_value='default'),
    )


def _group(entity: Entity) -> Action:
    options = {name: _flag(entity, name) for name in ('scoped', 'forwarding') if entity.has(name)}
    return actions.GroupAction(
        _actions(entity), launch_configurations=dict(_pairs(entity, 'keep')), **options
    )


def _flag(entity: Entity, name: str) -> bool:
    value = entity.values[name]
    if isinstance(value, str):
        value = coerce(value, 'bool')
    if not isinstance(value, bool):
        raise entity.wrong(f'has {name} {value!r}; it is true or false')
    return value


def _include(entity: Entity) -> Action:
    return actions.IncludeLaunchDescription(
        actions.Source(entity.pieces('file')),
        launch_arguments=[*_pairs(entity, 'arg'), *_pairs(entity, 'let')],
    )


def _ros_timer(entity: Entity) -> Action:
    return ros_actions.ROSTimer(period=entity.setting('period'), actions=_actions(entity))


def _timer(entity: Entity) -> Action:
    return actions.TimerAction(
        period=entity.setting('period'),
        actions=_actions(entity),
        **_settings(entity, 'cancel_on_shutdown'),
    )


def _process(entity: Entity) -> dict[str, Any]:
    """Return what programs and nodes have in common."""
    options = _given(entity, output='output', cwd='cwd', respawn='respawn', prefix='launch-prefix')
    options |= _settings(
        entity,
        *('respawn_delay', 'respawn_max_retries', 'sigkill_timeout', 'sigterm_timeout'),
        *('shell', 'emulate_tty'),
    )
    if entity.has('on_exit'):
        if entity.text('on_exit') != 'shutdown':
            raise entity.wrong(f'has on_exit {entity.text("on_exit")!r}; it may be shutdown')
        options['on_exit'] = [actions.Shutdown()]
    env = _pairs(entity, 'env')
    return options | ({'additional_env': dict(env)} if env else {})


def _executable(entity: Entity) -> Action:
    return execute.ExecuteProcess(
        cmd=_command_line(entity.pieces('cmd')), **_given(entity, name='name'), **_process(entity)
    )


def _node(entity: Entity, make: Callable[..., Action] = ros_actions.Node) -> Action:
    names = {'name': 'name', 'namespace': 'namespace', 'package': 'pkg', 'exec_name': 'exec_name'}
    options = _given(entity, **names) | _process(entity)
    for argument, name in (('arguments', 'args'), ('ros_arguments', 'ros_args')):
        if entity.has(name):
            options[argument] = _command_line(entity.pieces(name))
    return make(
        executable=entity.pieces('exec'),
        parameters=[_parameter(part) for part in entity.named('param')],
        remappings=_pairs(entity, 'remap', 'from', 'to'),
        **options,
    )


def _lifecycle_node(entity: Entity) -> Action:
    for name in ('name', 'namespace'):
        entity.text(name)
    return _node(entity, partial(LifecycleNode, **_settings(entity, 'autostart')))


def _parameter(entity: Entity) -> Any:
    """Return a file of parameters, or a dictionary with one parameter."""
    named = entity.has('name')
    if entity.has('from'):
        if named:
            raise entity.wrong('has name and from; it takes one of them')
        allowed = entity.setting('allow_substs') if entity.has('allow_substs') else False
        found: Any = ros_actions.ParameterFile(entity.pieces('from'), allow_substs=allowed)
        entity.finish()
        return found
    if entity.has('allow_substs'):
        raise entity.wrong('has allow_substs, which belongs to from')
    with entity.located():
        return {tuple(entity.pieces('name')): _value(entity)}


def _value(entity: Entity) -> Any:
    inner = entity.named('param')
    kind = type_named(entity.text('type')) if entity.has('type') else ''
    has_value = entity.has('value')
    if inner and (has_value or entity.has('type')):
        raise entity.wrong('has a value or a type, and parameters in it; it takes one of them')
    if inner:
        found = {tuple(part.pieces('name')): _value(part) for part in inner}
        entity.finish()
        return found
    if not has_value:
        raise entity.wrong("has no 'value', and needs one")
    value = entity.values['value']
    if not entity.typed:
        entity.has('value-sep')
        value = _untyped(entity, kind, value)
    elif not isinstance(value, str) and not is_value(value, kind) and '$(' not in str(value):
        what = f'of the type {kind}' if kind else 'of a parameter'
        raise entity.wrong(f'has value {value!r}, which is no value {what}')
    entity.finish()
    return ros_actions.ParameterValue(_templates(value), value_type=kind)


def _untyped(entity: Entity, kind: str, text: str) -> Any:
    """Return the value of a text of XML; a text with substitutions has its value later."""
    if entity.has('value-sep'):
        item = kind.removeprefix('list_of_')
        return [_coerced(part, item) for part in text.split(entity.text('value-sep'))]
    return _coerced(text, kind)


def _coerced(text: str, kind: str) -> Any:
    """Return a text as a value; one that is no YAML is meant as it stands."""
    try:
        return coerce(text, kind)
    except LaunchError as error:
        if '$(' in text or (not kind and isinstance(error.__cause__, ValueError)):
            return text
        raise


def _templates(value: Any) -> Any:
    """Return a value in which texts with substitutions are their pieces."""
    if isinstance(value, list):
        return [_templates(one) for one in value]
    if not isinstance(value, str):
        return value
    found = template(value)
    if len(found) == 1 and isinstance(found[0], TextSubstitution):
        return found[0].text
    return found


def _command_line(text: Text) -> list[Text]:
    """Split a text into words as a shell does; a substitution is never split."""
    words: list[Text] = []
    current: Text = []
    for part in text:
        if not isinstance(part, TextSubstitution):
            current.append(part)
            continue
        tokens = shlex.split(part.text)
        if (not tokens or part.text[0].isspace()) and current:
            words.append(current)
            current = []
        for number, token in enumerate(tokens):
            if number and current:
                words.append(current)
                current = []
            current.append(TextSubstitution(text=token))
        if tokens and part.text[-1].isspace():
            words.append(current)
            current = []
    return [*words, current] if current else words


def _reset(entity: Entity) -> Action:
    return actions.ResetLaunchConfigurations(dict(_pairs(entity, 'keep')))


def _append_env(entity: Entity) -> Action:
    return actions.AppendEnvironmentVariable(
        entity.pieces('name'),
        entity.pieces('value'),
        **_settings(entity, 'prepend'),
        **_given(entity, separator='separator'),
    )


def _with(make: Callable[..., Action], *names: str) -> Callable[[Entity], Action]:
    """Return a builder of an action that takes texts, in order."""
    return lambda entity: make(*(entity.pieces(name) for name in names))


_BUILDERS: dict[str, Callable[[Entity], Action]] = {
    'append_env': _append_env,
    'arg': _arg,
    'executable': _executable,
    'group': _group,
    'include': _include,
    'let': _with(actions.SetLaunchConfiguration, 'name', 'value'),
    'lifecycle_node': _lifecycle_node,
    'log': lambda entity: actions.LogInfo(msg=entity.pieces('message')),
    'node': _node,
    'push_ros_namespace': _with(ros_actions.PushROSNamespace, 'namespace'),
    'reset': _reset,
    'reset_env': lambda entity: actions.ResetEnvironment(),
    'ros_timer': _ros_timer,
    'set_env': _with(actions.SetEnvironmentVariable, 'name', 'value'),
    'set_parameter': _with(ros_actions.SetParameter, 'name', 'value'),
    'set_parameters_from_file': _with(ros_actions.SetParametersFromFile, 'filename'),
    'set_ros_log_dir': _with(ros_actions.SetROSLogDir, 'new_log_dir'),
    'set_remap': _with(ros_actions.SetRemap, 'from', 'to'),
    'shutdown': lambda entity: actions.Shutdown(**_given(entity, reason='reason')),
    'timer': _timer,
    'unset_env': _with(actions.UnsetEnvironmentVariable, 'name'),
}
