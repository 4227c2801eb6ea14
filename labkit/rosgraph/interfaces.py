"""Interface types, their classes and their text.

Those that are installed are found in the ament index. The types of a few packages that no wheel
has, and tutorials need, are built when their class is first asked for: their text is in `library`.
"""

from __future__ import annotations

import functools
import importlib
import os
import sys
from pathlib import Path
from typing import Any

from ament_index_python import get_resource, get_resources, has_resource

from labkit.errors import LabError, did_you_mean, nearest, quoted
from labkit.rosgraph.refusals import Refusal, Refused
from labkit.rosgraph.workspaces import why_missing

__all__ = [
    'KINDS',
    'action_class',
    'buildable',
    'check_exists',
    'check_package',
    'is_part',
    'listed_in',
    'message_class',
    'names',
    'names_in',
    'packages',
    'path_of',
    'service_class',
    'slot_class',
    'slots',
    'type_name',
]

KINDS = {'msg': 'message', 'srv': 'service', 'action': 'action'}
# Messages that an action or a service consists of, by the suffix of their names.
_PARTS = {
    'action': ('Goal', 'Result', 'Feedback', 'FeedbackMessage'),
    'srv': ('Request', 'Response', 'Event'),
}
# package/kind/Type.kind, written from the documented fields.
_LIBRARY = Path(__file__).parent / 'library'


def _extend_ament_path() -> None:
    """Make the ament index findable: wheels put it below the environment's own folder."""
    paths = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    if sys.prefix not in paths:
        os.environ['AMENT_PREFIX_PATH'] = os.pathsep.join([*filter(None, paths), sys.prefix])
        # colcon warns at each call of a folder there that is not a workspace of its own making.
        os.environ.setdefault('COLCON_LOG_LEVEL', 'error')


_extend_ament_path()


def names(kind: str = '') -> list[str]:
    """Return the full names of all interface types, sorted.

    Args:
        kind: `'msg'`, `'srv'` or `'action'`; all if empty.
    """
    return [name for package in packages() for name in names_in(package, kind)]


def packages(kind: str = '') -> list[str]:
    """Return the packages with interface types, sorted; of one kind if given."""
    found = sorted(get_resources('rosidl_interfaces'))
    return [package for package in found if not kind or names_in(package, kind)]


def buildable(package: str = '*') -> list[str]:
    """Return the full names of the types that can be built, of one package or all, sorted."""
    return sorted(
        str(path.relative_to(_LIBRARY).with_suffix(''))
        for path in _LIBRARY.glob(f'{package}/*/*.*')
    )


def names_in(package: str, kind: str = '') -> list[str]:
    """Return the full names of a package's interface types, sorted."""
    return sorted(name for name in listed_in(package) if not kind or name.split('/')[1] == kind)


def listed_in(package: str) -> list[str]:
    """Return the full names of a package's interface types, as its list has them."""
    if not _is_word(package):
        return []
    return _listed(package, os.environ['AMENT_PREFIX_PATH']) or buildable(package)


@functools.cache
def _listed(package: str, _search_path: str) -> list[str]:
    try:
        content, _ = get_resource('rosidl_interfaces', package)
    except LookupError:
        return []
    # Names with `_` are parts of services and actions.
    stems = dict.fromkeys(
        line.rsplit('.', 1)[0] for line in content.splitlines() if '_' not in line
    )
    return [f'{package}/{stem}' for stem in stems if stem.split('/')[0] in KINDS]


def check_package(package: str) -> None:
    """Raise a LabError unless a package is installed."""
    if not listed_in(package) and (not _is_word(package) or not has_resource('packages', package)):
        todo = why_missing(package) or did_you_mean(package, get_resources('packages'))
        raise LabError(f"Unknown package '{package}'", todo=todo)


