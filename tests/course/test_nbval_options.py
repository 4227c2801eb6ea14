"""nbval's options, tags and comments hold in notebooks that import labkit.

Each notebook is run twice: as it is, by nbval alone, and with an import of labkit in its first
cell. The notebooks do what nbval's own documentation and tests do.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import nbformat
import nbval.plugin
import pytest
from course.dots import BLACK, WHITE
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_notebook, new_output

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / 'docs/nbval.md').read_text(encoding='utf-8')


class Cell(NamedTuple):
    """A cell, what is stored of it, and what must come of it in each kind of run."""

    source: str
    stored: tuple[NotebookNode, ...] | str = ''
    tags: tuple[str, ...] = ()
    outcome: str = 'passed'
    lax: str = 'passed'
    unrun: bool = False


def text(text: str, name: str = 'stdout') -> NotebookNode:
    return new_output('stream', name=name, text=text)


def result(text: str, **mimes: str) -> NotebookNode:
    data = {'text/plain': text, **{f'image/{name}': value for name, value in mimes.items()}}
    return new_output('execute_result', data, execution_count=1)


def failure(name: str, value: str) -> NotebookNode:
    return new_output('error', ename=name, evalue=value, traceback=['elsewhere'])


NOW = 'import time\ntime.time_ns()'
OTHER = (result('1'),)
FAILS: Any = {'outcome': 'failure', 'lax': 'passed'}
RAISES: Any = {'outcome': 'failure', 'lax': 'failure'}
SKIPS: Any = {'outcome': 'skipped', 'lax': 'skipped'}
PNG = f'from IPython.display import Image\nimport base64\nImage(base64.b64decode({BLACK!r}))'
AN_IMAGE = '<IPython.core.display.Image object>'

MARKED = [
    Cell('print("hello")', 'hello\n'),
    Cell('print("hello")', 'hallo\n', **FAILS),
    Cell('print("hello")', **FAILS),
    Cell('6 * 7', (result('42'),)),
    # Comments.
    Cell(f'# NBVAL_IGNORE_OUTPUT\n{NOW}', OTHER),
    Cell(f'# PYTEST_VALIDATE_IGNORE_OUTPUT\n{NOW}', OTHER),
    Cell('if True:\n    # NBVAL_IGNORE_OUTPUT\n    print(id([]))', OTHER),
    Cell(f'# NBVAL_CHECK_OUTPUT\n{NOW}', OTHER, outcome='failure', lax='failure'),
    Cell('# NBVAL_CHECK_OUTPUT\n6 * 7', (result('42'),)),
    Cell('# NBVAL_SKIP\n1 / 0', **SKIPS),
    Cell('#NBVAL_SKIP\n1 / 0', unrun=True, **SKIPS),
    Cell('# NBVAL_RAISES_EXCEPTION\n1 / 0', (failure('ZeroDivisionError', 'division by zero'),)),
    Cell('# NBVAL_RAISES_EXCEPTION\nint("a")', (failure('ValueError', 'no'),), **FAILS),
    Cell('# NBVAL_RAISES_EXCEPTION\nint("a")', (failure('SyntaxError', 'a'),), **FAILS),
    Cell('# NBVAL_RAISES_EXCEPTION\npass', (failure('ValueError', 'no'),), **FAILS),
    Cell('# NBVAL_RAISES_EXCEPTION\npass'),
    Cell('# NBVAL_RAISES_EXCEPTION\nprint("here")\n1 / 0', 'here\n', **FAILS),
    Cell('# NBVAL_IGNORE_OUTPUT\n# NBVAL_RAISES_EXCEPTION\n1 / 0'),
    Cell('1 / 0', (failure('ZeroDivisionError', 'division by zero'),), **RAISES),
    Cell('print("still here")', 'still here\n'),
    # Tags, and both: the comment holds.
    Cell(NOW, OTHER, ('nbval-ignore-output',)),
    Cell(NOW, OTHER, ('pytest-validate-ignore-output',)),
    Cell(NOW, OTHER, ('nbval-check-output',), outcome='failure', lax='failure'),
    Cell('1 / 0', '', ('nbval-skip',), **SKIPS),
    Cell('1 / 0', (failure('ZeroDivisionError', 'division by zero'),), ('raises-exception',)),
    Cell('int("a")', (failure('ValueError', ''),), ('nbval-raises-exception',), **FAILS),
    Cell('1 / 0', '', ('nbval-raises-exception', 'nbval-ignore-output')),
    Cell(f'# NBVAL_IGNORE_OUTPUT\n{NOW}', OTHER, ('nbval-check-output',)),
    Cell(f'# NBVAL_CHECK_OUTPUT\n{NOW}', OTHER, ('nbval-ignore-output',), 'failure', 'failure'),
    Cell(NOW, OTHER, ('skip-execution',), **FAILS),  # a tag of nbconvert's, not of nbval's
    # What was never run.
    Cell(NOW, unrun=True),
    Cell('1 / 0', unrun=True, **RAISES),
    Cell('1', (result('1'),), unrun=True, **RAISES),
    Cell('', unrun=True),
    # Streams: of each, what is in it counts.
    Cell(
        'import sys\nprint("a", file=sys.stderr)\nprint("b")\nprint("c", file=sys.stderr)',
        (text('b\n'), text('a\nc\n', 'stderr')),
    ),
    Cell(
        'import sys\nfor name in ("stderr", "stdout", "stderr"):\n'
        '    print("x", file=getattr(sys, name), flush=True)',
        (text('x\n', 'stderr'), text('x\n'), text('x\n', 'stderr')),
    ),
    Cell('print("one\\rtwo")', 'two\n'),
    # Pictures, formulas.
    Cell(PNG, (result(AN_IMAGE, png=WHITE),)),
    Cell(PNG, (result(AN_IMAGE),)),
    Cell(PNG, (result('another text', png=BLACK),), **FAILS),
    Cell(
        'from IPython.display import Math\nMath("x^2")',
        (new_output('execute_result', {'text/plain': AN_IMAGE, 'text/latex': '$x^3$'}),),
        **FAILS,
    ),
]
DATED = [
    Cell('import datetime\nprint(datetime.date.today())', '2018-06-01\n', **FAILS),
    Cell('import os\nos.path.abspath("x")', (result("'/home/anna/x'"),), **FAILS),
    Cell('object()', (result('<object at 0x7f1200>'),), **FAILS),
    Cell(
        'raise ValueError(id([]))', (failure('ValueError', '1'),), ('raises-exception',), **FAILS
    ),
]
SANITIZE = r"""
[dates]
regex: \d\d\d\d-\d\d-\d\d
replace: DATE

