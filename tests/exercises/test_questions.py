from __future__ import annotations

from pathlib import Path

import pytest

from labkit.errors import LabError
from labkit.exercises import Choice, Number, Quiz, Several, Word, right, wrong
from labkit.exercises.attempts import progress_store

ODD = Choice(
    'Which is odd?',
    right('three', 'Because of 3.'),
    wrong('four', 'Four is even.'),
    wrong('zero', 'Zero is even.'),
)
ODDS = Several(
    'Which are odd?',
    right('three', 'Because of 3.'),
    right('five', 'Because of 5.'),
    wrong('four', 'Four is even.'),
)
RATE = Number(
    'How many a second?',
    10.0,
    'The period is 0.1 s.',
    'Divide 1 by the period.',
    wrong={0.1: 'This is the period.'},
    tolerance=0.5,
    unit='Hz',
)
NODE = Word('Who publishes?', lambda: ['/talker', '/other'], 'It is there.', 'Look at the graph.')


def letter(question: Choice | Several, *texts: str) -> str:
    return ''.join('abc'[question.labels().index(text)] for text in texts)


def test_right_choice_explains_all_answers() -> None:
    feedback = ODD.judge(letter(ODD, 'three').upper())
    assert feedback.is_right
    assert feedback.lines[0] == (letter(ODD, 'three'), 'Because of 3.')
    assert sorted(why for _, why in feedback.lines) == sorted(o.why for o in ODD.options)


def test_wrong_choice_explains_itself_and_gives_nothing_away() -> None:
    feedback = ODD.judge(letter(ODD, 'four'))
    assert not feedback.is_right
    assert [why for _, why in feedback.lines] == ['Four is even.']


@pytest.mark.parametrize('given', ['d', '', 'aa b', 7, 'three', None])
def test_what_is_no_choice_is_said(given: object) -> None:
    with pytest.raises(LabError):
        ODD.judge(given if given != 'aa b' else 'ab')


def test_several_needs_all_and_only_the_right_ones() -> None:
    assert ODDS.judge(letter(ODDS, 'five', 'three')).is_right
    assert ODDS.judge(list(letter(ODDS, 'five', 'three'))).is_right
    missing = ODDS.judge(letter(ODDS, 'five'))
    assert not missing.is_right and 'One right answer' in missing.lines[-1][1]
    assert 'Because' not in str(missing.lines)
    too_many = ODDS.judge(letter(ODDS, 'five', 'three', 'four'))
    assert [why for _, why in too_many.lines] == ['Four is even.']


@pytest.mark.parametrize('given', [10, 10.4, '10', ' 9,6 '])
def test_number_within_tolerance_is_right(given: object) -> None:
    assert RATE.judge(given).is_right


def test_wrong_number_is_explained() -> None:
    assert RATE.judge(0.1).lines == [('why', 'This is the period.')]
    assert RATE.judge(5).lines == [('why', 'Divide 1 by the period.')]
    with pytest.raises(LabError, match='must be a number'):
        RATE.judge('many')


def test_word_is_read_off_when_it_is_asked() -> None:
    assert NODE.judge("'/other' ").is_right
    assert NODE.judge('/nobody').lines == [('why', 'Look at the graph.')]


def test_quiz_as_text_is_the_same_each_time() -> None:
    quiz = Quiz('numbers', ODD, ODDS, RATE, NODE)
    assert repr(quiz) == repr(Quiz('numbers', ODD, ODDS, RATE, NODE))
    lines = repr(quiz).splitlines()
    assert lines[1] == ' 1. Which is odd? (one answer)'
    assert ' 3. How many a second? (a number, in Hz)' in lines
    assert len(lines) == 1 + 4 + 4 + 1 + 1


def test_answers_are_counted(home: Path) -> None:
    quiz = Quiz('numbers', ODD, RATE)
    quiz.lesson = 'odds'
    assert 'NOT YET' in repr(quiz.answer(2, 5))
    assert 'RIGHT' in repr(quiz.answer(2, 10))
    questions = progress_store.store.read()[0]['lessons']['odds']['questions']
    assert questions['numbers.2']['tries'] == 2 and questions['numbers.2']['passed_at']
    with pytest.raises(LabError, match='1 to 2'):
        quiz.answer(3, 'a')


def test_without_widgets_a_quiz_is_text(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, 'labkit.views.quiz', None)
    assert Quiz('numbers', ODD)._repr_mimebundle_() == {'text/plain': repr(Quiz('numbers', ODD))}
