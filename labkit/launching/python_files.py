"""Launch files in Python, and the modules that they import.

`launch` and `launch_ros` are not in the wheels of ROS 2. The modules of these names are made here,
of the classes of this package, and exist only in the process that launches.
"""

from __future__ import annotations

import importlib.util
import sys
import traceback
from types import ModuleType
from typing import Any, NoReturn

from labkit.errors import LabError, nearest
from labkit.launching import actions, conditions, events, model, ros_actions, substitutions
from labkit.launching.model import LaunchDescription, LaunchError, Place, placed

__all__ = ['from_python']

_COMPONENTS = 'nodes that share a process are programs in C++'
_LIFECYCLE = 'nodes with a life cycle are not part of this course'
# Names of the real modules that are known and left out, and why.
REFUSED = {
    'launch.actions': {'OpaqueCoroutine': 'take OpaqueFunction'},
    'launch.substitutions': {'Command': substitutions.REFUSED['command']},
    'launch_ros.actions': {
        'ComposableNodeContainer': _COMPONENTS,
        'LoadComposableNodes': _COMPONENTS,
        'LifecycleNode': _LIFECYCLE,
        'LifecycleTransition': _LIFECYCLE,
        'ROSTimer': 'it waits for the time of ROS; take TimerAction',
        'SetROSLogDir': 'set ROS_LOG_DIR before the launch',
        'SetUseSimTime': "take SetParameter('use_sim_time', True)",
    },
    'launch_ros.descriptions': {'ComposableNode': _COMPONENTS},
    'launch_ros.event_handlers': {'OnStateTransition': _LIFECYCLE},
}


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


def _perform_substitutions(context: model.Context, text: Any) -> str:
    return model.perform(context, model.pieces(text))


def _public(module: ModuleType) -> dict[str, Any]:
    """Return the classes of the real modules that a module of this package has."""
    return {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, type)
        and value.__module__ == module.__name__
        and not name.startswith('_')
    }


def _contents() -> dict[str, dict[str, Any]]:
    """Return what each module has, by its name."""
    ros = {**_public(ros_actions), 'PushRosNamespace': ros_actions.PushROSNamespace}
    values = {name: ros.pop(name) for name in ('Parameter', 'ParameterFile', 'ParameterValue')}
    texts = _public(substitutions)
    packages = ('FindPackage', 'FindPackagePrefix', 'FindPackageShare', 'ExecutableInPackage')
    in_packages = {name: texts.pop(name) for name in packages}
    general = {
        name: value
        for name, value in _public(actions).items()
        if name not in ('Source', 'Start', 'Written')
    }
    happened = _public(events)
    handlers = {name: happened[name] for name in happened if name.startswith('On')}
    sources = {'AnyLaunchDescriptionSource': AnyLaunchDescriptionSource}
    xml = {'XMLLaunchDescriptionSource': XMLLaunchDescriptionSource}
    in_yaml = {'YAMLLaunchDescriptionSource': YAMLLaunchDescriptionSource}
    basis = {
        'Action': model.Action,
        'Condition': model.Condition,
        'Event': events.Event,
        'EventHandler': events.EventHandler,
        'LaunchContext': model.Context,
        'LaunchDescription': LaunchDescription,
        'LaunchDescriptionEntity': model.Action,
        'LaunchDescriptionSource': actions.Source,
        'SomeSubstitutionsType': Any,
        'Substitution': model.Substitution,
    }
    return {
        'launch': basis,
        'launch.actions': general,
        'launch.conditions': _public(conditions),
        'launch.event_handlers': handlers,
        'launch.events': {name: happened[name] for name in ('ExecutionComplete', 'Shutdown')},
        'launch.events.process': {
            name: happened[name] for name in ('ProcessExited', 'ProcessIO', 'ProcessStarted')
        },
        'launch.launch_context': {'LaunchContext': model.Context},
        'launch.launch_description': {'LaunchDescription': LaunchDescription},
        'launch.launch_description_sources': {
            **sources,
            'FrontendLaunchDescriptionSource': AnyLaunchDescriptionSource,
            'PythonLaunchDescriptionSource': PythonLaunchDescriptionSource,
        },
        'launch.substitutions': {**texts, 'TextSubstitution': model.TextSubstitution},
        'launch.utilities': {'perform_substitutions': _perform_substitutions},
        'launch_ros': {},
        'launch_ros.actions': ros,
        'launch_ros.descriptions': values,
        'launch_ros.event_handlers': {},
        'launch_ros.parameter_descriptions': values,
        'launch_ros.substitutions': in_packages,
        'launch_xml': {},
        'launch_xml.launch_description_sources': xml,
        'launch_yaml': {},
        'launch_yaml.launch_description_sources': in_yaml,
    }


class _Lent(ModuleType):
    """A module of the real name. What it does not have is named, with the line that asks."""

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith('__'):
            raise AttributeError(name)
        place, module = placed(), self.__name__
        why = REFUSED.get(module, {}).get(name)
        if why:
            raise LaunchError(f'{name} is not supported here: {why}.', place=place)
        known = [word for word in vars(self) if not word.startswith('_')]
        near = nearest(name, known)
        raise LaunchError(
            f'{module} has no {name} here.',
            todo=f'Did you mean {near}?' if near else f'It has: {", ".join(sorted(known))}.',
            place=place,
        )


def lend() -> None:
    """Let launch files import `launch`, `launch_ros` and what belongs to them.

    Raises:
        LaunchError: The real ones are installed: then they are the right ones.
    """
    if isinstance(sys.modules.get('launch'), _Lent):
        return
    if importlib.util.find_spec('launch_ros') is not None:
        raise LaunchError(
            'The real package launch_ros is installed in this Python.',
            todo='Start the file with the ros2 of that installation.',
        )
    for name, content in _contents().items():
        module = _Lent(name)
        vars(module).update(content)
        module.__path__ = []
        sys.modules[name] = module
        parent, _, last = name.rpartition('.')
        if parent:
            setattr(sys.modules[parent], last, module)


def from_python(text: str, path: str) -> LaunchDescription:
    """Return what `generate_launch_description()` of a text of Python returns.

    Raises:
        LaunchError: It can't be run, or uses what is not supported.
    """
    lend()
    model.python_files.add(path)
    module = ModuleType('python_launch_file')
    module.__file__ = path
    try:
        exec(compile(text, path, 'exec'), vars(module))
        function = vars(module).get('generate_launch_description')
        if function is None:
            raise LaunchError(
                f"launch file at '{path}' does not contain the required function "
                "'generate_launch_description()'",
                place=Place(path, 1),
            )
        found = function()
    except SyntaxError as error:
        raise LaunchError(f'{error.msg}.', place=Place(path, error.lineno or 1)) from error
    except LabError as error:
        raise model.at(error, _line(error, path)) from error
    except (Exception, SystemExit) as error:
        raise LaunchError(f'{type(error).__name__}: {error}', place=_line(error, path)) from error
    if not isinstance(found, LaunchDescription):
        raise LaunchError(
            f'generate_launch_description() returns {found!r}, and a LaunchDescription is '
            'expected.',
            place=Place(path, function.__code__.co_firstlineno),
        )
    return found


def _line(error: BaseException, path: str) -> Place | None:
    """Return the last line of a file that led to an error."""
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == path and frame.lineno
    ]
    return Place(path, lines[-1]) if lines else None
