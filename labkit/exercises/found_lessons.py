"""The lessons that there are, found by their names, so that a new one needs no registration."""

from __future__ import annotations

import importlib
import pkgutil
import re
from typing import TYPE_CHECKING

from labkit.errors import LabError, did_you_mean

if TYPE_CHECKING:
    from labkit.exercises.lesson import Lesson

__all__ = ['all_lessons', 'lesson_names', 'load']

PACKAGE = 'labkit.lessons'


def load(name: str) -> Lesson:
    """Return a lesson without preparing its exercises.

    Raises:
        LabError: There is no such lesson.
    """
    names = lesson_names()
    bare = re.sub(r'^\d+_|\.ipynb$', '', name) if isinstance(name, str) else name
    if bare not in names:
        raise LabError(
            f'There is no lesson {name!r}.',
            todo=did_you_mean(str(bare), names) or f'The lessons: {", ".join(names)}.',
        )
    found: Lesson = importlib.import_module(f'{PACKAGE}.{bare}').LESSON
    return found


def lesson_names() -> list[str]:
    """Return the names of all lessons. A module whose name starts with `_` is none."""
    package = importlib.import_module(PACKAGE)
    names = (module.name for module in pkgutil.iter_modules(package.__path__))
    return sorted(name for name in names if not name.startswith('_'))


def all_lessons() -> list[Lesson]:
    """Return all lessons, in the order of their notebooks."""
    return sorted(map(load, lesson_names()), key=lambda found: found.notebook)
