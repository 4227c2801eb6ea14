from __future__ import annotations

import subprocess
import sys

from labkit.course.all_words import all_words


def test_all_that_a_learner_can_read_is_listed() -> None:
    lines = [line.split('\t') for line in all_words()]
    assert all(len(line) == 3 and all(line) for line in lines)
    found = {(path, key): text for path, key, text in lines}
    evens = 'labkit/lessons/odds/evens.yaml'
    assert found[evens, 'hints.1'].startswith('One node may have a publisher')
    assert found[evens, 'mistakes.evens/doubled.why'].startswith('The number is doubled.')
    assert (evens, 'mistakes.evens/doubled.change') not in found
    quiz = 'labkit/lessons/odds/quiz.yaml', 'quizzes.warm_up.1.options.1.right'
    assert found[quiz] == 'ros2 topic hz'
    assert ('labkit/exercises/common_mistakes.yaml', 'mistakes.spin/flood.todo') in found
    assert ('notebooks/04_odds.ipynb', 'evens-task') in found


def test_who_has_read_enough_sees_no_traceback() -> None:
    command = [sys.executable, '-m', 'labkit', 'docs', '--words']
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as program:
        assert program.stdout is not None and program.stderr is not None
        assert program.stdout.readline().count('\t') == 2
        program.stdout.close()
        assert program.stderr.read() == ''
