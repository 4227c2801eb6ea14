"""Answers to `first_node`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'capital letters',
        'Capital and small letters differ in names',
        ('hello_robot', 'Hello_Robot'),
    ),
    wrong('another node name', 'The names differ in an underscore'),
    wrong(
        'a letter too many',
        'names must be equal to the last letter',
        ('hello_robot', 'hello_robots'),
    ),
    wrong(
        'in a namespace',
        'it lies in another namespace',
        ("'hello_robot'", "'hello_robot', namespace='lab'"),
    ),
    wrong('the name of the example', 'the node /first_node', ('hello_robot', 'first_node')),
    wrong(
        'with a space',
        'The name of a node has letters, digits and _ only',
        ('hello_robot', 'hello robot'),
        outcome=ERROR,
    ),
    wrong(
        'no quotation marks',
        'hello_robot stands here without quotation marks',
        ("'hello_robot'", 'hello_robot'),
        outcome=ERROR,
        refused='The name is not defined.',
    ),
    wrong(
        'a text is not a node',
        "lab.spin() expects a node, but got the text 'hello_robot'",
        ("Node('hello_robot')", "'hello_robot'"),
        outcome=ERROR,
    ),
    wrong(
        'made and not spun',
        'it does nothing before somebody spins it',
        ("lab.spin(Node('hello_robot'))", "robot = Node('hello_robot')"),
    ),
    wrong(
        'a class, and no node of it',
        'Nothing runs before a node is made of it',
        ('\n\n\nrobot = lab.spin(HelloRobot())', ''),
        of='class',
    ),
    wrong('a program that does not spin', 'Its program does something else', run='process'),
    wrong(
        'ended again',
        'The cell ran to its end, and has left no node',
        ('robot = lab.spin(HelloRobot())', 'lab.remove(lab.spin(HelloRobot()))'),
        of='class',
    ),
    right('class'),
    right('functions, and a thread of its own'),
    right(
        'renamed from outside',
        (
            "lab.spin(Node('hello_robot'))\n",
            "robot = lab.spin(Node('first_node', cli_args=['--ros-args', '-r', "
            "'__node:=hello_robot']))\n",
        ),
    ),
    right('own process', of='class', run='process'),
    right('own process, by subprocess', of='class', run='subprocess'),
    right('own process, by asyncio', of='class', run='asyncio'),
]
