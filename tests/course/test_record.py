"""Recording stores what a lesson shows, in one form, and never half of it."""

from __future__ import annotations

import base64
import json
import os
import struct
import threading
import zlib
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from labkit.course import lesson_run
from labkit.course.lesson_run import LessonError, LessonRun, normalised
from labkit.course.record import lesson_paths, record, with_bullets, write_tasks
from labkit.errors import LabError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / 'course' / 'notebooks'
    path.mkdir(parents=True)
    return path


def write(path: Path, cells: dict[str, str], *, tags: dict[str, str] | None = None, **meta: Any):
    """Write a notebook of code cells: id -> source; and tags: id -> tag."""
    notebook = new_notebook(metadata=meta, cells=[new_markdown_cell('# A title', id='title')])
    for cell_id, source in cells.items():
        cell = new_code_cell(source, id=cell_id)
        if tags and cell_id in tags:
            cell.metadata.tags = [tags[cell_id]]
        notebook.cells.append(cell)
    nbformat.write(notebook, path)
    return path


def read(path: Path) -> dict[str, NotebookNode]:
    return {cell.id: cell for cell in nbformat.read(path, as_version=4).cells}


def shown(cell: NotebookNode) -> str:
    return ''.join(out.get('text') or out['data']['text/plain'] for out in cell.outputs)


def test_outputs_are_stored_in_one_form(folder: Path, capsys: pytest.CaptureFixture[str]):
    cells = {
        'pieces': """
            import sys
            for word in ('one', 'two'):
                print(word, flush=True)
                print('error', word, file=sys.stderr, flush=True)
        """,
        'result': '21 * 2',
        'wrong': '1 / 0',
        'widget': 'import ipywidgets; ipywidgets.IntSlider()',
        'updated': """
            from IPython.display import display
            handle = display('first', display_id=True)
            handle.update('last')
        """,
        'paths': 'import os, tempfile; print(os.getcwd(), tempfile.gettempdir(), sys.prefix)',
        'warning': 'import warnings; warnings.warn("careful")',
    }
    path = write(folder / '01_one.ipynb', cells, tags={'wrong': 'raises-exception'}, author='me')
    before = json.loads(path.read_text())
    before['cells'][1]['metadata'] = {'execution': {'iopub.status.idle': '2025-11-21T05:18'}}
    path.write_text(json.dumps(before))

    assert record(folder=folder) == 0
    assert '01_one ... 8 cells recorded in ' in capsys.readouterr().out
    first, stored = path.read_bytes(), read(path)
    assert list(stored) == ['title', *cells]
    assert [stored[name].execution_count for name in cells] == list(range(1, 8))
    assert [(out.name, out.text) for out in stored['pieces'].outputs] == [
        ('stdout', 'one\ntwo\n'),
        ('stderr', 'error one\nerror two\n'),
    ]
    assert shown(stored['result']) == '42'
    assert stored['wrong'].outputs[0].ename == 'ZeroDivisionError'
    assert stored['widget'].outputs[0].data == {'text/plain': 'IntSlider(value=0)'}
    assert shown(stored['updated']) == "'last'"
    assert shown(stored['paths']) == '$COURSE/notebooks $TMPDIR $ENVIRONMENT\n'
    assert shown(stored['warning']).startswith('cell:1: UserWarning: careful\n')
    assert nbformat.read(path, as_version=4).metadata == {
        'kernelspec': {'display_name': 'Python 3 (ipykernel)', 'language': 'python'}
        | {'name': 'python3'},
        'language_info': {'name': 'python'},
    }
    assert str(folder).encode() not in first and b'execution"' not in first

    assert record(folder=folder) == 0
    assert path.read_bytes() == first
    assert '8 cells unchanged' in capsys.readouterr().out


ENVIRONMENT = """
    import os
    for name in ('LABKIT_HEADLESS', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_DOMAIN_ID', 'LINES',
                 'PYTEST_CURRENT_TEST', 'NO_COLOR', 'PYTHON_COLORS', 'LABKIT_HOME',
                 'JPY_SESSION_NAME'):
        print(os.environ.get(name))
"""


