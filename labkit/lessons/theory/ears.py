"""Exercise: two nodes publish on one topic."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import HasText, NobodyElse, Publishes
from labkit.lessons._script import started_by_asyncio, started_by_subprocess

__all__ = ['ears']

STRING = 'std_msgs/msg/String'
EARS = ('/left_ear', '/right_ear')

EAR = """
from rclpy.node import Node
from std_msgs.msg import String


class Ear(Node):
    def __init__(self, name, noise):
        super().__init__(name)
        self.noise = noise
        self.publisher = self.create_publisher(String, 'sound', 10)
        self.timer = self.create_timer(0.2, self.listen)

    def listen(self):
        self.publisher.publish(String(data=self.noise))


left_ear = lab.spin(Ear('left_ear', 'a dog'))
right_ear = lab.spin(Ear('right_ear', 'a bell'))
"""
_PUBLISH = '        self.publisher.publish(String(data=self.noise))\n'
_RIGHT = "right_ear = lab.spin(Ear('right_ear', 'a bell'))\n"
_COUNT = ('        self.noise = noise\n', '        self.noise = noise\n        self.calls = 0\n')

_SCRIPT = """
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Ear(Node):
    def __init__(self, name):
        super().__init__(name)
        self.publisher = self.create_publisher(String, 'sound', 10)
        self.timer = self.create_timer(0.2, self.listen)

    def listen(self):
        self.publisher.publish(String(data=f'{self.get_name()} hears rain'))


rclpy.init()
executor = SingleThreadedExecutor()
for ear in [Ear('left_ear'), Ear('right_ear')]:
    executor.add_node(ear)
executor.spin()
"""

_THREAD = """
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class LeftEar(Node):
    def __init__(self):
        super().__init__('left_ear')
        self.pub = self.create_publisher(String, 'sound', 10)


class RightEar(Node):
    def __init__(self):
        super().__init__('right_ear')
        self.pub = self.create_publisher(String, 'sound', 10)


ears = [lab.spin(LeftEar()), lab.spin(RightEar())]
stop = threading.Event()


def work(ears):
    while not stop.wait(0.2) and rclpy.ok():
        for ear in ears:
            try:
                ear.pub.publish(String(data='wind'))
            except Exception:
                return


