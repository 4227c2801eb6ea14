"""The warm-up exercise and the quiz of `00_start_here.ipynb`."""

from __future__ import annotations

from labkit.exercises import Choice, Exercise, Lesson, Quiz, Solution, right, wrong
from labkit.exercises.clauses import Named, Runs
from labkit.lessons._robot import ROBOT_TOPICS

__all__ = ['LESSON']


first_node = Exercise(
    name='first_node',
    task='Start a node called `hello_robot`.',
    clauses=(
        Named('/hello_robot'),
        Runs('the node runs, as with `lab.spin`', node='/hello_robot'),
    ),
    hints=[
        'The cell `first-node` further up starts a node called first_node. Which line does it?',
        "Node('first_node') makes a node of that name, and lab.spin(...) lets it run.",
        "Write lab.spin(Node('hello_robot')), with the quotation marks and the brackets.",
    ],
    answer=Solution(
        __file__,
        'first_node.py',
        'Node(...) makes a node, and the text in quotation marks is its name. lab.spin(...) lets '
        'it run in the background. The import is needed once in a notebook.',
    ),
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
    minutes=20,
    teaches='how a lesson works; your first message; a robot to drive',
    exercises=[first_node],
    quizzes=[_QUIZ],
    topics=['/greetings', *ROBOT_TOPICS],
    given={
        '/first_node': 'first-node',
        '/listener': 'first-node',
        '/turtlebot': 'robot',
        '/teleop': 'robot',
    },
)
