"""The quizzes of `14_frames.ipynb`."""

from __future__ import annotations

from labkit.exercises import Quiz, words_of

__all__ = ['BET', 'QUIZ', 'WARM_UP']

WORDS = words_of(__file__)

WARM_UP = Quiz.of(WORDS, 'warm_up', cell_id='warm-up')

BET = Quiz.of(WORDS, 'bet', cell_id='bet')

QUIZ = Quiz.of(WORDS, 'frames')
