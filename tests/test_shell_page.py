"""notebooks/Shell.md: each piece prints what stands below it, and lessons link to it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

NOTEBOOKS = Path(__file__).parents[1] / 'notebooks'
PIECE = re.compile(r'```bash\n(.*?)```\n\n```text\n(.*?)```', re.DOTALL)


def test_each_piece_prints_what_the_page_says(tmp_path: Path):
    pieces = PIECE.findall((NOTEBOOKS / 'Shell.md').read_text('utf-8'))
    assert len(pieces) == 5
    # The Python of the environment, as in a terminal of JupyterLab.
    path = f'{Path(sys.executable).parent}{os.pathsep}{os.defpath}'
    for code, expected in pieces:
        done = subprocess.run(
            ['bash', '-c', code],
            cwd=tmp_path,
            env={'PATH': path, 'HOME': str(tmp_path), 'LC_ALL': 'C'},
            stdout=subprocess.PIPE,
            text=True,
        )
        assert done.stdout == expected, code


def test_no_piece_leaves_anything_that_ros_reads_in_the_terminal():
    for code, _ in PIECE.findall((NOTEBOOKS / 'Shell.md').read_text('utf-8')):
        assert not re.search(r'\b(ROS|RMW|RCUTILS|FASTRTPS)_', code), code


def test_it_is_linked_where_a_learner_meets_a_terminal_first():
    for number in ('02', '11'):
        (path,) = NOTEBOOKS.glob(f'{number}_*.ipynb')
        cells = json.loads(path.read_text('utf-8'))['cells']
        assert any('](Shell.md)' in ''.join(cell['source']) for cell in cells), path.name
