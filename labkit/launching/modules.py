"""The modules of the real `launch` and `launch_ros` by their names, and what each has here."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

from labkit.launching import (
    actions,
    conditions,
    event_handlers,
    events,
    execute,
    lifecycle_nodes,
    model,
    ros_actions,
    substitutions,
    utilities,
)
from labkit.launching.model import LaunchDescription, LaunchError, placed
from labkit.launching.templates import template

__all__ = ['FOLLOWS', 'contents']

FOLLOWS = {'launch': '3.4.10', 'launch_ros': '0.26.10'}
"""The versions of the real packages that launch files are read as by."""

_COMPONENTS = (
    'nodes that share a process are in C++; take a Node for each, if its package has a program'
)
_RUNS = 'this launch runs already; take IncludeLaunchDescription to launch another file with it'
_GRAPH = 'a launch has no node of its own; take an rclpy node, in a program'
_INSIDE = 'it is a part of the real launch that has no counterpart here'
# What the real modules have, and this course leaves out: by module, the names and why.
LEFT_OUT: dict[str, dict[str, str]] = {
    'launch': {'LaunchService': _RUNS, 'LaunchIntrospector': 'ros2 launch --print shows the tree'},
    'launch.event_handlers': {'OnIncludeLaunchDescription': 'take IncludeLaunchDescription'},
    'launch.events': {'IncludeLaunchDescription': 'take the action of that name'},
    'launch.frontend': dict.fromkeys(('Entity', 'ExtractSubstitution', 'Parser'), _INSIDE),
    'launch.launch_description_sources': dict.fromkeys(
        (
            'get_launch_description_from_any_launch_file',
            'get_launch_description_from_frontend_launch_file',
            'get_launch_description_from_python_launch_file',
            'load_python_launch_file_as_module',
        ),
        'take IncludeLaunchDescription',
    ),
    'launch.logging': dict.fromkeys(
        ('LaunchConfig', 'LaunchLogger', 'get_output_loggers', 'launch_config', 'reset'), _INSIDE
    ),
    'launch.utilities': dict.fromkeys(
        ('AsyncSafeSignalManager', 'visit_all_entities_and_collect_futures'), _INSIDE
    ),
    'launch_ros.actions': {
        'NodeActionExtension': _INSIDE,
    },
    'launch_ros.ros_adapters': dict.fromkeys(
        ('ROSAdapter', 'get_ros_adapter', 'get_ros_node'), _GRAPH
    ),
    'launch_ros.utilities': dict.fromkeys(
        (
            *(
                'LifecycleEventManager',
                'PluginException',
                'add_node_name',
                'evaluate_parameters',
                'get_node_name_count',
            ),
            *('normalize_parameters', 'normalize_remap_rule', 'normalize_remap_rules'),
            'to_parameters_list',
        ),
        _INSIDE,
    ),
    'launch_xml': dict.fromkeys(('Entity', 'Parser'), _INSIDE),
    'launch_yaml': dict.fromkeys(('Entity', 'Parser'), _INSIDE),
}
# Actions that it leaves out: told when their turn comes, since many stand below a condition.
ACTIONS_LEFT_OUT: dict[str, dict[str, str]] = {
    'launch.actions': {'OpaqueCoroutine': 'take OpaqueFunction'},
    'launch_ros.actions': {
        'ComposableNodeContainer': _COMPONENTS,
        'LoadComposableNodes': _COMPONENTS,
    },
}
# What only these actions are made of.
PARTS_LEFT_OUT = {'launch_ros.descriptions': ('ComposableLifecycleNode', 'ComposableNode')}
# Modules in which the real packages keep what a module above them has too.
_WITHIN = {
    'launch': """action condition event event_handler invalid_launch_file_error launch_context
        launch_description launch_description_entity launch_description_source
        launch_introspector launch_service some_entities_type some_substitutions_type
        substitution""",
    'launch.actions': """append_environment_variable declare_launch_argument emit_event
        execute_local execute_process group_action include_launch_description log_info
        opaque_coroutine opaque_function pop_environment pop_launch_configurations
        push_environment push_launch_configurations register_event_handler reset_environment
        reset_launch_configurations set_environment_variable set_launch_configuration
        shutdown_action timer_action unregister_event_handler unset_environment_variable
        unset_launch_configuration""",
    'launch.conditions': """evaluate_condition_expression_impl if_condition
        invalid_condition_expression_error launch_configuration_equals
        launch_configuration_not_equals unless_condition""",
    'launch.descriptions': 'executable',
    'launch.event_handlers': """event_named on_action_event_base on_execution_complete
        on_include_launch_description on_process_exit on_process_io on_process_start
        on_shutdown""",
    'launch.events': 'execution_complete include_launch_description matchers shutdown timer_event',
    'launch.events.process': """process_exited process_io process_matchers process_started
        process_stderr process_stdin process_stdout process_targeted_event running_process_event
        shutdown_process signal_process""",
    'launch.frontend': 'entity expose parse_substitution parser type_utils',
    'launch.launch_description_sources': """any_launch_description_source
        any_launch_file_utilities frontend_launch_description_source
        frontend_launch_file_utilities python_launch_description_source
        python_launch_file_utilities""",
    'launch.logging': 'handlers',
    'launch.substitutions': """anon_name boolean_substitution command environment_variable
        equals_substitution file_content find_executable if_else_substitution
        launch_configuration launch_log_dir local_substitution not_equals_substitution
        path_join_substitution python_expression substitution_failure text_substitution
        this_launch_file this_launch_file_dir""",
    'launch.utilities': """class_tools_impl ensure_argument_type_impl
        normalize_to_list_of_entities_impl normalize_to_list_of_substitutions_impl
        perform_substitutions_impl signal_management type_utils typing_file_path
        visit_all_entities_and_collect_futures_impl""",
    'launch_ros': 'parameters_type remap_rule_type',
    'launch_ros.actions': """composable_node_container lifecycle_node lifecycle_transition
        load_composable_nodes node push_ros_namespace ros_timer set_parameter
        set_parameters_from_file set_remap set_ros_log_dir set_use_sim_time""",
    'launch_ros.descriptions': 'composable_lifecycle_node composable_node',
    'launch_ros.event_handlers': 'on_state_transition',
    'launch_ros.events.lifecycle': 'change_state lifecycle_node_matchers state_transition',
    'launch_ros.events.matchers': 'matches_node_name',
    'launch_ros.substitutions': 'executable_in_package find_package parameter',
    'launch_ros.utilities': """evaluate_parameters lifecycle_event_manager namespace_utils
        normalize_parameters normalize_remap_rule plugin_support to_parameters_list
        track_node_names""",
    'launch_xml': 'entity parser',
    'launch_xml.launch_description_sources': 'xml_launch_description_source',
    'launch_yaml': 'entity parser',
    'launch_yaml.launch_description_sources': 'yaml_launch_description_source',
}


class LaunchDescriptionSource(actions.Source):
    """A launch description that is there already, as if a file had it."""

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: Any = '<string>',
        method: str = '',
    ) -> None:
        super().__init__(location)
        self.description = launch_description
        self.is_file = launch_description is None

    def load(self, context: model.Context, path: str) -> LaunchDescription:
        return super().load(context, path) if self.description is None else self.description


class PythonLaunchDescriptionSource(actions.Source):
    """The path of a launch file in Python."""

    form = 'python'


class XMLLaunchDescriptionSource(actions.Source):
    """The path of a launch file in XML."""

    form = 'xml'


class YAMLLaunchDescriptionSource(actions.Source):
    """The path of a launch file in YAML."""

    form = 'yaml'


class AnyLaunchDescriptionSource(actions.Source):
    """The path of a launch file in any form."""


def _public(module: ModuleType) -> dict[str, Any]:
    """Return the classes of the real modules that a module of this package has."""
    return {
        name: value
        for name, value in vars(module).items()
        if name in module.__all__ and isinstance(value, type)
    }


def contents() -> dict[str, dict[str, Any]]:
    """Return what each module has, by its name; a package comes before what is in it."""
    found = {**_of_launch(), **_of_launch_ros(), **_sources()}
    for module, names in LEFT_OUT.items():
        for name, why in names.items():
            found.setdefault(module, {})[name] = _LeftOut(name, (), {'why': why})
    for module, names in ACTIONS_LEFT_OUT.items():
        for name, why in names.items():
            found[module][name] = type(name, (_ActionLeftOut,), {'why': why})
    for module, parts in PARTS_LEFT_OUT.items():
        for name in parts:
            found.setdefault(module, {})[name] = type(name, (_OfThem,), {})
    found['launch_ros.parameter_descriptions'] = found['launch_ros.descriptions']
    for module, inside in _WITHIN.items():
        for name in inside.split():
            found[f'{module}.{name}'] = found[module]
    return dict(sorted(found.items()))


class _LeftOut(type):
    """The class of classes that can be imported and named, and say why when they are used."""

    why: str

    def __call__(cls, *args: Any, **options: Any) -> NoReturn:
        raise LaunchError(f'{cls.__name__} is not supported here: {cls.why}.', place=placed())

    def __getattr__(cls, name: str) -> NoReturn:
        if name.startswith('__'):
            raise AttributeError(name)
        cls()


class _ActionLeftOut(model.Action):
    """The basis of actions that can be made, and say why when their turn comes."""

    why: str

    def __init__(self, *args: Any, condition: model.Condition | None = None, **_: Any) -> None:
        super().__init__(condition=condition)

    def execute(self, context: model.Context) -> NoReturn:
        name = next(one.__name__ for one in type(self).__mro__ if 'why' in vars(one))
        raise LaunchError(f'{name} is not supported here: {self.why}.')


class _OfThem:
    """The basis of what such actions are made of: nothing ever comes of it."""

    def __init__(self, *args: Any, **options: Any) -> None:
        pass


def _of_launch() -> dict[str, dict[str, Any]]:
    happened, handlers = vars(events), vars(event_handlers)
    of_processes = {name: happened[name] for name in events.__all__ if 'Process' in name}
    matchers = ('matches_executable', 'matches_name', 'matches_pid')
    return {
        'launch': {
            'Action': model.Action,
            'BaseEventHandler': event_handlers.BaseEventHandler,
            'Condition': model.Condition,
            'Event': events.Event,
            'EventHandler': event_handlers.EventHandler,
            'InvalidLaunchFileError': LaunchError,
            'LaunchContext': model.Context,
            'LaunchDescription': LaunchDescription,
            'LaunchDescriptionEntity': model.Action,
            'LaunchDescriptionSource': LaunchDescriptionSource,
            'SomeActionsType': Any,
            'SomeEntitiesType': Any,
            'SomeEntitiesType_types_tuple': (model.Action, list, tuple),
            'SomeSubstitutionsType': Any,
            'SomeSubstitutionsType_types_tuple': (str, Path, model.Substitution, list, tuple),
            'Substitution': model.Substitution,
        },
        'launch.actions': {
            **_public(actions),
            'ExecuteLocal': execute.ExecuteLocal,
            'ExecuteProcess': execute.ExecuteProcess,
        },
        'launch.conditions': {
            **_public(conditions),
            'InvalidConditionExpressionError': LaunchError,
            'evaluate_condition_expression': conditions.evaluate_condition_expression,
        },
        'launch.descriptions': {'Executable': execute.Executable},
        'launch.event_handlers': {
            **{name: vars(execute)[name] for name in execute.__all__ if name[:2] == 'On'},
            **{name: handlers[name] for name in event_handlers.__all__ if name[0] in 'Oe'},
        },
        'launch.events': {
            name: happened[name]
            for name in ('ExecutionComplete', 'Shutdown', 'TimerEvent', 'matches_action')
        },
        'launch.events.process': {
            **of_processes,
            **{name: happened[name] for name in matchers},
        },
        'launch.frontend': {
            'InvalidFrontendLaunchFileError': LaunchError,
            'expose_action': utilities.exposed,
            'expose_substitution': utilities.exposed,
            'parse_substitution': template,
        },
        'launch.logging': {'get_logger': utilities.get_logger},
        'launch.substitutions': {
            **_public(substitutions),
            'SubstitutionFailure': LaunchError,
            'TextSubstitution': model.TextSubstitution,
        },
        'launch.utilities': _functions(utilities),
    }


def _functions(module: ModuleType) -> dict[str, Callable[..., Any]]:
    return {name: vars(module)[name] for name in module.__all__ if name != 'exposed'}


def _of_launch_ros() -> dict[str, dict[str, Any]]:
    ros = {
        **_public(ros_actions),
        'LifecycleNode': lifecycle_nodes.LifecycleNode,
        'LifecycleTransition': lifecycle_nodes.LifecycleTransition,
        'PushRosNamespace': ros_actions.PushROSNamespace,
        'RosTimer': ros_actions.ROSTimer,
    }
    values = {name: ros.pop(name) for name in ('Parameter', 'ParameterFile', 'ParameterValue')}
    of_ros = (
        *('ExecutableInPackage', 'FindPackage', 'FindPackagePrefix', 'FindPackageShare'),
        'Parameter',
    )
    joined = ros_actions.joined_namespace
    by_name = {'matches_node_name': lifecycle_nodes.matches_node_name}
    happened = {
        'ChangeState': lifecycle_nodes.ChangeState,
        'StateTransition': lifecycle_nodes.StateTransition,
    }
    return {
        'launch_ros': {},
        'launch_ros.actions': ros,
        'launch_ros.descriptions': values,
        'launch_ros.event_handlers': {'OnStateTransition': lifecycle_nodes.OnStateTransition},
        'launch_ros.events': by_name,
        'launch_ros.events.lifecycle': {**by_name, **happened},
        'launch_ros.events.matchers': by_name,
        'launch_ros.substitutions': {name: vars(substitutions)[name] for name in of_ros},
        'launch_ros.utilities': {
            'is_namespace_absolute': lambda ns: ns.startswith('/'),
            'is_root_namespace': lambda ns: ns == '/',
            'make_namespace_absolute': lambda ns: joined(None, ns),
            'prefix_namespace': joined,
        },
    }


def _sources() -> dict[str, dict[str, Any]]:
    every = {'AnyLaunchDescriptionSource': AnyLaunchDescriptionSource}
    return {
        'launch.launch_description_sources': {
            **every,
            'FrontendLaunchDescriptionSource': AnyLaunchDescriptionSource,
            'InvalidFrontendLaunchFileError': LaunchError,
            'InvalidLaunchFileError': LaunchError,
            'InvalidPythonLaunchFileError': LaunchError,
            'PythonLaunchDescriptionSource': PythonLaunchDescriptionSource,
        },
        'launch_xml': {},
        'launch_xml.launch_description_sources': {
            'XMLLaunchDescriptionSource': XMLLaunchDescriptionSource
        },
        'launch_yaml': {},
        'launch_yaml.launch_description_sources': {
            'YAMLLaunchDescriptionSource': YAMLLaunchDescriptionSource
        },
    }
