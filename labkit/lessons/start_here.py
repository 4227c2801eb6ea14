"""The warm-up exercise and the quiz of `00_start_here.ipynb`."""

from __future__ import annotations

from labkit.exercises import (
    Choice,
    Exercise,
    Lesson,
    Outcome,
    Probe,
    Quiz,
    Solution,
    Style,
    Wrong,
    expect,
    right,
    wrong,
)

__all__ = ['LESSON']

_NODE = """
from rclpy.node import Node

lab.spin(Node('hello_robot'))
"""


def _judge_first_node(probe: Probe) -> str:
    name = expect.node(probe, '/hello_robot')
    return f'A node called {name} is running.'


first_node = Exercise(
    name='first_node',
    task='Start a node called `hello_robot`.',
    nodes=['/hello_robot'],
    judge=_judge_first_node,
    hints=[
        'The cell `first-node` further up starts a node called first_node. Which line does it?',
        "Node('first_node') makes a node of that name, and lab.spin(...) lets it run.",
        "Write lab.spin(Node('hello_robot')), with the quotation marks and the brackets.",
    ],
    answer=Solution(
        _NODE,
        'Node(...) makes a node, and the text in quotation marks is its name. lab.spin(...) lets '
        'it run in the background. The import is needed once in a notebook.',
    ),
    styles=[
        Style(
            'class',
            """
from rclpy.node import Node


class HelloRobot(Node):
    def __init__(self):
        super().__init__('hello_robot')


robot = lab.spin(HelloRobot())
""",
        ),
        Style(
            'as in a tutorial',
            """
import rclpy

rclpy.init()
node = rclpy.create_node('hello_robot')
""",
        ),
    ],
    wrong=[
        Wrong(
            'capital letters',
            _NODE.replace('hello_robot', 'Hello_Robot'),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'no underscore',
            _NODE.replace('hello_robot', 'hellorobot'),
            'The names differ in an underscore',
        ),
        Wrong(
            'a letter too many',
            _NODE.replace('hello_robot', 'hello_robots'),
            'names must be equal to the last letter',
        ),
        Wrong(
            'with a space',
            _NODE.replace('hello_robot', 'hello robot'),
            'The name of a node has letters, digits and _ only',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no quotation marks',
            _NODE.replace("'hello_robot'", 'hello_robot'),
            'Python does not know the name hello_robot here',
            outcome=Outcome.ERROR,
            refused='The name is not defined.',
        ),
        Wrong(
            'a text is not a node',
            _NODE.replace("Node('hello_robot')", "'hello_robot'"),
            "lab.spin() expects a node, but got 'hello_robot'",
            outcome=Outcome.ERROR,
        ),
    ],
)

_QUIZ = Quiz(
    'cells',
    Choice(
        'You run the cell that starts first_node a second time. What is there afterwards?',
        right(
            'one node of that name: the new one',
            'The old node was ended first, so a cell can be run as often as you like.',
        ),
        wrong(
            'two nodes of that name',
            'That is what bare ROS would give you. Here lab.spin ends the old node of that name.',
        ),
        wrong(
            'one node: the old one',
            'The cell made a new node. The change that you made in the cell counts from now on.',
        ),
    ),
    Choice(
        'A cell shows [*] and nothing happens. What does that mean?',
        right(
            'It is still running, or it waits for another cell that is.',
            'The star becomes a number when the cell has ended. The stop button ends it early.',
        ),
        wrong(
            'It has failed.',
            'A cell that fails shows an error under it, and a number in the brackets.',
        ),
        wrong(
            'It was never run.',
            'The brackets of such a cell are empty: [ ].',
        ),
    ),
)

LESSON = Lesson(
    'start_here',
    '00_start_here.ipynb',
    exercises=[first_node],
    quizzes=[_QUIZ],
    topics=['/greetings'],
    given={'/first_node': 'first-node'},
)
