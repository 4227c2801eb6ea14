"""What trials work with: kernels, chance with a seed, a size; and what all of them ask."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat

ROOT = Path(__file__).resolve().parents[2]
LESSONS = sorted((ROOT / 'notebooks').glob('*.ipynb'))
CELL_SEC = 300.0
# What a person expects of cells in a wrong order: a name that is not there yet, or one that is
# there as something else; and what labkit says in words.
EXPECTED = re.compile(
    r'NameError: name|LabError: |LabTimeout: |NoSuchNameError: |_NotInWheels: |KeyboardInterrupt'
    r'|AttributeError: .* object has no attribute|AttributeError: module'
    # `lab.processes()[-1]`, where the cell that starts one comes later.
    r'|IndexError: list index out of range'
    # rclpy itself, where the cell that imports labkit comes later.
    r'|NotInitializedException: rclpy.init\(\) has not been called'
    r"|TypeError: 'NoneType' object does not support the context manager|AttributeError: __enter__"
    # A file that a later cell writes.
    r'|FileNotFoundError: |RCLInvalidROSArgsError: .*cruiser.yaml'
    # A node that ended with its name's next one, whose cell was interrupted before it was kept.
    r'|InvalidHandle: cannot use Destroyable because destruction was requested'
)


@dataclass
class Bench:
    """What a trial works with.

    Attributes:
        start: Starts a kernel; keyword arguments are environment variables.
        rng: Chance.
        large: Whether to do it for long.
    """

    start: Callable[..., Any]
    rng: random.Random
    large: bool

    def lessons(self) -> list[Path]:
        """Return the lessons: all that need nobody at the keyboard, or a quick one."""
        if self.large:
            return [path for path in LESSONS if not path.name.startswith(('06', '12'))]
        return [path for path in LESSONS if path.name.startswith('02')]


def code_cells(path: Path) -> list[Any]:
    return [cell for cell in nbformat.read(path, 4).cells if cell.cell_type == 'code']


def may_fail(cell: Any) -> bool:
    return 'raises-exception' in cell.metadata.get('tags', ())


def works(kernel: Any) -> None:
    """Check that a new learner could begin here: a talker is heard, the check says its word."""
    result = kernel.run(HEARD, CELL_SEC)
    assert (result.error, result.text.splitlines()[-1:]) == ('', ['heard']), (result, kernel.log)


HEARD = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
lab.stop()
_node, _heard = Node('after_all'), []
_node.create_subscription(String, '/after_all', _heard.append, 10)
_publisher = _node.create_publisher(String, '/after_all', 10)
lab.spin(_node)
_publisher.publish(String(data='hello'))
lab.wait_until(lambda: _heard, timeout_sec=60)
lab.stop()
print('heard')
"""
