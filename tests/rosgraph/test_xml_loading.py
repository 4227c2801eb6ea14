"""XML of others: lines, limits, and no entities."""

from __future__ import annotations

import pytest

from labkit.rosgraph import xml_loading
from labkit.rosgraph.xml_loading import XmlError, load_xml

BOMB = '<!DOCTYPE a [<!ENTITY x "ha"><!ENTITY y "&x;&x;&x;">]><a>&y;</a>'
FILE = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><a>&x;</a>'


def test_elements_have_their_lines_and_texts():
    root = load_xml('<?xml version="1.0" encoding="ascii"?>\n<a b="ü">\n<c> 1 <d/>2 </c><c/></a>')
    assert (root.tag, root.line, root.attributes) == ('a', 2, {'b': 'ü'})
    assert [(one.tag, one.line, one.text) for one in root.children] == [
        ('c', 3, '1 2'),
        ('c', 3, ''),
    ]
    assert root.all('c') == root.children and root.first('c') is root.children[0]
    assert root.first('e') is None and root.children[0].children[0].tag == 'd'


@pytest.mark.parametrize(
    ('text', 'said', 'line'),
    [
        (BOMB, "it declares the entity 'x'", 1),
        (FILE, "it declares the entity 'x'", 1),
        ('<a>&y;</a>', 'undefined entity, in <a>', 1),
        ('<a>\n<b>\n</a>', 'mismatched tag, in <b>', 3),
        ('', 'no element found', 1),
        ('\ud800', 'not well-formed (invalid token)', 1),
        ('<a/><b/>', 'junk after document element', 1),
        ('<a>' * 200, 'it is nested too deep', 1),
        ('<a>' + '<b/>\n' * 30_000, 'it has more than 20000 elements', 20_000),
    ],
)
def test_what_is_not_taken_is_said(text, said, line):
    with pytest.raises(XmlError) as raised:
        load_xml(text)
    assert (str(raised.value), raised.value.line) == (said, line)


def test_a_text_has_a_greatest_length(monkeypatch):
    monkeypatch.setattr(xml_loading, 'MOST_CHARACTERS', 20)
    assert load_xml('<a>1234567890123</a>').text == '1234567890123'
    with pytest.raises(XmlError, match='more than 20 characters'):
        load_xml('<a>12345678901234</a>')
