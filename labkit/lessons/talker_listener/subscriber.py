"""Exercise: a subscriber on /chatter."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Logs, Subscribes
from labkit.exercises.draws import draw_texts
from labkit.lessons._script import in_process, started_by_asyncio, started_by_subprocess

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


_LOG = '        self.get_logger().info(f\'I heard: "{msg.data}"\')\n'
_INIT = "        super().__init__('ear')\n"
_LATCHED = (
    ('self.on_message, 10)', 'self.on_message, latched)'),
    (
        '\n\nclass',
        '\nlatched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n\n\nclass',
    ),
    ('from std_msgs', 'from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs'),
)

hear_chatter = Exercise(
    name='hear_chatter',
    task='Write a node that subscribes to /chatter and logs the text of each `String`.',
    subscribes={'/chatter': STRING},
    clauses=(
        Subscribes('/chatter', STRING),
        Logs(
            '/chatter',
            'for each message, log one line that holds its text, within a second, and no other '
            'line',
            draw_texts,
        ),
    ),
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
        Style(
            'a logger below that of the node',
            changed(_EAR, ('get_logger().info', "get_logger().get_child('ears').info")),
        ),
        Style(
            'a list and a timer, by a node with the name of another one',
            changed(
                _EAR,
                (_INIT, "        super().__init__('listener')\n        self.heard = []\n"),
                (
                    'self.on_message, 10)\n',
                    'self.heard.append, 10)\n        self.create_timer(0.1, self.on_timer)\n',
                ),
                (
                    'def on_message(self, msg):\n',
                    'def on_timer(self):\n        while self.heard:\n'
                    '            msg = self.heard.pop(0)\n    ',
                ),
            ),
        ),
        Style(
            'a queue and a thread',
            """
import queue
import threading

from rclpy.node import Node
from std_msgs.msg import String

ear = Node('ear')
heard = queue.Queue()
ear.create_subscription(String, 'chatter', heard.put, 10)


def write(ear, heard):
    while True:
        ear.get_logger().info(heard.get().data)


threading.Thread(target=write, args=(ear, heard), daemon=True).start()
lab.spin(ear)
""",
        ),
        Style(
            'in a namespace, with an executor of its own',
            """
import threading

from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

ear = Node('ear', namespace='head')
ear.create_subscription(
    String, '/chatter', lambda msg: ear.get_logger().info(f'{msg.data} was said'), 10
)
executor = MultiThreadedExecutor()
executor.add_node(ear)
threading.Thread(target=executor.spin, daemon=True).start()
""",
        ),
        Style('own process', in_process(_EAR), process=True),
        Style('own process, by subprocess', started_by_subprocess(in_process(_EAR))),
        Style('own process, by asyncio', started_by_asyncio(in_process(_EAR))),
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
            'The callback does not log it.',
        ),
        Wrong(
            'logs something else',
            changed(_EAR, ('{msg.data}', 'msg.data')),
            'its line does not hold what the message says',
            refused='Nothing is put into the f-string.',
        ),
        Wrong(
            'small letters',
            changed(_EAR, ('{msg.data}', '{msg.data.lower()}')),
            'its line does not hold what the message says',
        ),
        Wrong(
            'only the first words',
            changed(_EAR, ('{msg.data}', '{msg.data[:20]}')),
            'its line does not hold what the message says',
        ),
        Wrong(
            'only the first time',
            changed(
                _EAR,
                (_INIT, f'{_INIT}        self.calls = 0\n'),
                (_LOG, f'        self.calls += 1\n        if self.calls == 1:\n    {_LOG}'),
            ),
            # The first one may be of the lesson's talker, before the check.
            '/ear logged nothing',
        ),
        Wrong(
            'every other one',
            changed(
                _EAR,
                (_INIT, f'{_INIT}        self.calls = 0\n'),
                (_LOG, f'        self.calls += 1\n        if self.calls % 2:\n    {_LOG}'),
            ),
            'Some messages are logged as they came, and this one is not.',
        ),
        Wrong('logs twice', changed(_EAR, (_LOG, 2 * _LOG)), 'logged more than once'),
        Wrong(
            'repeats its last line from a timer',
            changed(
                _EAR,
                (
                    _INIT,
                    f"{_INIT}        self.last = ''\n"
                    '        self.create_timer(4.0, self.repeat)\n',
                ),
                (
                    _LOG,
                    f'{_LOG}        self.last = msg.data\n\n    def repeat(self):\n'
                    '        self.get_logger().info(self.last)\n',
                ),
            ),
            'one line of /ear for each message',
        ),
        Wrong(
            'logs when nothing has come',
            changed(
                _EAR,
                (_INIT, f'{_INIT}        self.create_timer(12.3, self.tell)\n'),
                (
                    _LOG,
                    f"{_LOG}\n    def tell(self):\n        self.get_logger().info('waiting')\n",
                ),
            ),
            'A timer or a loop logs, too.',
        ),
        Wrong(
            'does not log the empty text',
            changed(_EAR, (_LOG, f'        if msg.data:\n    {_LOG}')),
            'Some messages are logged as they came, and this one is not.',
        ),
        Wrong(
            'hears nothing of usual publishers',
            changed(_EAR, *_LATCHED),
            'QoS profiles do not match',
        ),
        Wrong(
            'blocks in the callback',
            changed(
                _EAR,
                (_LOG, f'        time.sleep(3)\n{_LOG}'),
                ('from rclpy', 'import time\n\nfrom rclpy'),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'a class, and no node of it',
            _EAR.partition('\n\n\near')[0],
            'Nothing runs before a node is made of it.',
        ),
        Wrong(
            'a program that does not spin',
            changed(
                in_process(_EAR),
                ('rclpy.spin(Ear())', 'ear = Ear()\n    time.sleep(60)\n    ear.destroy_node()'),
                ('import rclpy\nfrom', 'import time\n\nimport rclpy\nfrom'),
            ),
            'Call rclpy.spin(node) in its program.',
            process=True,
        ),
        Wrong(
            'field misspelt',
            changed(_EAR, ('msg.data', 'msg.text')),
            'String has nothing called text',
            outcome=Outcome.ERROR,
        ),
    ],
)
