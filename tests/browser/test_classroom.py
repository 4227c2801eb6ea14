"""The teacher's view in the browser: it follows, names nobody unasked, and shows text as text."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect

from labkit.exercises.record.class_sheet import FILE_NAME
from tests.browser.accessibility import violations
from tests.browser.page import Notebook

pytestmark = pytest.mark.slow('a page in the browser')

WHY = 'Two copies of the node run at once, and their messages mix on the topic.'
HTML = '<img src=x onerror="window.hacked = 1">'
CELLS = {
    'class': 'import labkit as lab\nlab.classroom({folder!r})',
    'names': 'view = lab.classroom({folder!r}, names=True)\nview',
    'close': 'view.close()',
}


class Learners:
    """A folder of a class, with what learners have sent."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def send(self, name: str, **entry: Any) -> None:
        """Let somebody send something about count_up of lesson 04, first tried 15 min ago."""
        now = datetime.now(timezone.utc).replace(microsecond=0)
        first = (now - timedelta(minutes=15)).isoformat()
        item: dict[str, Any] = {
            'lesson': 'odds',
            'kind': 'exercise',
            'name': 'count_up',
            'first_try': first,
        }
        item |= {'tries': 2, 'last_try': now.isoformat(), **entry}
        sheet: dict[str, Any] = {
            'version': 1,
            'written_at': now.isoformat(),
            'since': first,
            'lesson': 'odds',
        }
        path = self.folder / name / FILE_NAME
        path.parent.mkdir(exist_ok=True)
        new = path.with_suffix('.new')
        new.write_text(json.dumps({**sheet, 'entries': [item]}))
        new.rename(path)


@pytest.fixture(scope='module')
def learners(tmp_path_factory: pytest.TempPathFactory) -> Learners:
    made = Learners(tmp_path_factory.mktemp('class'))
    made.send('Anna', last='FAIL', sentence=WHY)
    made.send('Ben', last='FAIL', sentence=WHY)
    made.send('Carl', last='PASS', passed_at='2026-01-01T00:00:00+00:00')
    made.send(HTML, last='FAIL', sentence=f'{HTML} is your teacher.')
    (made.folder / 'Mallory').mkdir()
    with (made.folder / 'Mallory' / FILE_NAME).open('wb') as file:
        file.truncate(1_000_000_000)
    return made


@pytest.fixture
def notebook(learners: Learners, open_cells: Callable[..., Notebook]) -> Iterator[Notebook]:
    folder = str(learners.folder)
    yield open_cells(**{name: code.format(folder=folder) for name, code in CELLS.items()})


def test_it_follows_and_names_nobody(notebook: Notebook, learners: Learners) -> None:
    notebook.run_cell('class')
    view = notebook.output('class').locator('.labkit-classroom')
    expect(view).to_contain_text('2 learners')
    expect(view).to_contain_text(WHY)
    expect(view).to_contain_text('1 passed, 3 trying')
    expect(view).to_contain_text('From 1 of them came something that can not be used.')
    expect(view).not_to_contain_text('your teacher')
    learners.send('Ben', last='PASS', passed_at='2026-01-01T00:00:00+00:00')
    expect(view).to_contain_text('2 passed, 2 trying')
    expect(view).to_contain_text('1 learner')
    for name in ('Anna', 'Ben', 'Carl', 'Mallory', 'img'):
        expect(view).not_to_contain_text(name)
    assert not violations(notebook, 'class')


def test_names_are_for_the_teacher_and_are_not_stored(
    notebook: Notebook, learners: Learners
) -> None:
    notebook.run_cell('class')
    notebook.run_cell('names')
    view = notebook.output('names').locator('.labkit-classroom')
    rows = view.locator('section').filter(has=view.page.locator('h4', has_text='Learners'))
    expect(rows.locator('tbody tr')).to_have_count(5)
    expect(rows.locator('tbody tr', has_text='Anna')).to_contain_text('15 min')
    expect(rows.locator('tbody tr', has_text='Mallory')).to_contain_text('too large')
    tried = rows.locator('tbody tr', has_text='Anna').get_by_role('img')
    expect(tried).to_have_attribute('aria-label', '0 passed, 2 tried')
    # What somebody calls themselves is text, and nothing else.
    expect(rows.locator('tbody th', has_text=HTML)).to_have_count(1)
    assert view.locator('img').count() == 0
    assert not notebook.page.evaluate('Boolean(window.hacked)')
    assert not violations(notebook, 'names')
    notebook.run_cell('close')
    expect(view).to_contain_text('This classroom has ended.')
    (stored,) = [cell['outputs'] for cell in notebook.cells() if cell['id'] == 'names']
    text = json.dumps(stored)
    assert 'share their progress' in text and WHY in text
    assert not any(name in text for name in ('Anna', 'Ben', 'Carl', 'Mallory', 'onerror'))


def test_wide_tables_scroll_by_keyboard_in_a_narrow_page(notebook: Notebook) -> None:
    notebook.run_cell('class')
    notebook.run_cell('names')
    view = notebook.output('names').locator('.labkit-classroom')
    expect(view).to_contain_text('Anna')
    size = notebook.page.viewport_size
    assert size is not None
    notebook.page.set_viewport_size({'width': 800, 'height': 900})
    try:
        box = view.locator('.labkit-classroom-scroll').last
        box.focus()
        expect(box).to_be_focused()
        wide = view.evaluate('view => view.scrollWidth <= view.clientWidth')
        assert wide, 'the view itself is not wider than its place'
    finally:
        notebook.page.set_viewport_size(size)
