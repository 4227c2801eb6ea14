"""Read files of requirements, such as environment.txt. Runs in Python from 3.8 on."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ['applicable']


def applicable(lines: Iterable[str], version: tuple[int, ...]) -> list[str]:
    """Return the packages that a requirements file asks for.

    Args:
        lines: Lines of requirements, marked with nothing but `python_full_version`.
        version: The Python version that they are for.
    """
    names = []
    for line in lines:
        line = line.split('#')[0].strip()
        if not line:
            continue
        marker = re.search(r"; *python_full_version *([<>=]+) *'(\d+)\.(\d+)\.?(\d*)", line)
        if marker:
            limit = (int(marker[2]), int(marker[3]), int(marker[4] or 0))
            fits = {
                '<': version < limit,
                '>=': version >= limit,
                '==': version[:2] == limit[:2],  # it stands with a star: '3.11.*'
            }
            if not fits.get(marker[1], True):
                continue
        names.append(line)
    return names
