from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from labkit import settings
from labkit.errors import LabError
from labkit.exercises import Choice, Number, Quiz, right, wrong
from labkit.views.card import Card
from labkit.views.quiz_form import QuizForm, quiz_form

EVIL = '<img src=x onerror=alert(1)>'


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('LABKIT_HOME', str(tmp_path))
    monkeypatch.setattr(settings, 'audience', lambda: settings.LEARNER)


def send(form: QuizForm, number: Any, answer: Any) -> None:
    form._handle_custom_msg({'number': number, 'answer': answer}, [])


@pytest.fixture
def quiz() -> Quiz:
    return Quiz(
        'numbers',
        Choice('Which is odd?', right('three', EVIL), wrong('four', 'Four is even.')),
        Number('How many nodes?', lambda: 1 / 0, 'So many.', 'Count them.'),
    )


def test_page_gets_the_questions_and_not_the_answers(
    quiz: Quiz, capsys: pytest.CaptureFixture[str]
) -> None:
    quiz._ipython_display_()
    # Without IPython its text is printed.
    assert 'Which is odd?' in capsys.readouterr().out
    assert quiz._form is not None and len(quiz._form.questions) == 2
    assert 'Four is even.' not in str(quiz._form.get_state())


def test_where_a_program_runs_the_notebook_a_quiz_is_text(
    quiz: Quiz, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(settings, 'audience', lambda: settings.RECORDING)
    with pytest.raises(NotImplementedError):
        quiz._ipython_display_()
    assert quiz._repr_mimebundle_() == {'text/plain': repr(quiz)}


def test_answer_comes_back_with_its_reasons(quiz: Quiz) -> None:
    form = quiz_form(quiz.form_data(), quiz.answer)
    labels = quiz.questions[0].labels()
    four, three = ('ab'[labels.index(label)] for label in ('four', 'three'))
    send(form, 1, four)
    assert form.answers['1'] == {
        'given': four,
        'tone': 'bad',
        'word': 'NOT YET',
        'rows': [(four, 'Four is even.')],
        'count': 1,
    }
    send(form, 1, three)
    assert form.answers['1']['word'] == 'RIGHT'
    # The page writes it as text: it is not escaped here.
    assert form.answers['1']['rows'] == [(three, EVIL), (four, 'Four is even.')]


def test_same_answer_is_news_to_the_page(quiz: Quiz) -> None:
    form = quiz_form(quiz.form_data(), quiz.answer)
    counts = []
    for _ in range(2):
        send(form, 1, 'x')
        counts.append(form.answers['1']['count'])
    assert counts == [1, 2]


def test_no_answer_and_a_graph_that_cannot_be_asked_are_said(quiz: Quiz) -> None:
    form = quiz_form(quiz.form_data(), quiz.answer)
    send(form, 1, 'x')
    assert form.answers['1']['tone'] == 'warn'
    assert 'must be a letter, a to b' in str(form.answers['1']['rows'])
    send(form, 2, '3')
    assert form.answers['2']['word'] == 'CANNOT TELL'
    assert 'ZeroDivisionError' in str(form.answers['2']['rows'])


def test_answers_of_an_earlier_session_come_back(quiz: Quiz) -> None:
    quiz.lesson = 'counting'
    quiz._ipython_display_()
    send(quiz._form, 1, 'a')
    again = Quiz(quiz.name, *quiz.questions)
    again.lesson = quiz.lesson
    again._ipython_display_()
    assert set(again._form.answers) == {'1'}
    answer = again._form.answers['1']
    assert (answer['given'], answer['tone']) == ('a', quiz._form.answers['1']['tone'])
    # The reasons come when it is answered anew.
    assert answer['rows'] == []


@pytest.mark.parametrize('content', [{}, {'number': None}, {'number': '1'}, {'number': [1]}])
def test_message_that_is_none_of_the_forms_is_ignored(content: dict[str, Any]) -> None:
    def answer(number: int, given: Any) -> Card:
        raise LabError('not reached')

    form = quiz_form([], answer)
    form._handle_custom_msg(content, [])
    assert form.answers == {}
