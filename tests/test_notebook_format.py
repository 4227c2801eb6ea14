"""The form of a lesson: each rule looks at every notebook, and is shown to find a bad one."""

from __future__ import annotations

import ast
import json
import re
import statistics
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import nbformat
import pytest
from IPython.core.inputtransformer2 import TransformerManager
from nbformat import NotebookNode
from nbformat.validator import iter_validate

from labkit.course.record import CELL_METADATA, KERNELSPEC, as_stored

NOTEBOOKS = Path(__file__).resolve().parent.parent / 'notebooks'
PATHS = sorted(NOTEBOOKS.glob('*.ipynb'))
# The first lesson only shows how lessons work, so it may be shorter than the others.
SHORT = {'00_start_here': {'cells': 12, 'words': 400}}
# This one has two halves, a robot's body and a world for it, and says where to pause.
LONG = {'15_robot_description': {'cells': 58, 'words': 1750}}
CELLS, WORDS, WORDS_IN_CELL, WORDS_IN_BULLET = (20, 48), (700, 1400), 130, 20
# What a box shows beside the panel on the right, without scrolling.
LINE = 79
BOX = re.compile(
    r'## On a real machine\n\n[^\n]+\n\n(?P<terminals>(?:```bash\n[^`]+```\n\n)+)'
    r'More: \[[^]\n]+\]\(https://docs\.ros\.org/en/jazzy/[^)\s]+\.html\)'
)
# What happens on such a machine without a word; test_real_machine.py types what is in a box.
IN_BOX = ('the same in every terminal', 'Ctrl-C')
FILLERS = r'\b(simply|just|easy|easily|obviously|of course)\b'
FENCE = re.compile(r'^ *```.*?^ *```', flags=re.S | re.M)
MACHINE_PATH = r'(?<![\w.$/~-])/(?:home|root|Users|tmp|mnt)/\w+'
UNSTEADY = {
    'a path of this machine': '|'.join(
        [MACHINE_PATH, r'[A-Z]:\\\\', r'/(?:usr|opt|var)/\w+/', r'~/\.', str(NOTEBOOKS.parent)]
    ),
    'a time stamp': r'\b\d{4}-\d\d-\d\d[T ]\d\d:\d\d|\b1[6-9]\d{8}(?:\d{3}|\d{9})?\b',
    'an address in memory': r'\b0x[0-9a-f]{6,}',
}
# Pages that lessons link to: those of this distribution, and a few others.
SITES = (
    'docs.ros.org/en/jazzy/',
    'index.ros.org',
    'robotics.stackexchange.com',
    'emanual.robotis.com/docs/en/',
    'docs.nav2.org/',
    'moveit.picknik.ai/',
    'control.ros.org/jazzy/',
)
# What a rule finds: id of the cell (or ''), what is wrong, what to do.
Found = Iterator[tuple[str, str, str]]
RULES: dict[str, Callable[[Lesson], Found]] = {}


def rule(check: Callable[[Lesson], Found]) -> Callable[[Lesson], Found]:
    RULES[check.__name__] = check
    return check


class Lesson:
    """A notebook as the rules look at it."""

    def __init__(self, path: Path) -> None:
        self.path, self.name = path, path.stem
        self.file = path.read_bytes()
        # nbformat.reads() would repair the file, and hide what is wrong with it.
        self.notebook = nbformat.v4.reads(self.file.decode())
        self.cells: list[NotebookNode] = self.notebook.cells
        for cell in self.cells:
            cell.setdefault('id', '')
        self.code = [cell for cell in self.cells if cell.cell_type == 'code']
        self.text = [cell for cell in self.cells if cell.cell_type == 'markdown']

    @property
    def next(self) -> Path | None:
        later = sorted(p for p in self.path.parent.glob('*.ipynb') if p.name > self.path.name)
        return later[0] if later else None


def without_code(source: str) -> str:
    """Return Markdown without code, comments and the targets of links."""
    source = re.sub(r'<!--.*?-->|<svg.*?</svg>', '', FENCE.sub('', source), flags=re.S)
    return re.sub(r'`[^`]*`', 'code', re.sub(r'\]\([^)]*\)', ']', source))


