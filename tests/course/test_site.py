"""The documentation site: each lesson with its stored outputs, and links that lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from labkit.course import site
from labkit.errors import LabError

pytestmark = pytest.mark.slow('it builds the site')

ROOT = Path(__file__).parents[2]
LESSONS = sorted((ROOT / 'notebooks').glob('*.ipynb'))


@pytest.fixture(scope='module')
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('site')
    assert 'is the front page of the site.' in site.build_site(folder)
    return folder


@pytest.mark.parametrize('lesson', LESSONS, ids=lambda path: path.stem)
def test_a_lesson_is_a_page_with_its_stored_outputs(built: Path, lesson: Path) -> None:
    page = (built / 'notebooks' / f'{lesson.stem}.html').read_text(encoding='utf-8')
    assert page.count('class="cell docutils') > 10
    # Text that a cell printed, and pictures: of the course, or drawn by labkit.
    assert 'class="output text_plain' in page or 'class="output stream' in page
    assert re.search('<img |<svg ', page)


def test_each_page_of_the_docs_is_there_and_can_be_searched_for(built: Path) -> None:
    pages = [*(ROOT / 'docs').glob('*.md'), *ROOT.glob('*.md')]
    for page in pages:
        assert (built / page.relative_to(ROOT)).with_suffix('.html').is_file(), page
    index = (built / 'searchindex.js').read_text(encoding='utf-8')
    assert '"docs/faults"' in index and '"notebooks/07_turtlebot"' in index


def test_the_front_page_has_its_picture(built: Path) -> None:
    page = (built / 'index.html').read_text(encoding='utf-8')
    found = re.search(r'<img [^>]*src="(_images/readme[^"]*)"', page)
    assert found and (built / found[1]).is_file()
    assert 'readme-dark' not in page


def test_pages_load_nothing_from_elsewhere(built: Path) -> None:
    loaded = re.compile(r'<(?:script|img|link rel="stylesheet")[^>]*(?:src|href)="(https?:[^"]+)"')
    found = [
        (path.name, address)
        for path in built.rglob('*.html')
        for address in loaded.findall(path.read_text(encoding='utf-8'))
    ]
    assert found == []


def test_a_link_that_leads_nowhere_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    course = tmp_path / 'course'
    (course / 'docs' / 'site').mkdir(parents=True)
    (course / 'README.md').write_text('# Course\n')
    for name in ('conf.py', 'index.md'):
        (course / 'docs' / 'site' / name).write_text((ROOT / 'docs' / 'site' / name).read_text())
    (course / 'docs' / 'site' / 'index.md').write_text('# Course\n\n[gone](docs/gone.md)\n')
    monkeypatch.setattr(site, 'ROOT', course)
    with pytest.raises(LabError, match=r"index\.md:3: .*'docs/gone\.md'"):
        site.build_site(tmp_path / 'site')
    assert not (tmp_path / 'site').exists()


def test_a_folder_with_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / 'thesis.txt').write_text('years of work')
    with pytest.raises(LabError, match='holds something else'):
        site.build_site(tmp_path)
    assert (tmp_path / 'thesis.txt').is_file()


def test_a_link_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / 'built').mkdir()
    for name in ('.buildinfo', 'thesis.txt'):
        (tmp_path / 'built' / name).write_text('years of work')
    (tmp_path / 'site').symlink_to('built')
    with pytest.raises(LabError, match='is a link') as told:
        site.build_site(tmp_path / 'site')
    assert str(tmp_path / 'built') in told.value.todo
    assert len(list((tmp_path / 'built').iterdir())) == 2
