"""The list of a class: a text file with the people who may log in, and who of them teaches."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from labkit.errors import LabError

__all__ = ['Member', 'read_class']

# A name is also a system account, and part of the path of a kernel's sockets, which has to be
# short.
_NAME = re.compile(r'[a-z][a-z0-9_-]{0,19}')
_TEACHER = 'teacher'


@dataclass(frozen=True)
class Member:
    """A member of the class.

    Attributes:
        name: Login name.
        teaches: Whether it is a teacher, who sees everybody's server and may stop it.
    """

    name: str
    teaches: bool = False


def read_class(path: Path) -> list[Member]:
    """Read the list of a class.

    Args:
        path: A text file with one name per line, followed by the word `teacher` for teachers. Text
            after `#` is ignored.

    Raises:
        LabError: The file can't be read, is empty, or has other content.
    """
    try:
        lines = path.read_text(encoding='utf-8').splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise LabError(
            f'The list of the class can not be read: {error}.',
            todo='Give a text file with a name on each line: --class robots.txt',
        ) from error
    members: dict[str, Member] = {}
    for number, line in enumerate(lines, start=1):
        words = line.partition('#')[0].split()
        if not words:
            continue
        member = _member(words, f'{path.name}, line {number}')
        if member.name in members:
            raise LabError(f'{path.name}, line {number}: {member.name!r} is there twice.')
        members[member.name] = member
    if not members:
        raise LabError(
            f'{path.name} names nobody.', todo='Write a name on each line, such as: anna'
        )
    return list(members.values())


def _member(words: list[str], place: str) -> Member:
    name, *others = words
    if not _NAME.fullmatch(name):
        raise LabError(
            f'{place}: {name!r} can not be the name of an account.',
            todo='Names have up to 20 signs: a to z, then also digits, _ and -.',
        )
    if others not in ([], [_TEACHER]):
        raise LabError(
            f'{place}: {" ".join(others)!r} is not known.',
            todo=f'Behind a name there is nothing, or the word {_TEACHER}.',
        )
    return Member(name, teaches=bool(others))
