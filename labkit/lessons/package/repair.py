"""Exercise: a package whose build fails, and then one of its programs."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.lessons.package.content import Built, InAWorkspace, Work
from labkit.lessons.package.made import BROKEN
from labkit.lessons.package.running import Running

__all__ = ['exercise']

WORDS = words_of(__file__)


def _is_untouched(work: Work) -> bool:
    setup = work.source / 'setup.py'
    if work.build.is_dir() or not setup.is_file():
        return False
    text = setup.read_text(encoding='utf-8', errors='replace')
    return "teller:main'\n" in text and 'hearer:mian' in text


exercise = Exercise(
    words=WORDS,
    clauses=(
        Built(BROKEN),
        Running('teller', 'teller', BROKEN),
        Running('hearer', 'hearer', BROKEN),
    ),
    stage=InAWorkspace(BROKEN, _is_untouched),
)
