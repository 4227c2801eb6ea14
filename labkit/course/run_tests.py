"""Run the test suite, or a part of it: style, types, format, layers, notebooks and tests."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

from labkit.errors import LabError
from labkit.setup.environment import ROOT, VENV, environment_variables, make_environment

__all__ = ['SHARDS', 'run_tests']

REQUIREMENTS = (
    *('environment.txt', 'labkit/hub/requirements.txt'),
    *('tests/requirements.txt', 'docs/requirements.txt'),
)
# Fast tests of the code as it stands; they come first and are not repeated later.
_FAST_TESTS = (
    'tests/test_layers.py',
    'tests/test_notebook_format.py',
    'tests/test_docs.py',
    'tests/test_requirements.py',
    'tests/course/test_shards.py',
    'tests/course/test_public_names.py',
    'tests/lessons/test_answers_style.py',
)
# Parts that continuous integration runs in parallel. The last one has everything that no other
# has, so that a new test is in exactly one of them.
SHARDS = {
    'lessons': ('notebooks', 'tests/lessons'),
    'ros': (
        *('tests/background', 'tests/asking', 'tests/programs', 'tests/sharing'),
        *('tests/ros2', 'tests/exercises'),
    ),
    'browser': ('tests/browser', 'tests/network', 'tests/views'),
    'rest': ('tests',),
}
# The limit judges nothing. It ends a test that hangs.
_PYTEST = ('pytest', '--nbval', '--timeout=900')
# One worker per processor: that of the proofs alone keeps eight kernels busy. A notebook runs in
# one worker from top to bottom, so that its cells share a kernel. tests/conftest.py decides which
# files come first.
_PROCESSORS = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else 2
_PARALLEL = ('-n', str(max(2, _PROCESSORS)), '--dist', 'loadscope', '--no-loadscope-reorder')


def run_tests(
    arguments: Sequence[str] = (),
    *,
    fast: bool = False,
    shard: str | None = None,
    coverage: bool = False,
) -> int:
    """Make the environment and run the tests in it.

    Args:
        arguments: Options and paths for pytest. With any, only pytest runs. Numbers of lessons
            come first, such as `04`: its cells, its format, and the proofs of its exercises.
        fast: Whether to run only what takes seconds: style, types, layers, format of notebooks.
        shard: The part of the notebooks and tests to run, None for all; see `SHARDS`.
        coverage: Whether to measure the coverage of labkit, kernels included.

    Returns:
        The exit code of the first step that failed, or 0. Running no test is a failure too.

    Raises:
        LabError: The options exclude each other.
    """
    steps = _steps(arguments, fast=fast, shard=shard)
    if coverage:
        steps = _measured(steps)
    python = make_environment(REQUIREMENTS)
    variables = _variables()
    for name, command in steps:
        print(f'\n== {name}: {" ".join(command)}', flush=True)
        done = subprocess.run([str(python), '-m', *command], cwd=ROOT, env=variables)
        if done.returncode != 0:
            code = done.returncode
            print(f'\nlabkit test: {name} failed (exit code {code}).', file=sys.stderr, flush=True)
            return code
    print('\nlabkit test: all passed.', flush=True)
    return 0


def _steps(
    arguments: Sequence[str] = (), *, fast: bool = False, shard: str | None = None
) -> list[tuple[str, list[str]]]:
    if fast:
        if arguments or shard:
            raise LabError('--fast runs a fixed list of checks: give it no other words.')
        return _fast_steps()
    done = [f'--ignore={path}' for path in _FAST_TESTS]
    run = [*_PYTEST, *_PARALLEL]
    lessons = list(takewhile(str.isdigit, arguments))
    if lessons and not shard:
        others = arguments[len(lessons) :]
        return [(f'lesson {number}', [*run, *_of_lesson(number), *others]) for number in lessons]
    if shard:
        return [(f'tests of {shard}', [*run, *shard_paths(shard), *done, *arguments])]
    if arguments:
        chosen = any((ROOT / argument.split('::')[0]).exists() for argument in arguments)
        paths = [] if chosen else ['notebooks', 'tests']
        return [('tests', [*run, *paths, *arguments])]
    return [*_fast_steps(), ('notebooks and tests', [*run, 'notebooks', 'tests', *done])]


def _of_lesson(number: str) -> list[str]:
    """Return the pytest arguments that select the tests of a lesson, such as `04`.

    Raises:
        LabError: There is no such lesson.
    """
    folder = ROOT / 'notebooks'
    found = sorted(path.stem for path in folder.glob(f'{int(number):02}_*.ipynb'))
    if not found:
        names = ', '.join(path.stem for path in sorted(folder.glob('*.ipynb')))
        raise LabError(f'There is no lesson {number}.', todo=f'The lessons are: {names}.')
    lesson, name = found[0], found[0].partition('_')[2]
    # The proofs of exercises have the lesson's name in their ids.
    chosen = ['-k', f'{lesson} or {name}-']
    return [f'notebooks/{lesson}.ipynb', 'tests/test_notebook_format.py', 'tests/lessons', *chosen]


def _fast_steps() -> list[tuple[str, list[str]]]:
    return [
        ('style', ['ruff', 'check', '.']),
        ('format', ['ruff', 'format', '--check', '.']),
        ('types', ['mypy']),
        ('layers and format', ['pytest', '-q', *_FAST_TESTS]),
    ]


def shard_paths(name: str) -> list[str]:
    """Return the pytest arguments that select a shard: folders, and what to ignore in them."""
    others = [path for other, paths in SHARDS.items() if other != name for path in paths]
    inner = [
        path
        for path in others
        if any(path != own and path.startswith(f'{own}/') for own in SHARDS[name])
    ]
    return [*SHARDS[name], *(f'--ignore={path}' for path in inner)]


# --- Coverage ------------------------------------------------------------------------------------


def _measured(steps: list[tuple[str, list[str]]]) -> list[tuple[str, list[str]]]:
    """Wrap the tests among the steps in coverage, and add its report."""
    if not any(command[:2] == list(_PYTEST[:2]) for _, command in steps):
        raise LabError('--coverage measures tests: there are none in --fast.')
    result = [('coverage of before', ['coverage', 'erase'])]
    for name, command in steps:
        tests = command[:2] == list(_PYTEST[:2])
        result.append((name, ['coverage', 'run', '-m', *command] if tests else command))
    page = _cache() / 'coverage' / 'index.html'
    return [
        *result,
        ('coverage put together', ['coverage', 'combine', '--quiet']),
        (f'coverage, also in {page}', ['coverage', 'html', '--quiet', '-d', str(page.parent)]),
        ('coverage', ['coverage', 'report']),
    ]


def _cache() -> Path:
    return Path(os.environ.get('LABKIT_CACHE', VENV / 'cache'))


def _variables() -> dict[str, str]:
    """Return the variables for the steps: caches of tools go into the environment's folder."""
    variables = environment_variables()
    cache = _cache()
    variables['COVERAGE_FILE'] = str(cache / 'coverage.data')
    variables['RUFF_CACHE_DIR'] = str(cache / 'ruff')
    variables['MYPY_CACHE_DIR'] = str(cache / 'mypy')
    variables['HYPOTHESIS_STORAGE_DIRECTORY'] = str(cache / 'hypothesis')
    variables['PYTEST_ADDOPTS'] = (
        f'-o cache_dir={cache / "pytest"} ' + variables.get('PYTEST_ADDOPTS', '')
    ).strip()
    return variables