[places, of this computer and of Anna's]
regex: '/[^']*/x'
replace: PLACE

[memory]
regex: (<object(?: object)?) at 0x[0-9a-f]+>
replace: OBJECT
regex: ^\d+$
replace: NUMBER
"""
SLOW = [
    Cell('import time'),
    Cell('time.sleep(1000)\nlater = 1', **RAISES),
    Cell('print("not interrupted")', 'not interrupted\n'),
    Cell('later', **SKIPS),
]


def write(path: Path, cells: Sequence[Cell], first: str, kernel: str = '') -> None:
    """Write a notebook; its first cell is the only one that differs."""
    notebook = new_notebook(cells=[new_code_cell(first, execution_count=1)])
    if kernel:
        notebook.metadata.kernelspec = {'name': kernel, 'display_name': kernel}
    for number, cell in enumerate(cells, 2):
        outputs = [text(cell.stored)] if isinstance(cell.stored, str) else list(cell.stored)
        made = new_code_cell(
            cell.source,
            outputs=[] if cell.stored == '' else outputs,
            execution_count=None if cell.unrun else number,
        )
        if cell.tags:
            made.metadata.tags = list(cell.tags)
        notebook.cells.append(made)
    nbformat.write(notebook, path)


class Both:
    """Run cells without and with labkit.

    Args:
        folder: Where.
        env: The variables of pytest.

    Attributes:
        printed: What pytest has printed.
    """

    def __init__(self, folder: Path, env: dict[str, str]) -> None:
        self.folder, self.env, self.printed = folder, env, ''

    def __call__(
        self, cells: Sequence[Cell], *options: str, kernel: str = ''
    ) -> tuple[list[str], list[str]]:
        """Return what came of the cells without, and with labkit."""
        write(self.folder / 'alone.ipynb', cells, 'pass', kernel)
        write(self.folder / 'ours.ipynb', cells, 'import labkit', kernel)
        command = [sys.executable, '-m', 'pytest', '-p', 'no:cacheprovider', '--junitxml=out.xml']
        command += ['--nbval-kernel-startup-timeout=240', *(options or ['--nbval'])]
        command += ['alone.ipynb', 'ours.ipynb']
        done = subprocess.run(
            command, cwd=self.folder, env=self.env, capture_output=True, text=True, timeout=300
        )
        self.printed = done.stdout + done.stderr
        found: dict[str, list[str]] = {'alone': [], 'ours': []}
        for case in ElementTree.parse(self.folder / 'out.xml').iter('testcase'):
            notebook = found.setdefault(case.get('classname', '').split('.')[0], [])
            notebook.append(case[0].tag if len(case) else 'passed')
        return found['alone'][1:], found['ours'][1:]


@pytest.fixture
def both(tmp_path: Path, installed: dict[str, str]) -> Both:
    return Both(tmp_path, installed)


def test_every_marker_holds(both: Both) -> None:
    alone, ours = both(MARKED, '--nbval')
    assert alone == [cell.outcome for cell in MARKED]  # so this is what nbval means
    assert ours == alone, both.printed


def test_lax_compares_only_what_is_marked(both: Both) -> None:
    alone, ours = both(MARKED, '--nbval-lax')
    assert ours == alone == [cell.lax for cell in MARKED]


@pytest.mark.parametrize('option', ['--nbval-sanitize-with', '--sanitize-with'])
def test_outputs_are_replaced_before_they_are_compared(
    both: Both, tmp_path: Path, option: str
) -> None:
    (tmp_path / 'rules.cfg').write_text(SANITIZE, encoding='utf-8')
    alone, ours = both(DATED)
    assert ours == alone == ['failure'] * len(DATED)
    alone, ours = both(DATED, '--nbval', option, 'rules.cfg')
    assert ours == alone == ['passed'] * len(DATED)


@pytest.mark.slow('waits for what hangs')
def test_a_cell_is_interrupted_after_its_time(both: Both) -> None:
    alone, ours = both(SLOW, '--nbval', '--nbval-cell-timeout=9.5')
    assert ours == alone == [cell.outcome for cell in SLOW]


@pytest.mark.slow('waits for what hangs')
def test_a_kernel_that_cannot_be_interrupted_ends_the_notebook(both: Both) -> None:
    deaf = 'import signal, time\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\ntime.sleep(1000)'
    alone, ours = both([Cell(deaf), Cell('1')], '--nbval', '--nbval-cell-timeout=10')
    assert ours == alone == ['failure', 'skipped']


def kernel(folder: Path, name: str, command: Sequence[str], **env: str) -> None:
    place = folder / 'share/jupyter/kernels' / name
    place.mkdir(parents=True)
    spec = {'argv': list(command), 'language': 'python', 'display_name': name, 'env': env}
    (place / 'kernel.json').write_text(json.dumps(spec))


IPYKERNEL = (sys.executable, '-m', 'ipykernel_launcher', '-f', '{connection_file}')
WHICH = 'import os\nos.environ.get("WHICH", "this")'


@pytest.fixture
def kernels(tmp_path: Path, installed: dict[str, str]) -> None:
    """Install kernels that say which they are, and one that never starts."""
    installed['JUPYTER_PATH'] = str(tmp_path / 'share/jupyter')
    for name in ('one', 'other'):
        kernel(tmp_path, name, IPYKERNEL, WHICH=name)
    kernel(tmp_path, 'never', [sys.executable, '-c', 'import time; time.sleep(1000)'])


@pytest.mark.slow('runs pytest on notebooks')
@pytest.mark.parametrize(
    ('options', 'expected'),
    [
        ([], 'one'),
        (['--nbval-kernel-name=other'], 'other'),
        (['--nbval-current-env'], 'this'),
        (['--current-env'], 'this'),
    ],
)
def test_the_kernel_is_the_one_that_is_named(
    both: Both, kernels: None, options: list[str], expected: str
) -> None:
    cells = [Cell(WHICH, (result(repr(expected)),))]
    alone, ours = both(cells, '--nbval', *options, kernel='one')
    assert ours == alone == ['passed']


@pytest.mark.slow('waits for a kernel that never starts')
def test_a_kernel_that_does_not_start_or_is_not_there_is_told(both: Both, kernels: None) -> None:
    options = ['--nbval-kernel-startup-timeout=1', '--nbval-kernel-name=never']
    alone, ours = both([Cell('1')], '--nbval', *options)
    assert ours == alone == ['error']
    alone, ours = both([Cell('1')], '--nbval', '--nbval-kernel-name=nowhere')
    assert ours == alone == ['error']
    assert "expected the name of a kernel, but it is 'nowhere'" in both.printed


CONFTEST = """
def pytest_collectstart(collector):
    if collector.fspath and collector.fspath.ext == '.ipynb':
        collector.skip_compare += 'text/html', 'stderr', 'evalue'
