"""notebooks/Python.md: each piece of code prints what stands below it, and lessons link to it."""

from __future__ import annotations

import contextlib
import io
import json
import re
from pathlib import Path
from typing import Any

NOTEBOOKS = Path(__file__).parents[1] / 'notebooks'
PIECE = re.compile(r'```python\n(.*?)```\n\n```text\n(.*?)```', re.DOTALL)


def test_each_piece_prints_what_the_page_says():
    pieces = PIECE.findall((NOTEBOOKS / 'Python.md').read_text('utf-8'))
    assert len(pieces) == 5
    names: dict[str, Any] = {}
    for code, expected in pieces:
        with contextlib.redirect_stdout(io.StringIO()) as out:
            exec(code, names)
        assert out.getvalue() == expected, code


def test_it_is_linked_where_a_learner_meets_such_code_first():
    for number in ('00', '01', '02'):
        (path,) = NOTEBOOKS.glob(f'{number}_*.ipynb')
        cells = json.loads(path.read_text('utf-8'))['cells']
        assert any('](Python.md)' in ''.join(cell['source']) for cell in cells), path.name
