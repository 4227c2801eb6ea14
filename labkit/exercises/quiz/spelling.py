"""Normalize typed answers: blanks, quotation marks, labels, units.

A form is a function that maps all spellings of an answer to the same text. It keeps upper and
lower case apart where ROS does.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable

__all__ = ['constant', 'field_name', 'name', 'numbers', 'ros2_command', 'tidy', 'type_name']

_QUOTES = '\'"`[]\u2018\u2019\u201a\u201c\u201d\u201e\u00ab\u00bb\u00b4'
_WHAT = r'(?:node|topic|service|type|field|message)'
# A line of output that was copied with its label: 'Node name: talker'.
_LABEL = re.compile(r'^[A-Za-z][A-Za-z ]*:\s+')
_DIGITS = (
    *('zero', 'one', 'two', 'three', 'four', 'five', 'six', 'seven', 'eight', 'nine', 'ten'),
    *('eleven', 'twelve', 'thirteen', 'fourteen', 'fifteen', 'sixteen', 'seventeen'),
    *('eighteen', 'nineteen', 'twenty'),
)
_NUMBER = re.compile(
    r'(?:(?:about|approximately|roughly|exactly|average rate:?|it is|=|~|\u2248)\s*)*'
    r'(?P<number>[-+]?\s*(?:\d[\d_]*(?:[ ]\d{3})*(?:[.,]\d+)*[.,]?|[.,]\d+)(?:e[-+]?\d+)?)'
    r'\s*(?P<unit>(?:1/)?[^\d\s].*)?'
)
_UNITS = {
    'Hz': r'hz|hertz|1/s|s\^?-1|messages?|'
    r'((messages?|msgs?|times|callbacks?)\s*)?(/|per|an?|each|every|in one)\s*s(ec(ond)?s?)?',
    'rad': r'rads?|radians?',
}


def tidy(text: str) -> str:
    """Return a text without surrounding quotation marks, punctuation and blanks."""
    text = ' '.join(unicodedata.normalize('NFKC', text).replace('\u200b', '').split())
    return text.strip(f'{_QUOTES} ').rstrip('.,;:!?').strip(f'{_QUOTES} ')


def name(text: str) -> str:
    """Return the name of a node, topic or service, without its leading slash."""
    text = _without_words(text)
    return re.sub(r'\s*/\s*', '/', text).strip('/')


def type_name(kind: str) -> Callable[[str], str]:
    """Return the form for types of a kind, `'msg'` or `'srv'`, which the name may omit."""
    return lambda text: name(text).replace(f'/{kind}/', '/')


def field_name(text: str) -> str:
    """Return the name of a field, without its value or type."""
    text = re.split(r'\s*[:=]', tidy(text))[0]
    text = re.sub(r'^(?:u?int\d+|float\d+|double|string|bool)\s+', '', text)
    return re.sub(r'^(?:msg|message)?\.', '', _without_words(text))


def constant(text: str) -> str:
    """Return a constant such as `BEST_EFFORT` in lower case, without blanks and underscores."""
    word = re.split(r'[:.]', tidy(text))[-1].casefold()
    return re.sub(r'^rmwqospolicyreliability|[\s_-]', '', re.sub(r'[\s_-]', '', word))


def ros2_command(text: str) -> str:
    """Return the first two words of a command, without a prompt and `ros2`."""
    text = re.sub(rf'[{re.escape(_QUOTES)},+]|\band\b', ' ', tidy(text).casefold())
    words = re.sub(r'^\s*[$%!>]?\s*(?:ros2\s+)?', '', text).split()
    return ' '.join(words[:2])


def numbers(text: str, unit: str = '') -> list[float]:
    """Return the possible values of a number: `4,5` is 4.5, and `1,500` is 1.5 or 1500.

    Args:
        text: The number, in digits or as a word, perhaps with its unit.
        unit: The expected unit, `''` for any.

    Raises:
        ValueError: `'no number'`, or the text is the other unit.
    """
    plain = tidy(text).casefold().replace('\u2212', '-').replace('\u2013', '-')
    plain = re.sub(r'^minus ', '-', plain)
    first, _, rest = plain.partition(' ')
    if first in _DIGITS:
        plain = f'{_DIGITS.index(first)} {rest}'
    match = _NUMBER.fullmatch(plain.strip())
    if match is None:
        raise ValueError('no number')
    seen = match['unit'] or ''
    allowed = _UNITS.get(unit, re.escape(unit.casefold())) if unit else r'\D*'
    if seen and not re.fullmatch(rf'({allowed})\.?', seen):
        raise ValueError(seen)
    found = _readings(match['number'].replace(' ', '').replace('_', ''))
    if not found:
        raise ValueError('no number')
    return found


def _readings(digits: str) -> list[float]:
    """Return the possible values of digits with points and commas."""
    if ',' in digits and '.' in digits:
        thousands = min(',.', key=digits.rfind)
        digits = digits.replace(thousands, '')
    readings = [digits.replace(',', '.')]
    if re.fullmatch(r'[-+]?\d{1,3}(,\d{3})+', digits):
        readings.append(digits.replace(',', ''))
    return [float(reading) for reading in readings if reading.count('.') <= 1]


def _without_words(text: str) -> str:
    """Return a name without a label, and without a word such as `node`."""
    text = tidy(_LABEL.sub('', tidy(text)))
    text = re.sub(rf'^(?:the )?(?:{_WHAT} )?', '', text, flags=re.IGNORECASE)
    return tidy(re.sub(rf' {_WHAT}$', '', text, flags=re.IGNORECASE))
