"""Interface types: which are installed, their classes, their text. Read from the ament index."""

from __future__ import annotations

import functools
import importlib
import os
import sys
from pathlib import Path
from typing import Any

from ament_index_python import get_resource, get_resources, has_resource

from labkit.errors import LabError, nearest
from labkit.rosgraph.refusals import Refusal, Refused

__all__ = [
    'KINDS',
    'action_class',
    'check_exists',
    'check_package',
    'is_part_of_action',
    'message_class',
    'names',
    'names_in',
    'packages',
    'path_of',
    'service_class',
    'type_name',
]

KINDS = {'msg': 'message', 'srv': 'service', 'action': 'action'}
# The messages that an action consists of, by what follows its name.
_PARTS = ('Goal', 'Result', 'Feedback', 'FeedbackMessage')


def _know_environment() -> None:
    """Let the ament index be found: wheels put it below the environment's own folder."""
    paths = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    if sys.prefix not in paths:
        os.environ['AMENT_PREFIX_PATH'] = os.pathsep.join([*filter(None, paths), sys.prefix])


_know_environment()


def names(kind: str = '') -> list[str]:
    """Return the full names of all interface types, sorted.

    Args:
        kind: `'msg'`, `'srv'` or `'action'`; all of them if empty.
    """
    return [name for package in packages() for name in names_in(package, kind)]


def packages(kind: str = '') -> list[str]:
    """Return the packages that have interface types, sorted; only those of a kind if given."""
    found = sorted(get_resources('rosidl_interfaces'))
    return [package for package in found if not kind or names_in(package, kind)]


def names_in(package: str, kind: str = '') -> list[str]:
    """Return the full names of the interface types of one package, sorted."""
    content = _listed(package, os.environ['AMENT_PREFIX_PATH']) if _is_word(package) else []
    return [name for name in content if not kind or name.split('/')[1] == kind]


@functools.cache
def _listed(package: str, _search_path: str) -> list[str]:
    try:
        content, _ = get_resource('rosidl_interfaces', package)
    except LookupError:
        return []
    # Names with `_` are parts of services and actions.
    stems = {line.rsplit('.', 1)[0] for line in content.splitlines() if '_' not in line}
    return sorted(f'{package}/{stem}' for stem in stems if stem.split('/')[0] in KINDS)


def check_package(package: str) -> None:
    """Raise a LabError unless a package is installed."""
    if not _is_word(package) or not has_resource('packages', package):
        near = nearest(package, get_resources('packages'))
        raise LabError(
            f"Unknown package '{package}'", todo=f'Did you mean {near!r}?' if near else ''
        )


def check_exists(name: str, kind: str = '') -> str:
    """Return the full name of an interface type that is installed.

    Args:
        name: `std_msgs/msg/String`, or `std_msgs/String` if `kind` is given.
        kind: `'msg'`, `'srv'` or `'action'`; any of them if empty. The parts of an action, such
            as `test_msgs/action/Fibonacci_FeedbackMessage`, are messages.

    Raises:
        Refused: There is none of that name. It says which one is near.
    """
    parts = name.split('/')
    if kind and len(parts) == 2:
        parts.insert(1, kind)
    full_name = '/'.join(parts)
    if len(parts) == 3 and full_name in names_in(parts[0], kind):
        return full_name
    if kind == 'msg' and is_part_of_action(full_name):
        return full_name
    known = names(kind)
    last = parts[-1].lower()
    same = [other for other in known if last and other.rsplit('/', 1)[-1].lower() == last]
    near = same[0] if same else nearest(full_name, known)
    what = f'{KINDS[kind]} type' if kind else 'interface'
    if len(parts) != 3 and not near:
        todo = f'Such a name has three parts: std_msgs/{kind or "msg"}/String'
    else:
        todo = f'Did you mean {near!r}?' if near else 'ros2 interface list shows all of them.'
    raise Refused(
        f'The passed {what} is invalid: {name!r} is not known.',
        todo=todo,
        reason=Refusal.UNKNOWN_TYPE,
    )


def message_class(name: str) -> Any:
    """Return the class of a message type, such as `std_msgs/msg/String` or `std_msgs/String`.

    Raises:
        Refused: There is none of that name.
    """
    return _class(check_exists(name, 'msg'))


def service_class(name: str) -> Any:
    """Return the class of a service type, such as `std_srvs/srv/Trigger`.

    Raises:
        Refused: There is none of that name.
    """
    return _class(check_exists(name, 'srv'))


def action_class(name: str) -> Any:
    """Return the class of an action type, such as `test_msgs/action/Fibonacci`.

    Raises:
        Refused: There is none of that name.
    """
    return _class(check_exists(name, 'action'))


def is_part_of_action(name: str) -> bool:
    """Tell whether a name is that of a message which belongs to an action that is installed."""
    package, kind, word, *_ = [*name.split('/'), '', '', '']
    action, _, part = word.rpartition('_')
    whole = f'{package}/action/{action}'
    return kind == 'action' and part in _PARTS and whole in names_in(package, 'action')


def type_name(msg_type: Any) -> str:
    """Return the ROS name of a message or service class, such as `std_msgs/msg/String`."""
    package, kind, *_ = msg_type.__module__.split('.')
    return f'{package}/{kind}/{msg_type.__name__}'


def path_of(name: str) -> Path:
    """Return the file that defines an interface type, given its full name."""
    package, kind, word = name.split('/')
    prefix = has_resource('packages', package)
    return Path(str(prefix)) / 'share' / package / kind / f'{word}.{kind}'


def _class(full_name: str) -> Any:
    package, kind, word = full_name.split('/')
    module = importlib.import_module(f'{package}.{kind}')
    if not is_part_of_action(full_name):
        return getattr(module, word)
    action, _, part = word.rpartition('_')
    whole = getattr(module, action)
    return getattr(whole.Impl if part == 'FeedbackMessage' else whole, part)


def _is_word(text: str) -> bool:
    return text.replace('_', '').isalnum() and text.isascii()