@pytest.mark.parametrize(('labkit', 'reach'), [({}, 'OFF'), ({'processes': True}, 'LOCALHOST')])
def test_the_kernel_does_not_depend_on_who_starts_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, labkit: dict[str, bool], reach: str
):
    monkeypatch.setenv('ROS_DOMAIN_ID', '7')
    monkeypatch.setenv('NO_COLOR', '1')
    monkeypatch.setenv('PYTHON_COLORS', '1')
    monkeypatch.setenv('LABKIT_HOME', '/nowhere')
    path = write(folder / '01_one.ipynb', {'env': ENVIRONMENT}, labkit=labkit)
    with LessonRun(path) as run:
        lines = shown(run.execute(1)).splitlines()
    home, session = '$TMPDIR/labkit', '$COURSE/notebooks/01_one.ipynb'
    assert lines == ['1', reach, 'None', '24', 'None', 'None', 'None', home, session]


@pytest.mark.slow('runs notebooks')
@pytest.mark.parametrize(
    ('source', 'tag', 'words'),
    [
        ('x = 1\ny', '', "Cell 'bad': it raised NameError: name 'y' is not defined"),
        ('a b', '', "Cell 'bad': it raised SyntaxError"),
        ('import sys; sys.exit(3)', '', "Cell 'bad': it raised SystemExit: 3"),
        ('1', 'raises-exception', "Cell 'bad': it is tagged raises-exception, but nothing"),
        ('import os\nos.write(2, b"my last words")\nos._exit(1)', '', 'my last words'),
        ('open("01_one.ipynb", "a").write("\\n")', '', 'was changed while it ran'),
    ],
)
def test_a_lesson_that_fails_is_left_as_it_was(
    folder: Path, capsys: pytest.CaptureFixture[str], source: str, tag: str, words: str
):
    cells = {'good': 'print(1)', 'bad': source}
    path = write(folder / '01_one.ipynb', cells, tags={'bad': tag} if tag else None)
    write(folder / '02_two.ipynb', {'good': 'print(2)'})
    before = path.read_bytes()
    assert record(folder=folder) == 1
    told = capsys.readouterr().out
    assert told.startswith('01_one ... failed\n')
    assert words in told and '\x1b' not in told
    assert '02_two ... 2 cells recorded' in told
    assert path.read_bytes().rstrip() == before.rstrip()
    assert sorted(p.name for p in folder.iterdir()) == ['01_one.ipynb', '02_two.ipynb']


def test_a_crash_while_storing_leaves_the_old_file(folder: Path, monkeypatch: pytest.MonkeyPatch):
    path = write(folder / '01_one.ipynb', {'good': 'print(1)'})
    before = path.read_bytes()

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, 'replace', stop)
    with pytest.raises(KeyboardInterrupt):
        record(folder=folder)
    assert [p.read_bytes() for p in folder.iterdir()] == [before]


def test_a_cell_that_takes_too_long_is_interrupted(folder: Path):
    cells = {'long': 'import time\ntime.sleep(1000)', 'next': '1'}
    path = write(folder / '01_one.ipynb', cells)
    with LessonRun(path, cell_timeout_sec=1) as run:
        with pytest.raises(LessonError, match='longer than 1 s and was interrupted') as caught:
            run.execute(1)
        assert caught.value.cell_id == 'long' and 'KeyboardInterrupt' in caught.value.traceback
        assert shown(run.execute(2)) == '1' and not run.broken


@pytest.mark.slow('waits for what hangs')
def test_a_cell_that_cannot_be_interrupted_ends_the_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(lesson_run, 'OUTPUT_TIMEOUT_SEC', 1)
    deaf = 'import signal, time\nsignal.signal(signal.SIGINT, signal.SIG_IGN)\ntime.sleep(1000)'
    path = write(folder / '01_one.ipynb', {'long': deaf, 'next': '1'})
    with LessonRun(path, cell_timeout_sec=1) as run:
        with pytest.raises(LessonError, match='Timeout waiting for IOPub output') as caught:
            run.execute(1)
        assert caught.value.cell_id == 'long' and run.broken
        with pytest.raises(LessonError, match='an earlier cell lost the kernel'):
            run.execute(2)


@pytest.mark.slow('records a notebook twice')
def test_what_nbval_is_told_of_a_cell_holds_when_it_is_recorded(folder: Path):
    cells = {
        'skipped': '# NBVAL_SKIP\n1 / 0',
        'meant': '# NBVAL_RAISES_EXCEPTION\n1 / 0',
        'measured': '# NBVAL_IGNORE_OUTPUT\nimport time; print(time.time_ns())',
    }
    path = write(folder / '01_one.ipynb', cells)
    assert record(folder=folder) == 0
    before = path.read_bytes()
    assert read(path)['skipped'].execution_count is None
    assert read(path)['meant'].outputs[0].ename == 'ZeroDivisionError'
    assert record(folder=folder) == 0
    assert path.read_bytes() == before


