"""A learner sees their own lines of a traceback, and the message."""

from __future__ import annotations

import re

import pytest

from labkit.background.tracebacks import short_traceback

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
        ("Node('a').create_publisher(Int16, 'b', 'deep')", 'TypeError: '),
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


GONE = """
class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)

class User(Node):
    def __init__(self):
        super().__init__('user')
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        old.publisher.publish(String())

old = Talker()
new = lab.spin(old), lab.spin(Talker())
"""


def test_what_was_destroyed_is_told_to_exist_no_more(kernel):
    kernel.run(SETUP)
    kernel.run(GONE)
    assert 'This Talker exists no more' in kernel.run('old.get_name()').traceback
    assert 'This Publisher exists no more' in kernel.run('old.publisher.topic_name').traceback
    cell = kernel.run('user = lab.spin(User())')
    said = kernel.wait_for_output(cell.msg_id, 'exists no more')
    assert 'This Publisher exists no more' in said and ', in on_timer' in said
    # Which of two things does not exist is not known here, and the node does.
    other = kernel.run(
        'class Other(User):\n'
        '    def use(self):\n'
        '        with old.publisher.handle: ...\n'
        'Other().use()'
    )
    assert other.error.startswith('InvalidHandle') and 'no more' not in other.traceback


@pytest.mark.parametrize(
    ('code', 'hinted'),
    [
        ("self.create_timer(1.0, print)\n        super().__init__('a')", True),
        ("self.get_logger().info('here')", True),
        ('self.nme', False),
        ("super().__init__('a')\n        self.nme", False),
        ('super().__init__()', False),
    ],
)
def test_a_node_that_is_none_yet_is_told_as_the_cause(kernel, code, hinted):
    kernel.run(SETUP)
    result = kernel.run(f'class A(Node):\n    def __init__(self):\n        {code}\nA()')
    assert ('This A is not a node yet' in result.traceback) is hinted
    assert 'During handling' not in result.traceback and 'inspect.py' not in result.traceback


THREAD = """
import threading
node = Node('a')
publisher = node.create_publisher(String, 'b', 10)
node.destroy_node()

def work():
    publisher.publish(String())

threading.Thread(target=work).start()
"""


def test_an_error_in_a_thread_is_shown_as_the_learners_line(kernel):
    kernel.run(SETUP)
    cell = kernel.run(THREAD)
    said = kernel.wait_for_output(cell.msg_id, 'exists no more')
    assert 'An error has ended Thread-' in said and 'line 7, in work' in said
    for name in LIBRARIES:
        assert name not in said, said


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


def ping(step):
    pong(step)


def pong(step):
    if step == 40:
        raise ValueError('at the end')
    ping(step + 1)


def twice(step):
    if step < 3:
        twice(step + 1)
    raise ValueError('no endless one')


@pytest.mark.parametrize(
    ('start', 'names', 'told'),
    [
        (ping, ['ping', 'pong'] * 2, ['and so on, 39 times more']),
        (twice, ['twice'] * 4, []),
    ],
)
def test_what_calls_itself_without_end_is_told_once(start, names, told):
    with pytest.raises(ValueError, match='end') as caught:
        start(0)
    said = short_traceback(caught.value)
    assert said.splitlines()[-1] == caught.exconly()
    calls = [line.rpartition(', in ')[2] for line in said.splitlines() if ', in ' in line]
    assert calls[1:] == names  # after this test itself
    assert re.findall(r'and so on, \d+ times more', said) == told


def test_an_endless_recursion_in_a_callback_is_a_few_lines(kernel):
    kernel.run(SETUP)
    cell = kernel.run(
        'class Deep(Node):\n'
        '    def __init__(self):\n'
        "        super().__init__('deep')\n"
        '        self.create_timer(0.01, self.on_timer)\n'
        '    def on_timer(self):\n'
        '        self.on_timer()\n'
        'deep = lab.spin(Deep())'
    )
    said = kernel.wait_for_output(cell.msg_id, 'RecursionError: ')
    assert said.count('self.on_timer()') == 1 and ' times more' in said
