"""Get notebooks back, from the copies that JupyterLab makes whenever it saves one.

They lie beside the progress, outside of the learner's folder, without outputs and compressed.
labkit/data/etc/jupyter/jupyter_server_config.py makes them, and bounds what they take.
"""

from __future__ import annotations

import gzip
import os
import zlib
from pathlib import Path

from labkit.course import learner_folder
from labkit.errors import LabError, first_few
from labkit.files import write_atomically
from labkit.settings import state_dir

__all__ = ['copies_folder', 'restore']

_ENDING = '.gz'
# Times of older copies that are told.
_TOLD = 10


def copies_folder() -> Path:
    """Return the folder of all copies: a folder for each notebook, a file for each time."""
    return state_dir() / 'copies'


def restore(notebook: str | None = None, at: str | None = None) -> list[str]:
    """Get notebooks back as they were last saved. What is there now goes to the backups.

    Args:
        notebook: The number of a lesson, or part of a notebook's path. By default all that are
            gone, can't be read, or are as the course has published them.
        at: The beginning of the time of a copy. By default the newest that is different.

    Returns:
        Sentences about the results.

    Raises:
        LabError: There is no such copy.
    """
    names = _names()
    if notebook is None:
        before = _there()
        said = learner_folder.copy_lessons()
        lost = [name for name in names if _is_lost(name)]
        for name in lost:
            try:
                said.append(_put_newest_back(name))
            except LabError as error:
                said.append(error.message)  # the others come back all the same
        uncopied = _there() - set(names)
        fresh = sorted(uncopied - before)
        broken = sorted(n for n in uncopied if _source(learner_folder.WORK / n) is None)
        if fresh:
            said.append(f'Without a copy, as the course has published it: {first_few(fresh)}.')
        if broken:
            said.append(
                f'Without a copy, and can not be read: {first_few(broken)}. For a fresh lesson: '
                f'labkit reset {broken[0][:2]}'
            )
        return said if lost or fresh or broken else [*said, 'No notebook is lost.']
    name = learner_folder.choose(notebook, sorted({*names, *_there()}))
    times = _times(name)
    if not times:
        raise LabError(
            f'There is no copy of {name}.', todo=f'For a fresh lesson: labkit reset {name[:2]}'
        )
    if at is None:
        said = [_put_newest_back(name, other_than=_source(learner_folder.WORK / name))]
    else:
        fitting = [time for time in times if time.startswith(at)]
        content = _content(name, fitting[-1]) if fitting else None
        if content is None:
            raise LabError(
                f'The copy of {fitting[-1]} can not be read.'
                if fitting
                else f'None is of {at!r}.',
                todo=f'There are those of {", ".join(times[-_TOLD:])}.',
            )
        said = [_put_back(name, fitting[-1], content)]
    others = [time for time in times if time not in said[0]][-_TOLD:]
    if others:
        said.append(f'Others are of {", ".join(others)}: labkit restore {notebook} --at TIME')
    return said


def _names() -> list[str]:
    folder = copies_folder()
    found = {path.parent.relative_to(folder) for path in folder.rglob(f'*{_ENDING}')}
    return sorted(map(str, found))


def _there() -> set[str]:
    """Return the names of the notebooks in the learner's folder itself."""
    return {path.name for path in learner_folder.WORK.glob('*.ipynb')}


def _times(name: str) -> list[str]:
    return sorted(path.name[: -len(_ENDING)] for path in (copies_folder() / name).glob('*.gz'))


def _is_lost(name: str) -> bool:
    path = learner_folder.WORK / name
    return _source(path) is None or learner_folder.is_untouched(name)


def _source(path: Path) -> bytes | None:
    """Return a notebook as its copy would be, None if it can't be read."""
    try:
        return learner_folder.without_outputs(path.read_bytes())
    except (OSError, ValueError, LookupError, TypeError):
        return None


def _content(name: str, time: str) -> bytes | None:
    """Return what a copy holds, None if it can't be read."""
    try:
        packed = (copies_folder() / name / f'{time}{_ENDING}').read_bytes()
        return gzip.decompress(packed) or None  # of an empty file gzip makes an empty one
    except (OSError, EOFError, zlib.error):
        return None


def _put_newest_back(name: str, other_than: bytes | None = None) -> str:
    """Put back the newest copy that can be read and is another one than what is there."""
    damaged: list[str] = []
    for time in reversed(_times(name)):
        content = _content(name, time)
        if content is None:
            damaged.append(time)
        elif content != other_than:
            newer = f' Newer, but damaged: {", ".join(damaged[:_TOLD])}.' if damaged else ''
            return _put_back(name, time, content) + newer
    unread = f' that can be read. Damaged: {", ".join(damaged[:_TOLD])}' if damaged else ''
    raise LabError(
        f'There is no other copy of {name}{unread}.',
        todo=f'There are those of {", ".join(_times(name)[-_TOLD:])}.',
    )


def _put_back(name: str, time: str, content: bytes) -> str:
    path = learner_folder.WORK / name
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        own = os.path.lexists(path) and not learner_folder.is_untouched(name)
        backup = learner_folder.back_up(path, name) if own else None
        write_atomically(path, content)
    except OSError as error:
        raise LabError(f'{str(path)!r} can not be written ({error.strerror}).') from error
    old = f' What was there is {backup}.' if backup else ''
    return f'{path} is as it was saved at {time}, without outputs.{old}'
