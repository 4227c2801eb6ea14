"""Exercise: two nodes publish on one topic."""

from __future__ import annotations

from labkit.exercises import Exercise, Probe, Solution, Style, Wrong, changed, expect

STRING = 'std_msgs/msg/String'
EARS = ('/left_ear', '/right_ear')


def judge_ears(probe: Probe) -> str:
    """Two publishers on one topic, by two nodes."""
    heard = []
    for name in EARS:
        source = expect.publisher(probe, '/sound', by=name)
        sounds = expect.messages(probe, source, count=3, hz=5.0)
        expect.each(
            sounds,
            'data',
            lambda text: text.strip() != '',
            expected='a text in every message',
            why='A new String is empty until its data is set.',
            todo="Write what the ear hears: String(data='...').",
        )
        heard.append(f'{name} says {sounds.values("data")[0]!r}')
    return f'One topic, two publishers: {", ".join(heard)}.'


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

ears = Exercise(
    name='ears',
    task='Two nodes, left_ear and right_ear, publish text on /sound five times a second each.',
    publishes={'/sound': STRING},
    shared=['/sound'],
    nodes=EARS,
    judge=judge_ears,
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
        Style(
            'two classes and a thread',
            """
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


def work():
    while not stop.wait(0.2) and rclpy.ok():
        for ear in ears:
            try:
                ear.pub.publish(String(data='wind'))
            except Exception:
                return


threading.Thread(target=work, daemon=True).start()
""",
        ),
    ],
    wrong=[
        Wrong(
            'both ears have one name',
            changed(EAR, ("'right_ear', 'a bell'", "'left_ear', 'a bell'")),
            '/right_ear',
        ),
        Wrong(
            'only one ear',
            changed(EAR, ("right_ear = lab.spin(Ear('right_ear', 'a bell'))", '')),
            '/right_ear',
        ),
        Wrong(
            'nothing in the message',
            changed(EAR, ('String(data=self.noise)', 'String()')),
            'A new String is empty until its data is set.',
        ),
        Wrong(
            'five seconds for five times a second',
            changed(EAR, ('create_timer(0.2', 'create_timer(5')),
            'its period is 5 s',
        ),
        Wrong(
            'another topic',
            changed(EAR, ("'sound'", "'sounds'")),
            'names must be equal to the last letter',
        ),
    ],
)
