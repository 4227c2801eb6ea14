"""Exercise: two nodes of one class, each with its own name to say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from labkit.exercises import (
    Exercise,
    Fail,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons.my_name_is.two_stages import STRING

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['two_names']

TEST = 'Her name is '
# How long two answers may take, and the second name after them.
ANSWER_SEC = 1.2
AFTER_SEC = 0.2

_NAMES = """
from rclpy.node import Node
from std_msgs.msg import String


class Introducer(Node):
    def __init__(self, node_name, first_name):
        super().__init__(node_name)
        self.first_name = first_name
        self.publisher = self.create_publisher(String, 'names', 10)
        self.subscription = self.create_subscription(String, 'incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.publisher.publish(String(data=msg.data + self.first_name))


ada = lab.spin(Introducer('ada', 'Ada'))
bob = lab.spin(Introducer('bob', 'Bob'))
"""
_START = _NAMES[_NAMES.index('ada = ') :].strip()


def _judge_two_names(probe: Probe) -> str:
    first = expect.publisher(probe, '/names')
    # Nodes of a process of their own come into the graph one after the other.
    probe.wait_to_appear(lambda: len({end.node for end in probe.publishers('/names')}) > 1)
    _expect_two_nodes(probe, probe.publishers('/names'))
    expect.subscription(probe, '/incomplete', by=first.node)
    watch = probe.watch('/names', STRING)
    probe.sender('/incomplete', STRING)({'data': TEST})

    def names() -> list[str]:
        texts = [str(text) for text in watch.values('data')]
        return [text.removeprefix(TEST) for text in texts if text.startswith(TEST)]

    probe.wait(lambda: len(names()) > 1, ANSWER_SEC)
    if not probe.wait(lambda: len(set(names())) > 1, AFTER_SEC):
        expect.hanging(probe)
        _refuse(names(), watch.values('data'))
    both = sorted(set(names()))
    expect.that(
        all(name and name == name.strip() for name in both),
        expected=f'{TEST!r} and a first name, on /names',
        seen=f'data = {expect.show([TEST + name for name in both])}',
        why='A name is missing, or there is a space too many beside it.',
        todo='Publish msg.data + self.first_name.',
    )
    return f'On /names came {" and ".join(repr(TEST + name) for name in both)}.'


def _expect_two_nodes(probe: Probe, publishers: Sequence[Endpoint]) -> None:
    nodes = {endpoint.node for endpoint in publishers}
    if len(nodes) > 1:
        return
    (name,) = nodes
    why = (
        'Were two nodes of the same name started? lab.spin() ends the first of them when the '
        'second one comes.'
    )
    if probe.node_names().count(name) > 1:
        why = 'Two nodes have the same name. ROS allows it, and nobody can tell them apart.'
    elif len(publishers) > 1:
        why = 'One node has two publishers. Two nodes are asked for.'
    raise Fail(
        'two nodes, of different names, that publish on /names',
        f'{len(publishers)} publisher{"s" * (len(publishers) > 1)} on /names, of {name} alone',
        why=why,
        todo="Give the name of the node as an argument, too: Introducer('ada', 'Ada')",
    )


def _refuse(names: Sequence[str], texts: Sequence[str]) -> NoReturn:
    seen = f'data = {expect.show(texts)}' if texts else 'nothing on /names'
    if len(names) > 1:
        why = (
            f'Both say {names[0]!r}: they share the name. A variable of the notebook or of the '
            'class is the same for all objects.'
        )
        todo = 'Keep the name in the object: self.first_name = first_name in __init__'
    elif names:
        why = f'Only one of the nodes answers, with {names[0]!r}.'
        todo = 'Start both with lab.spin(...).'
    elif texts:
        why = 'The text that came in is not used, so the answer is always the same.'
        todo = 'Publish msg.data + self.first_name.'
    else:
        why = 'The message came, but the callback of neither node did publish.'
        todo = 'Publish in the callback of the subscription, and start both with lab.spin(...).'
    raise Fail(
        f'two texts on /names when {TEST!r} comes on /incomplete, with different names',
        seen,
        why=why,
        todo=todo,
    )


two_names = Exercise(
    name='two_names',
    task='Two nodes of one class hear /incomplete. Each appends a first name of its own, and '
    'publishes on /names.',
    subscribes={'/incomplete': STRING},
    publishes={'/names': STRING},
    shared=['/names'],
    judge=_judge_two_names,
    hints=[
        'A class is a plan: two objects of it are two nodes. In what do the two differ?',
        'In two things: the name of the node and the first name. Both can be arguments of '
        '__init__.',
        'def __init__(self, node_name, first_name): then super().__init__(node_name) and '
        'self.first_name = first_name.',
    ],
    answer=Solution(
        _NAMES,
        'What differs is an argument and is kept in self, so each object has its own. Both '
        'publish on one topic, and both hear the same message.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String


def introduce(name):
    node = rclpy.create_node('stage_' + name.lower())
    publisher = node.create_publisher(String, '/names', 10)

    def answer(text):
        publisher.publish(String(data=text.data + name))

    node.create_subscription(String, '/incomplete', answer, 10)
    lab.spin(node)


for name in ('Eve', 'Finn', 'Gus'):
    introduce(name)
""",
        ),
        Style(
            'a class each',
            changed(
                _NAMES,
                (
                    _START,
                    """class Ada(Introducer):
    def __init__(self):
        super().__init__('lady', 'Ada')


class Bob(Introducer):
    def __init__(self):
        super().__init__('builder', 'Bob')


lab.spin(Ada())
lab.spin(Bob())
""",
                ),
            ),
        ),
        Style(
            'own process',
            changed(
                _NAMES,
                (
                    'from rclpy.node',
                    'import rclpy\nfrom rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    _START,
                    """rclpy.init()
executor = MultiThreadedExecutor()
for node in (Introducer('ada', 'Ada'), Introducer('bob', 'Bob')):
    executor.add_node(node)
executor.spin()
""",
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'one node only',
            changed(_NAMES, ("bob = lab.spin(Introducer('bob', 'Bob'))\n", '')),
            'of /ada alone',
        ),
        Wrong(
            'same node name',
            changed(_NAMES, ("'bob', 'Bob'", "'ada', 'Bob'")),
            'lab.spin() ends the first of them',
        ),
        Wrong(
            'same first name',
            changed(_NAMES, ("'bob', 'Bob'", "'bob', 'Ada'")),
            "Both say 'Ada'",
        ),
        Wrong(
            'a variable for all',
            changed(
                _NAMES,
                ('self.first_name = first_name', 'Introducer.first_name = first_name'),
            ),
            "Both say 'Bob': they share the name.",
        ),
        Wrong(
            'second one not spun',
            changed(_NAMES, ("lab.spin(Introducer('bob', 'Bob'))", "Introducer('bob', 'Bob')")),
            "Only one of the nodes answers, with 'Ada'",
        ),
        Wrong(
            'string built once',
            changed(_NAMES, ('msg.data + self', "'My name is ' + self")),
            'The text that came in is not used',
        ),
        Wrong(
            'space too many',
            changed(_NAMES, ('msg.data + self', "msg.data + ' ' + self")),
            'there is a space too many beside it',
        ),
        Wrong(
            'one node with two publishers',
            changed(
                _NAMES,
                (_START, "ada = lab.spin(Introducer('ada', 'Ada'))"),
                (
                    '    def on_text',
                    "        self.other = self.create_publisher(String, 'names', 10)\n\n"
                    '    def on_text',
                ),
                (
                    'self.first_name))',
                    "self.first_name))\n        self.other.publish(String(data=msg.data + 'Bob'))",
                ),
            ),
            'One node has two publishers.',
        ),
        Wrong(
            'capital letter',
            changed(_NAMES, ("String, 'names', 10", "String, 'Names', 10")),
            'Capital and small letters differ in names',
        ),
    ],
)
