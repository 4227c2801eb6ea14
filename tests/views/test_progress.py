from __future__ import annotations

from xml.etree import ElementTree

from labkit.views.progress_picture import Item, Row, picture, text_form

ROWS = [
    Row('01_a & b', [Item('exercise', '<one>', 'done'), Item('question', 'q.1', 'tried')]),
    Row('02_long', [Item('question', f'q.{n}', 'open') for n in range(60)]),
    Row('03_empty', []),
]


def test_picture_is_well_formed_and_escaped() -> None:
    # No bare `&` or `<` from a name: an XML parser would refuse it.
    root = ElementTree.fromstring(picture(ROWS, '<note>'))
    texts = ''.join(root.itertext())
    assert '01_a & b' in texts and 'exercise <one>: done' in texts and '<note>' in texts


def test_every_square_is_inside_the_picture_and_has_a_sign() -> None:
    svg = ElementTree.fromstring(picture(ROWS)).find('{http://www.w3.org/2000/svg}svg')
    assert svg is not None
    _, _, width, height = map(float, svg.attrib['viewBox'].split())
    squares = svg.findall('.//{http://www.w3.org/2000/svg}rect')
    assert len(squares) == 62
    for square in squares:
        assert float(square.attrib['x']) + float(square.attrib['width']) <= width
        assert float(square.attrib['y']) + float(square.attrib['height']) <= height
    assert '✔' in ''.join(svg.itertext()) and '…' in ''.join(svg.itertext())


def test_text_form_counts() -> None:
    assert text_form(ROWS).splitlines() == [
        'Progress: 1 of 1 exercise, 0 of 61 questions done',
        '  01_a & b  1 of 1 exercise, 0 of 1 question',
        '    done   <one>',
        '  02_long   0 of 60 questions',
        '  03_empty  ',
    ]
