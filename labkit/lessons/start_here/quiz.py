"""The quiz of `00_start_here.ipynb`."""

from __future__ import annotations

from labkit.exercises import Quiz, words_of

__all__ = ['QUIZ']

WORDS = words_of(__file__)

QUIZ = Quiz.of(WORDS, 'cells')