def words(source: str) -> int:
    """Count words as read from top to bottom: neither code nor tables, which are looked up."""
    text = re.sub(r'^\s*\|.*$|!\[[^]]*\]|<[^>]*>', '', without_code(source), flags=re.M)
    return len(re.findall(r'\w[\w’\'-]*', text))


def bullets(source: str) -> list[str]:
    return re.findall(r'^[-*] +(.*)$', source, flags=re.M)


def lines(source: str) -> list[str]:
    return [line for line in source.splitlines() if line.strip()]


def tags(cell: NotebookNode) -> list[str]:
    return cell.metadata.get('tags', [])


def python(cell: NotebookNode) -> ast.Module:
    """Parse a cell, with its magics made Python as IPython does it."""
    return ast.parse(TransformerManager().transform_cell(cell.source))


@rule
def first_cell(lesson: Lesson) -> Found:
    cell = lesson.cells[0]
    source = cell.source if cell.cell_type == 'markdown' else ''
    if not source.startswith('# '):
        yield cell.id, 'does not begin with a title', 'Let the first cell begin with "# Title".'
    for other in lesson.text[1:]:
        if re.search(r'^# |<h1', without_code(other.source), flags=re.M):
            yield other.id, 'holds a second title', 'Use "## " and below: one title a lesson.'
    about = without_code(source).partition('\n')[2].partition('You will')[0].strip()
    if not about.endswith('.') or len(re.findall(r'[.?!](?:\s|$)', about)) != 1:
        yield cell.id, f'says {about!r} after the title', 'Say in one sentence what it is about.'
    if 'You will' not in source or not 3 <= len(bullets(source)) <= 5:
        todo = 'Write "You will", then 3 to 5 bullets that say what.'
        yield cell.id, f'has {len(bullets(source))} bullets under "You will"', todo
    if not re.search(r'\b\d+ (?:to \d+ )?(?:minutes|min)\b', source):
        yield cell.id, 'does not say how long it takes', 'Add for instance "Time: 40 minutes."'


@rule
def setup_cell(lesson: Lesson) -> Found:
    cell = lesson.cells[1]
    if cell.id != 'setup' or cell.cell_type != 'code':
        yield cell.id, 'is the second cell', 'Let the second cell be the setup cell, id "setup".'
        return
    source = lines(cell.source)
    if not 2 <= len(source) <= 3 or source[0] != 'import labkit as lab':
        todo = 'Write 2 or 3 lines; the first is "import labkit as lab".'
        yield cell.id, f'is {cell.source!r}', todo
    for given in re.findall(r'lab\.lesson\((.*?)\)', cell.source):
        if given != repr(lesson.name[3:]):
            yield cell.id, f'names the lesson {given}', f'Name it {lesson.name[3:]!r}.'
    first = Lesson(min(lesson.path.parent.glob('*.ipynb')))
    expected = first.cells[1].source.replace(repr(first.name[3:]), repr(lesson.name[3:]))
    if cell.source != expected:
        todo = f'Use the same setup cell everywhere: {expected!r}.'
        yield cell.id, f'differs from the one of {first.name}', todo


@rule
def last_cell(lesson: Lesson) -> Found:
    cell = lesson.cells[-1]
    promised, done = bullets(lesson.cells[0].source), bullets(cell.source)
    if cell.cell_type != 'markdown' or len(done) != len(promised):
        todo = f'End with the {len(promised)} bullets of the first cell, as done.'
        yield cell.id, f'has {len(done)} bullets', todo
    for before, after in zip(promised, done, strict=False):
        if not set(re.findall(r'\w{4,}', before.lower())) & set(re.findall(r'\w+', after.lower())):
            yield cell.id, f'says {after!r}', f'Say that this is done: {before!r}.'
    tail = '`lab.progress()` shows how far you are.'
    if lesson.next:
        title = Lesson(lesson.next).cells[0].source.partition('\n')[0].removeprefix('# ')
        tail += f' Next: [{title}]({lesson.next.name}).'
    if not (cell.source.startswith('## What you can do now\n') and cell.source.endswith(tail)):
        todo = f'Begin it with "## What you can do now", and end it with {tail!r}.'
        yield cell.id, 'differs from the last cells of other lessons', todo


