"""The recipe for an exercise in CONTRIBUTING.md, followed to the letter on a copy of a lesson."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import proof
import pytest
from cases import changes_of
from nbformat.v4 import new_code_cell, new_markdown_cell

import labkit.lessons
from labkit.course.record import write_tasks
from labkit.exercises.found_lessons import load

pytestmark = pytest.mark.slow('all proofs of an exercise')

ROOT = Path(__file__).resolve().parent.parent.parent
NOTEBOOK = '04_odds.ipynb'
# Of the words, of the judge, and of the solution.
MOST_LINES = 15, 15, 15
RUFF = [sys.executable, '-m', 'ruff', 'format', '--config', str(ROOT / 'pyproject.toml')]


@pytest.fixture
def course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder with the packages of the lessons, as a part of `labkit.lessons`."""
    shutil.copytree(ROOT / 'labkit' / 'lessons' / 'odds', tmp_path / 'odds')
    monkeypatch.setattr(labkit.lessons, '__path__', [str(tmp_path), *labkit.lessons.__path__])
    for name in [name for name in sys.modules if name.startswith('labkit.lessons.odds')]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(proof, 'NOTEBOOKS', tmp_path)
    return tmp_path


def test_the_recipe_gets_all_its_proofs(course: Path, tmp_path: Path) -> None:
    recipe = (ROOT / 'CONTRIBUTING.md').read_text().partition('## Add an exercise')[2]
    words, module, solution = re.findall(r'```(?:yaml|python)\n(.*?)```', recipe, re.DOTALL)[:3]
    parts = (words, module, solution)
    counts = [sum(bool(line.strip()) for line in part.splitlines()) for part in parts]
    assert all(count <= most for count, most in zip(counts, MOST_LINES, strict=True)), counts
    for code in (module, solution):
        subprocess.run([*RUFF, '--check', '-'], input=code, text=True, check=True)
    write(course, *parts)
    lesson = load('odds')
    exercise = lesson.halves
    states = proof.states_of(exercise)
    assert len(exercise.clauses) == 2 and len(exercise.hints) == 3
    assert len(changes_of(exercise)) == 5
    (tmp_path / 'run').mkdir()
    wanted = {(exercise.name, state.name) for state in states}
    found = proof.prove(lesson, tmp_path / 'run', wanted)
    for state in states:
        finding = found[exercise.name, state.name]
        assert finding.outcome is state.outcome, f'{state.name}: {finding.text}'
        assert ' '.join(state.says.split()) in finding.text


def write(course: Path, words: str, module: str, solution: str) -> None:
    """Add the exercise to the copy of the lesson and of its notebook."""
    (course / 'odds' / 'halves.yaml').write_text(words)
    (course / 'odds' / 'halves.py').write_text(module)
    (course / 'odds' / 'solutions' / 'halves.py').write_text(solution)
    init = course / 'odds' / '__init__.py'
    text = init.read_text()
    assert 'exercises=[' in text
    text = text.replace('exercises=[', 'exercises=[halves, ')
    init.write_text(
        text.replace('\nLESSON', '\nfrom labkit.lessons.odds import halves\n\nLESSON', 1)
    )
    notebook = nbformat.read(ROOT / 'notebooks' / NOTEBOOK, as_version=4)
    where = [cell.id for cell in notebook.cells].index('evens-task')
    path = f'import labkit.lessons\nlabkit.lessons.__path__.insert(0, {str(course)!r})'
    notebook.cells[where:where] = [
        new_markdown_cell('## Exercise: halves\n\nWrite a node:', id='halves-task'),
        new_code_cell('...', id='halves-starter'),
        new_code_cell('lesson.halves.check()', id='halves-check'),
        new_code_cell('# lesson.halves.hint()\n# lesson.halves.solution()'),
    ]
    notebook.cells.insert(0, new_code_cell(path))
    write_tasks(notebook, NOTEBOOK)
    task = next(cell.source for cell in notebook.cells if cell.id == 'halves-task')
    assert task.count('\n- ') == 2 and '- the name of the node is `halver`' in task
    nbformat.write(notebook, course / NOTEBOOK)
