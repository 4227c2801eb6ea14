"""labkit's plugin of pytest: with `--nbval`, notebooks of labkit are run and compared its way.

pytest finds it by its entry point, wherever labkit is installed, and loads it in each of its runs,
also where colcon tests a package that has nothing to do with labkit. So it loads nothing more
before nbval has found a notebook that uses labkit, and leaves all others to nbval.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Generator
from pathlib import Path

import pytest

_LOADED_WITH_THIS = {
    'labkit',
    'labkit.course',
    'labkit.domain_ids',
    'labkit.errors',
    'labkit.settings',
    'labkit.stop_button',
    __name__,
}
_IMPORT = re.compile(r'^\s*(?:import|from)\s+(?:[\w.]+\s*,\s*)*labkit\b', re.MULTILINE)


def pytest_addoption() -> None:
    """Undo the import of labkit, if that was for this plugin: whoever imports it does so anew."""
    loaded = {name for name in sys.modules if name.partition('.')[0] == 'labkit'}
    if 'labkit' not in loaded or loaded - _LOADED_WITH_THIS:
        return  # it was forgotten already, or is used
    sys.modules['labkit.settings'].give_environment_back()
    for name in loaded:
        del sys.modules[name]


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(
    file_path: Path,
) -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
    """Put a `LessonFile` in the place of what nbval has made of a notebook of labkit."""
    found = yield
    # Not what another conftest has made of it. nbval may be missing, so it is not imported here.
    theirs = [file for file in found if type(file).__module__ == 'nbval.plugin']
    if not theirs or not uses_labkit(file_path):
        return found
    from labkit.course.nbval_cells import LessonFile

    ours = [LessonFile.from_parent(file.parent, path=file_path) for file in theirs]
    return [*(file for file in found if file not in theirs), *ours]


def uses_labkit(path: Path) -> bool:
    """Tell whether a notebook imports labkit, or has metadata of it."""
    try:
        notebook = json.loads(path.read_text(encoding='utf-8'))
        if 'labkit' in notebook['metadata']:
            return True
        cells = [cell for cell in notebook['cells'] if cell['cell_type'] == 'code']
        return any(_IMPORT.search(''.join(cell['source'])) for cell in cells)
    except (OSError, ValueError, LookupError, TypeError):
        return False  # nbval says what is wrong with it
