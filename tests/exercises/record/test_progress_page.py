"""The page with all lessons: always true, and it never overwrites another file."""

from __future__ import annotations

import re
from datetime import datetime
from pathlib import Path

import pytest

from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.record import progress_page as module
from labkit.exercises.record.progress_page import (
    MARK,
    VARIABLE,
    follow_progress,
    main,
    page,
    write_home,
)
from labkit.exercises.record.progress_store import progress_store
from labkit.views.progress_picture import Item, Row

NOW = datetime(2026, 11, 23, 14, 5)


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The page of a notebook that `labkit lab` has opened."""
    file = tmp_path / 'Home.md'
    monkeypatch.setenv(VARIABLE, str(file))
    monkeypatch.setattr(progress_store, 'after_change', [])
    return file


def test_page_names_each_lesson_what_it_teaches_and_what_is_done() -> None:
    items = [
        Item('exercise', 'ones', 'done', '04_odds.ipynb#cell-id=ones-task'),
        Item('exercise', 'evens', 'tried', '04_odds.ipynb#cell-id=evens-task'),
        Item('question', 'types.1', 'open'),
    ]
    rows = [Row('04 Odd numbers', items, '04_odds.ipynb', 'types; queues')]
    text = page(rows, [('04 Odd numbers, evens', '04_odds.ipynb#cell-id=evens-task')], NOW)
    lines = [line.replace('&nbsp;', ' ').replace(' &ensp;', ', ') for line in text.splitlines()]
    assert lines[0] == MARK.strip()
    assert '**50 %** of the exercises: 1 of 2 exercises, 0 of 1 question.' in lines
    assert 'Go on: **[04 Odd numbers, evens](04_odds.ipynb#cell-id=evens-task)**' in lines
    assert (
        '| [04 Odd numbers](04_odds.ipynb) | types; queues | '
        '✔ [ones](04_odds.ipynb#cell-id=ones-task), '
        '… [evens](04_odds.ipynb#cell-id=evens-task) | 0 of 1 | 50 % |'
    ) in lines
    assert '23 November 2026 at 14:05' in text


def test_page_has_all_lessons(path: Path) -> None:
    assert main([str(path)]) == 0
    links = re.findall(r'^\| \[.*?\]\((.*?)\) \|', path.read_text(), re.MULTILINE)
    assert links == [lesson.notebook for lesson in all_lessons()]
    # On the road as well.
    stations = re.findall(r'\[!\[(.*?)\]\(data:.*?\)\]\((.*?)\)', path.read_text())
    assert [href for _, href in stations] == links
    assert stations[1][0].startswith('01 What ROS is: 0 %')


def test_page_follows_what_is_noted(path: Path) -> None:
    write_home(path)
    assert '○&nbsp;[ones]' in path.read_text()
    follow_progress()
    follow_progress()
    progress_store.note_check('odds', 'ones', 'PASS')
    assert '✔&nbsp;[ones]' in path.read_text()
    assert '[04 Odd numbers, count_up](04_odds.ipynb#cell-id=count-up-task)' in path.read_text()
    assert len(progress_store.after_change) == 1


def test_without_labkit_lab_nothing_is_written(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(VARIABLE)
    follow_progress()
    progress_store.note_check('odds', 'ones', 'PASS')
    assert not path.exists()


def test_page_of_the_learners_own_stays(path: Path) -> None:
    path.write_text('# My home\n')
    write_home(path)
    assert path.read_text() == '# My home\n'


def test_page_that_can_not_be_written_does_not_disturb_a_check(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_arguments: object) -> None:
        raise OSError('no space')

    follow_progress()
    monkeypatch.setattr(module, 'write_atomically', refuse)
    assert progress_store.note_check('odds', 'ones', 'PASS') == ''
    path.mkdir()
    assert progress_store.note_check('odds', 'ones', 'PASS') == ''
