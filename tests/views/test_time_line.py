"""The time line under a verdict: a picture, a table, and lines of text with the same facts."""

from __future__ import annotations

from xml.etree import ElementTree

from labkit.exercises import Outcome
from labkit.exercises.verdict import Verdict
from labkit.views.time_line import Event, TimeLine

ODDS, EVENS = ('/odds', 'this check'), ('/evens', '/<evener>')
LINE = TimeLine(
    30.0,
    {ODDS: [1.0, 2.0], EVENS: [1.0, 1.0000001]},
    [
        Event(1.0, *ODDS, 'data: 5'),
        Event(1.0, *EVENS, '<b>'),
        Event(1.0000001, *EVENS, 'data: 6'),
        Event(2.0, *ODDS, 'data: 7'),
    ],
    at=2.0,
)


def page(shown: TimeLine | Verdict) -> ElementTree.Element:
    return ElementTree.fromstring(f'<main>{shown._repr_html_().replace("<br>", "<br/>")}</main>')


def test_text_has_each_message_and_marks_where_it_went_wrong() -> None:
    assert repr(LINE).splitlines() == [
        'TIME LINE: all 4 messages in 30 s of the time of your nodes',
        '    1.000 s  /odds  this check: data: 5',
        '    1.000 s  /evens  /<evener>: <b>',
        '    1.000 s  /evens  /<evener>: data: 6',
        '>   2.000 s  /odds  this check: data: 7',
    ]


def test_table_has_the_same_and_names_of_others_are_escaped() -> None:
    rows = [[cell.text for cell in row] for row in page(LINE).iter('tr')]
    assert rows[0] == ['Time in s', 'Topic', 'From', 'Message']
    assert rows[2] == ['1.000', '/evens', '/<evener>', '<b>']
    marked = [row for row in page(LINE).iter('tr') if row.get('style') == 'font-weight:bold']
    assert [row[3].text for row in marked] == ['data: 7']


def test_picture_has_a_lane_for_each_publisher_and_says_so() -> None:
    (picture,) = page(LINE).iter('svg')
    assert picture.get('role') == 'img'
    assert 'It went wrong at 2.0 s.' in picture.attrib['aria-label']
    texts = [text.text for text in picture.iter('text')]
    assert texts[:2] == ['/odds from this check', '/evens from /<evener>']
    ticks = [path.attrib['d'].count('M') for path in picture.iter('path')]
    assert ticks == [2, 1, 1]  # two at one place, and where it went wrong


def test_many_messages_make_a_picture_of_bounded_size() -> None:
    moments = [i / 1000 for i in range(30_000)]
    many = TimeLine(30.0, {ODDS: moments}, LINE.events[:1])
    assert len(many._repr_html_()) < 20_000
    assert '1 of 30000 messages' in repr(many)


def test_it_stands_in_a_verdict_folded_where_all_is_well() -> None:
    failed = page(Verdict(Outcome.FAIL, 'evens', expected='6', seen='7', time_line=LINE))
    (box,) = failed
    assert [child.tag for child in box][-2:] == ['svg', 'details']
    (box,) = page(Verdict(Outcome.PASS, 'evens', 'all right', time_line=LINE))
    assert box[-1].tag == 'details' and box[-1][1].tag == 'svg'
    without = Verdict(Outcome.FAIL, 'evens', expected='6', seen='7')
    assert not list(page(without).iter('svg'))
