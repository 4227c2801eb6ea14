from __future__ import annotations

import re
from html.parser import HTMLParser

from labkit.views.card import Card
from labkit.views.solution import SolutionCard

CODE = """
class Talker(Node):
    def __init__(self):
        super().__init__('<b>&amp;')  # a name
        self.text = f'{1 < 2} </script>'

%ros2 topic list
"""


class Code(HTMLParser):
    """The text of a page's `pre`, and the style of each of its words."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.text, self.styles = '', dict[str, str]()
        self._inside, self._style = False, ''
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = self._inside or tag == 'pre'
        self._style = dict(attrs).get('style') or ''

    def handle_endtag(self, tag: str) -> None:
        self._inside = self._inside and tag != 'pre'
        self._style = ''

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.text += data
            self.styles[data] = self._style


def solution() -> SolutionCard:
    return SolutionCard('info', 'SOLUTION', 'talker', text='So.', code=CODE)


def test_code_is_shown_letter_by_letter_whatever_is_in_it() -> None:
    assert Code(solution()._repr_html_()).text == CODE.rstrip()


def test_colours_are_those_of_the_editor_and_elsewhere_of_the_page() -> None:
    html = solution()._repr_html_()
    styles = Code(html).styles
    assert 'keyword-color' in styles['class'] and 'bold' in styles['class']
    assert 'comment-color' in styles['# a name'] and 'def-color' in styles['Talker']
    code = html.partition('<pre')[2].partition('</pre>')[0]
    assert set(re.findall(r'var\(--jp-mirror-editor-[\w-]+, (\w+)\)', code)) == {'inherit'}
    assert not re.search(r'color:(?!var)', code.partition('>')[2])


def test_text_is_that_of_any_card() -> None:
    assert repr(solution()) == repr(Card('info', 'SOLUTION', 'talker', text='So.', code=CODE))