@rule
def box(lesson: Lesson) -> Found:
    cell = lesson.cells[-2]
    found = BOX.fullmatch(cell.source)
    if cell.id != 'real-machine' or not found:
        todo = 'End with a cell "real-machine": see those of other lessons.'
        yield cell.id, 'is not the box "On a real machine"', todo
        return
    for terminal in re.findall(r'```bash\n(.*?)```', found['terminals'], flags=re.S):
        typed = [line for line in lines(terminal) if not line.startswith('#')]
        if not 3 <= len(typed) <= 7:
            yield cell.id, f'has a terminal of {len(typed)} lines', 'Make it 3 to 7.'
        for line in lines(terminal):
            if len(line) > LINE:
                yield cell.id, f'has a line of {len(line)} characters', f'Make it {LINE} at most.'
    for part in IN_BOX:
        if part not in found['terminals']:
            yield cell.id, f'does not say {part!r}', 'Say it behind a #.'


@rule
def quiz(lesson: Lesson) -> Found:
    found = [cell.id for cell in lesson.cells]
    if 'quiz' not in found:
        yield '', 'has no cell "quiz"', 'Let it show the quiz of the lesson.'
        return
    place = found.index('quiz')
    before = lesson.cells[place - 1]
    if before.id != 'quiz-read' or not re.search(r'^## Quiz$', before.source, re.M):
        yield before.id, 'stands before the quiz', 'Announce it in a cell "quiz-read": "## Quiz".'
    for later in found[place:]:
        if later.endswith('-task'):
            yield later, 'comes after the quiz', 'Put the quiz behind the exercises.'


@rule
def short_bullets(lesson: Lesson) -> Found:
    for cell in lesson.text:
        for bullet in bullets(cell.source):
            count = len(without_code(bullet).split())
            if count > WORDS_IN_BULLET:
                todo = f'Split it, or shorten it to {WORDS_IN_BULLET}.'
                yield cell.id, f'has a bullet of {count} words: {bullet!r}', todo


@rule
def moves(lesson: Lesson) -> Found:
    """The robot comes first: no lesson before its own waits for it."""
    if lesson.name < '07' and not any('lab.Turtlebot(' in cell.source for cell in lesson.code):
        yield '', 'has nothing that moves', 'Let one of its examples drive lab.Turtlebot().'


@rule
def size(lesson: Lesson) -> Found:
    low = SHORT.get(lesson.name, {'cells': CELLS[0], 'words': WORDS[0]})
    prose = sum(words(cell.source) for cell in lesson.text)
    # A guess is a line before the cell that answers it.
    count = sum(not cell.source.startswith('lesson.guess(') for cell in lesson.cells)
    high = LONG.get(lesson.name, {'cells': CELLS[1], 'words': WORDS[1]})
    if not low['cells'] <= count <= high['cells']:
        yield '', f'has {count} cells', f'Make it {low["cells"]} to {high["cells"]}.'
    if not low['words'] <= prose <= high['words']:
        yield '', f'has {prose} words of prose', f'Make it {low["words"]} to {high["words"]}.'
    for cell in lesson.text:
        if words(cell.source) > WORDS_IN_CELL:
            todo = f'Split it, or shorten it to {WORDS_IN_CELL}.'
            yield cell.id, f'has {words(cell.source)} words', todo
    for cell in lesson.code:
        if not 1 <= len(lines(cell.source)) <= 30:
            yield cell.id, f'has {len(lines(cell.source))} lines of code', 'Make it 1 to 30.'
    median = statistics.median(len(lines(cell.source)) for cell in lesson.code)
    if median > 5:
        yield '', f'has a median of {median} lines a code cell', 'Split cells: at most 5.'


@rule
def code(lesson: Lesson) -> Found:
    for cell in lesson.code:
        try:
            tree = python(cell)
        except SyntaxError as error:
            if 'raises-exception' not in tags(cell):
                yield cell.id, f'is not Python: {error}', 'Correct it, or tag raises-exception.'
            continue
        if any(is_sleep(node) for node in at_cell_level(tree)):
            todo = 'Wait for a count or a condition: lab.wait_until(...).'
            yield cell.id, 'waits for a time', todo


