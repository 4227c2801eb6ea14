"""Test values, drawn anew for each check from all that a task allows: the traps are in here.

So an answer that is right for small letters only, for short texts, for other values than the one
before or for the numbers of the last check is found out. How close together the values are sent,
`clauses/base.py` draws.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import count
from typing import Any, TypeVar

__all__ = [
    'INT16',
    'INT32',
    'KNOWN',
    'MANY',
    'MORE',
    'draw_float',
    'draw_for',
    'draw_int16s',
    'draw_names',
    'draw_outside',
    'draw_size',
    'draw_texts',
    'filled',
    'in_a_row',
]

T = TypeVar('T')

_WORDS = ('boat', 'harbour', 'Wind', 'NORTH', 'grün', 'Öl', 'señor', 'çay', 'λάμδα', 'Żuk', '日本')
_NAMES = ('Bo', 'Eva María', 'Çağla', '李娜', 'Dr. O', 'van  der Berg', 'Ödön', "O'Neill", 'JO')
# The people of the lessons, and what their cells say: a node may treat its own like no other's.
KNOWN = ('Ada', 'Bo', 'Chidi')
_SAID = ('Hello', 'Hello World: 1', 'My name is Ada', 'news')
INT16 = (-32768, 32767)
INT32 = (-(2**31), 2**31 - 1)
# Each name gets a number of its own: who is known from the last check is nobody new.
_numbers = count(random.randint(100, 999), random.choice((3, 7, 11)))
# So many are sent at least, and how many more at most, is drawn: a node may stop after thirty.
MANY, MORE = 32, 8
# A plain value is first: what is wrong with any value is not to look like a matter of a trap.
PLAIN = 2


def draw_texts(*, empty: bool = True) -> list[str]:
    """Return texts: small and capital letters, digits, letters of many languages, a long one.

    Args:
        empty: Whether some of them say nothing: the empty text, and one of blanks.
    """
    word = random.choice
    number = random.randint
    plain = [f'{word(_WORDS)} {n}' for n in random.sample(range(2, 100), PLAIN)]
    traps = [
        f'{word(_WORDS)}{word(_WORDS).upper()} {word("!?.,;:")}',
        f'{word(_WORDS)} {word(_WORDS)}.',
        f'{number(1000, 9999)}',
        f'-{number(1, 9)}.0',
        '0',
        word('aZ9é'),
        f'{word(_WORDS).title()} "{word(_WORDS)}" {{{word("abcXYZ")}}} \\{word("nt")} %s <b>',
        ' '.join(word(_WORDS) for _ in range(number(900, 1200))),
        *(f'{name}: {word(_WORDS)} {number(2, 99)}' for name in KNOWN),
        *_SAID,
        f'{word(_WORDS)}\t{word(_WORDS)}',
        f'  {word(_WORDS)} ',
        f'{word(_WORDS)}  {word(_WORDS)}   {number(2, 99)}',
        f'{word(_WORDS)}: {word(_WORDS)}: {number(2, 99)}',
        f'{number(1, 9)}:{number(10, 59)}',
        f'{word(_WORDS)},{word(_WORDS)};{word(_WORDS)}',
        f'{word(_WORDS).swapcase()} {word("🤖🚲")}',
    ]
    nothing = ['', ' ' * number(1, 3)] if empty else []
    more = [f'{word(_WORDS)} {i}' for i in range(100, 100 + MANY + MORE)]
    return in_a_row(plain, [*traps, *nothing], more)


def draw_names(how_many: int = len(_NAMES)) -> list[str]:
    """Return names that nobody has heard: of one word and of several, two of them nearly alike.

    Args:
        how_many: How many.
    """
    names = [f'{_NAMES[i % len(_NAMES)]}{next(_numbers)}' for i in range(how_many - 1)]
    random.shuffle(names)
    return [*names, next(name.swapcase() for name in names if name.swapcase() != name)]


def draw_int16s(low: int = INT16[0], high: int = INT16[1], step: int = 1) -> list[int]:
    """Return numbers: the limits and those next to them, around zero, and some in between.

    Args:
        low: The smallest number.
        high: The largest one.
        step: From one to the next: 2 for every other number from `low` on.
    """
    allowed = range(low, high + 1, step)
    near_zero = [n for n in (-2 * step, -step, -1, 0, 1, step, 2 * step) if n in allowed]
    middle = range(len(allowed) // 4, 3 * len(allowed) // 4)
    drawn = [allowed[i] for i in random.sample(middle, min(len(middle), MANY + MORE))]
    edges = [allowed[i] for i in (0, 1, -2, -1)]
    return in_a_row(drawn[:PLAIN], [*near_zero, *edges], drawn[PLAIN:])


def draw_outside(low: int, high: int, limits: tuple[int, int] = INT32) -> list[int]:
    """Return numbers that lie outside of a range, the nearest first: next to it, and far away.

    Some of these are one of the range by their last digits or bytes, or without their sign.

    Args:
        low: The smallest number of the range.
        high: The largest one.
        limits: The smallest and the largest number of the type.
    """
    inside = random.randint(low, high)
    far = [sign * (inside + 10**power) for power in (2, 3, 4, 6) for sign in (1, -1)]
    far += [inside + 2**power for power in (8, 16)]
    found = {low - 1, high + 1, -inside, random.randint(high + 2, high + 79), *far, *limits}
    return sorted((n for n in found if not low <= n <= high), key=lambda n: (abs(n), n))


def draw_size(least: float, most: float) -> float:
    """Return a number whose size is drawn, of two that are far apart: 0.01, 0.1, 1 or 10."""
    return round(math.exp(random.uniform(math.log(least), math.log(most))), 3)


def draw_float(low: float, high: float) -> float:
    """Return a number between two others, with three decimals, so that it is read easily."""
    return round(random.uniform(low, high), 3)


def in_a_row(plain: Sequence[T], traps: Iterable[T], more: Iterable[T] = ()) -> list[T]:
    """Return values in an order that is drawn, some of them twice in a row, and one again later.

    Args:
        plain: The first ones: at least two, which are different.
        traps: What is sent in any case.
        more: What is sent until there are many.
    """
    rest = list(traps)
    many = MANY + random.randint(0, MORE)
    rest += list(more)[: max(0, many - len(plain) - len(rest))]
    random.shuffle(rest)
    # The first one comes again when it may be forgotten.
    twice = random.randrange(len(rest))
    rest.insert(twice, rest[twice])
    return [plain[0], *plain, *rest, plain[0], plain[0]]


def filled(msg_type: str, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of a message with all others of its type that are no arrays, drawn.

    So nobody can count on it that what a task does not name is zero.

    Args:
        msg_type: Name of the type.
        fields: Those that are given; dots lead to inner ones.
    """
    from labkit.rosgraph.interfaces import message_class

    return {**_drawn_fields(message_class(msg_type)), **fields}


