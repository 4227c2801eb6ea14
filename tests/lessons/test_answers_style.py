"""Solutions, their styles and wrong answers are linted and formatted as all other code is."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from cases import Answer
from cases.generic import KINDS
from nbformat.v4 import new_code_cell, new_notebook
from proof import lessons, states_of

ROOT = Path(__file__).resolve().parent.parent.parent
# What stands in the first cells of every lesson.
SETUP = "import labkit as lab\n\nlesson = lab.lesson('')"

ANSWERS = {
    f'{lesson.name}-{exercise.name}-{answer.name}': answer
    for lesson in lessons()
    for exercise in lesson.exercises
    for answer in states_of(exercise)
    if answer.code and not (answer.name in KINDS and 'process' not in answer.name)
}


def write(answer: Answer, folder: Path, number: int) -> Path:
    """Write an answer as what it is: a script, or a cell of a notebook, where magics are code."""
    assert answer.code is not None
    if answer.process:
        path = folder / 'tests' / f'{number}.py'
        path.write_text(answer.code.strip() + '\n')
    else:
        path = folder / 'notebooks' / f'{number}.ipynb'
        notebook = new_notebook(cells=[new_code_cell(SETUP), new_code_cell(answer.code.strip())])
        notebook.metadata['language_info'] = {'name': 'python'}
        nbformat.write(notebook, path)
    return path


def ruff(folder: Path, *arguments: str) -> str:
    """Run ruff in a folder, with the settings of this repository; return what it prints."""
    command = [sys.executable, '-m', 'ruff', *arguments, '--no-cache']
    command += ['--config', str(ROOT / 'pyproject.toml'), '.']
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


@pytest.fixture(scope='module')
def complaints(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """What ruff has to say of each answer that it finds something wrong with."""
    folder = tmp_path_factory.mktemp('answers')
    # Settings that hold for single folders hold for the same ones here.
    for name in ('notebooks', 'tests'):
        (folder / name).mkdir()
    written = {
        str(write(answer, folder, number)): name
        for number, (name, answer) in enumerate(ANSWERS.items())
    }
    found: dict[str, list[str]] = {}
    linted: list[dict[str, Any]] = json.loads(ruff(folder, 'check', '--output-format=json'))
    for problem in linted:
        place = f'line {problem["location"]["row"]}: {problem["code"]} {problem["message"]}'
        found.setdefault(written[problem['filename']], []).append(place)
    formatted = ruff(folder, 'format', '--check', '--output-format=json')
    for problem in json.loads(formatted):
        found.setdefault(written[problem['filename']], []).append('is not formatted')
    return found


@pytest.mark.parametrize('name', ANSWERS)
def test_answer_is_linted_and_formatted(name: str, complaints: dict[str, list[str]]) -> None:
    answer = ANSWERS[name]
    found = complaints.get(name, [])
    if answer.refused:
        assert found, f'ruff finds nothing wrong with it, so refused={answer.refused!r} can go'
    else:
        assert not found, '\n'.join([*found, str(answer.code)])