def at_cell_level(tree: ast.AST) -> Iterator[ast.AST]:
    """Return the nodes that run with the cell itself, not in a function that it defines."""
    for node in ast.iter_child_nodes(tree):
        if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            yield node
            yield from at_cell_level(node)


def is_sleep(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Call) and re.search(r'\bsleep$', ast.unparse(node.func)) is not None
    )


@rule
def ids(lesson: Lesson) -> Found:
    for cell_id, count in Counter(cell.id for cell in lesson.cells).items():
        todo = 'Give it a name by hand, such as "talker-class".'
        if count > 1:
            yield cell_id, f'is the id of {count} cells', todo
        if re.fullmatch(r'[0-9a-f]{8}(-[0-9a-f-]+)?', cell_id) or not re.fullmatch(
            r'[a-z][a-z0-9]*(-[a-z0-9]+)*', cell_id
        ):
            yield cell_id, 'has an id that nobody chose', todo


@rule
def stored(lesson: Lesson) -> Found:
    todo = f'Run: python3 -m labkit record {lesson.name}'
    for error in iter_validate(lesson.notebook, version=4, version_minor=5):
        yield '', f'is not a valid notebook: {error.message}', 'Correct the file.'
    meta = lesson.notebook.metadata
    expected = {'kernelspec': KERNELSPEC, 'language_info': {'name': 'python'}}
    if {key: value for key, value in meta.items() if key != 'labkit'} != expected:
        yield '', f'has the metadata {dict(meta)}', todo
    for number, cell in enumerate(lesson.code, start=1):
        if cell.execution_count != number:
            yield cell.id, f'has execution count {cell.execution_count}, not {number}', todo
        if any('widget-view' in mime for out in cell.outputs for mime in out.get('data', {})):
            yield cell.id, 'holds the view of a widget', todo
    for cell in lesson.cells:
        extra = set(cell.metadata) - set(CELL_METADATA)
        if extra:
            yield cell.id, f'has the metadata {sorted(extra)}', todo
    if as_stored(lesson.notebook) != lesson.file:
        yield '', 'is not written as `labkit record` writes it', todo


@rule
def steady(lesson: Lesson) -> Found:
    """What is stored must be the same on every machine, at any time."""
    for cell in lesson.code:
        pictures = re.compile(r'"image/(png|jpeg)": "[^"]*"')
        text = pictures.sub('', json.dumps(cell.outputs, ensure_ascii=False))
        text = re.sub(r'\\u001b\[[\d;]*m', ' ', text)
        for what, pattern in UNSTEADY.items():
            for match in re.findall(pattern, text):
                todo = 'Let the cell show something that stays the same.'
                yield cell.id, f'shows {what}: {match!r}', todo
    for cell in lesson.cells:
        for match in re.findall(MACHINE_PATH, cell.source):
            yield cell.id, f'names a path of one machine: {match!r}', 'Use a relative path.'


@rule
def numbers(lesson: Lesson) -> Found:
    """What is measured is shown: a reader can't tell a near miss from True."""
    for cell in lesson.code:
        texts = [out.get('text') or out.get('data', {}).get('text/plain') for out in cell.outputs]
        for line in '\n'.join(text for text in texts if text).splitlines():
            # `ros2 param get` says this of a parameter that is a boolean.
            if re.search(r'(?:^|\W)(?:True|False)$', line) and 'Boolean value is' not in line:
                yield cell.id, f'shows {line!r}', 'Show the number, or say it in words.'


@rule
def exemptions(lesson: Lesson) -> Found:
    for cell in lesson.code:
        reason = cell.metadata.get('labkit', {}).get('reason', '')
        if 'nbval-ignore-output' in tags(cell) and words(reason) < 3:
            todo = 'Say why in its metadata: "labkit": {"reason": "..."}.'
            yield cell.id, 'is exempted from comparison without a reason', todo
        for tag in set(tags(cell)) & {'nbval-skip', 'skip-execution', 'nbval-raises-exception'}:
            yield cell.id, f'is tagged {tag}', 'Every cell runs: take the tag away.'
        if re.search(r'^\s*#\s*(NBVAL_|PYTEST_VALIDATE)', cell.source, flags=re.M):
            yield cell.id, 'speaks to nbval in a comment', 'Use a tag.'


