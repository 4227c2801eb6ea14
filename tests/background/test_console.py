"""Output of callbacks appears under the cell of their node, whatever sys.stdout is."""

from __future__ import annotations

SETUP = """
import labkit as lab
from rclpy.node import Node

class Loud(Node):
    def __init__(self, name='loud', fails=False):
        super().__init__(name)
        self.count, self.fails = 0, fails
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        self.count += 1
        if self.fails:
            raise ValueError('broken')
        print('line\\n' * 30)
"""


def test_a_first_start_in_a_cell_that_captures_its_output(kernel):
    kernel.run(SETUP)
    kernel.run('%%capture\nlab.start()')
    cell = kernel.run('loud = lab.spin(Loud())')
    assert not kernel.run('lab.wait_until(lambda: loud.count >= 20)').error
    shown = kernel.wait_for_output(cell.msg_id, '200 lines are shown').splitlines()
    assert len(shown) == 201


def test_a_captured_cell_between_two_others(kernel):
    kernel.run(SETUP + 'loud = lab.spin(Loud("quiet"))\nloud.act = None')
    # Between two callbacks: none of them speaks any more.
    kernel.run('lab.wait_until(lambda: True)')
    kernel.run('%%capture caught\nprint("mine")\nimport sys\nerr = sys.stderr')
    assert kernel.run('print(repr(caught.stdout.splitlines()[0]))').text == "'mine'\n"
    cell = kernel.run('other = lab.spin(Loud("other"))')
    assert 'line' in kernel.wait_for_output(cell.msg_id, 'line')


def test_an_error_is_shown_again_when_its_cell_is_run_again(kernel):
    kernel.run(SETUP)
    code = 'loud = lab.spin(Loud(fails=True))'
    for _ in range(3):
        cell = kernel.run(code)
        assert not kernel.run('lab.wait_until(lambda: loud.count >= 3)').error
        shown = kernel.wait_for_output(cell.msg_id, 'ValueError: broken')
        assert shown.count('The callback on_timer of /loud failed') == 1
    # Only one record of it is kept.
    errors = 'from labkit.background.runtime import runtime\nprint(len(runtime.console.errors))'
    assert kernel.run(errors).text == '1\n'


QUIET = """
import labkit as lab
from rclpy.node import Node
"""


def test_a_node_that_the_next_statement_replaces_is_not_told(kernel):
    kernel.run(QUIET)
    both = 'left = lab.spin(Node("left_ear"))\nright = lab.spin(Node("right_ear"))'
    for _ in range(2):
        assert kernel.run(both, cell_id='ears').text == ''


def test_a_node_that_is_left_over_is_told_after_the_cell(kernel):
    kernel.run(QUIET)
    kernel.run('lab.spin(Node("old"))\nlab.spin(Node("kept"))', cell_id='ears')
    result = kernel.run(
        'lab.spin(Node("new"))\nlab.spin(Node("kept"))\nprint("end")', cell_id='ears'
    )
    assert result.text.splitlines() == [
        'end',
        "/old, which this cell started before, still runs. lab.remove('/old') ends it.",
    ]
    # A cell that starts nothing, such as one that was emptied to look at something, is quiet.
    assert kernel.run('print("only looking")', cell_id='ears').text == 'only looking\n'


def test_a_line_without_an_end_is_cut(kernel):
    kernel.run(SETUP)
    cell = kernel.run(
        'class Long(Loud):\n    def on_timer(self):\n        self.count += 1\n'
        "        print('x' * 1_000_000)\n\nlong = lab.spin(Long('long'))"
    )
    shown = kernel.wait_for_output(cell.msg_id, '(1,000,000 characters)')
    first = shown.splitlines()[0]
    assert first == f'{"x" * 2000} ... (1,000,000 characters)'
