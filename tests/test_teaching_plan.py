"""The times that lessons and the teachers' page promise: they are what the lessons ask for."""

from __future__ import annotations

import math
import re
from pathlib import Path

import nbformat
import pytest

from labkit.exercises.found_lessons import lesson_names, load

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / 'docs' / 'teaching.md').read_text()
# Of a session of ninety minutes, so many are for the lesson.
SESSION = 70
WORDS_A_MINUTE = 150
# An exercise takes so many minutes, and where it takes longer.
EXERCISE = 10
LONGER = {**dict.fromkeys(('08', '09', '10', '11', '13', '14', '15'), 15), '07': 20, '12': 20}
# The cells of a lesson run for so many minutes at most.
RUNNING = 30

LESSONS = {lesson.notebook[:2]: lesson for lesson in map(load, lesson_names())}


def exercise_minutes(number: str) -> int:
    return LONGER.get(number, EXERCISE)


def minutes_of(number: str) -> int:
    notebook = nbformat.read(ROOT / 'notebooks' / LESSONS[number].notebook, as_version=4)
    found = re.search(r'Time: (\d+) minutes', notebook.cells[0].source)
    assert found is not None
    return int(found[1])


def rows(heading: str) -> list[list[str]]:
    section = PAGE.partition(f'## {heading}\n')[2].partition('\n## ')[0]
    lines = [line for line in section.splitlines() if line.startswith('|')]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines[2:]]


@pytest.mark.parametrize('number', sorted(LESSONS))
def test_time_of_a_lesson_is_that_of_its_words_and_exercises(number: str) -> None:
    lesson = LESSONS[number]
    notebook = nbformat.read(ROOT / 'notebooks' / lesson.notebook, as_version=4)
    texts = [cell.source for cell in notebook.cells if cell.cell_type == 'markdown']
    reading = len(' '.join(texts).split()) / WORDS_A_MINUTE
    least = reading + len(lesson.exercises) * exercise_minutes(number)
    assert least <= minutes_of(number) <= least + RUNNING
    assert lesson.minutes == minutes_of(number)


def test_each_of_five_sessions_is_long_enough() -> None:
    found = rows('Five sessions')
    assert len(found) == 5
    for _, lessons, left, minutes, *_ in found:
        names = re.findall(r'`(\w+)`', left)
        wanted = 0
        for number in lessons.split(', '):
            own = [name for name in names if name in {e.name for e in LESSONS[number].exercises}]
            names = [name for name in names if name not in own]
            wanted += minutes_of(number) - len(own) * exercise_minutes(number)
        assert not names, 'exercises of other lessons'
        assert wanted == int(minutes) <= SESSION


def test_the_whole_course_adds_up() -> None:
    found, spent = rows('The whole course'), 0
    assert [name[:2] for name, *_ in found] == sorted(LESSONS)
    for name, minutes, sessions, _ in found:
        assert int(minutes) == minutes_of(name[:2])
        first, last = spent // SESSION + 1, math.ceil((spent + int(minutes)) / SESSION)
        assert sessions == (f'{first} to {last}' if last > first else f'{first}')
        spent += int(minutes)
    assert f'are {spent} minutes, or eighteen sessions' in PAGE
    assert math.ceil(spent / SESSION) == 18