def _drawn_fields(msg_class: Any, before: str = '') -> dict[str, Any]:
    from labkit.rosgraph.interfaces import message_class

    found: dict[str, Any] = {}
    for name, kind in msg_class.get_fields_and_field_types().items():
        if kind in _FIELDS:
            found[before + name] = _FIELDS[kind]()
        elif '/' in kind and not kind.endswith(']') and not kind.startswith('sequence'):
            inner = message_class(kind.replace('/', '/msg/'))
            found.update(_drawn_fields(inner, f'{before}{name}.'))
    return found


def draw_for(msg_type: str) -> Sequence[Any]:
    """Return values for the field `data` of a type, where a task allows all of them.

    Raises:
        LookupError: There are none for this type.
    """
    return _BY_TYPE[msg_type]()


_BY_TYPE: dict[str, Callable[[], Sequence[Any]]] = {
    'std_msgs/msg/Int16': draw_int16s,
    'std_msgs/msg/String': draw_texts,
}
_FIELDS: dict[str, Callable[[], Any]] = {
    'boolean': lambda: random.random() < 0.5,
    'string': lambda: random.choice(_WORDS),
    # Numbers that all sizes can hold, and exactly.
    **dict.fromkeys(('float', 'double'), lambda: random.randint(1, 99) / 8),
    **dict.fromkeys(
        (f'{sign}int{bits}' for sign in ('', 'u') for bits in (8, 16, 32, 64)),
        lambda: random.randint(1, 99),
    ),
}
