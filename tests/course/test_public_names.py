"""The page about the public names is that of the code, and says all about each of them."""

from __future__ import annotations

from pathlib import Path

import pytest

import labkit
from labkit.course.public_names import FAULTS, PAGE, page, public_names
from labkit.silent.catalogue import page as page_of_faults

INIT = """
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    from labkit.robot import Robot, drive
__all__ = ['Robot', 'drive']
"""
BASE = '''
class Base:
    """A base.

    Args:
        name: Its name.
    """
    def __init__(self, name: str = 'robot', *wheels: int, **options: object) -> None: ...
'''
ROBOT = '''
from labkit.base import Base
class Robot(Base):
    """A robot."""
def drive(robot: Robot, *, speed: float = 0.2,
          forever: bool) -> list[str]:
    """Drive a robot.

    It stops at walls: nothing breaks.

    Args:
        robot: Which one.
        speed: How fast, in m/s,
            at most.
    Raises:
        LabError: It has no wheels.
    """
'''


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Give a package with one function and one class, which is made as its base is."""
    (tmp_path / 'labkit').mkdir()
    for name, text in (('__init__', INIT), ('robot', ROBOT), ('base', BASE)):
        (tmp_path / 'labkit' / f'{name}.py').write_text(text)
    return tmp_path


def test_page_of_faults_is_up_to_date() -> None:
    current = FAULTS.read_text() == page_of_faults()
    assert current, 'Write it anew: python3 -m labkit docs'


def test_page_is_up_to_date() -> None:
    names = public_names()
    assert [one.name for one in names] == list(labkit.__all__)
    current = PAGE.read_text() == page(names)
    assert current, 'Write it anew: python3 -m labkit docs'


def test_each_public_name_says_all_about_itself() -> None:
    assert [problem for one in public_names() for problem in one.problems()] == []


def test_what_is_missing_would_be_found(root: Path) -> None:
    robot, drive = public_names(root)
    assert robot.problems() == [
        'Robot does not describe options',
        'Robot does not describe wheels',
    ]
    assert drive.problems() == [
        'drive does not describe forever',
        'drive does not say what it returns',
    ]
    path = root / 'labkit' / 'robot.py'
    path.write_text(path.read_text().replace('robot: Which', 'car: Which'))
    assert public_names(root)[1].problems()[1:3] == [
        'drive does not describe robot',
        'drive has no car',
    ]
    path.write_text('def drive(): ...\nclass Robot: ...')
    assert [one.problems() for one in public_names(root)] == [
        ['Robot has no docstring'],
        ['drive has no docstring'],
    ]
    path.write_text('')
    with pytest.raises(LookupError, match=r'labkit\.robot neither defines Robot nor imports it'):
        public_names(root)


def test_form_of_the_page(root: Path) -> None:
    robot, drive = public_names(root)
    assert robot.signature == "lab.Robot(name: str = 'robot', *wheels: int, **options: object)"
    assert drive.signature == (
        'lab.drive(robot: Robot, *, speed: float = 0.2, forever: bool) -> list[str]'
    )
    text = page([drive])
    assert '| [`lab.drive`](#labdrive) | Drive a robot. |' in text
    assert 'It stops at walls: nothing breaks.\n\n**Args**\n\n- `robot`: Which one.\n' in text
    assert '- `speed`: How fast, in m/s, at most.\n\n**Raises**\n\n- `LabError`: It has' in text


def test_long_signatures_take_a_line_for_each_parameter() -> None:
    (turtlebot,) = [one for one in public_names() if one.name == 'Turtlebot']
    assert turtlebot.signature.startswith('lab.Turtlebot(\n    *,\n    name: str = ')
    assert turtlebot.signature.endswith(',\n)')
