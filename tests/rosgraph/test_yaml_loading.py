"""YAML of others ends in time, whatever stands in it."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import pytest

from labkit.rosgraph.yaml_loading import load_yaml, load_yaml_file

BOMB = 'a0: &a0 [x, x]\n' + ''.join(f'a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n' for n in range(1, 40))
MERGED = 'a0: &a0 {x: 1, y: 2}\n' + ''.join(
    f'a{n}: &a{n} {{<<: [*a{n - 1}, *a{n - 1}]}}\n' for n in range(1, 40)
)


@pytest.mark.parametrize(
    ('text', 'data'),
    [
        ('', None),
        ('{data: 1}', {'data': 1}),
        ('a: &a {x: 1}\nb: {<<: *a, y: 2}', {'a': {'x': 1}, 'b': {'x': 1, 'y': 2}}),
        ('2026-01-02', date(2026, 1, 2)),
    ],
)
def test_data(text: str, data: object) -> None:
    assert load_yaml(text) == data


@pytest.mark.parametrize(
    ('text', 'problem'),
    [
        (BOMB, 'its aliases repeat too many values'),
        (MERGED, 'its aliases repeat too many values'),
        ('&a [*a]', 'its aliases repeat too many values'),
        ('/lamp: &a {ros__parameters: {speed: *a}}', 'its aliases repeat too many values'),
        ('[' * 3000, 'it is nested too deep'),
        ('[' * 3000 + ']' * 3000, 'it is nested too deep'),
        ('{', 'expected the node content'),
        ('{data: \a}', 'unacceptable character'),
        ('!!int ""', '.'),
        ('!!timestamp never', '.'),
        ('9' * 5000, '.'),
        ('2026-99-99', '.'),
        ('!!python/object:os.system x', 'could not determine a constructor'),
    ],
)
def test_what_can_not_be_taken(text: str, problem: str) -> None:
    with pytest.raises(ValueError, match=problem) as caught:
        load_yaml(text)
    assert len(str(caught.value)) < 200 and '\n' not in str(caught.value)
    assert 'sys.' not in str(caught.value)  # for programmers of Python


def test_files(tmp_path: Path) -> None:
    path = tmp_path / 'a.yaml'
    path.write_bytes(b'a: \xff')
    with pytest.raises(ValueError, match='utf-8'):
        load_yaml_file(path)
    path.write_bytes(b'#' * 2_000_000)
    with pytest.raises(OSError, match='Larger than'):
        load_yaml_file(path)
