"""Exercise: a package whose build fails, and then one of its programs."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.lessons.package.content import Built, InAWorkspace, Work
from labkit.lessons.package.made import BROKEN
from labkit.lessons.package.running import Running

__all__ = ['exercise']


def _is_untouched(work: Work) -> bool:
    setup = work.source / 'setup.py'
    if work.build.is_dir() or not setup.is_file():
        return False
    text = setup.read_text(encoding='utf-8', errors='replace')
    return "teller:main'\n" in text and 'hearer:mian' in text


exercise = Exercise(
    name='repair',
    task='Repair the package broken_lab, build it, and run both of its programs in terminals.',
    clauses=(
        Built(BROKEN),
        Running('teller', 'teller', BROKEN),
        Running('hearer', 'hearer', BROKEN),
    ),
    stage=InAWorkspace(BROKEN, _is_untouched),
    hints=[
        'Build it, and look at the lines under stderr. What is Python not content with?',
        'Two pieces of text without a comma between them become one piece.',
        'The first fault is a comma that is missing after the teller. The second one: a function '
        'main is called mian. Then, in each of two terminals: cd ros2_ws, '
        'source install/setup.bash, and ros2 run.',
    ],
    answer=Solution(
        __file__,
        'repair.sh',
        'Without the comma Python makes one entry of the two. The wrong name of a function is '
        'found only when the program runs.',
    ),
)
