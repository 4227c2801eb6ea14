"""What the pages in docs/ and the README name is there: files, and tests."""

from __future__ import annotations

import functools
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob('*.md'), *(ROOT / 'docs').rglob('*.md')]
LINK = re.compile(r'(?:\]\(|\bsrc(?:set)?=")(?!https?:|mailto:|#)([^)#\s"]+)')
TEST = re.compile(r'`(test_\w+?)(\.py)?(…)?`')


@functools.cache
def sources() -> dict[str, str]:
    """Return the text of each file of tests by its name."""
    return {path.name: path.read_text('utf-8') for path in (ROOT / 'tests').rglob('test_*.py')}


def missing_files(page: Path) -> list[str]:
    """Return the links to files that are not there; a badge is that of a workflow."""
    text = page.read_text(encoding='utf-8').replace('/badge.svg)', ')')
    links = [link.replace('../../actions/', '.github/') for link in LINK.findall(text)]
    return [link for link in links if not (page.parent / link).exists()]


def missing_tests(text: str) -> list[str]:
    """Return the tests, files of tests and beginnings of names (`test_…`) that are not there."""
    all_of_it = '\n'.join(sources().values())
    return [
        name
        for name, is_file, cut in TEST.findall(text)
        if not (
            f'{name}.py' in sources()
            if is_file
            else re.search(rf'^ *def {name}{"" if cut else "[(]"}', all_of_it, re.MULTILINE)
        )
    ]


@pytest.mark.parametrize('page', PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_what_is_named_is_there(page: Path) -> None:
    assert missing_files(page) == []
    assert missing_tests(page.read_text(encoding='utf-8')) == []


def test_what_is_not_there_is_found(tmp_path: Path) -> None:
    page = tmp_path / 'page.md'
    page.write_text('[a](gone.md) [b](page.md#part) [c](https://gone.example) <img src="x.png">')
    assert missing_files(page) == ['gone.md', 'x.png']
    text = '`test_unheard_of_…` `test_no.py` `test_docs.py` `test_what_is_…` `test_what_`'
    assert missing_tests(text) == ['test_unheard_of_', 'test_no', 'test_what_']
