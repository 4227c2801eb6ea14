"""notebooks/Glossary.md: each word stands in bold in the lesson named there, in no other."""

from __future__ import annotations

import json
import re
from pathlib import Path

NOTEBOOKS = Path(__file__).parents[1] / 'notebooks'
PAGE = NOTEBOOKS / 'Glossary.md'
ROW = re.compile(r'^\| ([^|]+) \| ([^|]+) \| \[(\d\d)\]\(([^)]+)\) \|$', re.MULTILINE)


def texts() -> dict[str, str]:
    """Return the text cells of each lesson by the name of its file."""
    found = {}
    for path in NOTEBOOKS.glob('*.ipynb'):
        cells = json.loads(path.read_text('utf-8'))['cells']
        text = [''.join(cell['source']) for cell in cells if cell['cell_type'] == 'markdown']
        found[path.name] = '\n\n'.join(text)
    return found


# Words that are ordinary English, too, and so may stand in a lesson before the one of their own.
ORDINARY = {
    'client', 'constant', 'feedback', 'frame', 'goal', 'joint', 'link', 'package', 'publisher',
    'record', 'result', 'server', 'subscriber', 'subscription',
}  # fmt: skip


def too_early(page: str) -> list[str]:
    """Return where a word stands before it is explained, and nothing says where that will be."""
    found = []
    for path in sorted(NOTEBOOKS.glob('*.ipynb')):
        for cell in json.loads(path.read_text('utf-8'))['cells']:
            text = re.sub(
                r'```.*?```|`[^`]*`|\[[^]]*\]\([^)]*\)',
                '',
                ''.join(cell['source']),
                flags=re.DOTALL,
            )
            points_ahead = re.search(r'[Ll]ater lessons|\blesson \d\d\b', text)
            if cell['cell_type'] != 'markdown' or points_ahead:
                continue
            for word, _, _, target in ROW.findall(page):
                used = re.search(rf'\b{re.escape(word)}(s|es)?\b', text, re.IGNORECASE)
                if used and path.name < target and word not in ORDINARY:
                    found.append(f'{path.name}, cell {cell["id"]!r}: {word}')
    return found


def problems(page: str) -> list[str]:
    """Return what is wrong with the page."""
    rows, lessons = ROW.findall(page), texts()
    words = [word for word, *_ in rows]
    found = [] if len(rows) == page.count('\n| ') - 1 else ['a row of another form']
    if words != sorted({*words}, key=str.casefold):
        found.append('not in the order of the alphabet, or a word twice')
    for word, sentence, number, target in rows:
        bold = re.compile(rf'\*\*{re.escape(word)}(s|es)?\*\*', re.IGNORECASE)
        where = sorted(name for name, text in lessons.items() if bold.search(text))
        if where != [target] or target[:2] != number:
            found.append(f'{word}: in bold in {where}, not in {number} {target} alone')
        if not re.fullmatch(r'[A-Z][^.]*\.', re.sub('`[^`]+`', 'code', sentence)):
            found.append(f'{word}: not one sentence: {sentence}')
    return found


def test_each_word_is_where_the_glossary_says():
    page = PAGE.read_text('utf-8')
    assert len(ROW.findall(page)) > 60
    assert problems(page) == []


def test_no_word_is_used_before_it_is_explained():
    assert too_early(PAGE.read_text('utf-8')) == []


def test_what_is_wrong_is_found():
    page = PAGE.read_text('utf-8')
    later = page.replace('| spin | To take', '| spin | To').replace('[02](02_', '[09](09_')
    assert "02_talker_listener.ipynb, cell 'spin': spin" in too_early(later)
    assert problems(page.replace('| spin |', '| spinn |')) == [
        'spinn: in bold in [], not in 02 02_talker_listener.ipynb alone'
    ]
    again = '| spin | To spin. | [02](02_talker_listener.ipynb) |\n'
    assert problems(page + again) == ['not in the order of the alphabet, or a word twice']
    assert problems(page + '| yaw | An angle.\n') == ['a row of another form']
    assert problems(page.replace('A program that runs.', 'It runs. So it is.')) == [
        'process: not one sentence: It runs. So it is.'
    ]
