"""The quizzes of `15_robot_description.ipynb`."""

from __future__ import annotations

from labkit.exercises import Quiz, guesses_of, words_of

__all__ = ['GUESSES', 'QUIZ', 'WARM_UP']

WORDS = words_of(__file__)

WARM_UP = Quiz.of(WORDS, 'warm_up', cell_id='warm-up')

QUIZ = Quiz.of(WORDS, 'robot_description')

GUESSES = guesses_of(WORDS)
