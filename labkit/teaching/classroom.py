"""The teacher's view of a class: `lab.classroom()`."""

from __future__ import annotations

import os
from datetime import datetime, timezone

from labkit.teaching.class_folder import ClassFolder, chosen_folder
from labkit.teaching.counting import count
from labkit.views.class_board import Board
from labkit.views.classroom import Classroom

__all__ = ['classroom']


def classroom(folder: str | os.PathLike[str] | None = None, *, names: bool = False) -> Classroom:
    """Show your class: who is at which lesson, what is passed, what fails most, who is stuck.

    It is live in a notebook while it is visible. By default it shows no names, for the projector.
    It knows the learners who have joined with `lab.join_class()`, from what their computers have
    reported.

    Args:
        folder: The folder of the class; known on a hub, or if `LABKIT_CLASS_FOLDER` is set.
        names: Whether to show names, for you alone. Names are never stored in the notebook.

    Returns:
        A view to show in a cell. `.close()` ends it.

    Raises:
        LabError: There is no such folder.
    """
    reader = ClassFolder(chosen_folder(folder))

    def read() -> Board:
        return count(reader.read(), datetime.now(timezone.utc))

    return Classroom(read, names=names)
