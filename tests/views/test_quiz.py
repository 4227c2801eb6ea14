from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from labkit import settings
from labkit.errors import LabError
from labkit.exercises import Choice, Number, Quiz, right, wrong
from labkit.views.card import Card
from labkit.views.quiz import QuizForm, quiz_form

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


def test_page_gets_the_questions_and_not_the_answers(quiz: Quiz) -> None:
    data = quiz._repr_mimebundle_()
    assert 'application/vnd.jupyter.widget-view+json' in data
    assert data['text/plain'] == repr(quiz)
    assert 'Four is even.' not in str(quiz._form.get_state())


def test_where_a_program_runs_the_notebook_a_quiz_is_text(
    quiz: Quiz, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(settings, 'audience', lambda: settings.RECORDING)
    assert quiz._repr_mimebundle_() == {'text/plain': repr(quiz)}


def test_answer_comes_back_as_escaped_html(quiz: Quiz) -> None:
    form = quiz_form(quiz.form_data(), quiz.answer)
    labels = quiz.questions[0].labels()
    send(form, 1, 'ab'[labels.index('four')])
    assert 'NOT YET' in form.feedback['1']
    send(form, 1, 'ab'[labels.index('three')])
    assert 'RIGHT' in form.feedback['1']
    assert '<img' not in form.feedback['1'] and '&lt;img' in form.feedback['1']


def test_no_answer_and_a_graph_that_cannot_be_asked_are_said(quiz: Quiz) -> None:
    form = quiz_form(quiz.form_data(), quiz.answer)
    send(form, 1, 'x')
    assert 'must be a letter, a to b' in form.feedback['1']
    send(form, 2, '3')
    assert 'CANNOT TELL' in form.feedback['2'] and 'ZeroDivisionError' in form.feedback['2']


@pytest.mark.parametrize('content', [{}, {'number': None}, {'number': '1'}, {'number': [1]}])
def test_message_that_is_none_of_the_forms_is_ignored(content: dict[str, Any]) -> None:
    def answer(number: int, given: Any) -> Card:
        raise LabError('not reached')

    form = quiz_form([], answer)
    form._handle_custom_msg(content, [])
    assert form.feedback == {}
