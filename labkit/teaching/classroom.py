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

    It is live in a notebook, for as long as it can be seen. By itself it names nobody, for the
    projector. It knows those who have joined with `lab.join_class()`, and of them what their
    computers have told.

    Args:
        folder: The folder of the class; on a hub, or where `LABKIT_CLASS_FOLDER` is set, it is
            known.
        names: Whether to tell who is who, for you alone. Names are never stored in the notebook.

    Returns:
        What a cell shows. `.close()` ends it.

    Raises:
        LabError: There is no such folder.
    """
    place = ClassFolder(chosen_folder(folder))

    def look() -> Board:
        return count(place.read(), datetime.now(timezone.utc))

    return Classroom(look, names=names)
