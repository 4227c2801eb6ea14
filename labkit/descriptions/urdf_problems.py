"""One thing that is wrong with a description, in sentences."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ['Problem']


@dataclass(frozen=True)
class Problem:
    """What is wrong with a description of a robot.

    Attributes:
        message: What was expected and what was seen.
        todo: What to do next, '' if that is plain.
        line: Where, from 1; 0 if nowhere.
        is_error: Whether ROS refuses it. What it takes, though nobody can have meant it, is none.
    """

    message: str
    todo: str = ''
    line: int = 0
    is_error: bool = False

    def __str__(self) -> str:
        message = self.message[:1].upper() + self.message[1:]
        return f'Line {self.line}: {message}' if self.line else message
