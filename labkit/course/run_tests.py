"""Run the test suite, or a part of it: style, types, format, layers, notebooks and tests."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

from labkit.errors import LabError
from labkit.setup.environment import ROOT, VENV, environment_variables, make_environment
from labkit.setup.machine import VERSIONS, clean_environment, interpreters

__all__ = ['run_tests']

REQUIREMENTS = (
    *('environment.txt', 'labkit/hub/requirements.txt', 'labkit/sim/physics/requirements.txt'),
    *('tests/requirements.txt', 'docs/requirements.txt'),
)
# Fast tests of the code as it stands; they come first and are not repeated later.
_FAST_TESTS = (
    'tests/test_layers.py',
    'tests/test_notebook_format.py',
    'tests/test_docs.py',
    'tests/test_requirements.py',
    'tests/test_quarantine.py',
    'tests/course/test_workflows.py',
    'tests/course/test_public_names.py',
    'tests/lessons/test_answers_style.py',
)
# The limits judge nothing. They end what hangs: a cell, a kernel that starts, a test.
_LIMITS = (
    '--nbval-cell-timeout=60',
    '--nbval-kernel-startup-timeout=120',
    '--timeout=900',
)
_PYTEST = ('pytest', '--nbval', *_LIMITS, '-p', 'tests.gate')
# Two workers for each processor: many tests mostly wait. (Of the gate on two processors, three
# took 13 min 16 s and left a quarter of them idle, four 12 min 17 s.) A notebook runs in one
# worker from top to bottom, so that its cells share a kernel. tests/conftest.py decides which
# files come first.
_PROCESSORS = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else 2
_PARALLEL = ('-n', str(2 * _PROCESSORS), '--dist', 'loadscope', '--no-loadscope-reorder')
_GATE = ('-m', 'not slow and not quarantined')
# More than that is no test that flakes: something is broken, and a second try would hide how much.
_MOST_FLAKES = 12


def run_tests(
    arguments: Sequence[str] = (),
    *,
    everything: bool = False,
    fast: bool = False,
    coverage: bool = False,
) -> int:
    """Make the environment and run the tests in it.

    Args:
        arguments: Options and paths for pytest. With any, only pytest runs. Numbers of lessons
            come first, such as `04`: its cells, its format, and the proofs of its exercises.
        everything: Whether to run slow tests and quarantined ones as well, and then the quick
            checks and the notebooks on each other Python of the course that is here.
        fast: Whether to run only what takes seconds: style, types, layers, format of notebooks.
        coverage: Whether to measure the coverage of labkit, kernels included.

    Returns:
        The exit code of the first step that failed, or 0. Running no test is a failure too.

    Raises:
        LabError: The options exclude each other.
    """
    steps = _steps(arguments, everything=everything, fast=fast)
    if coverage:
        steps = _measured(steps)
    python = make_environment(REQUIREMENTS)
    flaky: dict[str, str] = {}
    for name, command in steps:
        print(f'\n== {name}: {" ".join(command)}', flush=True)
        code = _run(python, command)
        if code == 1 and _may_flake(command):
            failed = json.loads(_failures().read_text(encoding='utf-8'))
            code = _second_try(python, failed)
            if code == 0:
                flaky.update(failed)
        if code != 0:
            print(f'\nlabkit test: {name} failed (exit code {code}).', file=sys.stderr, flush=True)
            return code
    if everything:
        code, said = _on_other_pythons()
        print(f'\nlabkit test: {said}', flush=True)
        if code != 0:
            return code
    _tell(flaky)
    return 0


def _run(python: Path, command: Sequence[str]) -> int:
    return subprocess.run([str(python), '-m', *command], cwd=ROOT, env=_variables()).returncode


def _steps(
    arguments: Sequence[str] = (), *, everything: bool = False, fast: bool = False
) -> list[tuple[str, list[str]]]:
    if fast:
        if arguments or everything:
            raise LabError('--fast runs a fixed list of checks: give it no other words.')
        return _fast_steps()
    run = [*_PYTEST, f'--failures={_failures()}', *_PARALLEL]
    if everything or not arguments:
        done = [f'--ignore={path}' for path in _FAST_TESTS]
        chosen = [] if everything else _GATE
        whole = [*run, *chosen, 'notebooks', 'tests', *done, *arguments]
        return [*_fast_steps(), ('notebooks and tests', whole)]
    lessons = list(takewhile(str.isdigit, arguments))
    if lessons:
        others = arguments[len(lessons) :]
        return [(f'lesson {number}', [*run, *_of_lesson(number), *others]) for number in lessons]
    named = any((ROOT / argument.split('::')[0]).exists() for argument in arguments)
    paths = [] if named else ['notebooks', 'tests']
    return [('tests', [*run, *paths, *arguments])]


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


# --- A second try --------------------------------------------------------------------------------


def _may_flake(command: Sequence[str]) -> bool:
    """Tell whether failures of a step are tried again: not those of a test that somebody named."""
    return '--dist' in command and not any('::' in word for word in command)


def _second_try(python: Path, failed: dict[str, str]) -> int:
    """Run what has failed once more, alone; return the exit code.

    A cell can't be run by itself, since its kernel has gone on: its whole notebook is.

    Args:
        python: The environment's interpreter.
        failed: Id of each test that failed -> the first line of its error.
    """
    paths = {name: name.partition('::')[0] for name in failed}
    again = sorted({p if p.endswith('.ipynb') else name for name, p in paths.items()})
    if not again or len(again) > _MOST_FLAKES:
        return 1
    print(f'\n== a second try, alone: {len(again)} of what failed', flush=True)
    return _run(python, [*_PYTEST, '-v', '-p', 'no:xdist', *again])


def _tell(flaky: dict[str, str]) -> None:
    """Say last what passed only at the second try; in the summary of a job of CI, too."""
    lines = ['labkit test: all passed.']
    if flaky:
        lines = [f'labkit test: all passed, {len(flaky)} of them only at the second try:']
        lines += [f'  {name}\n      {error}' for name, error in flaky.items()]
    text = '\n'.join(lines)
    print(f'\n{text}', flush=True)
    summary = os.environ.get('GITHUB_STEP_SUMMARY')
    if summary:
        with open(summary, 'a', encoding='utf-8') as file:
            file.write(f'```\n{text}\n```\n')


def _failures() -> Path:
    return _cache() / 'failures.json'


# --- Other Pythons -------------------------------------------------------------------------------


def _on_other_pythons() -> tuple[int, str]:
    """Run quick checks and notebooks on each other Python, in a copy with its own environment.

    Returns:
        An exit code, and which Python has passed what.
    """
    found = {one.version: one.path for one in interpreters() if one.has_pip}
    told = ['{}.{} (everything)'.format(*sys.version_info[:2])]
    for version in sorted(VERSIONS):
        name = '{}.{}'.format(*version)
        if version == sys.version_info[:2]:
            continue
        if version not in found:
            told.append(f'{name} (not here)')
            continue
        print(f'\n==== Python {name}', flush=True)
        with tempfile.TemporaryDirectory() as folder:
            course = Path(folder) / 'course'
            # The workspaces are what lessons have made: here, where git does not leave them out,
            # they would be judged as code of the course.
            ignored = shutil.ignore_patterns('.git', '.venv', '__pycache__', '*_ws')
            shutil.copytree(ROOT, course, ignore=ignored, symlinks=True)
            for words in (['--fast'], ['notebooks']):
                command = [found[version], '-m', 'labkit', 'test', *words]
                code = subprocess.run(command, cwd=course, env=clean_environment()).returncode
                if code != 0:
                    return code, f'Python {name} failed.'
        told.append(f'{name} (quick checks, notebooks)')
    return 0, f'Python {", ".join(told)}.'


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
