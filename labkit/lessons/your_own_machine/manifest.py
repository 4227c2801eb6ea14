"""Exercise: a package.xml that names what the code imports."""

from __future__ import annotations

import sys

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.package.content import Built, InAWorkspace, Runs, Work, dependencies
from labkit.lessons.your_own_machine.made import COURIER

__all__ = ['exercise']

WORDS = words_of(__file__)

IMPORTED = ('rclpy', 'std_msgs', 'geometry_msgs')

MISSING = WORDS.mistake('manifest/missing')
CHANGED = WORDS.mistake('manifest/changed')
OF_PYTHON = WORDS.mistake('manifest/of-python')


def _names_imports(work: Work) -> None:
    missing = [name for name in IMPORTED if name not in dependencies(work)]
    if missing:
        raise Fail(
            'each package that courier.py imports, in package.xml',
            f'without {" and ".join(missing)}',
            (MISSING if _imports(work, missing[0]) else CHANGED).of(name=missing[0]),
        )


def _imports(work: Work, name: str) -> bool:
    """Tell whether the module still imports a package; if it can not be read, it does."""
    path = work.source / COURIER / 'courier.py'
    try:
        return name in path.read_text(encoding='utf-8', errors='replace')
    except OSError:
        return True


def _names_no_module(work: Work) -> None:
    wrong = [name for name in dependencies(work) if name in sys.stdlib_module_names]
    if wrong:
        raise Fail('names of packages in package.xml', wrong[0], OF_PYTHON.of(name=wrong[0]))


def _is_untouched(work: Work) -> bool:
    path = work.source / 'package.xml'
    return path.is_file() and not work.build.is_dir() and path.read_text().count('<depend>') == 1


exercise = Exercise(
    words=WORDS,
    clauses=(
        Built(COURIER),
        Asked(WORDS.clause('names-imports'), _names_imports),
        Asked(WORDS.clause('names-no-module'), _names_no_module),
        Runs('courier', 'courier', COURIER),
    ),
    stage=InAWorkspace(COURIER, _is_untouched),
)
