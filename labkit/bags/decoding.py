"""Messages from the bytes of a bag: with the class that is installed, or as the bag defines it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rclpy.serialization import deserialize_message

from labkit.errors import LabError
from labkit.rosgraph import interfaces
from labkit.rosgraph.refusals import Refused

__all__ = ['Decoder']


class Decoder:
    """Makes messages of bytes.

    Args:
        definitions: Name of a type -> its definition in the bag, and the language of that.
    """

    def __init__(self, definitions: Mapping[str, tuple[str, str]]) -> None:
        self._definitions = definitions
        self._classes: dict[str, Any] = {}
        self._store: Any = None

    def decode(self, msg_type: str, data: bytes) -> Any:
        """Return a message.

        Args:
            msg_type: Name of its type.
            data: Its bytes, in CDR.

        Raises:
            LabError: The type is not known, or the bytes are no message of it.
        """
        try:
            found = self._class(msg_type)
            if found is not None:
                return deserialize_message(data, found)
            return self._foreign(msg_type).deserialize_cdr(data, msg_type)
        except LabError:
            raise
        except Exception as error:  # of two libraries, about bytes that anybody may have written
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
        """Return what decodes a type that is not installed here."""
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
