"""Lessons for live coding: what stays, what goes to the notes, and that nobody's work is lost."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from labkit.course import learner_folder, live_coding
from labkit.errors import LabError
from labkit.exercises.found_lessons import load

ODDS = Path(__file__).resolve().parents[2] / 'notebooks' / '04_odds.ipynb'


@pytest.fixture
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(learner_folder, 'WORK', tmp_path / 'work')
    return tmp_path / 'work'


def cells_of(notebook: live_coding.Notebook) -> dict[str, str]:
    return {cell['id']: live_coding._text(cell) for cell in notebook['cells']}


def test_what_is_left_of_a_lesson() -> None:
    published = json.loads(ODDS.read_text())
    whole, left = cells_of(published), cells_of(live_coding.blank(published))
    for cell_id in ('title', 'setup', 'ones-check', 'ones-help', 'quiz', 'done'):
        assert left[cell_id] == whole[cell_id], cell_id
    for cell_id in ('int16', 'counter', 'ones-starter', 'ask-graph'):
        assert left[cell_id] == '', cell_id
    assert left['message-object'] == '## A message is an object'
    assert left['stadium'] == 'from labkit.lessons.odds.stadium import open_stadium'
    # A task stays as it is; the sentences before it are about the cell above.
    heading = '## Exercise 2: odd numbers'
    assert left['count-up-task'] == heading + whole['count-up-task'].partition(heading)[2]
    assert left['ones-task'].startswith('![The 65536 values of an Int16 lie on a circle.')
    assert 'Nobody says a word' not in left['ones-task']
    # What is published stays as it is.
    assert published == json.loads(ODDS.read_text())


def test_solutions_and_notes_have_all() -> None:
    published, lesson = json.loads(ODDS.read_text()), load('odds')
    cells = cells_of(live_coding.solved(published, lesson))
    assert cells['count-up-starter'] == lesson.count_up.answer.code.strip()
    assert cells['count-up-reason'].startswith('**One solution.** The number lives in the node')
    assert list(cells).index('count-up-reason') == list(cells).index('count-up-starter') + 1
    notes = live_coding.notes(published, lesson)
    for cell_id, text in cells.items():
        assert text.strip() in notes, cell_id


def test_a_reason_is_no_markdown() -> None:
    published = json.loads((ODDS.parent / '07_turtlebot.ipynb').read_text())
    lesson = load('turtlebot')
    reason = cells_of(live_coding.solved(published, lesson))['stop-reason']
    plain = reason.replace('\\', '').removeprefix('**One solution.** ')
    assert plain == lesson.stop.answer.reason and '_' in plain
    assert reason.count('\\_') == plain.count('_')


def test_what_somebody_has_typed_is_kept(work: Path) -> None:
    told = live_coding.write_blank('4')
    path = work / '04_odds.blank.ipynb'
    assert f'{path} is a fresh copy.' in told
    assert (work / '04_odds.notes.md').is_file()
    typed = path.read_text().replace('"source": ""', '"source": "print(1)"')
    path.write_text(typed)
    assert 'The old one is' in live_coding.write_blank('4')
    assert (work / 'backups' / '04_odds.blank.backup-1.ipynb').read_text() == typed
    assert 'is a fresh copy already' in live_coding.write_blank('odds')
    assert '04_odds.solved.ipynb' in live_coding.write_solved('odds')
    # The learner's own copy is not touched by any of it.
    assert json.loads((work / '04_odds.ipynb').read_text())['cells']
    with pytest.raises(LabError, match='is not a lesson'):
        live_coding.write_solved('44')
