"""A lesson for live coding: with empty cells and notes for the presenter, or with solutions.

Both are made from the published lesson each time, and written into the learner's folder.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from copy import deepcopy
from typing import Any

from labkit.course.learner_folder import fresh_lesson, put
from labkit.exercises import Exercise, Lesson
from labkit.exercises.found_lessons import load

__all__ = ['blank', 'notes', 'solved', 'write_blank', 'write_solved']

Notebook = dict[str, Any]
# These are read together with the class, so their text stays.
_PLAN = ('title', 'done')
_HEADING = re.compile(r'#{1,6} ')
_HELPERS = re.compile(r'^from labkit\..*', flags=re.MULTILINE)
_PICTURE = re.compile(r'!\[[^\]]*\]\([^)]*\)')
# Characters with a meaning in Markdown.
_MARKS = re.compile(r'([\\`*_{}\[\]<>#|])')


def write_blank(lesson: str) -> str:
    """Write a lesson with headings, tasks and empty cells, and notes with everything left out.

    Args:
        lesson: Its number or name.

    Returns:
        A sentence for each file.

    Raises:
        LabError: There is no such lesson.
    """
    stem, notebook = _published(lesson)
    known = load(stem)
    return '\n'.join(
        [
            put(f'{stem}.blank.ipynb', _as_file(blank(notebook))),
            put(f'{stem}.notes.md', notes(notebook, known).encode()),
        ]
    )


def write_solved(lesson: str) -> str:
    """Write a lesson with solutions in place of the starters.

    Args:
        lesson: Its number or name.

    Returns:
        A sentence that says where it is.

    Raises:
        LabError: There is no such lesson.
    """
    stem, notebook = _published(lesson)
    return put(f'{stem}.solved.ipynb', _as_file(solved(notebook, load(stem))))


def blank(notebook: Notebook) -> Notebook:
    """Return a lesson for a teacher who types it in front of a class.

    What the class reads together stays: headings, pictures, the plan, the tasks. So does what
    nobody wants to type: the setup, checks, hints and quizzes, and imports of the lesson's own
    helpers. The other code cells are empty, and their explanation is left to the teacher.

    Args:
        notebook: The lesson.
    """
    result = deepcopy(notebook)
    cells = []
    for cell in result['cells']:
        text = _text(cell)
        if cell['cell_type'] != 'markdown':
            if not _is_kept(cell['id'], text):
                # Its tags describe the removed code: that it raises, or is not compared.
                cell.update(source='\n'.join(_HELPERS.findall(text)), metadata={})
            cells.append(cell)
            continue
        kept = _kept_text(cell['id'], text)
        if kept:
            cells.append(cell | {'source': kept})
    result['cells'] = cells
    return result


def notes(notebook: Notebook, lesson: Lesson) -> str:
    """Return the whole lesson with solutions as a page to keep beside the typed one.

    Args:
        notebook: The lesson.
        lesson: Its exercises.
    """
    parts = []
    for cell in solved(notebook, lesson)['cells']:
        text = _text(cell).strip()
        is_code = cell['cell_type'] == 'code'
        parts.append(f'```python\n{text}\n```' if is_code else text)
    return '\n\n'.join(parts) + '\n'


def solved(notebook: Notebook, lesson: Lesson) -> Notebook:
    """Return a lesson with solutions in the starter cells, each with its reason below.

    Args:
        notebook: The lesson.
        lesson: Its exercises.
    """
    result = deepcopy(notebook)
    exercises = {exercise.starter_id: exercise for exercise in lesson.exercises}
    cells: list[dict[str, Any]] = []
    for cell in result['cells']:
        exercise = exercises.get(cell['id'])
        cells += [cell] if exercise is None else _solution(cell, exercise)
    result['cells'] = cells
    return result


def _solution(starter: Mapping[str, Any], exercise: Exercise) -> Iterator[dict[str, Any]]:
    yield {**starter, 'source': exercise.answer.code.strip()}
    reason = _MARKS.sub(r'\\\1', exercise.answer.reason)
    yield {
        'cell_type': 'markdown',
        'id': f'{exercise.name.replace("_", "-")}-reason',
        'metadata': {},
        'source': f'**One solution.** {reason}',
    }


def _is_kept(cell_id: str, code: str) -> bool:
    """Return whether a cell is the setup, or only calls the lesson: a check, a hint, a quiz."""
    lines = [line.lstrip('# ') for line in code.splitlines()]
    return cell_id == 'setup' or all(re.match(r'(await )?lesson\.', line) for line in lines)


def _kept_text(cell_id: str, text: str) -> str:
    """Return the part of a text cell that stays, `''` if none does."""
    lines = text.split('\n')
    headings = [number for number, line in enumerate(lines) if _HEADING.match(line)]
    if cell_id in _PLAN:
        return text
    if cell_id.endswith('-task') and headings:
        # The text before its heading is about the cell above.
        before = '\n\n'.join(_PICTURE.findall('\n'.join(lines[: headings[-1]])))
        return f'{before}\n\n'.lstrip() + '\n'.join(lines[headings[-1] :])
    kept = [line for line in lines if _HEADING.match(line) or _PICTURE.match(line)]
    return '\n\n'.join(kept)


def _published(lesson: str) -> tuple[str, Notebook]:
    name, content = fresh_lesson(lesson)
    return os.path.splitext(name)[0], json.loads(content)


def _text(cell: Mapping[str, Any]) -> str:
    source = cell['source']
    return source if isinstance(source, str) else ''.join(source)


def _as_file(notebook: Notebook) -> bytes:
    return (json.dumps(notebook, indent=1, ensure_ascii=False) + '\n').encode()
