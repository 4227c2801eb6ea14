"""What labkit wants of JupyterLab: its app for views, and a copy of each saved notebook.

The copies lie outside of the learner's folder: see labkit/course/copies.py. JupyterLab's process
reads this, which imports nothing of labkit (see labkit/course/server.py).
"""

from __future__ import annotations

import gzip
import json
import os
import time
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

# Of all copies of a learner. One of a lesson takes some 10 kB.
_MOST_BYTES = 20_000_000


def _keep(os_path: str, model: dict[str, Any], contents_manager: Any) -> None:
    if model['type'] != 'notebook':
        return
    # What can't be copied is saved all the same.
    with suppress(OSError, ValueError, LookupError, TypeError):
        notebook = json.loads(Path(os_path).read_bytes())
        for cell in notebook['cells']:
            if cell['cell_type'] == 'code':
                cell.update(outputs=[], execution_count=None)
        content = json.dumps(notebook, indent=1, ensure_ascii=False).encode() + b'\n'
        name = os.path.relpath(os_path, contents_manager.root_dir)
        if not name.startswith(os.pardir):
            _write(Path(os.environ['LABKIT_COPIES']), name, gzip.compress(content, mtime=0))


def _write(copies: Path, name: str, content: bytes) -> None:
    folder = copies / name
    folder.mkdir(parents=True, exist_ok=True)
    before = sorted(folder.glob('*.gz'))
    if before and before[-1].read_bytes() == content:
        return
    # Two of one second have one name: the later one stays.
    path = folder / time.strftime('%Y-%m-%d %H:%M:%S.gz')
    new = path.with_name(f'.{os.getpid()}')
    new.write_bytes(content)
    os.replace(new, path)
    _make_room(copies)


def _make_room(copies: Path) -> None:
    """Delete the oldest copies, and the only one of a notebook last."""
    newest: dict[Path, Path] = {}
    for path in copies.rglob('*.gz'):
        newest[path.parent] = max(newest.get(path.parent, path), path)
    kept = sorted(copies.rglob('*.gz'), key=lambda path: (path in newest.values(), path.name))
    size = sum(path.stat().st_size for path in kept)
    while size > _MOST_BYTES:
        size -= kept[0].stat().st_size
        kept.pop(0).unlink()


c = get_config()  # type: ignore[name-defined] # noqa: F821 (Jupyter brings it)
# For the commands of JupyterLab that views run: see labkit/views/live.js.
c.LabApp.expose_app_in_browser = True
if os.environ.get('LABKIT_COPIES'):
    c.ContentsManager.post_save_hook = _keep
    # Extensions change the configuration later, and then Jupyter sets the same hook once more.
    warnings.filterwarnings('ignore', r'Overriding existing post_save_hook \(_keep\)')
