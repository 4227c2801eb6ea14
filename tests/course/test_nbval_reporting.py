"""What `pytest --nbval` finds in a lesson, and how it tells: real runs on small lessons."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import nbformat
import pytest
from course.dots import BLACK, WHITE
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from labkit.course.pytest_plugin import uses_labkit
from labkit.course.record import record

PLUGIN = 'labkit.course.pytest_plugin'
Run = Callable[..., tuple[dict[str, str], str]]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / 'course' / 'notebooks'
    path.mkdir(parents=True)
    return path


@pytest.fixture
def nbval(folder: Path, installed: dict[str, str]) -> Run:
    """Give a function that runs nbval, and returns what came of each test, and all it printed."""

    def run(*arguments: str) -> tuple[dict[str, str], str]:
        report = folder / 'report.xml'
        command = [sys.executable, '-m', 'pytest', '--nbval', '-v', '-p', 'no:cacheprovider']
        command += [
            '--nbval-kernel-startup-timeout=240',
            '-W',
            'error',
            '-W',
            'ignore::ResourceWarning',
            f'--junitxml={report}',
        ]
        done = subprocess.run(
            [*command, *(arguments or ['notebooks'])],
            cwd=folder.parent,
            env=installed,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert report.exists(), done.stderr
        cases = ElementTree.parse(report).iter('testcase')
        outcomes = {
            case.get('name', ''): (case[0].tag if len(case) else 'passed') for case in cases
        }
        return outcomes, done.stdout

    return run


def write(path: Path, cells: dict[str, str], tags: dict[str, str] | None = None) -> None:
    notebook = new_notebook(cells=[new_code_cell(text, id=name) for name, text in cells.items()])
    notebook.metadata.labkit = {}
    for cell in notebook.cells:
        if tags and cell.id in tags:
            cell.metadata.tags = [tags[cell.id]]
    nbformat.write(notebook, path)


def change(path: Path, changes: dict[str, Callable[[NotebookNode], object]]) -> None:
    """Change what is stored of some cells."""
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        changes.get(cell.id, lambda cell: None)(cell)
    nbformat.write(notebook, path)


def section(output: str, cell_id: str) -> str:
    """Return what is reported about one cell."""
    return re.split(rf'\n_+ \w+::{cell_id} _+\n', output)[1].split('\n____')[0].split('\n====')[0]


CELLS = {
    'same': 'print("hello")',
    'text': 'print("hello")\nprint("world")',
    'space': 'print("hello")',
    'line-break': 'print("hello", end="")',
    'errors': 'import sys; print("careful", file=sys.stderr)',
    'result': '6 * 7',
    'extra': 'print("hello")',
    'missing': 'pass',
    'order': 'from IPython.display import display\ndisplay(1)\ndisplay(2)',
    'html': 'from IPython.display import HTML\nHTML("<b>2</b>")',
    'data': 'display({"application/json": {"a": [1, 2]}}, raw=True)',
    'meant': 'raise ValueError("no")',
    'exempted': 'import time; print(time.monotonic())',
    'needs': 'print("not installed")',
    'picture': f'display({{"image/png": "{BLACK}", "text/plain": "a dot"}}, raw=True)',
    'picture-text': f'display({{"image/png": "{BLACK}", "text/plain": "a dot"}}, raw=True)',
}
TAGS = {'meant': 'raises-exception', 'exempted': 'nbval-ignore-output'}


def stores(index: int, **fields: object) -> Callable[[NotebookNode], object]:
    return lambda cell: cell.outputs[index].update(**fields)


def displays(**data: object) -> Callable[[NotebookNode], object]:
    named = {mime.replace('__', '/'): value for mime, value in data.items()}
    return lambda cell: cell.outputs[0].data.update(named)


def needs_what_is_not_here(cell: NotebookNode) -> None:
    cell.metadata.labkit = {'needs': 'a_package_that_nobody_has'}
    cell.outputs[0].update(text='something else\n')


CHANGES: dict[str, Callable[[NotebookNode], object]] = {
    'text': stores(0, text='hallo\nworld\n'),
    'space': stores(0, text='hello  \n'),
    'line-break': stores(0, text='hello\n'),
    'errors': stores(0, text='harmless\n'),
    'result': displays(text__plain='41'),
    'extra': lambda cell: cell.outputs.clear(),
    'missing': lambda cell: cell.outputs.append(new_output('stream', name='stderr', text='x')),
    'order': lambda cell: cell.outputs.reverse(),
    'html': displays(text__html='<b>1</b>'),
    'data': displays(application__json={'a': [1, 3]}),
    'meant': stores(0, evalue='yes'),
    'exempted': stores(0, text='something else\n'),
    'needs': needs_what_is_not_here,
    'picture': displays(image__png=WHITE),
    'picture-text': displays(text__plain='a line'),
}
PASS = {'same', 'exempted', 'needs', 'picture'}


def test_every_difference_is_found_and_shown(folder: Path, nbval: Run):
    write(folder / '01_one.ipynb', {'setup': 'pass', **CELLS}, TAGS)
    assert record(folder=folder) == 0
    outcomes, _ = nbval()
    assert set(outcomes.values()) == {'passed'} and list(outcomes) == ['setup', *CELLS]

    change(folder / '01_one.ipynb', CHANGES)
    outcomes, output = nbval()
    assert {name for name in CELLS if outcomes[name] == 'passed'} == PASS
    told = section(output, 'text')
    assert "Lesson 01_one, cell 'text': it does not show what is stored" in told
    assert '    print("hello")\n    print("world")\n' in told
    assert '-  hallo\n+  hello\n   world\n' in told
    assert f'python3 -m labkit record {folder / "01_one.ipynb"}' in told
    assert '-  hello··\n+  hello\n' in section(output, 'space')
    assert '+[stdout] (without a line break at the end)\n' in section(output, 'line-break')
    assert '-  harmless\n+  careful\n' in section(output, 'errors')
    assert '-  41\n+  42\n' in section(output, 'result')
    assert '+[stdout]\n+  hello\n' in section(output, 'extra')
    assert '-  x\n' in section(output, 'missing')
    assert '-  <b>1</b>\n+  <b>2</b>\n' in section(output, 'html')
    assert '-  ValueError: yes\n+  ValueError: no\n' in section(output, 'meant')


@pytest.mark.slow('it runs lessons in a pytest of its own')
def test_each_lesson_tells_what_went_wrong_in_it(folder: Path, nbval: Run):
    write(folder / '01_one.ipynb', {'long': 'for i in range(100):\n    print("line", i)'})
    record(folder=folder)
    longer = ''.join(f'line {i if i != 50 else "fifty"}\n' for i in range(100))
    change(folder / '01_one.ipynb', {'long': stores(0, text=longer)})
    write(folder / '02_two.ipynb', {'raises': 'x = 1\ny', 'after': 'print(x)'})
    deadly = 'import os\nos.write(2, b"my last words")\nos.kill(os.getpid(), 11)'
    change(folder / '02_two.ipynb', {'after': lambda cell: cell.update(execution_count=2)})
    write(folder / '03_three.ipynb', {'dies': deadly, 'skipped': 'pass'})
    write(folder / '04_four.ipynb', {'tagged': 'pass'}, {'tagged': 'nbval-skip'})

    outcomes, output = nbval()
    failed = {'long', 'raises', 'after', 'dies'}
    assert {name for name, outcome in outcomes.items() if outcome == 'failure'} == failed
    # nbval expects a cell to fail whose kernel is gone: only the first is reported.
    assert outcomes['skipped'] == outcomes['tagged'] == 'skipped'

    told = section(output, 'long')
    assert '   line 49\n-  line fifty\n+  line 50\n   line 51\n' in told
    assert 'line 40' not in told and 'line 60' not in told
    told = section(output, 'raises')
    assert "Lesson 02_two, cell 'raises': it raised NameError: name 'y' is not defined" in told
    assert '----> 2 y' in told and '\x1b' not in told
    # The cell after it runs all the same, and is compared.
    assert '+  1\n' in section(output, 'after')
    told = section(output, 'dies')
    assert 'Kernel died' in told and 'my last words' in told


@pytest.mark.slow('waits for what hangs')
def test_a_cell_that_hangs_is_ended(folder: Path, nbval: Run):
    write(folder / '01_one.ipynb', {'long': 'import time\ntime.sleep(1000)', 'next': 'pass'})
    outcomes, output = nbval('--nbval-cell-timeout=10', 'notebooks')
    # nbval expects the next one to fail, too; it does not.
    assert outcomes == {'long': 'failure', 'next': 'passed'}
    told = section(output, 'long')
    assert 'it took longer than 10 s and was interrupted' in told and '----> 2 time.sleep' in told


@pytest.mark.slow('it runs lessons in a pytest of its own')
def test_two_workers_can_share_the_lessons(folder: Path, nbval: Run):
    cells = {'first': 'x = [1]', 'second': 'x.append(2)', 'third': 'x'}
    for name in ('01_one', '02_two'):
        write(folder / f'{name}.ipynb', cells)
    record(folder=folder)
    outcomes, output = nbval('-n', '2', '--dist', 'loadscope', 'notebooks')
    assert set(outcomes.values()) == {'passed'}, output
    assert output.count('PASSED') == 6


@pytest.mark.slow('it runs lessons in a pytest of its own')
def test_one_cell_can_be_run_alone(folder: Path, nbval: Run):
    write(folder / '01_one.ipynb', {'first': 'x = [1]', 'second': 'x.append(2)', 'third': 'x'})
    record(folder=folder)
    write(folder / '02_two.ipynb', {'early': 'wrong', 'late': 'pass'})
    outcomes, output = nbval('notebooks/01_one.ipynb::third', 'notebooks/02_two.ipynb::late')
    assert outcomes == {'third': 'passed', 'late': 'failure'}, output
    assert "cell 'late': cell 'early', which runs before it: it raised NameError" in output


@pytest.mark.parametrize(
    ('cell', 'is_ours'),
    [
        ('import labkit as lab', True),
        ('    from labkit import spin', True),
        ('import os, labkit', True),
        ('print("import labkit")', False),
        ('import labkit_like', False),
    ],
)
def test_what_is_in_a_notebook_says_whose_it_is(tmp_path: Path, cell: str, is_ours: bool):
    path = tmp_path / 'any.ipynb'
    cells = [new_markdown_cell('import labkit'), new_code_cell(f'x = 1\n{cell}')]
    nbformat.write(new_notebook(cells=cells), path)
    assert uses_labkit(path) is is_ours


@pytest.mark.parametrize('text', ['', '[]', '{"metadata": {}, "cells": [1]}', '\xff'])
def test_a_file_that_is_no_notebook_is_left_to_nbval(tmp_path: Path, text: str):
    path = tmp_path / 'any.ipynb'
    path.write_text(text, encoding='latin-1')
    assert not uses_labkit(path)


@pytest.mark.slow('runs pytest on notebooks')
def test_other_notebooks_are_compared_by_nbval(folder: Path, nbval: Run):
    write(folder / '01_ours.ipynb', {'first': 'import labkit\n1'})
    record(folder=folder)
    path = folder / 'theirs.ipynb'
    nbformat.write(new_notebook(cells=[new_code_cell('1', id='one')]), path)
    outcomes, output = nbval()
    # nbval counts cells.
    assert outcomes == {'first': 'passed', 'Cell 0': 'passed'}, output


@pytest.mark.slow('runs pytest on notebooks')
def test_the_plugin_may_be_asked_for_again(folder: Path, nbval: Run):
    write(folder / '01_one.ipynb', {'first': '1', 'second': '2'})
    record(folder=folder)
    (folder.parent / 'conftest.py').write_text(f'pytest_plugins = [{PLUGIN!r}]')
    outcomes, output = nbval('-p', PLUGIN, 'notebooks')
    assert outcomes == {'first': 'passed', 'second': 'passed'}, output
    assert output.count('PASSED') == 2


@pytest.mark.slow('runs pytest on notebooks')
def test_tests_of_others_notice_nothing(tmp_path: Path, installed: dict[str, str]):
    (tmp_path / 'test_mine.py').write_text("""
import json, os, sys

def test_mine():
    with open('seen.json', 'w') as file:
        json.dump([sorted(sys.modules), sys.path, dict(os.environ)], file)
    import labkit
    assert os.environ['ROS_PYTHON_CHECK_FIELDS'] == '1'
""")
    seen = []
    for options in ([], ['-p', f'no:{PLUGIN}']):
        command = [sys.executable, '-m', 'pytest', '-v', '-p', 'no:cacheprovider', *options]
        done = subprocess.run(
            command, cwd=tmp_path, env=installed, capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0, done.stdout + done.stderr
        seen.append(json.loads((tmp_path / 'seen.json').read_text()))
    # Nothing of labkit is loaded, nothing for it, and the variables are those of before.
    assert seen[0] == seen[1]
    assert 'rclpy' not in seen[0][0]
