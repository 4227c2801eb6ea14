"""Guesses: kept with the progress, told beside what comes, never wrong."""

from __future__ import annotations

import itertools
from pathlib import Path
from types import SimpleNamespace

import pytest

from labkit import settings
from labkit.errors import LabError
from labkit.exercises import words_of
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.learner_errors import last_cell
from labkit.exercises.quiz import guess as guess_module
from labkit.exercises.quiz.guess import Guess, guesses_of
from labkit.exercises.record.progress_file import Store
from labkit.exercises.record.progress_store import ProgressStore

CELL = 'late-listener'


@pytest.fixture(autouse=True)
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ProgressStore:
    found = ProgressStore(Store(tmp_path))
    monkeypatch.setattr(guess_module, 'progress_store', found)
    return found


@pytest.fixture
def late() -> Guess:
    found = Guess(
        'late',
        'How many come?',
        ['none', 'five', 'ten'],
        came='five',
        why='So deep.',
        shown_by=CELL,
    )
    found.lesson = 'odds'
    return found


@pytest.fixture
def live(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """A learner before a page; return what the cells display."""
    shown: list[object] = []
    monkeypatch.setattr(settings, 'audience', lambda: settings.LEARNER)
    monkeypatch.setattr('IPython.display.display', lambda value, **_: shown.append(value))
    monkeypatch.setattr(last_cell, '_after', [])
    return shown


def run(cell_id: str, error: Exception | None = None) -> None:
    """Run a cell."""
    result = SimpleNamespace(
        error_before_exec=None,
        error_in_exec=error,
        info=SimpleNamespace(cell_id=cell_id),
        execution_count=1,
    )
    last_cell._look(result)


def test_a_guess_is_text_without_a_page(late: Guess) -> None:
    assert repr(late) == (
        'How many come?\n  a) none   b) five   c) ten\nGuess, then run the cell that comes next.'
    )


def test_a_guess_stands_beside_what_came(late: Guess, live: list[object]) -> None:
    late._ipython_display_()
    live.clear()
    late._form._handle_custom_msg({'guess': 2}, [])
    assert (late._form.guessed, late._form.words) == (2, 'Now run the cell that comes next.')
    run('another')
    run(CELL, ValueError())
    assert not live
    run(CELL)
    (card,) = live
    assert 'YOU GUESSED: ten' in repr(card) and 'What came: five. So deep.' in repr(card)
    assert late._form.words == 'What came: five. So deep.'
    # Once for each time that it was asked.
    run(CELL)
    assert len(live) == 1


def test_who_was_right_is_told_why(late: Guess, live: list[object]) -> None:
    late._ipython_display_()
    late.choose(' B ')
    live.clear()
    run(CELL)
    (card,) = live
    assert 'AS YOU GUESSED: five' in repr(card) and 'So deep.' in repr(card)


def test_a_cell_runs_without_a_guess(late: Guess, live: list[object]) -> None:
    late._ipython_display_()
    live.clear()
    run(CELL)
    assert not live and late._form.words == 'What came: five. So deep.'


def test_guesses_before_and_after_the_answer_are_kept_apart(
    late: Guess, live: list[object], store: ProgressStore
) -> None:
    late._ipython_display_()
    for letter in 'ca':
        late.choose(letter)
    run(CELL)
    late.choose('b')
    entry = store.store.read()[0]['lessons']['odds']['guesses']['late']
    assert (entry['before'], entry['after']) == (0, 1) and 'passed_at' not in entry
    # The next day it is shown as it was guessed, and a guess comes after the answer.
    again = Guess('late', late.ask, late.options, came='five', why=late.why, shown_by=CELL)
    again.lesson = 'odds'
    again._ipython_display_()
    assert again._form.guessed == 0
    again.choose('c')
    entry = store.store.read()[0]['lessons']['odds']['guesses']['late']
    assert (entry['before'], entry['after']) == (0, 2)
    # What stands under the cell is the guess of this day.
    live.clear()
    run(CELL)
    (card,) = live
    assert 'YOU GUESSED: ten' in repr(card)


def test_who_was_told_before_any_guess_guesses_after_it(
    late: Guess, live: list[object], store: ProgressStore
) -> None:
    late._ipython_display_()
    run(CELL)
    late.choose('b')
    entry = store.store.read()[0]['lessons']['odds']['guesses']['late']
    assert (entry['after'], entry.get('before')) == (1, None)


@pytest.mark.parametrize('index', [3, -1, True, '1', 1.0, [1], None])
def test_a_guess_changed_by_hand_to_what_is_no_option_is_ignored(
    late: Guess, live: list[object], store: ProgressStore, index: object
) -> None:
    store.store.update(
        lambda data: data['lessons'].update(odds={'guesses': {'late': {'before': index}}})
    )
    late._ipython_display_()
    assert late._form.guessed == -1
    live.clear()
    run(CELL)
    assert not live and late._form.words == 'What came: five. So deep.'


@pytest.mark.parametrize('letter', ['d', '', 'ab', 2, None])
def test_what_is_no_option_is_said(late: Guess, letter: object) -> None:
    with pytest.raises(LabError, match='none of the options'):
        late.choose(letter)  # type: ignore[arg-type]


@pytest.mark.parametrize('index', [3, -1, True, '1', None])
def test_a_message_that_is_no_guess_is_ignored(
    late: Guess, live: list[object], store: ProgressStore, index: object
) -> None:
    late._ipython_display_()
    late._form._handle_custom_msg({'guess': index}, [])
    assert late._form.guessed == -1 and store.guess('odds', 'late') is None


def test_an_unknown_guess_is_answered_with_the_nearest() -> None:
    (lesson,) = (found for found in all_lessons() if found.name == 'bags')
    with pytest.raises(LabError, match='no guess') as caught:
        lesson.guess('pase')
    assert 'pace' in caught.value.todo


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('ask: So?\n    options: [a, b]\n    came: c\n    why: w\n    shown_by: x', 'options'),
        ('ask: So?\n    options: [a]\n    came: a\n    why: w\n    shown_by: x', 'options'),
        ('ask: So?\n    options: [a, b]\n    came: a\n    shown_by: x', 'lacks why'),
        ('ask: So?\n    option: [a, b]', 'options'),
    ],
)
def test_what_is_no_guess_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / 'quiz.yaml'
    path.write_text(f'guesses:\n  late:\n    {text}\n')
    with pytest.raises(LabError) as caught:
        guesses_of(words_of(str(path)))
    assert said in f'{caught.value.message} {caught.value.todo}'


@pytest.mark.parametrize('lesson', all_lessons(), ids=lambda lesson: lesson.name)
def test_each_guess_is_asked_just_before_the_cell_that_answers_it(lesson) -> None:
    import nbformat

    notebooks = Path(__file__).resolve().parents[3] / 'notebooks'
    cells = nbformat.read(notebooks / lesson.notebook, 4).cells
    asked = {}
    for cell, following in itertools.pairwise(cells):
        if cell.source.startswith('lesson.guess('):
            asked[cell.source] = following.id
    wanted = {f'lesson.guess({guess.name!r})': guess.shown_by for guess in lesson.guesses}
    assert asked == wanted
