"""What a node class needs is found in the cells that have made it, or named with its line.

The cells run in this process, each in the same namespace, as those of a notebook do.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from textwrap import dedent
from typing import Any

import pytest
from rclpy.node import Node

import labkit
from labkit.errors import LabError
from labkit.packages.cells import Cell, Notebook
from labkit.packages.export import export
from labkit.packages.gather import Gathered, gather

TALKER = """\
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.1, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.publisher.publish(String(data=f'Hello World: {self.count}'))
        self.count += 1
"""


@pytest.fixture(autouse=True)
def ros_ends() -> Iterator[None]:
    yield
    labkit.stop()


def gathered(*cells: str) -> Gathered:
    """Run cells, and gather what their `Talker` needs."""
    namespace: dict[str, Any] = {'__name__': '__main__', 'lab': labkit}
    ran = []
    for number, text in enumerate(cells, start=2):
        ran.append(Cell(f'Cell In[{number}]', number, dedent(text)))
        exec(compile(ran[-1].source, ran[-1].label, 'exec', dont_inherit=True), namespace)
    return gather(namespace['Talker'], Notebook(namespace, ran))


def source(*cells: str) -> str:
    """Return the imports, then the definitions."""
    found = gathered(*cells)
    text = '\n'.join([*sorted(found.imports), *(each.text for each in found.definitions)])
    ast.parse(text)
    return text


def refused(*cells: str) -> str:
    """Return what is said to be in the way."""
    with pytest.raises(LabError) as caught:
        gathered(*cells)
    return str(caught.value)


def test_imports_constants_functions_and_bases_come_along():
    text = source(
        'import math, json\nimport numpy as np\nfrom rclpy.node import Node',
        '# Seconds between two messages.\nRATE, UNUSED = 0.5, 3\nLEFT = 1',
        'def twice(x):\n    return half(x) * 4\n\ndef half(x):\n    return math.floor(x) / LEFT',
        'TABLE = [twice(n) for n in range(3)]',
        'class Base(Node):\n    def __init__(self):\n        super().__init__("talker")',
        """
        class Talker(Base):
            '''Says numbers. '''
            table = TABLE

            def __init__(self):
                super().__init__()
                self.create_timer(RATE, lambda: np.array(twice(2)))
        """,
    )
    assert [line for line in text.splitlines() if line and not line.startswith(' ')] == [
        'from rclpy.node import Node',
        'import math',
        'import numpy as np',
        '# Seconds between two messages.',
        'RATE, UNUSED = 0.5, 3',
        'LEFT = 1',
        'def twice(x):',
        'def half(x):',
        'TABLE = [twice(n) for n in range(3)]',
        'class Base(Node):',
        'class Talker(Base):',
    ]


def test_the_latest_definition_counts():
    old = TALKER.replace('Hello', 'Old')
    text = source(old, TALKER, 'WORD = 1', 'WORD = "new"', TALKER.replace("f'Hello", "WORD + f'"))
    assert 'Old' not in text and 'WORD = "new"' in text and 'WORD = 1' not in text


def test_a_base_class_that_ran_later_stands_first():
    base = 'class Base(Node):\n    pass'
    talker = 'class Talker(Base):\n    def __init__(self):\n        super().__init__("talker")'
    text = source('from rclpy.node import Node', base, talker, base)
    assert text.index('class Base') < text.index('class Talker')


def test_names_of_other_origins():
    text = source(
        'try:\n    import math as m\nexcept ImportError:\n    m = None',
        'from rclpy.node import *\nfrom std_msgs.msg import *',
        'class Talker(Node):\n    def __init__(self):\n        super().__init__("talker")\n'
        '        self.data = String(data=str(m.pi))',
    )
    assert 'import math as m\n' in text and 'import String\n' in text


def test_a_comment_and_decorators_stay():
    text = source(
        'import functools\nfrom rclpy.node import Node',
        '# This talks.\n@functools.total_ordering\nclass Talker(Node):\n'
        '    def __init__(self):\n        super().__init__("talker")  # its name\n\n'
        '    def __lt__(self, other):\n        return False',
    )
    assert '\n# This talks.\n@functools.total_ordering\nclass Talker(Node):\n' in text
    assert 'super().__init__("talker")  # its name' in text and 'import functools\n' in text


def test_annotations_stay_text():
    found = gathered(
        'from __future__ import annotations\nfrom rclpy.node import Node\n'
        'class Talker(Node):\n    def __init__(self: Talker) -> None:\n'
        "        super().__init__('talker')",
    )
    assert found.annotations and not gathered(TALKER).annotations


def changed(old: str, new: str) -> str:
    assert old in TALKER
    return TALKER.replace(old, new)


@pytest.mark.parametrize(
    ('cells', 'words'),
    [
        (
            ['speed = 3', changed('self.count += 1', 'self.count += sped')],
            "uses 'sped'.\nCell In[3], line 14: self.count += sped\n"
            "No cell of this notebook has made it.\nDid you mean 'speed'?",
        ),
        (
            [changed('self.count += 1', 'self.count += math.pi')],
            "uses 'math'.\nCell In[2], line 14: self.count += math.pi\n"
            'No cell of this notebook has made it.\nRun a cell with: import math',
        ),
        (
            [changed('self.count += 1', 'lab.wait_until(lambda: True)')],
            "uses 'lab'.\nCell In[2], line 14: lab.wait_until(lambda: True)\nIt belongs to labkit",
        ),
        (
            [changed('self.count += 1', 'import labkit.sim')],
            "uses 'labkit'.\nCell In[2], line 14: import labkit.sim\nIt belongs to labkit",
        ),
        (
            ['from labkit import wait_until', changed('self.count += 1', 'wait_until(len)')],
            "uses 'wait_until'.\nCell In[3], line 14: wait_until(len)\nIt belongs to labkit",
        ),
        (
            [TALKER, 'old = lab.spin(Talker())', changed('self.count += 1', 'old.count = 1')],
            "uses 'old'.\nCell In[4], line 14: old.count = 1\nIt is a Talker that runs in this "
            'notebook: Cell In[3], line 1: old = lab.spin(Talker())\n',
        ),
        (
            [TALKER, 'p = lab.spin(Talker()).publisher', changed('self.publisher.', 'p.')],
            'It is a Publisher that runs in this notebook',
        ),
        (
            ['def helper():\n    return lab.graph()', changed('self.count += 1', 'helper()')],
            "uses 'lab'.\nCell In[2], line 2: return lab.graph()\n",
        ),
        (
            ['for step in (1, 2): pass', changed('+= 1', '+= step')],
            "uses 'step'.\nCell In[3], line 14: self.count += step\nCell In[2], line 1: for step "
            'in (1, 2): pass gives it its value inside of another statement.',
        ),
        (
            ['if True:\n    def step(): return 1', changed('+= 1', '+= step()')],
            'Cell In[2], line 2: def step(): return 1 gives it its value inside',
        ),
        (
            [changed('self.count += 1', 'display(self.count)')],
            "uses 'display'.\nCell In[2], line 14: display(self.count)\nIt belongs to notebooks",
        ),
        (
            ['def main():\n    return 1', changed('+= 1', '+= main()')],
            'The program that is made has its own main.',
        ),
    ],
)
def test_what_can_not_come_along_is_named(cells, words):
    said = refused(*cells)
    assert words in said, said


class Needy(Node):
    def __init__(self, rate, depth):
        super().__init__('needy')


class Plain:
    pass


def inner() -> type:
    class Inner(Node):
        pass

    return Inner


@pytest.mark.parametrize(
    ('thing', 'words'),
    [
        (Needy, 'Needy() needs rate, depth, and `ros2 run` gives it nothing.\nGive each a value'),
        (Plain, 'lab.export takes classes of nodes, and this is <class'),
        (inner(), 'Inner is defined inside of inner.'),
        (labkit.Turtlebot, 'Turtlebot belongs to labkit, the helper of this notebook.'),
    ],
)
def test_what_is_no_class_of_a_node_that_can_run_alone(thing, words, tmp_path):
    with pytest.raises(LabError) as caught:
        export(thing, package='talk', folder=tmp_path)
    assert words in str(caught.value)
    assert list(tmp_path.iterdir()) == []
