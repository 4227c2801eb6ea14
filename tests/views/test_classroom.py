"""The live view of a class: it looks only while it is seen, and waits for no folder."""

from __future__ import annotations

import pytest

STAGE = """
import threading
import labkit as lab
from labkit.views import classroom
from labkit.views.class_board import Board, FailRow, LearnerRow, LessonRow
from labkit.views.classroom import Classroom
classroom.READ_SEC = 0.01
looks, free = [], threading.Event()
free.set()

def look():
    looks.append(threading.current_thread().name)
    free.wait()
    return Board(
        shared=len(looks), at_work=1, stuck=1,
        lessons=[LessonRow('04 Odd numbers', 1, [('ones', 1, 0)])],
        fails=[FailRow(1, '04 Odd numbers, ones', 'It is not.')],
        learners=[LearnerRow('Anna', 'x', 1, 'odds.ones', 'FAIL', 12, 1, '')],
        exercise_count=46,
    )

def threads():
    return sum(thread.name == 'labkit classroom' for thread in threading.enumerate())

class Page:
    # What a page would get, and what it would say.
    def __init__(self, view):
        self.widget, self.known = view._widget, {}
        self.widget.send = lambda content, buffers=None: self.known.update(content)
        self.say('seen')

    def say(self, word):
        self.widget._handle_custom_msg({'view': word}, [])
"""


@pytest.fixture
def stage(run):
    run(STAGE)
    return run


def test_it_looks_while_it_is_seen_and_in_a_thread_of_its_own(stage):
    stage('view = Classroom(look, names=False)\npage = Page(view)')
    stage('lab.wait_until(lambda: page.known["figures"][0] > 5, timeout_sec=60)')
    assert stage('print(set(looks[1:]), threads())') == "{'labkit classroom'} 1"
    assert stage('print(page.known.get("learners"), page.known["fails"])') == (
        "None [[1, '04 Odd numbers, ones', 'It is not.']]"
    )
    stage('page.say("gone")\nlab.wait_until(lambda: not threads(), timeout_sec=60)')
    # Seen again, it looks again; closed, no more.
    stage('page.say("seen")\nprint(threads())')
    stage('view.close()\nlab.wait_until(lambda: not threads(), timeout_sec=60)')
    assert stage('print("has ended" in page.known["ended"])') == 'True'


@pytest.mark.slow('waits for what does not answer')
def test_a_folder_that_does_not_answer_holds_up_nothing(stage):
    stage('view = Classroom(look, names=True)\npage = Page(view)')
    stage('lab.wait_until(lambda: page.known["figures"][0] > 2, timeout_sec=60)')
    stage('classroom.SILENT_SEC = 0.1\nfree.clear()')
    stage('lab.wait_until(lambda: page.known["note"] == classroom.SILENT, timeout_sec=60)')
    assert stage('print(page.known["learners"][0][0])') == 'Anna'
    # To close it does not wait either. When the folder is back, the thread ends.
    stage('view.close()\nfree.set()\nlab.wait_until(lambda: not threads(), timeout_sec=60)')


def test_names_are_told_only_where_they_are_asked_for_and_never_stored(stage):
    for names in (False, True):
        stage(f'view = Classroom(look, names={names})')
        assert stage('print("Anna" in repr(view))') == str(names)
        assert stage('print("Anna" in view._static()["text/plain"])') == 'False'
        assert stage('print("share their progress" in view._static()["text/plain"])') == 'True'
