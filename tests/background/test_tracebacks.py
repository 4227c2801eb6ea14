"""What a learner sees of an error: their own lines, and the message."""

from __future__ import annotations

import pytest

SETUP = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import Int16, String
lab.start()
"""
LIBRARIES = ('site-packages', 'labkit/', 'threading.py')


@pytest.mark.parametrize(
    ('code', 'message'),
    [
        ('Int16(data=40000)', "AssertionError: The 'data' field must be an integer in"),
        ("Node('a').create_publisher(3, 'b', 10)", 'Error'),
        ("Node('a b')", 'InvalidNodeNameException: Invalid node name'),
        ('lab.wait_until(lambda: 1 / 0)', 'ZeroDivisionError: division by zero'),
    ],
)
def test_errors_inside_ros_are_shown_as_the_learners_lines(kernel, code, message):
    kernel.run(SETUP)
    result = kernel.run(f'def mine():\n    {code}\n\nmine()')
    assert message in result.traceback
    assert f'----> 2     {code}' in result.traceback or f'----> 2 {code}' in result.traceback
    assert 'mine()' in result.traceback
    for name in LIBRARIES:
        assert name not in result.traceback, result.traceback


def test_stop_button_shows_the_line_that_waited(kernel):
    kernel.run(SETUP)
    cell = kernel.start('lab.wait_until(lambda: print("waiting"), timeout_sec=None)')
    kernel.wait_for_output(cell, 'waiting')
    kernel.interrupt()
    result = kernel.finish(cell)
    assert result.error.startswith('KeyboardInterrupt')
    assert '----> 1 lab.wait_until' in result.traceback
    for name in LIBRARIES:
        assert name not in result.traceback, result.traceback


def test_other_errors_and_the_verbose_mode_show_all(kernel):
    kernel.run(SETUP)
    assert 'json/decoder.py' in kernel.run('import json\njson.loads("{")').traceback
    assert 'SyntaxError' in kernel.run('1 +').error
    kernel.run('%xmode Verbose')
    assert '_int16.py' in kernel.run('Int16(data=40000)').traceback
