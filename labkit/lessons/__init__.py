"""The exercises and quizzes of the lessons, one module a notebook, each with a `LESSON`.

A module is called like its notebook without the number: `04_odds.ipynb`, `labkit.lessons.odds`.
How to write one: see `labkit.exercises`. None of them imports ROS, so that progress can be shown
on any machine.
"""
