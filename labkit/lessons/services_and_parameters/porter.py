"""Exercise: a node that calls a service when it hears a message, without waiting for itself."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers, Named
from labkit.lessons._script import in_process
from labkit.lessons.services_and_parameters.porter_clauses import (
    BOOL,
    NEWS,
    NODE,
    STRING,
    WISH,
    Calls,
    draw,
    explain,
    message,
)

__all__ = ['porter']


_PORTER = """
from rclpy.node import Node
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool


class Porter(Node):
    def __init__(self):
        super().__init__('porter')
        self.client = self.create_client(SetBool, 'move_door')
        self.publisher = self.create_publisher(String, 'news', 10)
        self.subscription = self.create_subscription(Bool, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        future = self.client.call_async(SetBool.Request(data=msg.data))
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.publisher.publish(String(data=future.result().message))


lab.spin(Porter())
"""
_CALLBACK = """    def on_wish(self, msg):
        future = self.client.call_async(SetBool.Request(data=msg.data))
        future.add_done_callback(self.on_response)

    def on_response(self, future):
        self.publisher.publish(String(data=future.result().message))
"""
_AWAIT = """    async def on_wish(self, msg):
        response = await self.client.call_async(SetBool.Request(data=msg.data))
        self.publisher.publish(String(data=response.message))
"""
_CALL = """    def on_wish(self, msg):
        response = self.client.call(SetBool.Request(data=msg.data))
        self.publisher.publish(String(data=response.message))
"""
_CLIENT = "self.create_client(SetBool, 'move_door')"
_GROUP = """self.create_client(
            SetBool, 'move_door', callback_group=MutuallyExclusiveCallbackGroup()
        )"""
_IMPORT = 'from rclpy.node import Node\n'
_IMPORT_GROUP = 'from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n'


porter = Exercise(
    name='porter',
    task='Call /move_door for each Bool on /wish, and publish the message of each response on '
    '/news.',
    publishes={NEWS: STRING},
    subscribes={WISH: BOOL},
    nodes=[NODE],
    clauses=(
        Named(NODE),
        Calls(),
        Answers(
            WISH,
            NEWS,
            f'publish the `message` of each response on `{NEWS}` (`{STRING}`), once, within a '
            'second',
            answer=message,
            draw=draw,
            by=NODE,
            explain=explain,
        ),
    ),
    hints=[
        'The callback of the subscription must not wait. Who takes the response then?',
        'call_async() gives a future. Its add_done_callback() says who gets it when it is done.',
        'future.add_done_callback(self.on_response), and in on_response(self, future): '
        'future.result().message',
    ],
    answer=Solution(
        _PORTER,
        'The callback of the subscription sends the request and returns. When the response is '
        'there, on_response is called with the future that holds it.',
    ),
    styles=[
        Style(
            'await, and a callback group for the client',
            changed(
                _PORTER,
                (_CALLBACK, _AWAIT),
                (_CLIENT, _GROUP),
                (_IMPORT, f'{_IMPORT_GROUP}{_IMPORT}'),
            ),
        ),
        Style(
            'lambda',
            changed(
                _PORTER,
                (
                    _CALLBACK,
                    '    def on_wish(self, msg):\n'
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
                    '        future.add_done_callback(lambda done: self.say(done.result()))\n\n'
                    '    def say(self, response):\n'
                    '        self.publisher.publish(String(data=response.message))\n',
                ),
            ),
        ),
        Style(
            'waits until the door is there',
            changed(
                _PORTER,
                (
                    _CLIENT,
                    f'{_CLIENT}\n        while not self.client.wait_for_service('
                    "timeout_sec=1.0):\n            self.get_logger().info('waiting')",
                ),
            ),
        ),
        Style('own process', in_process(_PORTER), process=True),
        Style(
            'own process, two threads, and call()',
            changed(
                in_process(
                    changed(
                        _PORTER,
                        (_CALLBACK, _CALL),
                        (_CLIENT, _GROUP),
                        (_IMPORT, f'{_IMPORT_GROUP}{_IMPORT}'),
                    )
                ),
                ('rclpy.spin(Porter())', 'rclpy.spin(Porter(), MultiThreadedExecutor(2))'),
                (
                    'from rclpy.node import Node\n',
                    'from rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node import Node\n',
                ),
            ),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'call() in the callback',
            changed(_PORTER, (_CALLBACK, _CALL)),
            'inside a callback would wait for ever',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'call() in the callback, in a process of its own',
            in_process(changed(_PORTER, (_CALLBACK, _CALL))),
            'So it waits for ever: a deadlock.',
            process=True,
        ),
        Wrong(
            'await in one callback group',
            changed(_PORTER, (_CALLBACK, _AWAIT)),
            'So it waits for ever: a deadlock.',
        ),
        Wrong(
            'has had enough after ten',
            changed(
                _PORTER,
                (
                    '    def on_wish(self, msg):\n',
                    '    def on_wish(self, msg):\n'
                    "        self.wishes = getattr(self, 'wishes', 0) + 1\n"
                    '        if self.wishes > 10:\n            return\n',
                ),
            ),
            'Some messages lead to a call, and others do not.',
        ),
        Wrong(
            'does not wait at all',
            changed(
                _PORTER,
                (
                    '        future.add_done_callback(self.on_response)\n',
                    '        self.on_response(future)\n',
                ),
            ),
            'was not done yet',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no done callback',
            changed(
                _PORTER,
                ('        future.add_done_callback(self.on_response)\n', ''),
                ('        future = self.client', '        self.future = self.client'),
            ),
            'nothing was published when its response came',
        ),
        Wrong(
            'always opens',
            changed(_PORTER, ('SetBool.Request(data=msg.data)', 'SetBool.Request(data=True)')),
            'The request is always the same',
        ),
        Wrong(
            'the opposite',
            changed(_PORTER, ('Request(data=msg.data)', 'Request(data=not msg.data)')),
            'The request says the opposite',
        ),
        Wrong(
            'calls twice',
            changed(
                _PORTER,
                (
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n',
                    '        self.client.call_async(SetBool.Request(data=msg.data))\n'
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n',
                ),
            ),
            'The service is called more often than messages come.',
        ),
        Wrong(
            'opens only',
            changed(
                _PORTER,
                (
                    '        future = self.client',
                    '        if not msg.data:\n            return\n        future = self.client',
                ),
            ),
            'Some messages lead to a call',
        ),
        Wrong(
            'a text of its own',
            changed(_PORTER, ('future.result().message', "'Ada opened the door'")),
            'The text is not the message of the response.',
        ),
        Wrong(
            'publishes twice',
            changed(
                _PORTER,
                (
                    '        self.publisher.publish(String(data=future.result().message))\n',
                    '        for _ in range(2):\n            self.publisher.publish(String('
                    'data=future.result().message))\n',
                ),
            ),
            'A message is answered more than once.',
        ),
        Wrong(
            'no call',
            changed(
                _PORTER,
                (
                    '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
                    '        future.add_done_callback(self.on_response)\n',
                    '        self.request = SetBool.Request(data=msg.data)\n',
                ),
            ),
            'No request has come to the door.',
        ),
        Wrong(
            'another topic',
            changed(_PORTER, ("'news'", "'new'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'another node name',
            changed(_PORTER, ("__init__('porter')", "__init__('portier')")),
            'The name is what super().__init__() gets',
        ),
        Wrong(
            'not spun',
            changed(_PORTER, ('lab.spin(Porter())', 'Porter()')),
            'Hand the node over: lab.spin(node)',
        ),
    ],
)
