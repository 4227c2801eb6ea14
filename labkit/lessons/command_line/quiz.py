"""The quiz on the command line itself."""

from __future__ import annotations

from labkit.exercises import Quiz, words_of
from labkit.exercises.quiz import spelling

__all__ = ['QUIZ', 'WARM_UP']

WORDS = words_of(__file__)

WARM_UP = Quiz.of(WORDS, 'warm_up', cell_id='warm-up')

QUIZ = Quiz.of(WORDS, 'commands', ros2_command={'form': spelling.ros2_command})
