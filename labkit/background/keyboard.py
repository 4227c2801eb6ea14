"""`input()` while a program runs a lesson: nobody is there to type."""

from __future__ import annotations

from labkit import settings
from labkit.background import compat

__all__ = ['press_enter_for_nobody']


def press_enter_for_nobody() -> None:
    """Let each `input()` be answered with the Enter key alone, where a program runs the lesson.

    A cell such as `text = input('Your message: ') or 'Hello'` then runs as if a person had
    pressed Enter. For a person, nothing changes.
    """
    if settings.in_kernel() and settings.audience().same_each_time:
        compat.answer_input(_press_enter)


def _press_enter(prompt: object = '') -> str:
    print(prompt)
    return ''
