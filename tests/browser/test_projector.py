"""Larger type for a projector: all that a cell shows follows, and nothing is cut off."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.slow('a page in the browser')

CELLS = {
    'setup': """
import matplotlib.pyplot as plt
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import Int16

class Odds(Node):
    def __init__(self):
        super().__init__('odd_source')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        self.get_logger().info('Published')
        self.publisher.publish(Int16(data=1))

lesson = lab.lesson('odds')
""",
    'print': "print('a line of text')",
    'log': """
odds = lab.spin(Odds())
lab.wait_for_message('/odds', Int16)
""",
    'card': 'lesson.count_up',
    'monitor': "lab.monitor('/odds')",
    'plot': "lab.plot('/odds.data')",
    'robot': 'robot = lab.spin(lab.Turtlebot())',
    'arena': 'lab.arena()',
    'graph': 'lab.graph()',
    'figure': """
plt.figure(figsize=(4, 2))
plt.plot([1, 3, 2])
plt.show()
""",
    'on': 'lab.projector()',
    'off': 'lab.projector(False)',
}
# Cell -> what in it holds letters, or letters in a drawing.
LETTERS = {
    'print': 'pre',
    'log': 'pre',
    'card': '[role=status]',
    'monitor': '.labkit-live',
    'plot': '.labkit-live',
    'arena': '.labkit-live',
    'graph': 'svg text',
    'figure': 'svg',
}
# How large the letters are: in a drawing that is scaled, as they are seen.
SIZE = """element => element.closest('svg')
  ? element.getBoundingClientRect().height
  : Number.parseFloat(getComputedStyle(element).fontSize)"""
# Whether something is wider than the notebook.
WIDER = """element => element.getBoundingClientRect().right
  > element.closest('.jp-Notebook').getBoundingClientRect().right + 1"""


@pytest.fixture
def notebook(open_cells):
    found = open_cells(**CELLS)
    for cell_id in CELLS:
        if cell_id not in ('on', 'off'):
            found.run_cell(cell_id)
            assert found.error_of(cell_id) == '', cell_id
    return found


def ask(notebook, cell_id, question):
    """Ask the first of the letters of an output, in one go: views draw their parts anew."""
    answer = notebook.page.wait_for_function(
        f"""([output, selector]) => {{
          const element = output.querySelector(selector);
          return element && [({question})(element)];
        }}""",
        arg=[notebook.output(cell_id).element_handle(), LETTERS[cell_id]],
    )
    return answer.json_value()[0]


def sizes(notebook):
    return {cell_id: ask(notebook, cell_id, SIZE) for cell_id in LETTERS}


def mode(notebook, on):
    notebook.page.wait_for_function(
        "on => Boolean(document.querySelector('.labkit-projector')) === on", arg=on
    )


def test_type_grows_everywhere_and_goes_back(notebook):
    before = sizes(notebook)
    assert 'is on' in notebook.run_cell('on')
    mode(notebook, True)
    larger = sizes(notebook)
    # A graph with a robot is as wide as the page already.
    assert larger.pop('graph') >= before['graph']
    assert {cell_id for cell_id in larger if larger[cell_id] < 1.5 * before[cell_id]} == set()
    for cell_id in LETTERS:
        assert not ask(notebook, cell_id, WIDER), cell_id
    # It stays while cells run, its own too.
    for cell_id in ('print', 'monitor', 'on'):
        notebook.run_cell(cell_id)
        mode(notebook, True)
    assert 'is off' in notebook.run_cell('off')
    mode(notebook, False)
    again = sizes(notebook)
    assert again == pytest.approx(before, rel=0.1)