def test_the_next_cell_runs_after_one_that_raised(folder: Path):
    path = write(folder / '01_one.ipynb', {'bad': '1 / 0', 'next': 'print("here")'})
    with LessonRun(path) as run:
        with pytest.raises(LessonError, match='ZeroDivisionError'):
            run.execute(1)
        assert shown(run.execute(2)) == 'here\n'


def test_earlier_cells_run_first(folder: Path):
    path = write(folder / '01_one.ipynb', {'a': 'x = [1]', 'b': 'x.append(2)', 'c': 'x'})
    with LessonRun(path) as run:
        assert shown(run.execute(3)) == '[1, 2]'
        assert shown(run.execute(3)) == '[1, 2]'


@pytest.mark.slow('runs notebooks')
def test_nothing_is_left_running(folder: Path):
    source = """
        import os, subprocess, tempfile
        child = subprocess.Popen(['sleep', '1000'])
        print(os.getpid(), child.pid, len(os.listdir(tempfile.gettempdir())) > 0)
    """
    path = write(folder / '01_one.ipynb', {'child': source})
    with LessonRun(path) as run:
        kernel, child, has_files = shown(run.execute(1)).split()
        home = Path(f'/proc/{kernel}/environ').read_bytes().partition(b'TMPDIR=')[2]
        temporary = Path(home.partition(b'\0')[0].decode())
        assert temporary.is_dir() and has_files == 'True'
    assert not temporary.exists()
    assert ended(kernel) and ended(child)


def ended(pid: str) -> bool:
    """Tell whether a process is gone, or only waits for its parent to read its exit code."""
    try:
        return Path(f'/proc/{pid}/stat').read_text().rpartition(') ')[2][0] == 'Z'
    except (FileNotFoundError, ProcessLookupError):
        return True


@pytest.mark.slow('records a notebook twice')
def test_measured_values_of_an_exempted_cell_are_kept(folder: Path):
    source = 'import time\nprint(f"{time.monotonic_ns()} ns on 2 cores")'
    cells = {'measured': source, 'compared': 'print(1)'}
    tags = {'measured': 'nbval-ignore-output'}
    path = write(folder / '01_one.ipynb', cells, tags=tags)
    record(folder=folder)
    first = path.read_bytes()
    record(folder=folder)
    assert path.read_bytes() == first
    path.write_text(path.read_text().replace('cores\\")', 'threads\\")'))
    record(folder=folder)
    assert 'threads\n' in shown(read(path)['measured'])


def test_lessons_are_chosen_by_number_or_name(folder: Path):
    for name in ('02_talk', '00_start', '10_bags'):
        write(folder / f'{name}.ipynb', {'a': '1'})
    (folder / 'notes.ipynb').touch()

    def chosen(*names: str) -> list[str]:
        return [path.stem for path in lesson_paths(names, folder=folder)]

    assert chosen() == ['00_start', '02_talk', '10_bags']
    assert chosen('10', '02') == ['02_talk', '10_bags']
    assert chosen('02_talk', 'notebooks/02_talk.ipynb') == ['02_talk']
    copy = folder.parent / '02_talk.ipynb'
    write(copy, {'a': '1'})
    assert lesson_paths([str(copy)], folder=folder) == [copy]
    assert lesson_paths([str(copy), '00'], folder=folder) == [folder / '00_start.ipynb', copy]
    with pytest.raises(LabError, match=r"'1'[^$]*The lessons are: 00_start, 02_talk, 10_bags"):
        chosen('1')


def stream(name: str, text: str) -> NotebookNode:
    return new_output('stream', name=name, text=text)


def test_streams_are_put_together_between_pictures():
    picture = new_output('display_data', data={'text/plain': 'a picture'})
    outputs = [stream('stderr', 'e1\n'), stream('stdout', 'o1\n'), stream('stderr', 'e2\n')]
    outputs += [picture, stream('stdout', 'o2'), stream('stdout', '\n')]
    result = normalised(outputs, {})
    assert [out.get('text', 'a picture') for out in result] == [
        *('o1\n', 'e1\ne2\n', 'a picture', 'o2\n')
    ]
    assert normalised(result, {}) == result
    assert outputs[0].text == 'e1\n', 'what came in was changed'


