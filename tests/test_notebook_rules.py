"""The rules for the form of a lesson let a good notebook pass, and find what is wrong in a bad."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from pathlib import Path

import pytest
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from labkit.course.record import KERNELSPEC, as_stored

_PATH = Path(__file__).with_name('test_notebook_format.py')
_SPEC = importlib.util.spec_from_file_location('notebook_format', _PATH)
assert _SPEC is not None and _SPEC.loader is not None
form = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(form)

TITLE = """# Talk and listen

Two nodes talk over a topic.

You will:

- write a publisher
- write a subscriber
- watch the graph

Time: 40 minutes."""
LAST = """## What you can do now

- You wrote a publisher.
- You wrote a subscriber.
- You watched the graph.

`lab.progress()` shows how far you are. Next: [Talk and listen](02_next.ipynb)."""
PROSE = 'A node sends its words to a topic, and whoever listens there hears them. ' * 6
SETUP = "import labkit as lab\n\nlesson = lab.lesson('{}')"


REAL = """## On a real machine

The same in terminals:

```bash
# Terminal 1
source /opt/ros/jazzy/setup.bash
export ROS_DOMAIN_ID=7  # the same in every terminal
ros2 run demo_nodes_py talker  # until Ctrl-C
```

```bash
# Terminal 2
source /opt/ros/jazzy/setup.bash
export ROS_DOMAIN_ID=7
ros2 topic echo /chatter
```

