from __future__ import annotations

import asyncio
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from labkit.exercises import Outcome
from labkit.exercises.found_lessons import load
from labkit.exercises.verdict import Verdict
from labkit.views.card import Card

TEACHING = Path(__file__).parents[2] / 'docs' / 'teaching.md'
EVIL = '<script>alert("x")</script><img src=x onerror=alert(1)>'
FULL = Verdict(
    Outcome.FAIL,
    'count_up',
    expected='1, 3, 5',
    seen='2, 4, 6',
    why='These are even.',
    todo='Start with `1`.',
)


class Page(HTMLParser):
    """The tags and the text of a page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.text = ''
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.text += data


def test_text_form_names_everything_in_order() -> None:
    assert repr(FULL).splitlines() == [
        'FAIL: count_up',
        '  Expected: 1, 3, 5',
        '  Seen:     2, 4, 6',
        '  Why:      These are even.',
        '  Next:     Start with `1`.',
    ]


def test_long_lines_are_wrapped_under_their_label() -> None:
    lines = repr(Verdict(Outcome.FAIL, 'x', why='word ' * 60)).splitlines()
    assert max(map(len, lines)) <= 92
    assert all(line.startswith('       word') for line in lines[2:])


@pytest.mark.parametrize('outcome', Outcome)
def test_outcome_is_a_word_in_both_forms(outcome: Outcome) -> None:
    verdict = Verdict(outcome, 'x')
    assert repr(verdict) == f'{outcome.value}: x'
    assert outcome.value in Page(verdict._repr_html_()).text
    assert 'role="status"' in verdict._repr_html_()


@pytest.mark.parametrize('outcome', Outcome)
def test_a_verdict_is_true_if_it_has_passed(outcome: Outcome) -> None:
    assert bool(Verdict(outcome, 'x')) is (outcome is Outcome.PASS)


def test_any_verdict_can_be_awaited() -> None:
    async def wait() -> Verdict:
        return await FULL

    assert asyncio.run(wait()) is FULL


def test_the_cell_for_teachers_passes_for_an_answer_alone(kernel: Any) -> None:
    page = TEACHING.read_text(encoding='utf-8')
    (cell,) = re.findall(r'^```python\n(### BEGIN HIDDEN TESTS\n.*?)^```', page, re.M | re.S)
    kernel.run("import labkit as lab\nlesson = lab.lesson('talker_listener')")
    refused = 'AssertionError: NOT ATTEMPTED: every_two_seconds'
    assert kernel.run(cell).error.startswith(refused)
    kernel.run(load('talker_listener').every_two_seconds.answer.code)
    assert kernel.run(cell).error == ''


def test_colours_are_those_of_the_theme_with_a_fallback() -> None:
    html = FULL._repr_html_()
    assert re.findall(r'var\((--jp-[\w-]+), ', html)
    assert not re.search(r'var\(--jp-[\w-]+\)', html)


@pytest.mark.parametrize('part', ['name', 'text', 'expected', 'seen', 'why', 'todo', 'trace'])
def test_everything_is_escaped(part: str) -> None:
    fields: dict[str, Any] = {'name': 'x', part: EVIL}
    page = Page(Verdict(Outcome.ERROR, **fields)._repr_html_())
    assert {'script', 'img'}.isdisjoint(page.tags)
    assert EVIL in page.text


def test_words_in_backticks_are_code() -> None:
    html = Card('info', 'HINT', '', text='Use `a < b` here.')._repr_html_()
    assert '<code>a &lt; b</code>' in html


def test_a_note_does_not_change_the_verdict() -> None:
    noted = FULL.with_note('The file is gone.')
    assert noted.outcome is Outcome.FAIL
    assert 'The file is gone.' in repr(noted)
