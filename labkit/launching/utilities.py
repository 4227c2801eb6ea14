"""What `launch.utilities`, `launch.logging` and `launch.frontend` lend to code of one's own.

Classes of substitutions, actions and event handlers that somebody has written for the real launch
are made with these functions.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable
from typing import Any

from labkit.launching.event_handlers import entities_in
from labkit.launching.model import Action, Context, Substitution, Text, perform, pieces
from labkit.launching.parameter_types import coerce, is_value
from labkit.launching.ros_actions import is_text, kind_of

__all__ = [
    'coerce_to_type',
    'ensure_argument_type',
    'exposed',
    'get_logger',
    'is_a',
    'is_a_subclass',
    'isclassinstance',
    'normalize_to_list_of_entities',
    'normalize_to_list_of_substitutions',
    'normalize_typed_substitution',
    'perform_substitutions',
    'perform_typed_substitution',
]


def normalize_to_list_of_substitutions(subs: Any) -> Text:
    """Return a text, a substitution, or several of them, as a list of substitutions."""
    return pieces(subs)


def normalize_to_list_of_entities(entities: Iterable[Any]) -> list[Action]:
    """Return actions and lists of actions as one list."""
    return [action for one in entities for action in entities_in(one)]


def perform_substitutions(context: Context, subs: Iterable[Substitution]) -> str:
    """Return the text that substitutions make."""
    return perform(context, pieces(subs))


def isclassinstance(obj: Any) -> bool:
    """Return True: all is of a class."""
    return True


def is_a(obj: Any, entity_type: type) -> bool:
    """Return whether something is of a class."""
    return isinstance(obj, entity_type)


def is_a_subclass(obj: Any, entity_type: type) -> bool:
    """Return whether something is of a class, or is itself a subclass of it."""
    return isinstance(obj, entity_type) or (isinstance(obj, type) and issubclass(obj, entity_type))


def ensure_argument_type(
    argument: Any, types: Any, argument_name: str, caller: str | None = None
) -> None:
    """Raise a TypeError unless an argument is of one of some types."""
    known = tuple(types) if isinstance(types, Iterable) else (types,)
    if not isinstance(argument, known):
        names = ', '.join(str(one) for one in known)
        start = f"'{caller}' expected" if caller else 'Expected'
        raise TypeError(
            f"{start} '{argument_name}' to be one of [{names}], but got '{argument}' of type "
            f"'{type(argument)}'"
        )


def coerce_to_type(value: str, data_type: Any = None, *, can_be_str: bool = False) -> Any:
    """Return a text as a value of a type, by the rules of YAML if that is None.

    Raises:
        ValueError: It is none, and may not stay a text.
    """
    try:
        return coerce(value, kind_of(data_type))
    except Exception as error:
        if can_be_str:
            return value
        raise ValueError(str(error)) from error


def normalize_typed_substitution(value: Any, data_type: Any) -> Any:
    """Return what `perform_typed_substitution` takes: a value, a text, or a list of both."""
    if is_text(value):
        return pieces(value)
    if isinstance(value, list):
        return [pieces(one) if is_text(one) else one for one in value]
    if not is_value(value, kind_of(data_type)):
        raise TypeError(f"value='{value}' is not an instance of {data_type}")
    return value


def perform_typed_substitution(context: Context, value: Any, data_type: Any) -> Any:
    """Return a value with its substitutions made, as a value of a type."""
    if is_text(value):
        return coerce(perform(context, pieces(value)), kind_of(data_type))
    if isinstance(value, list):
        item = kind_of(data_type).removeprefix('list_of_')
        return [
            coerce(perform(context, pieces(one)), item) if is_text(one) else one for one in value
        ]
    return value


def exposed(_: str) -> Any:
    """Return a decorator without effect: XML and YAML have the words of the real launch."""
    return lambda one: one


class _Line(logging.Handler):
    """Shows a record as the launch shows its own lines."""

    def emit(self, record: logging.LogRecord) -> None:
        print(f'[{record.levelname}] [{record.name}]: {record.getMessage()}', flush=True)


def get_logger(name: str | None = None) -> logging.Logger:
    """Return a logger, whose lines are shown among those of the launch."""
    logger = logging.getLogger(name or 'launch')
    if not any(isinstance(handler, _Line) for handler in logger.handlers):
        logger.addHandler(_Line())
        logger.setLevel(logging.INFO)
        logger.propagate = False
    return logger
