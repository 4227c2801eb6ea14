"""Values in a verdict: what was expected and what was seen show the place where they part."""

from __future__ import annotations

import pytest

from labkit.exercises.expect import apart
from labkit.exercises.expect.values import text_trouble


@pytest.mark.parametrize(
    ('wanted', 'seen', 'shown'),
    [
        ([1, 2], [1, 3], ('1, 2', '1, 3')),
        ([], [0], ('none', '0')),
        (
            list(range(20)),
            list(range(9)),
            ('7 alike, then 7, 8, 9, 10, 11, 12, ...', '7 alike, then 7, 8'),
        ),
        ([*range(9), 0], [*range(9), 1], ('7 alike, then 7, 8, 0', '7 alike, then 7, 8, 1')),
    ],
)
def test_two_rows_show_where_they_part(
    wanted: list[int], seen: list[int], shown: tuple[str, str]
) -> None:
    assert apart(wanted, seen) == shown


def test_two_long_texts_show_where_they_part() -> None:
    start, end = 'a' * 300, 'z' * 300
    expected, seen = apart([f'{start} 17 {end}'], [f'{start} 71 {end}'])
    assert ' 17 ' in expected and ' 71 ' in seen
    assert len(expected) < 120


def test_what_a_long_text_lacks_is_told_in_short() -> None:
    for wanted, seen in (('Ada' + 'b' * 900, 'Ada'), ('Ada', 'Ada' + 'b' * 900)):
        mistake = text_trouble(seen, wanted)
        assert mistake is not None
        assert "'bbb" in mistake.reason and len(mistake.reason) < 160
