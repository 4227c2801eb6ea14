"""What lessons say in prose, and no cell shows: each sentence is there, and is true."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import nbformat
import pytest

from labkit.domain_ids import first_port, ports_of_participants
from labkit.launching.model import truth

NOTEBOOKS = Path(__file__).resolve().parents[2] / 'notebooks'

SLEEPY = """
import threading, time
import labkit as lab
from rclpy.node import Node

seen = []
fast, slow = lab.spin(Node('fast')), lab.spin(Node('slow'))
fast.create_timer(0.01, lambda: seen.append(('fast', threading.get_ident())))

def doze():
    before = len(seen)
    time.sleep(0.3)
    seen.append(('slow', threading.get_ident(), len(seen) - before))
    timer.cancel()

timer = slow.create_timer(0.05, doze)
lab.wait_until(lambda: any(each[0] == 'slow' for each in seen))
print(len({each[1] for each in seen}), [each[2:] for each in seen if each[0] == 'slow'])
"""
BOUNDED = """
from test_msgs.msg import Strings

msg = Strings()
msg.bounded_string_value = 'é' * 22
try:
    msg.bounded_string_value = 'e' * 23
except AssertionError:
    print('refused')
"""


def says(cell: str, *sentences: str) -> None:
    """Refuse a cell, as `04/burst-read`, that no longer says something."""
    (path,) = NOTEBOOKS.glob(f'{cell[:2]}_*.ipynb')
    cells = nbformat.read(path, as_version=4).cells
    source = next(each.source for each in cells if each.id == cell[3:])
    assert [each for each in sentences if each not in source] == []


def test_all_nodes_of_a_notebook_share_one_executor_with_one_thread(kernel: Any) -> None:
    says('04/burst-read', 'All nodes of a notebook share one with one thread')
    says('09/executor-read', 'here of all nodes of the notebook')
    # One thread for both nodes, and nothing of the fast one while the slow one sleeps.
    assert kernel.run(SLEEPY).text.strip() == '1 [(0,)]'


def test_a_bounded_text_is_counted_in_characters(script: Callable[..., Any]) -> None:
    says('12/grammar-read', '`string<=10` at most ten characters')
    assert script(BOUNDED, ROS_PYTHON_CHECK_FIELDS='1').stdout.strip() == 'refused'


@pytest.mark.parametrize(('text', 'is_true'), [('true', 1), ('1', 1), ('false', 0), ('0', 0)])
def test_a_condition_is_true_or_1(text: str, is_true: bool) -> None:
    says('13/launch-read', 'only if the value is `true` or `1`')
    assert truth(text) == is_true


def test_ports_of_a_domain_end_where_those_of_the_next_begin() -> None:
    says('16/network-read', 'those of domain d begin at 7400 + 250 d', 'From some 120 programs')
    assert first_port(7) == 7400 + 250 * 7
    # What is left for participants, behind the ports for finding each other. Each has two.
    each = ports_of_participants(7)
    assert (first_port(8) - each.start) / each.step == 120
