"""Quizzes: questions, their answers, and how an answer may be spelled."""
