"""Exercise: a subscriber on /chatter."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    Outcome,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.lessons._script import in_process

__all__ = ['hear_chatter']

STRING = 'std_msgs/msg/String'

_EAR = """
from rclpy.node import Node
from std_msgs.msg import String


class Ear(Node):
    def __init__(self):
        super().__init__('ear')
        self.subscription = self.create_subscription(String, 'chatter', self.on_message, 10)

    def on_message(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


ear = lab.spin(Ear())
"""


def _judge_hear_chatter(probe: Probe) -> str:
    source = expect.subscription(probe, '/chatter')
    line = expect.logs(probe, source.node, source, {'data': 'red boat 17'}, 'red boat 17')
    return f'{source.node} logged: {line}'


hear_chatter = Exercise(
    name='hear_chatter',
    task='Write a node that subscribes to /chatter and logs the text of each `String`.',
    subscribes={'/chatter': STRING},
    judge=_judge_hear_chatter,
    hints=[
        'The class Listener is nearly what you need.',
        'create_subscription() takes four things: type, topic, callback, depth. The callback '
        'takes the message.',
        'In the callback: self.get_logger().info(f\'I heard: "{msg.data}"\')',
    ],
    answer=Solution(
        _EAR,
        'The callback is passed by its name. ROS calls it for each message, and the text is in '
        'msg.data.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('secretary')


def note(message):
    node.get_logger().warning('noted: ' + message.data)


node.create_subscription(String, '/chatter', note, 1)
lab.spin(node)
""",
        ),
        Style('own process', in_process(_EAR), process=True),
    ],
    wrong=[
        Wrong(
            'capital letter',
            changed(_EAR, ("'chatter'", "'Chatter'")),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'in the namespace of the node',
            changed(_EAR, ("'chatter'", "'~/chatter'")),
            'it lies in another namespace',
        ),
        Wrong(
            'wrong type',
            # Within one process ROS refuses it; between processes it is silent.
            changed(in_process(_EAR), ('String', 'Int16')),
            'A topic carries one type of message.',
            process=True,
        ),
        Wrong(
            'callback called',
            changed(_EAR, ('self.on_message,', 'self.on_message(),')),
            'A callback is passed, not called',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'callback without a message',
            changed(_EAR, ('(self, msg)', '(self)')),
            'This callback does not take one argument',
            outcome=Outcome.ERROR,
            refused='The name msg is not defined.',
        ),
        Wrong(
            'not spun',
            changed(_EAR, ('lab.spin(Ear())', 'Ear()')),
            'Nothing takes them out.',
        ),
        Wrong(
            'prints and does not log',
            changed(_EAR, ('self.get_logger().info(', 'print(')),
            'The callback does not log.',
        ),
        Wrong(
            'logs something else',
            changed(_EAR, ('{msg.data}', 'msg.data')),
            'its line does not hold what the message says',
            refused='Nothing is put into the f-string.',
        ),
        Wrong(
            'field misspelt',
            changed(_EAR, ('msg.data', 'msg.text')),
            'String has nothing called text',
            outcome=Outcome.ERROR,
        ),
    ],
)
