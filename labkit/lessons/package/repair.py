"""Exercise: a package whose build fails, and then one of its programs."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.lessons.package.content import Built, InAWorkspace, Runs, Work
from labkit.lessons.package.made import BROKEN

__all__ = ['repair']


def _is_untouched(work: Work) -> bool:
    setup = work.source / 'setup.py'
    if work.build.is_dir() or not setup.is_file():
        return False
    text = setup.read_text(encoding='utf-8', errors='replace')
    return "talker:main'\n" in text and 'listener:mian' in text


repair = Exercise(
    name='repair',
    task='Repair the package broken_lab, build it, and let both of its programs run.',
    clauses=(
        Built(BROKEN),
        Runs('talker', 'talker', BROKEN),
        Runs('listener', 'listener', BROKEN),
    ),
    stage=InAWorkspace(BROKEN, _is_untouched),
    hints=[
        'Build it, and look at the lines under stderr. What is Python not content with?',
        'Two pieces of text without a comma between them become one piece.',
        'The first fault is a comma that is missing after the talker. The second one: a function '
        'main is called mian.',
    ],
    answer=Solution(
        __file__,
        'repair.ipy',
        'Without the comma Python makes one entry of the two. The wrong name of a function is '
        'found only when the program runs.',
    ),
)