def check_exists(name: str, kind: str = '') -> str:
    """Return the full name of an installed interface type.

    Args:
        name: `std_msgs/msg/String`, or `std_msgs/String` if `kind` is given.
        kind: `'msg'`, `'srv'` or `'action'`; any if empty. Parts of an action or a service, such
            as `test_msgs/action/Fibonacci_FeedbackMessage`, are messages.

    Raises:
        Refused: There is no such type. Suggests a similar name.
    """
    parts = name.split('/')
    if kind and len(parts) == 2:
        parts.insert(1, kind)
    full_name = '/'.join(parts)
    if len(parts) == 3 and full_name in names_in(parts[0], kind):
        return full_name
    if kind == 'msg' and is_part(full_name):
        return full_name
    known = names(kind)
    known += [name for name in buildable() if kind in ('', name.split('/')[1])]
    last = parts[-1].lower()
    same = [other for other in known if last and other.rsplit('/', 1)[-1].lower() == last]
    near = same[0] if same else nearest(full_name, known)
    what = f'{KINDS[kind]} type' if kind else 'interface'
    if len(parts) != 3 and not near:
        todo = f'Such a name has three parts: std_msgs/{kind or "msg"}/String'
    else:
        todo = f'Did you mean {near!r}?' if near else 'ros2 interface list shows all of them.'
    if not listed_in(parts[0]):
        todo = why_missing(parts[0]) or todo
    raise Refused(
        f'The passed {what} is invalid: {quoted(name)} is not known.',
        todo=todo,
        reason=Refusal.UNKNOWN_TYPE,
    )


def message_class(name: str) -> Any:
    """Return the class of a message type, such as `std_msgs/msg/String` or `std_msgs/String`.

    Raises:
        Refused: There is no such type.
    """
    return _class(check_exists(name, 'msg'))


def service_class(name: str) -> Any:
    """Return the class of a service type, such as `std_srvs/srv/Trigger`.

    Raises:
        Refused: There is no such type.
    """
    return _class(check_exists(name, 'srv'))


def action_class(name: str) -> Any:
    """Return the class of an action type, such as `test_msgs/action/Fibonacci`.

    Raises:
        Refused: There is no such type.
    """
    return _class(check_exists(name, 'action'))


def is_part(name: str) -> bool:
    """Return whether a name is that of a message of an installed action or service."""
    package, kind, word, *_ = [*name.split('/'), '', '', '']
    whole, _, part = word.rpartition('_')
    return part in _PARTS.get(kind, ()) and f'{package}/{kind}/{whole}' in names_in(package, kind)


def type_name(msg_type: Any) -> str:
    """Return the ROS name of a message or service class, such as `std_msgs/msg/String`."""
    package, kind, *_ = msg_type.__module__.split('.')
    return f'{package}/{kind}/{msg_type.__name__}'


def slots(msg_type: Any) -> dict[str, Any]:
    """Return the fields of a message class with their types as `rosidl_parser` defines them."""
    return dict(zip(msg_type.get_fields_and_field_types(), msg_type.SLOT_TYPES, strict=True))


def slot_class(slot: Any) -> Any:
    """Return the class of a field that is a message, None for others."""
    names = getattr(slot, 'namespaced_name', None)
    return message_class('/'.join(names())) if names is not None else None


def path_of(name: str) -> Path:
    """Return the file that defines an interface type."""
    package, kind, word = name.split('/')
    prefix = has_resource('rosidl_interfaces', package)
    return (Path(prefix, 'share') if prefix else _LIBRARY) / package / kind / f'{word}.{kind}'


def _class(full_name: str) -> Any:
    package, kind, word = full_name.split('/')
    module = importlib.import_module(f'{package}.{kind}')
    if not is_part(full_name):
        return getattr(module, word)
    name, _, part = word.rpartition('_')
    whole = getattr(module, name)
    return getattr(whole.Impl if part == 'FeedbackMessage' else whole, part)


def _is_word(text: str) -> bool:
    return text.replace('_', '').isalnum() and text.isascii()
