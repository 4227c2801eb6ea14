"""A command over several lines, as manuals and Tab completion of robots write YAML."""

from __future__ import annotations

import pytest
from IPython.core.inputtransformer2 import TransformerManager

from labkit.ros2.magic import _join_lines
from labkit.ros2.shell import split

START = '%ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '
TWIST = '"linear:\n    x: 0.2\n  # odd for Python, and for YAML a remark\nangular:\n    z: 0.5"'
YAML = TWIST.strip('"')


def python(cell: str) -> str:
    """Return what IPython makes of a cell."""
    manager = TransformerManager()
    manager.cleanup_transforms.append(_join_lines)
    return manager.transform_cell(cell)


def magics(cell: str) -> list[str]:
    """Return the text of each `%ros2` of a cell, as Python runs it."""
    ran: list[str] = []

    class Shell:
        def run_line_magic(self, name: str, line: str) -> None:
            ran.append(line)

        system = ran.append

    exec(compile(python(cell), 'cell', 'exec'), {'get_ipython': Shell, 'spoken': ran.append})
    return ran


@pytest.mark.parametrize(
    ('cell', 'words'),
    [
        (START + TWIST, [YAML]),
        (START + TWIST.replace('"', "'"), [YAML]),
        (START + TWIST + ' --rate 1', [YAML, '--rate', '1']),
        (START + '\\\n  ' + TWIST, [YAML]),
        (f'if True:\n    {START}{TWIST}\n    spoken("after")', [YAML]),
        (f'x = 1\n!echo "it\'s"\n{START}{TWIST}', [YAML]),
        (START + '"linear:\n  x: 0.2" # isn\'t it', ['linear:\n  x: 0.2']),
    ],
)
def test_a_quotation_mark_closes_where_it_closes(cell: str, words: list[str]):
    line = next(line for line in magics(cell) if line.startswith('topic'))
    assert split(line)[5:] == words
    assert python(cell).count('\n') == cell.count('\n') + 1  # the lines of a traceback are right


def test_what_follows_is_run_as_it_stands():
    cell = f'{START}{TWIST}\nspoken("between")\n%ros2 topic list  # don\'t\nspoken("after")'
    assert magics(cell)[1:] == ['between', "topic list  # don't", 'after']


def test_a_terminal_gets_several_lines_too():
    cell = f'!{START[1:]}{TWIST}\nspoken("after")'
    assert magics(cell) == [START[1:] + TWIST, 'after']


@pytest.mark.parametrize(
    'cell',
    [
        'text = """\n%ros2 topic pub "linear:\n"""\nother = "it"',
        "text = '''\n    !ros2 topic pub \"linear:\n'''",
        'print(\n%ros2 "a\nb")',
        '%%writefile notes.txt\n%ros2 topic pub "linear:\n  x: 1"',
        '%ros2 topic list\nprint("it\'s")',
        '%ros2\nprint("it\'s")',
        '%ros2?',
        '%ros2x "a\nb"',
        'x = "\nb"',
    ],
)
def test_nothing_else_is_touched(cell: str):
    lines = cell.splitlines(keepends=True)
    assert _join_lines(lines) == lines


def test_a_quotation_mark_that_never_closes_takes_the_rest():
    assert magics(f'spoken("before")\n{START}"linear:\n    x: 1\n  y: 2\nspoken("never")') == [
        'before',
        f'{START[6:]}"linear:\n    x: 1\n  y: 2\nspoken("never")',
    ]


@pytest.mark.parametrize(
    ('text', 'words'),
    [
        ('topic pub /a\n"x:\n 1"\n', ['topic', 'pub', '/a', 'x:\n 1']),
        ("topic # a remark, isn't it\nlist #one\n-t", ['topic', 'list', '-t']),
        ('topic \\\n  list', ['topic', 'list']),
    ],
)
def test_a_whole_cell_is_one_command(text: str, words: list[str]):
    assert split(text) == words


def test_in_a_kernel(kernel):
    kernel.run("""
import labkit as lab
from geometry_msgs.msg import Twist
from rclpy.node import Node
node = lab.spin(Node('robot'))
heard = []
node.create_subscription(Twist, 'cmd_vel', lambda m: heard.append((m.linear.x, m.angular.z)), 10)
""")
    for cell in (START + TWIST, f'%{START}\n{TWIST}'):
        told = kernel.run(cell)
        assert not told.error, told.traceback
        assert 'publishing #1: geometry_msgs.msg.Twist(' in told.text
    assert 'usage: ros2 topic pub' in kernel.run(f'!{START[1:]}{TWIST} --help').text
    heard = kernel.run('lab.wait_until(lambda: len(heard) == 2)\nheard')
    assert heard.text == '[(0.2, 0.5), (0.2, 0.5)]\n'
    told = kernel.run(f'{START}"linear:\n  x: 0.2')
    assert not told.error
    assert 'A quotation mark " or \' is missing: all of the lines after it' in told.text
    # The history has what was written; help and the Tab key know both forms.
    written = kernel.run('print(get_ipython().history_manager.input_hist_raw[2])')
    assert written.text == f'{START}{TWIST}\n'
    assert 'all of the cell is one command' in kernel.inspect('%%ros2')
    reply = kernel._client.complete('%%ros2 topic pu', 15, reply=True, timeout=60)
    assert reply['content']['matches'] == ['pub']
