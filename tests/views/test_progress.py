from __future__ import annotations

from datetime import date
from xml.etree import ElementTree

import pytest

from labkit.views.course_map import course_map, earned, markdown_map
from labkit.views.passed_card import PassedCard
from labkit.views.progress_picture import Item, Row, percent, picture, text_form

ROWS = [
    Row(
        '01 a & b',
        [
            Item('exercise', '<one>', 'done', '01_a.ipynb#cell-id=<one>'),
            Item('question', 'q.1', 'tried'),
        ],
        '01_a.ipynb',
        minutes=35,
    ),
    Row('02 long', [Item('question', f'q.{n}', 'open') for n in range(60)]),
    Row('03 empty', []),
]


def page_of(html: str) -> ElementTree.Element:
    # No bare `&` or `<` from a name: an XML parser would refuse it.
    return ElementTree.fromstring(html)


def test_picture_is_well_formed_and_escaped() -> None:
    page = page_of(picture(ROWS, '<note>', [('02 long, <x>', '02_long.ipynb')]))
    text = ''.join(page.itertext())
    assert '01 a & b' in text and '✔ <one>' in text and '<note>' in text
    links = {''.join(a.itertext()): a.attrib['href'] for a in page.iter('a')}
    assert links == {
        '01 a & b': '01_a.ipynb',
        '✔ <one>': '01_a.ipynb#cell-id=<one>',
        '02 long, <x>': '02_long.ipynb',
    }


def test_mark_says_its_state_in_words() -> None:
    page = page_of(picture(ROWS))
    labels = [element.attrib.get('aria-label') for element in page.iter('a')]
    assert 'exercise <one>: done' in labels


def test_each_lesson_has_a_line_with_its_share() -> None:
    lines = list(page_of(picture(ROWS)).iter('tr'))[1:]
    cells = [[' '.join(''.join(c.itertext()).split()) for c in line] for line in lines]
    assert cells == [
        ['01 a & b', '35 min', '100 %', '✔ <one>', '0 of 1'],
        ['02 long', '', '0 %', '', '0 of 60'],
        ['03 empty', '', '0 %', '', ''],
    ]


@pytest.mark.parametrize(
    ('done', 'count', 'share'),
    [(0, 0, 0), (0, 3, 0), (1, 200, 1), (1, 3, 33), (199, 200, 99), (3, 3, 100)],
)
def test_nothing_is_said_only_of_nothing_and_all_only_of_all(
    done: int, count: int, share: int
) -> None:
    states = ['done'] * done + ['tried'] * (count - done)
    assert percent([Item('exercise', 'x', state) for state in states]) == share


def test_text_form_counts() -> None:
    assert text_form(ROWS).splitlines() == [
        'Progress: 1 of 1 exercise, 0 of 61 questions done',
        '  01 a & b  1 of 1 exercise, 0 of 1 question',
        '    done   <one>',
        '  02 long   0 of 60 questions',
        '  03 empty  ',
    ]


def test_card_of_a_solved_exercise() -> None:
    items = [Item('exercise', 'one', 'done', 'x#1'), Item('exercise', 'two', 'open', 'x#2')]
    card = PassedCard(
        'good',
        'PASS',
        'one',
        'Seen <it>.',
        asked=['publish `Int16`', '<b>'],
        exercises=items,
        onward=[('Next: two', 'x#2')],
    )
    assert repr(card) == 'PASS: one\n  Seen <it>.'
    page = page_of(card._repr_html_().replace('<br>', '<br/>'))
    text = ' '.join(''.join(page.itertext()).split())
    assert text.startswith('✔ PASS: one')
    assert 'Task✔ publish Int16✔ <b>' in text and 'SeenSeen <it>.' in text
    assert '✔ one ○ two 1 of 2 exercises of this lesson' in text
    hrefs = [a.attrib['href'] for a in page.iter('a')]
    assert hrefs == ['x#1', 'x#2', 'x#2']


def test_map_has_a_station_for_each_lesson_and_the_robot_where_one_is() -> None:
    begun = Row('03 begun', [Item('exercise', x, s) for x, s in (('x', 'done'), ('y', 'open'))])
    rows = [ROWS[0], ROWS[1], begun, Row('04 here', [], '04_here.ipynb'), ROWS[2]]
    page = page_of(course_map(rows, '04_here.ipynb'))
    svg = '{http://www.w3.org/2000/svg}'
    stations = list(page.iter(f'{svg}svg'))
    assert len(stations) == len(rows)
    with_robot = [s for s in stations if len(list(s.iter(f'{svg}g'))) == 2]
    assert with_robot == [stations[3]]
    # One ring is the way, the second one what is done of it.
    rings = [len(list(s.iter(f'{svg}circle'))) for s in stations]
    assert rings == [2, 1, 2, 1, 1]
    # The road leaves a station whose exercises are solved in another colour, up to the next one.
    roads = [['success' in p.attrib['stroke'] for p in s.findall(f'{svg}path')] for s in stations]
    assert roads == [[True], [True, False], [False, False], [False, False], [False]]


def test_each_station_is_a_link_with_words() -> None:
    page = page_of(course_map(ROWS))
    links = page.findall('a')
    assert [link.attrib['href'] for link in links] == ['01_a.ipynb']
    assert links[0].attrib['aria-label'] == '01 a & b: 100 %, 35 min'
    assert [part.attrib['aria-label'] for part in page.findall('span')] == [
        '02 long: 0 %',
        '03 empty: 0 %',
    ]


def test_road_in_markdown_is_links_with_pictures() -> None:
    text = markdown_map([Row('01 a [b]', [], '01_a.ipynb'), Row('02 c', [])])
    assert text.startswith('[![01 a (b): 0 %](data:image/svg+xml;base64,')
    assert ')](01_a.ipynb)![02 c: 0 %](data:' in text and '\n' not in text


def test_certificate_says_what_was_done_and_when() -> None:
    page = page_of(earned(ROWS, date(2026, 3, 3), date(2026, 5, 9)))
    text = ' '.join(' '.join(page.itertext()).split())
    assert '1 of 1 exercise, 0 of 61 questions, from 3 March 2026 to 9 May 2026.' in text