More: [Topics](https://docs.ros.org/en/jazzy/Topics.html)"""


def good(name: str) -> NotebookNode:
    cells = [new_markdown_cell(TITLE, id='title'), new_code_cell(SETUP.format(name), id='setup')]
    for number in range(9):
        cells.append(new_markdown_cell(f'## Part {number}\n\n{PROSE}', id=f'part-{number}'))
        cells.append(new_code_cell(f'count = {number}\nprint(count)', id=f'cell-{number}'))
    cells[-2].update(id='quiz-read', source=f'## Quiz\n\n{PROSE}')
    cells[-1].update(id='quiz', source='robot = lab.spin(lab.Turtlebot())\nprint(8)')
    cells.append(new_markdown_cell(REAL, id='real-machine'))
    cells.append(new_markdown_cell(LAST, id='done'))
    meta = {'kernelspec': KERNELSPEC, 'language_info': {'name': 'python'}}
    notebook = new_notebook(cells=cells, metadata=meta)
    code = [cell for cell in cells if cell.cell_type == 'code']
    for number, cell in enumerate(code, start=1):
        cell.execution_count = number
        cell.outputs = [new_output('stream', name='stdout', text=f'{number}\n')]
    return notebook


def problems(folder: Path, notebook: NotebookNode, content: bytes = b'') -> dict[str, list[str]]:
    """Return what each rule says about a notebook that is followed by a good one."""
    path = folder / '01_talk.ipynb'
    path.write_bytes(content or as_stored(notebook))
    (folder / '02_next.ipynb').write_bytes(as_stored(good('next')))
    found = {name: form.report(form.Lesson(path), check) for name, check in form.RULES.items()}
    return {name: sentences for name, sentences in found.items() if sentences}


def test_a_good_notebook_keeps_all_rules(tmp_path: Path):
    assert problems(tmp_path, good('talk')) == {}


def text(cell: int, source: str) -> Callable[[NotebookNode], object]:
    """Return a change that gives a cell another source."""
    return lambda notebook: notebook.cells[cell].update(source=source)


def more(cell: int, source: str) -> Callable[[NotebookNode], object]:
    """Return a change that adds something to a cell."""
    return lambda nb: nb.cells[cell].update(source=f'{nb.cells[cell].source}\n\n{source}')


def a_task(source: str) -> Callable[[NotebookNode], object]:
    """Return a change that makes a cell the task of an exercise."""
    return lambda notebook: notebook.cells[2].update(id='hello-task', source=source)


def shows(text: str) -> Callable[[NotebookNode], object]:
    """Return a change that lets a cell show another text."""
    return lambda notebook: notebook.cells[3].outputs[0].update(text=text)


def displays(**data: str) -> Callable[[NotebookNode], object]:
    """Return a change that lets a cell display something."""
    data = {mime.replace('__', '/').replace('_', '-'): value for mime, value in data.items()}
    return lambda nb: nb.cells[3].update(outputs=[new_output('display_data', data=data)])


def tagged(*tags: str, reason: str = '') -> Callable[[NotebookNode], object]:
    """Return a change that gives a code cell tags, and a reason for them."""
    meta = {'tags': list(tags), 'labkit': {'reason': reason}}
    return lambda notebook: notebook.cells[3].update(metadata=meta)


LONG = '\n'.join(f'a{n} = {n}' for n in range(31))
SIX = '\n'.join(f'a{n} = {n}' for n in range(6))
WIDGET = {'application__vnd.jupyter.widget_view+json': '{"model_id": "1"}'}
BAD = [
    ('first_cell', text(0, TITLE[1:]), 'does not begin with a title'),
    ('first_cell', more(4, '# Another title'), "cell 'part-1': holds a second title"),
    ('first_cell', text(0, TITLE.replace('topic.', 'topic. They do.')), 'in one sentence'),
    ('first_cell', text(0, TITLE.replace('- write', 'write')), 'has 1 bullets'),
    ('first_cell', text(0, TITLE.replace('You will', 'We will')), '"You will"'),
    ('first_cell', text(0, TITLE.replace('minutes', 'pages')), 'how long it takes'),
    ('setup_cell', lambda nb: nb.cells.pop(1), "cell 'part-0': is the second cell"),
    ('setup_cell', text(1, 'import labkit as lab'), 'Write 2 or 3 lines'),
    ('setup_cell', text(1, SETUP.format('other')), "Name it 'talk'"),
    ('last_cell', text(-1, LAST.replace('- You watched', 'You watched')), 'has 2 bullets'),
    ('last_cell', text(-1, LAST.replace('the graph', 'a film')), 'this is done'),
    ('last_cell', text(-1, LAST.replace('02_next', '03_other')), 'differs from the last'),
    ('last_cell', text(-1, LAST.replace('[Talk and', '[talk and')), 'differs from the last'),
    ('last_cell', text(-1, LAST.replace('What you can do', 'Done')), 'differs from the last'),
    ('box', lambda nb: nb.cells.pop(-2), "cell 'quiz': is not the box"),
    ('box', text(-2, REAL.replace('docs.ros.org', 'example.org')), 'is not the box'),
    ('box', text(-2, REAL.replace('```bash\n# Terminal 2', '# Terminal 2')), 'is not the box'),
    ('box', text(-2, REAL.replace('ros2 run', '\n'.join('abcde') + '\nrun')), 'of 8 lines'),
    ('box', text(-2, REAL.replace('run', 'run' * 30)), 'a line of 132 characters'),
    ('box', text(-2, REAL.replace('every', 'each')), "does not say 'the same in every"),
    ('box', text(-2, REAL.replace('until Ctrl-C', 'for ever')), "does not say 'Ctrl-C'"),
    ('quiz', lambda nb: nb.cells[-3].update(id='questions'), 'has no cell "quiz"'),
    ('quiz', text(-4, PROSE), "cell 'quiz-read': stands before the quiz"),
    ('quiz', lambda nb: nb.cells[-2].update(id='hello-task'), 'comes after the quiz'),
    ('short_bullets', a_task('- ' + 'word ' * 21), 'has a bullet of 21 words'),
    ('moves', text(-3, 'print(8)'), 'has nothing that moves'),
    ('size', lambda nb: nb.cells.__delitem__(slice(2, 6)), 'has 18 cells. Make it 20'),
    ('size', lambda nb: [text(n, 'Few words.')(nb) for n in range(2, 20, 2)], 'words of prose'),
    ('size', text(2, PROSE * 2), "'part-0': has 168 words"),
    ('size', text(3, LONG), "'cell-0': has 31 lines"),
    ('size', text(3, '\n'), 'has 0 lines'),
    ('size', lambda nb: [text(n, SIX)(nb) for n in range(3, 20, 2)], 'has a median of 6'),
    ('code', text(3, 'a b'), 'is not Python'),
    ('code', text(3, 'for i in range(3):\n    time.sleep(1)'), 'waits for a time'),
    ('ids', lambda nb: nb.cells[3].update(id='part-0'), 'is the id of 2 cells'),
    ('ids', lambda nb: nb.cells[3].pop('id'), 'nobody chose'),
    ('ids', lambda nb: nb.cells[3].update(id='deadbeef'), 'nobody chose'),
    ('ids', lambda nb: nb.cells[3].update(id='0b2e9d1c-3f6e-4b6a-9d57-1f2a3b4c5d6e'), 'nobody'),
    ('stored', lambda nb: nb.cells[3].update(execution_count=None), 'execution count None'),
    ('stored', lambda nb: nb.cells[3].update(execution_count=7), 'execution count 7, not 2'),
    ('stored', lambda nb: nb.cells[3].outputs[0].pop('name'), 'is not a valid notebook'),
    ('stored', displays(text__plain='a slider', **WIDGET), 'the view of a widget'),
    ('steady', shows('in /home/ada/lesson'), "a path of this machine: '/home/ada'"),
    ('steady', shows('in /opt/ros/jazzy'), 'a path of this machine'),
    ('steady', shows('at 2025-11-21T05:18:41'), 'a time stamp'),
    ('steady', shows('[1763702321.5]: hello'), 'a time stamp'),
    ('steady', shows('<Talker object at 0x7f3a5c1d2e10>'), 'an address in memory'),
    ('steady', text(3, "open('/tmp/bag')"), 'names a path of one machine'),
    ('numbers', shows('True'), "shows 'True'"),
    ('numbers', displays(text__plain='in time: False'), "shows 'in time: False'"),
    ('exemptions', tagged('nbval-ignore-output'), 'without a reason'),
    ('exemptions', tagged('nbval-skip'), 'Every cell runs'),
    ('exemptions', more(3, '# NBVAL_IGNORE_OUTPUT'), 'Use a tag'),
    ('pictures', more(2, '![](graph.png)'), 'without alternative text'),
    ('pictures', more(2, '<img src="graph.png" alt="">'), 'without alternative text'),
    ('pictures', more(2, '<svg><circle/></svg>'), 'without alternative text'),
    ('pictures', more(2, '```mermaid\ngraph LR\n```'), 'without alternative text'),
    ('pictures', displays(image__png='', text__plain='<Figure size 64x48>'), 'without text'),
    ('links', more(2, 'See [it](03_missing.ipynb).'), 'is not there'),
    ('links', more(2, 'See [it](http://example.org).'), 'is not there'),
    ('links', more(2, 'See [it](https://docs.ros.org/en/humble/x.html).'), 'is not there'),
    ('links', more(2, 'See [it](#Part-99).'), 'is not there'),
    ('links', more(2, 'See ![a graph](attachment:graph.png).'), 'is not there'),
    ('links', more(2, 'See [](02_next.ipynb).'), 'without words'),
    ('tone', more(2, 'Well done!'), 'has an exclamation mark'),
    ('tone', more(2, 'It is Easy.'), "says 'Easy'"),
]


@pytest.mark.parametrize(('name', 'change', 'words'), BAD)
def test_what_is_wrong_is_found(name: str, change, words: str, tmp_path: Path):
    notebook = good('talk')
    change(notebook)
    sentences = problems(tmp_path, notebook).get(name, [])
    assert len([line for line in sentences if words in line]) == 1, sentences


@pytest.mark.parametrize(
    'change',
    [
        more(2, '```python\n# no title, and not simply!\n```'),
        more(2, '![A talker and a listener](02_next.ipynb "a picture")'),
        more(2, '[Part 3](#Part-3), `a != b`, [docs](https://docs.ros.org/en/jazzy/)'),
        more(2, '```mermaid\ngraph LR\naccDescr: a talker and a listener\n```'),
        more(2, '| ' + 'word ' * 200 + '|'),
        text(3, 'def slow():\n    time.sleep(1)'),
        text(3, '%ros2 topic list\n!ros2 topic list'),
        shows('Boolean value is: False'),
        shows('/chatter, /tmp, work/talk.py and $COURSE/notebooks in 12 of 3000'),
        tagged('nbval-ignore-output', reason='It shows a measured time.'),
        displays(image__png='', text__plain='odom.x rises from 0 to 1'),
    ],
)
def test_what_is_right_is_let_pass(change, tmp_path: Path):
    notebook = good('talk')
    change(notebook)
    assert problems(tmp_path, notebook) == {}


@pytest.mark.parametrize('where', ['notebook', 'cell'])
def test_what_an_editor_adds_is_found(where: str, tmp_path: Path):
    notebook = good('talk')
    content = as_stored(notebook)
    if where == 'notebook':
        content = content.replace(b'"language_info"', b'"widgets": {},\n  "language_info"')
    else:
        content = content.replace(b'"metadata": {}', b'"metadata": {"execution": {}}', 1)
    assert 'has the metadata' in problems(tmp_path, notebook, content)['stored'][0]


def test_another_way_of_writing_the_file_is_found(tmp_path: Path):
    content = as_stored(good('talk')).replace(b'\n ', b'\n\t')
    found = problems(tmp_path, good('talk'), content)
    assert list(found) == ['stored'] and 'is not written as' in found['stored'][0]


def test_every_rule_is_shown_to_find_something():
    assert {name for name, *_ in BAD} == set(form.RULES)
