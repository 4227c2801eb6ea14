"""The exceptions of tf2, with the names and the words of the real ones."""

from __future__ import annotations

from labkit.errors import LabError

__all__ = [
    'ConnectivityException',
    'ExtrapolationException',
    'InvalidArgumentException',
    'LookupException',
    'TimeoutException',
    'TransformException',
]


class TransformException(LabError):
    """The base of all exceptions of tf2."""

    @property
    def shown_name(self) -> str:
        """The name under which a notebook shows it: the one that `except` takes."""
        return type(self).__name__


class ConnectivityException(TransformException):
    """The two frames are in trees that are not connected."""


class LookupException(TransformException):
    """A frame is not known, or the tree has a loop."""


class ExtrapolationException(TransformException):
    """The buffer has nothing for that time: it is later, or earlier, than all that was heard."""


class InvalidArgumentException(TransformException):
    """A frame's name is empty or begins with a slash."""


class TimeoutException(TransformException):
    """Something has not come in time."""
