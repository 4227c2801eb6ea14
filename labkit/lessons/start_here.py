"""The warm-up exercise and the quiz of `00_start_here.ipynb`."""

from __future__ import annotations

from labkit.exercises import (
    Choice,
    Exercise,
    Lesson,
    Outcome,
    Quiz,
    Solution,
    Style,
    Wrong,
    changed,
    right,
    wrong,
)
from labkit.exercises.clauses import Named, Runs
from labkit.lessons._script import in_process, started_by_asyncio, started_by_subprocess

__all__ = ['LESSON']

_NODE = """
from rclpy.node import Node

lab.spin(Node('hello_robot'))
"""


_CLASS = """
from rclpy.node import Node


class HelloRobot(Node):
    def __init__(self):
        super().__init__('hello_robot')


robot = lab.spin(HelloRobot())
"""

first_node = Exercise(
    name='first_node',
    task='Start a node called `hello_robot`.',
    nodes=['/hello_robot'],
    clauses=(
        Named('/hello_robot'),
        Runs('the node runs: it is spun, as `lab.spin` does it', node='/hello_robot'),
    ),
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
        Style('class', _CLASS),
        Style(
            'functions, and a thread of its own',
            """
import threading

import rclpy
from rclpy.executors import MultiThreadedExecutor

node = rclpy.create_node('hello_robot')
executor = MultiThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
""",
        ),
        Style(
            'renamed from outside',
            """
from rclpy.node import Node

robot = lab.spin(Node('first_node', cli_args=['--ros-args', '-r', '__node:=hello_robot']))
""",
        ),
        Style('own process', in_process(_CLASS), process=True),
        Style('own process, by subprocess', started_by_subprocess(in_process(_CLASS))),
        Style('own process, by asyncio', started_by_asyncio(in_process(_CLASS))),
    ],
    wrong=[
        Wrong(
            'capital letters',
            changed(_NODE, ('hello_robot', 'Hello_Robot')),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'no underscore',
            changed(_NODE, ('hello_robot', 'hellorobot')),
            'The names differ in an underscore',
        ),
        Wrong(
            'a letter too many',
            changed(_NODE, ('hello_robot', 'hello_robots')),
            'names must be equal to the last letter',
        ),
        Wrong(
            'in a namespace',
            changed(_NODE, ("'hello_robot'", "'hello_robot', namespace='lab'")),
            'it lies in another namespace',
        ),
        Wrong(
            'the name of the example',
            changed(_NODE, ('hello_robot', 'first_node')),
            'the node /first_node',
        ),
        Wrong(
            'with a space',
            changed(_NODE, ('hello_robot', 'hello robot')),
            'The name of a node has letters, digits and _ only',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no quotation marks',
            changed(_NODE, ("'hello_robot'", 'hello_robot')),
            'Python does not know the name hello_robot here',
            outcome=Outcome.ERROR,
            refused='The name is not defined.',
        ),
        Wrong(
            'a text is not a node',
            changed(_NODE, ("Node('hello_robot')", "'hello_robot'")),
            "lab.spin() expects a node, but got 'hello_robot'",
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'made and not spun',
            changed(_NODE, ("lab.spin(Node('hello_robot'))", "robot = Node('hello_robot')")),
            'it does nothing before somebody spins it',
        ),
        Wrong(
            'a class, and no node of it',
            changed(_CLASS, ('\n\n\nrobot = lab.spin(HelloRobot())', '')),
            'nothing runs before a node is made of it'.capitalize(),
        ),
        Wrong(
            'a program that does not spin',
            changed(
                in_process(_CLASS),
                (
                    'rclpy.spin(HelloRobot())',
                    'robot = HelloRobot()\n    time.sleep(60)\n    robot.destroy_node()',
                ),
                ('import rclpy\nfrom', 'import time\n\nimport rclpy\nfrom'),
            ),
            'Its program does something else',
            process=True,
        ),
        Wrong(
            'ended again',
            changed(
                _CLASS, ('robot = lab.spin(HelloRobot())', 'lab.remove(lab.spin(HelloRobot()))')
            ),
            'Not attempted yet',
            outcome=Outcome.NOT_ATTEMPTED,
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
    title='Start here',
    teaches='how a lesson works; your first message',
    exercises=[first_node],
    quizzes=[_QUIZ],
    topics=['/greetings'],
    given={'/first_node': 'first-node', '/listener': 'first-node'},
)