@rule
def pictures(lesson: Lesson) -> Found:
    for cell in lesson.text:
        without = re.findall(r'!\[\s*\]', cell.source)
        without += [i for i in re.findall(r'<img[^>]*>', cell.source) if not alt(i)]
        without += [s for s in re.findall(r'<svg.*?</svg>', cell.source, re.S) if not alt(s)]
        mermaid = [m for m in FENCE.findall(cell.source) if '```mermaid' in m]
        without += [m for m in mermaid if not re.search(r'accDescr\s*[:{]\s*\S', m)]
        for picture in without:
            todo = 'Say what it shows: ![...], alt="...", <title> or, in Mermaid, accDescr.'
            yield cell.id, f'has a picture without alternative text: {picture[:40]!r}', todo
    for cell in lesson.code:
        plain = [out.get('text') or out.get('data', {}).get('text/plain') for out in cell.outputs]
        shown = [text for text in plain if text and not text.startswith('<Figure')]
        mimes = {mime for out in cell.outputs for mime in out.get('data', {})}
        if not shown and any(mime.startswith('image/') for mime in mimes):
            yield cell.id, 'shows a picture without text', 'Print what it shows as well.'


def alt(element: str) -> bool:
    pattern = r'(?:\balt|aria-label)=["\']\s*[^"\'\s]|<title>\s*[^<\s]'
    return re.search(pattern, element) is not None


@rule
def links(lesson: Lesson) -> Found:
    sources = [re.sub('`[^`]*`', '', FENCE.sub('', cell.source)) for cell in lesson.text]
    headings = re.findall(r'^#+ +(.+?)\s*$', '\n'.join(sources), flags=re.M)
    anchors = {heading.replace(' ', '-') for heading in headings}
    for cell, source in zip(lesson.text, sources, strict=True):
        for label, target in re.findall(r'\[([^]]*)\]\(([^)\s]*)[^)]*\)', source):
            if not label.strip():
                yield cell.id, f'has a link to {target!r} without words', 'Say where it leads.'
            if not resolves(target, lesson, cell, anchors):
                yield cell.id, f'links to {target!r}, which is not there', 'Correct the link.'


def resolves(target: str, lesson: Lesson, cell: NotebookNode, anchors: set[str]) -> bool:
    if target.startswith('https://'):
        return target.removeprefix('https://').startswith(SITES)
    if target.startswith('#'):
        return target[1:] in anchors
    if target.startswith('attachment:'):
        return target.removeprefix('attachment:') in cell.get('attachments', {})
    path = target.partition('#')[0]
    return ':' not in path and bool(path) and (lesson.path.parent / path).is_file()


@rule
def tone(lesson: Lesson) -> Found:
    for cell in lesson.text:
        prose = re.sub(r'!\[', '[', without_code(cell.source))
        if '!' in prose:
            yield cell.id, 'has an exclamation mark', 'Say it calmly.'
        for filler in re.findall(FILLERS, prose, flags=re.I):
            yield cell.id, f'says {filler!r}', 'Leave it out: it may not be so for the reader.'


def report(lesson: Lesson, check: Callable[[Lesson], Found]) -> list[str]:
    return [
        f'{lesson.name}{f", cell {cell_id!r}" if cell_id else ""}: {what}. {todo}'
        for cell_id, what, todo in check(lesson)
    ]


@pytest.mark.parametrize('name', RULES)
@pytest.mark.parametrize('path', PATHS, ids=lambda path: path.stem)
def test_lesson_keeps_the_rule(path: Path, name: str):
    found = report(Lesson(path), RULES[name])
    assert not found, '\n'.join(found)


def test_there_are_lessons_and_their_names_are_in_order():
    assert PATHS
    assert [p.name for p in PATHS if not re.fullmatch(r'\d\d(_[a-z0-9]+)+\.ipynb', p.name)] == []
    assert len({path.name[:2] for path in PATHS}) == len(PATHS)


def test_few_cells_are_exempted():
    cells = [cell for path in PATHS for cell in Lesson(path).code]
    exempted = [cell.id for cell in cells if 'nbval-ignore-output' in tags(cell)]
    assert len(exempted) <= 0.05 * len(cells), f'{exempted} are more than 5 % of {len(cells)}'
