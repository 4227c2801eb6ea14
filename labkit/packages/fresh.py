"""Whether the module of an exported class loads without the notebook, and what it lacks."""

from __future__ import annotations

import ast
import json
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

from labkit.errors import LabError
from labkit.files import read_json
from labkit.packages.cells import Notebook, place
from labkit.packages.gather import Gathered
from labkit.settings import prepared_variables

__all__ = ['lacking_imports']

_SCRIPT = Path(__file__).with_name('fresh_python.py')
# What `lab.source` adds packages to.
_SOURCED = ('AMENT_PREFIX_PATH', 'LD_LIBRARY_PATH', 'PYTHONPATH')
# rclpy takes a second, on a busy machine ten.
LOAD_SEC = 60
# For Python to start and to end, and for code in C that does not look at the signal.
SPARE_SEC = 20


def lacking_imports(module: str, text: str, gathered: Gathered, notebook: Notebook) -> set[str]:
    """Load a module in a fresh Python, and return the imports that it lacks.

    A cell may use `rclpy.node.Node` after `import rclpy`, since something else in the kernel has
    loaded that module.

    Args:
        module: Its full name, such as `'talk.talker'`.
        text: Its source.
        gathered: What it was made of.
        notebook: The notebook that has the cells.

    Raises:
        LabError: It does not load there. The message has the error, and its line.
    """
    answer = _load(module, text, sorted(gathered.submodules))
    if answer['error']:
        line, missing = answer['line'], answer['missing'].partition('.')[0]
        file = getattr(sys.modules.get(missing), '__file__', None)
        todo = (
            'A program has neither the other cells nor the folder of this notebook, nor '
            'variables that a cell has set. Write what the line needs into its cell.'
        )
        if file:
            todo = (
                f'Here, it is loaded from {file}, where no program looks. Write what is needed '
                'of it into a cell.'
            )
        raise LabError(
            f'{gathered.name} can not become a package: its module does not load in a fresh '
            'Python.\n' + _place(line, text, gathered, notebook) + answer['error'],
            todo=todo,
        )
    return {f'import {name}' for name in answer['lacking']}


def _load(module: str, text: str, submodules: list[str]) -> dict[str, Any]:
    """Return the answer of the script; one with an error if there is none."""
    with tempfile.TemporaryDirectory(prefix='labkit-') as name:
        folder = Path(name)
        package, _, own = module.partition('.')
        (folder / package).mkdir()
        (folder / package / '__init__.py').touch()
        (folder / package / f'{own}.py').write_text(text, encoding='utf-8')
        asked = {
            'module': module,
            'submodules': submodules,
            'answer': str(folder / 'answer.json'),
            'seconds': LOAD_SEC,
        }
        process = subprocess.Popen(
            [sys.executable, '-c', _SCRIPT.read_text(encoding='utf-8'), json.dumps(asked)],
            cwd=folder,
            env=_variables(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # The stop button ends it below, with all that the module has started.
            start_new_session=True,
        )
        try:
            with suppress(subprocess.TimeoutExpired):
                process.wait(LOAD_SEC + SPARE_SEC)
            ended = process.poll()
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        with suppress(FileNotFoundError):
            answer: dict[str, Any] = read_json(folder / 'answer.json')
            return answer
    state = 'It does not end.' if ended is None else f'Python ended with exit code {ended}.'
    return {'lacking': [], 'error': state, 'line': 0, 'missing': ''}


def _variables() -> dict[str, str]:
    """Return the variables of this process without those that cells have set."""
    sourced = {name: os.environ[name] for name in _SOURCED if name in os.environ}
    return {**prepared_variables, **sourced}


def _place(line: int, text: str, gathered: Gathered, notebook: Notebook) -> str:
    """Return the place in a cell of a line of a module, `''` if it is not known."""
    lines = text.splitlines()
    for definition in gathered.definitions:
        body = definition.text
        first = text[: text.find(body)].count('\n') + 1 if body in text else line + 1
        last = first + body.count('\n')
        if first <= line <= last:
            end = definition.node.end_lineno or definition.node.lineno
            return f'{place(definition.cell, end - (last - line))}\n'
    if not line:
        return ''
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Import, ast.ImportFrom)) and node.lineno == line:
            alias = node.names[0]
            found = notebook.find(alias.asname or alias.name.partition('.')[0])
            if found is not None:
                return f'{place(found.cell, found.node.lineno)}\n'
    return f'{lines[line - 1]}\n'