threading.Thread(target=work, args=(ears,), daemon=True).start()
"""

ears = Exercise(
    name='ears',
    task='Two nodes, left_ear and right_ear, publish text on /sound five times a second each.',
    publishes={'/sound': STRING},
    shared=['/sound'],
    nodes=EARS,
    clauses=(
        *(Publishes('/sound', 5.0, STRING, by=ear) for ear in EARS),
        HasText('/sound', by=EARS),
        NobodyElse('/sound', EARS),
    ),
    hints=[
        'The class Eye of this lesson is nearly an Ear. What differs: the topic.',
        'Five times a second is a period of 0.2 s.',
        "One class, two nodes: lab.spin(Ear('left_ear')) and lab.spin(Ear('right_ear')).",
    ],
    answer=Solution(
        EAR,
        'A class describes a kind of node. The name makes the difference between two nodes of '
        'that kind, so it is passed when the node is made.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String


def make_ear(name):
    ear = rclpy.create_node(name)
    publisher = ear.create_publisher(String, '/sound', 1)
    ear.create_timer(1 / 5, lambda: publisher.publish(String(data=f'{name} hears rain')))
    lab.spin(ear)


make_ear('left_ear')
make_ear('right_ear')
""",
        ),
        Style('two classes and a thread', _THREAD),
        Style(
            'one by a timer, one by a thread',
            changed(
                _THREAD,
                (
                    "        super().__init__('left_ear')\n",
                    "        super().__init__('left_ear')\n"
                    '        self.create_timer(0.2, self.listen)\n',
                ),
                (
                    '\n\nclass RightEar',
                    "\n    def listen(self):\n        self.pub.publish(String(data='a dog'))\n\n\n"
                    'class RightEar',
                ),
                ('for ear in ears:', 'for ear in ears[1:]:'),
            ),
        ),
        Style(
            'a fast timer, each fourth call',
            changed(
                EAR,
                _COUNT,
                ('create_timer(0.2', 'create_timer(0.05'),
                (
                    _PUBLISH,
                    '        self.calls += 1\n        if self.calls % 4 == 0:\n    ' + _PUBLISH,
                ),
            ),
        ),
        Style('both in a process of their own', _SCRIPT, process=True),
        Style('both in a process, by subprocess', started_by_subprocess(_SCRIPT)),
        Style(
            'one here, one in a process, by asyncio',
            started_by_asyncio(changed(_SCRIPT, (", Ear('right_ear')", '')))
            + EAR.replace("left_ear = lab.spin(Ear('left_ear', 'a dog'))\n", ''),
        ),
    ],
    wrong=[
        Wrong(
            'both ears have one name',
            changed(EAR, ("'right_ear', 'a bell'", "'left_ear', 'a bell'")),
            'There is no node called /right_ear.',
        ),
        Wrong('only one ear', changed(EAR, (_RIGHT, '')), 'There is no node called /right_ear.'),
        Wrong(
            'the other ear only',
            changed(EAR, ("left_ear = lab.spin(Ear('left_ear', 'a dog'))\n", '')),
            'There is no node called /left_ear.',
        ),
        Wrong(
            'a name is misspelt',
            changed(EAR, ("'left_ear', 'a dog'", "'left_ears', 'a dog'")),
            '/left_ears is not /left_ear',
        ),
        Wrong(
            'one is silent',
            changed(
                EAR,
                (_PUBLISH, "        if self.get_name() == 'left_ear':\n    " + _PUBLISH),
            ),
            'The timer calls its callback, but publish() is not called there',
        ),
        Wrong(
            'the left one is silent',
            changed(
                EAR,
                (_PUBLISH, "        if self.get_name() == 'right_ear':\n    " + _PUBLISH),
            ),
            'The timer calls its callback, but publish() is not called there',
        ),
        Wrong(
            'one is not spun',
            changed(EAR, (_RIGHT, "right_ear = Ear('right_ear', 'a bell')\n")),
            'nothing runs its callbacks',
        ),
        Wrong(
            'one is slower',
            changed(EAR, ('create_timer(0.2', "create_timer(0.2 if name == 'left_ear' else 0.25")),
            'a message every 0.25 s (4 Hz): 1.25 times too slow',
        ),
        Wrong(
            'a little too fast',
            changed(EAR, ('create_timer(0.2', 'create_timer(0.19')),
            '1.05 times too fast',
        ),
        Wrong(
            'one of two is silent, in a thread',
            changed(_THREAD, ('for ear in ears:', 'for ear in ears[:1]:')),
            'One of these nodes does not publish at this rate: /left_ear, /right_ear.',
        ),
        Wrong(
            'a third ear',
            EAR + "third_ear = lab.spin(Ear('third_ear', 'a cat'))\n",
            '/third_ear publishes there, too',
        ),
        Wrong(
            'two publishers in one ear',
            changed(
                EAR,
                (
                    '        self.timer',
                    "        self.second = self.create_publisher(String, 'sound', 10)\n"
                    '        self.timer',
                ),
                (_PUBLISH, _PUBLISH + _PUBLISH.replace('publisher', 'second')),
            ),
            'said by two publishers',
        ),
        Wrong(
            'says each thing twice',
            changed(EAR, (_PUBLISH, 2 * _PUBLISH)),
            'is publish() called twice',
        ),
        Wrong(
            'one stops after ten',
            changed(
                EAR,
                _COUNT,
                (
                    _PUBLISH,
                    '        self.calls += 1\n'
                    "        if self.calls <= 10 or self.get_name() == 'left_ear':\n    "
                    + _PUBLISH,
                ),
            ),
            'but publish() is not called there, or not any more',
        ),
        Wrong(
            'stops after a minute',
            changed(
                EAR,
                _COUNT,
                (
                    _PUBLISH,
                    '        self.calls += 1\n        if self.calls <= 75:\n    ' + _PUBLISH,
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'nothing in the message',
            changed(EAR, ('String(data=self.noise)', 'String()')),
            'its field data is an empty text at first',
        ),
        Wrong(
            'nothing to say later on',
            changed(
                EAR,
                (
                    'publish(String(data=self.noise))',
                    'publish(String(data=self.noise))\n        self.noise = self.noise[1:]',
                ),
            ),
            'its field data is an empty text at first',
        ),
        Wrong(
            'only spaces',
            changed(EAR, ("'a bell'", "'  '")),
            'A text of spaces says nothing.',
        ),
        Wrong(
            'five seconds for five times a second',
            changed(EAR, ('create_timer(0.2', 'create_timer(5')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'another topic',
            changed(EAR, ("'sound'", "'sounds'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'another type',
            changed(
                EAR,
                ('from std_msgs.msg import String', 'from std_msgs.msg import Int16'),
                ('(String, ', '(Int16, '),
                ('String(data=self.noise)', 'Int16(data=7)'),
            ),
            'A topic carries one type of message.',
        ),
        Wrong(
            'not set up',
            changed(EAR, ('        super().__init__(name)\n', '')),
            'super().__init__(...) has not been called',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'a class, and no node of it',
            EAR.partition('\n\n\nleft_ear')[0],
            'Nothing runs before a node is made of it.',
        ),
    ],
)
