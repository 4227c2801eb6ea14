"""What a buffer does with messages: it takes them to another frame, by functions for their types.

Whoever imports `tf2_geometry_msgs` registers those for its types.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from std_msgs.msg import Header

__all__ = [
    'BufferInterface',
    'ConvertRegistration',
    'NotImplementedException',
    'Stamped',
    'TransformRegistration',
    'TypeException',
    'convert',
]

_NO_TIME = Duration()


class TypeException(Exception):
    """No function is registered for a type."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):
    """A subclass of `BufferInterface` lacks what it has to do itself."""

    def __init__(self) -> None:
        self.errstr = 'CanTransform or LookupTransform not implemented'
        super().__init__(self.errstr)


class TransformRegistration:
    """The functions that transform messages, by type: one table for the whole process."""

    _functions: ClassVar[dict[type, Callable[[Any, TransformStamped], Any]]] = {}

    def add(self, key: type, callback: Callable[[Any, TransformStamped], Any]) -> None:
        """Register a function that takes a message and a transform, and returns a new message."""
        self._functions[key] = callback

    def get(self, key: type) -> Callable[[Any, TransformStamped], Any]:
        """Return the function of a type.

        Raises:
            TypeException: There is none.
        """
        return _registered(self._functions, key)

    def print_me(self) -> None:
        """Print the table."""
        print(self._functions)


class ConvertRegistration:
    """The functions that convert between types: one table for the whole process."""

    _to_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _from_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _convert: ClassVar[dict[Any, Callable[[Any], Any]]] = {}

    def add_to_msg(self, key: type, callback: Callable[[Any], Any]) -> None:
        """Register what makes a message of a type."""
        self._to_msg[key] = callback

    def add_from_msg(self, key: type, callback: Callable[[Any], Any]) -> None:
        """Register what makes a type of a message."""
        self._from_msg[key] = callback

    def add_convert(self, key: tuple[type, type], callback: Callable[[Any], Any]) -> None:
        """Register what makes the second type of the first one."""
        self._convert[key] = callback

    def get_to_msg(self, key: type) -> Callable[[Any], Any]:
        """Return what makes a message of a type; raise a `TypeException` if there is none."""
        return _registered(self._to_msg, key)

    def get_from_msg(self, key: type) -> Callable[[Any], Any]:
        """Return what makes a type of a message; raise a `TypeException` if there is none."""
        return _registered(self._from_msg, key)

    def get_convert(self, key: tuple[type, type]) -> Callable[[Any], Any]:
        """Return what converts a pair of types; raise a `TypeException` if there is none."""
        return _registered(self._convert, key)


def convert(a: Any, b_type: type) -> Any:
    """Return an object as one of another type.

    Raises:
        TypeException: Nothing is registered for these types.
    """
    known = ConvertRegistration()
    if (type(a), b_type) in known._convert:
        return known.get_convert((type(a), b_type))(a)
    if type(a) is b_type:
        return deepcopy(a)
    return known.get_from_msg(b_type)(known.get_to_msg(type(a))(a))


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:  # the real one's name
    """Give an object a header, and return it."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class BufferInterface:
    """What all buffers can do, once they can look transforms up."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self,
        object_stamped: Any,
        target_frame: str,
        timeout: Duration = _NO_TIME,
        new_type: type | None = None,
    ) -> Any:
        """Return a message as it is in another frame.

        Args:
            object_stamped: A message with a header. For those of geometry_msgs,
                `import tf2_geometry_msgs` first.
            target_frame: That frame.
            timeout: How long to wait for the transform.
            new_type: Type to convert the result to.

        Raises:
            TypeException: There is no function for this type.
            TransformException: The transform is not known.
        """
        function = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        result = function(object_stamped, found)
        return result if new_type is None else convert(result, new_type)

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Duration = _NO_TIME,
        new_type: type | None = None,
    ) -> Any:
        """Return a message as it is in another frame at another time.

        Args:
            object_stamped: A message with a header.
            target_frame: That frame.
            target_time: That time.
            fixed_frame: A frame that does not move meanwhile.
            timeout: How long to wait for the transform.
            new_type: Type to convert the result to.

        Raises:
            TypeException: There is no function for this type.
            TransformException: The transform is not known.
        """
        function = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        result = function(object_stamped, found)
        return result if new_type is None else convert(result, new_type)

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Duration = _NO_TIME
    ) -> TransformStamped:
        """Return the transform from one frame to another."""
        raise NotImplementedException

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = _NO_TIME,
    ) -> TransformStamped:
        """Return the transform from a frame at one time to another one at another time."""
        raise NotImplementedException

    def can_transform(
        self, target_frame: str, source_frame: str, time: Any, timeout: Duration = _NO_TIME
    ) -> Any:
        """Return whether a transform is known."""
        raise NotImplementedException

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = _NO_TIME,
    ) -> Any:
        """Return whether a transform between two times is known."""
        raise NotImplementedException


def _registered(functions: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in functions:
        raise TypeException(f'Type {key} is not loaded or supported')
    return functions[key]
