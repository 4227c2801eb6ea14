"""XML that somebody else has written: elements with their lines, with limits, no entities."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.parsers import expat

__all__ = ['Element', 'XmlError', 'load_xml']

# The largest robots of public repositories have some thousand elements, ten deep.
MOST_ELEMENTS = 20_000
MOST_DEPTH = 100
# Most characters of a document.
MOST_CHARACTERS = 10_000_000


class XmlError(ValueError):
    """Report a text that is no XML, or one that is not taken.

    Attributes:
        line: The line in which that is seen, from 1.
    """

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.line = line


@dataclass
class Element:
    """An element of XML.

    Attributes:
        tag: Its name, with the prefix of its namespace.
        line: The line in which it begins.
        attributes: The values of its attributes.
        children: The elements in it, in order.
        text: The text in it, without that of the elements in it, stripped.
    """

    tag: str
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    text: str = ''

    def all(self, tag: str) -> list[Element]:
        """Return the elements in it that have a tag."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """Return the first element in it that has a tag, None if there is none."""
        return next((child for child in self.children if child.tag == tag), None)


def load_xml(text: str) -> Element:
    """Return the root of a document.

    Entities that the document declares itself are refused: ten lines of them can stand for
    billions, and others name files. Nothing is loaded from elsewhere.

    Raises:
        XmlError: It is no XML, too large, nested too deep, or declares entities.
    """
    if len(text) > MOST_CHARACTERS:
        raise XmlError(f'it has more than {MOST_CHARACTERS} characters', 1)
    # Whatever encoding it declares: it has been decoded already.
    parser = expat.ParserCreate('utf-8')
    parser.buffer_text = True
    roots: list[Element] = []
    opened: list[Element] = []
    count = 0

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MOST_ELEMENTS:
            raise XmlError(f'it has more than {MOST_ELEMENTS} elements', parser.CurrentLineNumber)
        if len(opened) >= MOST_DEPTH:
            raise XmlError('it is nested too deep', parser.CurrentLineNumber)
        element = Element(tag, parser.CurrentLineNumber, dict(attributes))
        (opened[-1].children if opened else roots).append(element)
        opened.append(element)

    def end(tag: str) -> None:
        element = opened.pop()
        element.text = element.text.strip()

    def characters(data: str) -> None:
        opened[-1].text += data

    def declare(name: str, *_: object) -> None:
        raise XmlError(f'it declares the entity {name!r}', parser.CurrentLineNumber)

    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    parser.EntityDeclHandler = declare
    try:
        parser.Parse(text.encode(errors='surrogatepass'), True)
    except expat.ExpatError as error:
        inside = f', in <{opened[-1].tag}>' if opened else ''
        raise XmlError(f'{expat.errors.messages[error.code]}{inside}', error.lineno) from error
    return roots[0]
