"""What of a verdict is the course's own, and that nothing of a learner's is."""

from __future__ import annotations

import pytest

from labkit.exercises.learner_errors import explain_error
from labkit.exercises.sentences import is_of_the_course, known_sentences, of_the_course


@pytest.mark.parametrize(
    'sentence',
    [
        'Two copies of the node run at once, and their messages mix on the topic.',
        'A class is a plan. Nothing runs before a node is made of it.',
        'What print() writes is not in the log.',
    ],
)
def test_sentences_of_judges_are_the_courses(sentence: str) -> None:
    assert of_the_course(sentence) == sentence
    assert is_of_the_course(sentence)


def test_what_is_a_learners_is_left_out() -> None:
    why, _ = explain_error(NameError("name 'my_secret' is not defined", name='my_secret'))
    assert 'my_secret' in why
    said = of_the_course(f'{why} My teacher is stupid. <script>alert(1)</script>.')
    assert said.startswith('Python does not know the name … here: it is misspelt')
    assert not any(word in said for word in ('secret', 'stupid', '<'))
    assert is_of_the_course(said)
    for text in ('', 'My teacher is stupid.', f'{said} And stupid.', 'my_secret is … here.'):
        assert not is_of_the_course(text)
    assert of_the_course('42 is what 17 has said.') == ''


def test_documentation_and_code_of_the_course_are_no_sentences() -> None:
    text = '\n'.join(known_sentences())
    assert 'Return what is said in words of the course alone' not in text
    # One that fits to anything would let anything pass.
    assert all(len(sentence.replace('…', '').split()) >= 3 for sentence in known_sentences())