"""


def test_what_a_conftest_leaves_out_is_not_compared(both: Both, tmp_path: Path) -> None:
    html = {'text/plain': '1', 'text/html': '<b>'}
    cells = [
        Cell('import sys\nprint("a", file=sys.stderr)\nprint("b")', (text('b\n'),)),
        Cell('import sys\nprint("a", file=sys.stderr)\nprint("c")', (text('b\n'),), **FAILS),
        Cell('1', (new_output('execute_result', html, execution_count=1),)),
        Cell('int("a")', (failure('ValueError', ''),), ('raises-exception',)),
        Cell('int("a")', (failure('KeyError', ''),), ('raises-exception',), **FAILS),
    ]
    (tmp_path / 'conftest.py').write_text(CONFTEST)
    alone, ours = both(cells)
    assert ours == alone == [cell.outcome for cell in cells]


@pytest.mark.slow('runs pytest on notebooks')
def test_coverage_counts_what_the_cells_run(both: Both, tmp_path: Path) -> None:
    (tmp_path / 'lib.py').write_text('def a():\n    return 1\n\n\ndef b():\n    return 1\n')
    options = ['--nbval', '-p', 'pytest_cov', '--cov=lib']
    for path, name in (('alone.ipynb', 'a'), ('ours.ipynb', 'b')):
        cells = [Cell(f'import lib\nlib.{name}()', (result('1'),))]
        both(cells, *options, f'--deselect={path}')
    both([Cell('# NBVAL_IGNORE_OUTPUT\nimport lib\nlib.a()')], *options)
    assert re.search(r'lib\.py +4 +1 +75%', both.printed), both.printed


@pytest.mark.slow('runs pytest on notebooks')
def test_nbdime_is_as_broken_without_labkit(both: Both, tmp_path: Path) -> None:
    """Where nbval has mended it, docs/nbval.md says too little."""
    (tmp_path / 'nbdime/webapp').mkdir(parents=True)
    log = 'from types import SimpleNamespace\nlog = SimpleNamespace(set_nbdime_log_level=print)\n'
    (tmp_path / 'nbdime/__init__.py').write_text(log)
    (tmp_path / 'nbdime/webapp/nbdiffweb.py').write_text('run_server = browse = None\n')
    for path in ('alone.ipynb', 'ours.ipynb'):
        both([Cell('1')], '--nbval', '--nbdime', f'--deselect={path}')
        assert 'pytest_report_teststatus(report=rep)' in both.printed
        assert 'INTERNALERROR' in both.printed


def test_the_page_lists_all_that_nbval_knows() -> None:
    parser = pytest.Parser(_ispytest=True)
    nbval.plugin.pytest_addoption(parser)
    groups = [parser.getgroup('nbval'), parser.getgroup('terminal reporting')]
    options = {name for group in groups for option in group.options for name in option.names()}
    known = options | set(nbval.plugin.comment_markers) | set(nbval.plugin.metadata_tags)
    assert '--nbval-lax' in known and 'nbval-skip' in known
    listed = set(re.findall(r'`(?:# )?([^`=]+)', PAGE))
    assert known <= listed, known - listed
    tried = Path(__file__).read_text(encoding='utf-8')
    assert [name for name in sorted(known) if name not in tried] == []