@pytest.mark.parametrize(
    ('text', 'expected'),
    [
        ('/srv/course/labkit/record.py', '$COURSE/labkit/record.py'),
        ('/srv/course', '$COURSE'),
        ('"/srv/course/x" \x1b[32m/srv/course/y', '"$COURSE/x" \x1b[32m$COURSE/y'),
        ('/srv/course/.venv/bin', '$ENVIRONMENT/bin'),
        ('/srv/course2 /mnt/srv/course', '/srv/course2 /mnt/srv/course'),
        ('~/lab/x and ~/laboratory', '$HERE/x and ~/laboratory'),
        ('/tmp/ipykernel_123/456.py:7: Warning', 'cell:7: Warning'),
    ],
)
def test_folders_are_replaced(text: str, expected: str):
    folders = {'/srv/course': '$COURSE', '/srv/course/.venv': '$ENVIRONMENT'}
    folders[str(Path.home() / 'lab')] = '$HERE'
    assert normalised([stream('stdout', text)], folders)[0].text == expected
    error = new_output('error', ename='E', evalue=text, traceback=[text])
    assert normalised([error], folders)[0].traceback == [expected]


@pytest.mark.parametrize(
    ('text', 'expected'),
    [
        ('Finished <<< lab [1.23s]\n', 'Finished <<< lab [... s]\n'),
        (
            'Failed   <<< a [0.65s, exited with code 1]',
            'Failed   <<< a [... s, exited with code 1]',
        ),
        ('Summary: 2 packages finished [1min 2s]', 'Summary: 2 packages finished [... s]'),
        ('Summary: 1 package finished [0.9s]', 'Summary: 1 package finished [... s]'),
        ('a list [1.5s] and [3]', 'a list [1.5s] and [3]'),
    ],
)
def test_times_of_colcon_are_replaced(text: str, expected: str):
    assert normalised([stream('stdout', text)], {})[0].text == expected


def test_a_picture_keeps_its_pixels_and_nothing_else():
    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data)
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', check)

    header = chunk(b'IHDR', struct.pack('>IIBBBBB', 1, 1, 8, 0, 0, 0, 0))
    pixels, end = chunk(b'IDAT', zlib.compress(b'\0\0')), chunk(b'IEND', b'')
    extra = chunk(b'tEXt', b'Software\0Matplotlib') + chunk(b'tIME', bytes(7))
    signature = b'\x89PNG\r\n\x1a\n'
    text = base64.b64encode(signature + header + extra + pixels + end).decode()
    output = new_output('display_data', data={'image/png': text})
    stored = normalised([output], {})[0].data['image/png']
    assert base64.b64decode(stored) == signature + header + pixels + end


TASK = (
    '## Exercise\n\nDo so:\n\n- the first\n  of them\n- the second\n\n'
    'And then:\n\n- old\n- more\n\nGood.'
)


@pytest.mark.parametrize(
    ('texts', 'wanted'),
    [
        (['a', 'b', 'c'], 'Do so:\n\n- a\n- b\n\nAnd then:\n\n- c\n\nGood.'),
        (['a', 'b', 'c', 'd', 'e'], 'Do so:\n\n- a\n- b\n\nAnd then:\n\n- c\n- d\n- e\n\nGood.'),
    ],
)
def test_bullets_of_a_task_are_those_of_its_clauses(texts: list[str], wanted: str) -> None:
    assert with_bullets(TASK, texts) == f'## Exercise\n\n{wanted}'
    assert with_bullets(with_bullets(TASK, texts), texts) == with_bullets(TASK, texts)


def test_task_without_bullets_gets_them_at_its_end() -> None:
    assert with_bullets('## Exercise', ['a', 'b']) == '## Exercise\n\n- a\n- b'


def test_tasks_of_the_lessons_are_as_their_clauses_say() -> None:
    for path in lesson_paths():
        notebook = nbformat.read(path, as_version=4)
        before = [cell.source for cell in notebook.cells]
        write_tasks(notebook, path.name)
        assert [cell.source for cell in notebook.cells] == before


def test_variables_may_go_while_a_kernel_is_started():
    run = LessonRun.__new__(LessonRun)
    run.notebook, run.path, run._home = new_notebook(), Path('lesson.ipynb'), Path('home')
    ended = threading.Event()

    def come_and_go():
        while not ended.is_set():
            os.environ['COMES_AND_GOES'] = '1'
            del os.environ['COMES_AND_GOES']

    other = threading.Thread(target=come_and_go)
    other.start()
    try:
        found = [run._environment() for _ in range(5000)]
    finally:
        ended.set()
        other.join()
    assert {variables['LABKIT_HEADLESS'] for variables in found} == {'1'}
