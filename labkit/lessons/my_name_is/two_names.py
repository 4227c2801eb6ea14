"""Exercise: two nodes of one class, each with its own name to say."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution, Style, Wrong, changed
from labkit.lessons.my_name_is.two_names_clauses import EachAnswers, NamesDiffer, TwoNodes
from labkit.lessons.my_name_is.two_stages_clauses import STRING

__all__ = ['two_names']


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
_PUBLISH = '        self.publisher.publish(String(data=msg.data + self.first_name))\n'
_START = _NAMES[_NAMES.index('ada = ') :].strip()


two_names = Exercise(
    name='two_names',
    task='Two nodes of one class hear /incomplete. Each appends a first name of its own, and '
    'publishes on /names.',
    subscribes={'/incomplete': STRING},
    publishes={'/names': STRING},
    shared=['/names'],
    clauses=(TwoNodes(), EachAnswers(), NamesDiffer()),
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
            'one more, and a list and a timer',
            """
from rclpy.node import Node
from std_msgs.msg import String


class Guest(Node):
    def __init__(self, name):
        super().__init__(f'{name.lower()}_node', namespace='party')
        self.name = name
        self.waiting = []
        self.publisher = self.create_publisher(String, '/names', 10)
        self.create_subscription(String, '/incomplete', self.waiting.append, 10)
        self.create_timer(0.3, self.speak)

    def speak(self):
        while self.waiting:
            self.publisher.publish(String(data=self.waiting.pop(0).data + self.name))


guests = [lab.spin(Guest(name)) for name in ('Ada', 'Bob', 'Zoe')]
""",
        ),
        Style(
            'names that the lesson has used',
            changed(
                _NAMES, ("'ada', 'Ada'", "'observer', 'Ada'"), ("'bob', 'Bob'", "'display', 'Bob'")
            ),
        ),
        Style(
            'executors of their own, in threads',
            changed(
                _NAMES,
                (
                    'from rclpy.node',
                    'import threading\n\nfrom rclpy.executors import SingleThreadedExecutor\n'
                    'from rclpy.node',
                ),
                (
                    _START,
                    """for name in ('Ada', 'Bob'):
    executor = SingleThreadedExecutor()
    executor.add_node(Introducer(name.lower(), name))
    threading.Thread(target=executor.spin, daemon=True).start()
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
            '/bob is there, but it is not spun',
        ),
        Wrong(
            'string built once',
            changed(_NAMES, ('msg.data + self', "'My name is ' + self")),
            'The text that came in is not part of what goes out.',
        ),
        Wrong(
            'space too many',
            changed(_NAMES, ('msg.data + self', "msg.data + ' ' + self")),
            'There is a space too many beside the name.',
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
        Wrong(
            'answers twice',
            changed(_NAMES, (_PUBLISH, _PUBLISH + _PUBLISH)),
            'A node publishes more than one text',
        ),
        Wrong(
            'passes on, and answers',
            changed(_NAMES, (_PUBLISH, _PUBLISH + '        self.publisher.publish(msg)\n')),
            'A node publishes more than one text',
        ),
        Wrong(
            'a name that changes',
            changed(
                _NAMES,
                (_PUBLISH, _PUBLISH + '        self.first_name = self.first_name[::-1]\n'),
            ),
            'The names are others than those that came with the first text.',
        ),
        Wrong(
            'only the first time',
            changed(
                _NAMES,
                (
                    _PUBLISH,
                    '        if self.first_name:\n    '
                    + _PUBLISH
                    + "        self.first_name = ''\n",
                ),
            ),
            'nothing on /names',
        ),
        Wrong(
            'one of them knows one text only',
            changed(
                _NAMES,
                (
                    _PUBLISH,
                    "        if self.first_name == 'Ada' or msg.data == 'My name is ':\n    "
                    + _PUBLISH,
                ),
            ),
            'Only 1 of 2 nodes answered',
        ),
        Wrong(
            'repeats its answer',
            changed(
                _NAMES,
                (
                    '        self.first_name = first_name\n',
                    '        self.first_name = first_name\n        self.heard = None\n'
                    '        self.timer = self.create_timer(0.2, self.on_timer)\n',
                ),
                (
                    _PUBLISH,
                    '        self.heard = msg\n\n    def on_timer(self):\n'
                    '        if self.heard:\n'
                    '            self.publisher.publish('
                    'String(data=self.heard.data + self.first_name))\n',
                ),
            ),
            'a timer or a loop publishes them',
        ),
        Wrong(
            'one of them listens elsewhere',
            changed(
                _NAMES,
                ("String, 'incomplete', self", 'String, self.inner, self'),
                (
                    '        self.first_name = first_name\n',
                    '        self.first_name = first_name\n'
                    "        self.inner = 'incomplete' if first_name == 'Ada' else 'complete'\n",
                ),
            ),
            '/bob with a subscription to /incomplete',
        ),
    ],
)
