"""Decoding the messages of a bag: with the installed class, or by the bag's own definition."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rclpy.serialization import deserialize_message

from labkit.errors import LabError
from labkit.rosgraph import interfaces
from labkit.rosgraph.refusals import Refused

__all__ = ['Decoder']


class Decoder:
    """Decodes messages.

    Args:
        definitions: Type name -> its definition in the bag, and the language of that.
    """

    def __init__(self, definitions: Mapping[str, tuple[str, str]]) -> None:
        self._definitions = definitions
        self._classes: dict[str, Any] = {}
        self._store: Any = None

    def decode(self, msg_type: str, data: bytes) -> Any:
        """Decode a message.

        Args:
            msg_type: Name of its type.
            data: The message in CDR.

        Raises:
            LabError: The type is unknown, or the data is not a message of it.
        """
        try:
            found = self._class(msg_type)
            if found is not None:
                return deserialize_message(data, found)
            store = self._foreign(msg_type)
            least = _least_size(store, msg_type)
            if least > len(data):
                # Without a look at the data, rosbags would make as much as the definition says.
                raise ValueError(f'a message has at least {least} bytes')
            return store.deserialize_cdr(data, msg_type)
        except LabError:
            raise
        except Exception as error:  # two libraries, and data from anywhere
            raise LabError(
                f'These {len(data)} bytes are no message of {msg_type}: '
                f'{type(error).__name__}: {error}',
                todo='The bag may be damaged, or the type may have been another one there.',
            ) from error

    def _class(self, msg_type: str) -> Any:
        if msg_type not in self._classes:
            try:
                self._classes[msg_type] = interfaces.message_class(msg_type)
            except Refused:
                self._classes[msg_type] = None
        return self._classes[msg_type]

    def _foreign(self, msg_type: str) -> Any:
        """Return a type store that decodes a type not installed here."""
        from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

        if self._store is None:
            self._store = get_typestore(Stores.ROS2_JAZZY)
        if msg_type in self._store.fielddefs:
            return self._store
        text, encoding = self._definitions.get(msg_type, ('', ''))
        if not text:
            raise LabError(
                f'{msg_type} is not installed here, and the bag does not say how it is defined.',
                todo='Install the package of the type. The topic can be counted and played back '
                'by others without it.',
            )
        found = (
            get_types_from_idl(text)
            if encoding == 'ros2idl'
            else get_types_from_msg(text, msg_type)
        )
        known = self._store.fielddefs
        self._store.register({name: what for name, what in found.items() if name not in known})
        return self._store


def _least_size(store: Any, msg_type: str) -> int:
    """Return how many bytes a message of a type has at least."""
    from rosbags.interfaces import Nodetype

    sizes: dict[str, int] = {}

    def of_type(name: str) -> int:
        if name not in sizes:
            sizes[name] = max(1, sum(of_field(what) for _, what in store.fielddefs[name][1]))
        return sizes[name]

    def of_field(what: Any) -> int:
        kind, inside = what
        if kind == Nodetype.ARRAY:
            return int(inside[1] * of_field(inside[0]))
        return of_type(inside) if kind == Nodetype.NAME else 1

    return of_type(msg_type)
