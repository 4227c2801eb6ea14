"""docs/coverage.md: each row is there, and the cells that it names are in the notebooks."""

from __future__ import annotations

import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / 'docs/coverage.md'
# Items of the labs, lessons of the curriculum, and sentences.
COUNTS = {'A': 37, 'B': 28, 'C': 17, 'D': 16, 'E': 16, 'T': 41}
ROWS = {f'{letter}{number}' for letter, count in COUNTS.items() for number in range(1, count + 1)}
ROWS |= {f'{number:02}' for number in range(17)}
ROW = re.compile(r'^\| ([A-Z]?\d+) \| [^|]+ \| ([^|]+) \|$', re.MULTILINE)
CELL = re.compile(r'`(\d\d/[\w-]+)`')


def cells() -> set[str]:
    """Return the ids of all cells, as `NN/cell-id`."""
    found = set()
    for path in (ROOT / 'notebooks').glob('*.ipynb'):
        for cell in json.loads(path.read_text('utf-8'))['cells']:
            found.add(f'{path.name[:2]}/{cell["id"]}')
    return found


def problems(page: str) -> list[str]:
    """Return what is wrong with the page."""
    rows, known = ROW.findall(page), cells()
    names = [name for name, _ in rows]
    found = [f'{name}: no row' for name in sorted(ROWS - {*names})]
    found += [f'{name}: is no item' for name in sorted({*names} - ROWS)]
    found += [f'{name}: {names.count(name)} rows' for name in {*names} if names.count(name) > 1]
    for name, where in rows:
        named = CELL.findall(where)
        found += [f'{name}: no cell {cell}' for cell in named if cell not in known]
        if not named and not where.startswith('not yet'):
            found.append(f'{name}: names no cell, and does not say "not yet"')
    return found


def test_each_row_is_there_and_its_cells_are():
    assert problems(PAGE.read_text('utf-8')) == []


def test_what_is_wrong_is_found():
    page = PAGE.read_text('utf-8')
    first = ROW.search(page)
    assert first
    assert problems(page.replace(first[0], '')) == [f'{first[1]}: no row']
    assert problems(f'{page}| A99 | more | `00/setup` |\n') == ['A99: is no item']
    assert problems(f'{page}{first[0]}\n') == [f'{first[1]}: 2 rows']
    assert problems(page.replace('`00/robot`', '`00/robt`')) == ['00: no cell 00/robt']
    assert 'A2: names no cell, and does not say "not yet"' in problems(
        page.replace(
            '`00/doctor` `00/real-machine` `11/real-machine` `16/install-list` `16/source` '
            '`16/bashrc-list`',
            'everywhere',
        )
    )
