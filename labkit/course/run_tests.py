"""Run the whole test suite: style, types, format, layers, then every notebook and every test."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from labkit.setup.environment import ROOT, VENV, environment_variables, make_environment

__all__ = ['run_tests']

REQUIREMENTS = ('environment.txt', 'tests/requirements.txt')
# Quick, and about the code as it stands; they come first and are not repeated later.
_FORMAT_TESTS = ('tests/test_layers.py', 'tests/test_notebook_format.py')
_PYTEST = ('pytest', '--nbval', '--timeout=300')
# One worker runs a notebook from top to bottom, so that its cells share a kernel.
_PARALLEL = ('-n', '2', '--dist', 'loadscope')


def run_tests(arguments: Sequence[str] = ()) -> int:
    """Make the environment and run the tests in it.

    Args:
        arguments: Options and paths for pytest. With any, only pytest runs.

    Returns:
        The exit code of the first step that failed, or 0. No test at all is a failure too.
    """
    python = make_environment(REQUIREMENTS)
    for name, command in _steps(arguments):
        print(f'\n== {name}: {" ".join(command)}', flush=True)
        code = subprocess.run([str(python), '-m', *command], cwd=ROOT, env=_variables()).returncode
        if code != 0:
            print(f'\nlabkit test: {name} failed (exit code {code}).', file=sys.stderr, flush=True)
            return code
    print('\nlabkit test: all passed.', flush=True)
    return 0


def _steps(arguments: Sequence[str]) -> list[tuple[str, list[str]]]:
    if arguments:
        chosen = any((ROOT / argument.split('::')[0]).exists() for argument in arguments)
        paths = [] if chosen else ['notebooks', 'tests']
        return [('tests', [*_PYTEST, *_PARALLEL, *paths, *arguments])]
    done = [f'--ignore={path}' for path in _FORMAT_TESTS]
    return [
        ('style', ['ruff', 'check', '.']),
        ('format', ['ruff', 'format', '--check', '.']),
        ('types', ['mypy', '--strict', 'labkit']),
        ('layers and notebook format', ['pytest', '-q', *_FORMAT_TESTS]),
        ('notebooks and tests', [*_PYTEST, *_PARALLEL, 'notebooks', 'tests', *done]),
    ]


def _variables() -> dict[str, str]:
    """Return the variables for the steps: what the tools remember goes into the environment."""
    variables = environment_variables()
    cache = Path(os.environ.get('LABKIT_CACHE', VENV / 'cache'))
    variables['RUFF_CACHE_DIR'] = str(cache / 'ruff')
    variables['MYPY_CACHE_DIR'] = str(cache / 'mypy')
    variables['HYPOTHESIS_STORAGE_DIRECTORY'] = str(cache / 'hypothesis')
    variables['PYTEST_ADDOPTS'] = (
        f'-o cache_dir={cache / "pytest"} ' + variables.get('PYTEST_ADDOPTS', '')
    ).strip()
    return variables
