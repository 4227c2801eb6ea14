"""Mistakes as data: words with values, ids, and the first one whose model fits."""

from __future__ import annotations

from typing import Any

import pytest

from labkit.exercises import Fail
from labkit.exercises.learner_errors import explain_error
from labkit.exercises.mistakes import Mistake, known_mistakes, recognise, said_by_the_course

GREEDY = Mistake(
    'test/greedy', 'It takes {count} at once.', 'Take {{one}} of {count}.', model=lambda n: 2 * n
)


def test_fail_says_a_mistake_with_its_values() -> None:
    fail = Fail('one', 'three', GREEDY.of(count=3))
    assert (fail.why, fail.todo) == ('It takes 3 at once.', 'Take {one} of 3.')
    assert fail.mistake is not None and fail.mistake.id == 'test/greedy'


def test_sentence_for_a_class_has_no_values() -> None:
    mistake = GREEDY.of(count='<script>')
    assert mistake.sentence == 'It takes … at once.'
    assert said_by_the_course(mistake.sentence)
    assert not said_by_the_course(mistake.reason)


def test_an_id_belongs_to_one_mistake() -> None:
    with pytest.raises(ValueError, match="Two mistakes have the id 'test/greedy'"):
        Mistake('test/greedy', 'Something else.')
    assert known_mistakes()['test/greedy'] is GREEDY


def test_the_first_model_that_fits_is_the_reason() -> None:
    same = Mistake('test/same', 'Nothing is done with it.', model=lambda n: n)
    nameless = Mistake('', 'It has no model.')

    def fits(value: int, came: int) -> Mistake | None:
        def does_so(mistake: Mistake) -> bool:
            return mistake.model is not None and mistake.model(value) == came

        return recognise([nameless, same, GREEDY], does_so)

    assert fits(3, 6) is GREEDY
    assert fits(0, 0) is same
    assert fits(3, 5) is None


def test_names_of_a_learner_are_left_out_of_what_a_class_sees() -> None:
    mistake = explain_error(NameError("name 'my_secret' is not defined", name='my_secret'))
    assert mistake is not None and 'my_secret' in mistake.reason
    assert mistake.sentence.startswith('Python does not know the name … here: it is misspelt')
    assert said_by_the_course(mistake.sentence)
    for text in ('', 'My teacher is stupid.', f'{mistake.sentence} And stupid.', mistake.reason):
        assert not said_by_the_course(text)


def test_none_is_not_taken_for_a_message() -> None:
    nothing: Any = None
    for wrong in (lambda: nothing + 1, lambda: 'a' + nothing):
        with pytest.raises(TypeError) as caught:
            wrong()
        assert explain_error(caught.value) is None
