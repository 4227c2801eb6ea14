"""Test values, drawn anew for each check from all that a task allows.

So an answer that is right for small letters only, for short texts or for the numbers of the last
check is found out.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

__all__ = ['draw_float', 'draw_int16s', 'draw_texts']

_WORDS = ('boat', 'harbour', 'Wind', 'NORTH', 'grün', 'Öl', 'señor', 'çay', 'λάμδα', 'Żuk', '日本')
INT16 = (-32768, 32767)
# With so many more there are more than ten: a node may stop after that many.
MORE = 4


def draw_texts(*, empty: bool = True) -> list[str]:
    """Return texts: small and capital letters, digits, letters of many languages, a long one.

    Args:
        empty: Whether one of them is empty.
    """
    word = random.choice
    texts = [
        f'{word(_WORDS)} {random.randint(2, 99)}',
        f'{word(_WORDS)}{word(_WORDS).upper()} {word("!?.,;:")}',
        f'{random.randint(1000, 9999)}',
        f'{word(_WORDS).title()} "{word(_WORDS)}" {{{word("abcXYZ")}}} \\{word("nt")} %s',
        ' '.join(word(_WORDS) for _ in range(random.randint(60, 90))),
        f'  {word(_WORDS)} ',
    ]
    random.shuffle(texts)
    more = [f'{word(_WORDS)} {number}' for number in range(1, MORE + 1)]
    return [*texts, *[''] * empty, texts[0], *more]


def draw_int16s(low: int = INT16[0], high: int = INT16[1], step: int = 1) -> list[int]:
    """Return numbers: the limits, zero or what is next to it, and some in between.

    Args:
        low: The smallest number.
        high: The largest one.
        step: From one to the next: 2 for every other number from `low` on.
    """
    allowed = range(low, high + 1, step)
    near_zero: Sequence[int] = [number for number in (-step, 0, 1, step) if number in allowed]
    middle = range(len(allowed) // 4, 3 * len(allowed) // 4)
    drawn = [allowed[i] for i in random.sample(middle, 4 + MORE)]
    # The limits come last: what is wrong with any number is not to look like a matter of limits.
    return [*drawn, *near_zero[:1], drawn[0], allowed[0], allowed[-1]]


def draw_float(low: float, high: float) -> float:
    """Return a number between two others, with three decimals, so that it is read easily."""
    return round(random.uniform(low, high), 3)
