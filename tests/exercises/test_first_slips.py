"""The slips of a beginner's first hour have a sentence each."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import pytest
from rclpy.node import Node

from labkit.exercises.learner_errors import explain_error

CLASS = """from rclpy.node import Node
from std_msgs.msg import Int16


class Ones(Node):
    def __init__(self):
        super().__init__('ones')
        self.publisher = self.create_publisher(Int16, 'ones', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        self.publisher.publish(Int16(data=1))


lab.spin(Ones())
"""
SLIPS = [
    ('        self.timer', '          self.timer', 'further to the right than the one before'),
    ('        self.timer', '      self.timer', 'in a column in which no line before it begins'),
    ('        self.timer', '\tself.timer', 'Tabs and spaces are mixed'),
    ('        self.publisher.publish', 'self.publisher.publish', 'Put four more spaces'),
    ('on_timer(self):', 'on_timer(self)', 'Write a : at the end of this line.'),
    ('data=1))', 'data=1)', 'The bracket ( is opened in this line, and never closed.'),
    ("'ones', 10", "'ones, 10", 'A text begins in this line, and its end is missing.'),
    ("'ones', 10", 'ones, 10', "A text has quotation marks: 'ones'"),
    ("__init__('ones')", '__init__(ones)', 'ones stands here without quotation marks'),
    ('spin(Ones())', "spin('ones')", 'the variable that holds it, without quotation marks.'),
    ('spin(Ones())', 'spin(Ones)', 'Make a node of it: lab.spin(Ones())'),
    ('lab.spin', 'spin', 'misspelt, not imported, or a text without quotation marks.'),
]


def test_each_slip_has_its_sentence(kernel: Any) -> None:
    kernel.run('import labkit as lab; lesson = lab.lesson("odds")')
    for old, new, says in SLIPS:
        assert kernel.run(CLASS.replace(old, new, 1), cell_id='ones-starter').error
        told = ' '.join(kernel.run('lesson.ones.check()').text.split())
        assert told.startswith('ERROR: ones'), told
        assert says in told, told
        assert '<tokenize>' not in told and 'ipykernel_' not in told, told


def test_init_that_was_stopped_is_told_before_any_spin(kernel: Any) -> None:
    kernel.run('import labkit as lab; lesson = lab.lesson("odds")')
    timer = 'self.timer = self.create_timer(0.1, self.on_timer)'
    waits = CLASS.replace(timer, 'while True:\n            raise KeyboardInterrupt')
    kernel.run(waits, cell_id='ones-starter')
    told = ' '.join(kernel.run('lesson.ones.check()').text.split())
    assert told.startswith('FAIL: ones'), told
    assert '__init__ had not returned when its cell was stopped (Cell In[' in told, told
    assert 'line 10: raise KeyboardInterrupt' in told, told


def test_what_is_logged_is_a_text(lab: ModuleType) -> None:
    with pytest.raises(TypeError) as caught:
        Node('teller').get_logger().info(5)  # type: ignore[arg-type]
    mistake = explain_error(caught.value)
    assert mistake is not None
    assert mistake.reason == 'A log line is a text, and the logger got something else.'
    assert "info(f'{value}')" in mistake.step
