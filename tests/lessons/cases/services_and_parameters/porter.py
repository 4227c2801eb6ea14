"""Answers to `porter`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'makes the request alone',
        'No request has come to /door.',
        (
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(self.on_response)\n',
            '        self.request = SetBool.Request(data=msg.data)\n',
        ),
    ),
    wrong(
        'calls more',
        '/door is asked more often than messages come.',
        (
            '        future = self',
            '        self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future = self',
        ),
    ),
    wrong(
        'opens only',
        'Some messages lead to a request, and others do not.',
        (
            '        future = self',
            '        if not msg.data:\n            return\n        future = self',
        ),
    ),
    wrong(
        'always true',
        'The request is always the same, whatever the message says.',
        ('data=msg.data', 'data=True'),
    ),
    wrong(
        'turns around',
        'What is asked differs from what was heard.',
        (
            '        future = self',
            "        self.is_open = not getattr(self, 'is_open', False)\n        future = self",
        ),
        ('data=msg.data', 'data=self.is_open'),
    ),
    wrong(
        'drops a wish while the door moves',
        'Some messages lead to a request, and others do not.',
        (
            '        future = self',
            "        if getattr(self, 'busy', False):\n            return\n"
            '        self.busy = True\n        future = self',
        ),
        (
            '        self.publisher.publish(',
            '        self.busy = False\n        self.publisher.publish(',
        ),
    ),
    wrong(
        'one future for all calls',
        "AttributeError: 'NoneType' object has no attribute 'message'",
        ('        future = self', '        self.future = self'),
        ('        future.add', '        self.future.add'),
        ('future.result().message', 'self.future.result().message'),
        outcome=ERROR,
    ),
    wrong(
        'news of what succeeded alone',
        'were answered correctly, the others were not',
        (
            '        self.publisher.publish(',
            '        if future.result().success:\n            self.publisher.publish(',
        ),
    ),
    wrong(
        'stops after twenty',
        'Some messages lead to a request, and others do not.',
        (
            '        future = self',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count > 20:\n            return\n        future = self',
        ),
    ),
    wrong(
        'call() in the callback',
        'inside a callback would wait for ever',
        (
            '    def on_wish(self, msg):\n'
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(self.on_response)\n\n'
            '    def on_response(self, future):\n'
            '        self.publisher.publish(String(data=future.result().message))\n',
            '    def on_wish(self, msg):\n'
            '        response = self.client.call(SetBool.Request(data=msg.data))\n'
            '        self.publisher.publish(String(data=response.message))\n',
        ),
        outcome=ERROR,
    ),
    wrong(
        'call() in the callback, in a process of its own',
        'So it waits for ever: a deadlock.',
        (
            '    def on_wish(self, msg):\n'
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(self.on_response)\n\n'
            '    def on_response(self, future):\n'
            '        self.publisher.publish(String(data=future.result().message))\n',
            '    def on_wish(self, msg):\n'
            '        response = self.client.call(SetBool.Request(data=msg.data))\n'
            '        self.publisher.publish(String(data=response.message))\n',
        ),
        run='process',
    ),
    wrong(
        'await in one callback group',
        'would wait for ever',
        (
            '    def on_wish(self, msg):\n'
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(self.on_response)\n\n'
            '    def on_response(self, future):\n'
            '        self.publisher.publish(String(data=future.result().message))\n',
            '    async def on_wish(self, msg):\n'
            '        response = await '
            'self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        self.publisher.publish(String(data=response.message))\n',
        ),
        outcome=ERROR,
    ),
    wrong(
        'has had enough after ten',
        'Some messages lead to a request, and others do not.',
        (
            '    def on_wish(self, msg):\n',
            '    def on_wish(self, msg):\n'
            "        self.wishes = getattr(self, 'wishes', 0) + 1\n"
            '        if self.wishes > 10:\n            return\n',
        ),
    ),
    wrong(
        'does not wait at all',
        'was not done yet',
        (
            '        future.add_done_callback(self.on_response)\n',
            '        self.on_response(future)\n',
        ),
        outcome=ERROR,
    ),
    wrong(
        'publishes twice',
        'A message is answered more than once.',
        (
            '        self.publisher.publish(String(data=future.result().message))\n',
            '        for _ in range(2):\n'
            '            self.publisher.publish(String(data=future.result().message))\n',
        ),
    ),
    wrong('calls another service', "Write the name as '/move_door'", ("'move_door'", "'door'")),
    wrong(
        'a server of its own beside the door',
        'one server of /move_door: /door',
        (
            '        self.publisher =',
            "        self.create_service(SetBool, 'move_door', lambda asked, answer: answer)\n"
            '        self.publisher =',
        ),
    ),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong('not spun', 'Hand the node over: lab.spin(node)'),
    right(
        'await, and a callback group for the client',
        (
            '    def on_wish(self, msg):\n'
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(self.on_response)\n\n'
            '    def on_response(self, future):\n'
            '        self.publisher.publish(String(data=future.result().message))\n',
            '    async def on_wish(self, msg):\n'
            '        response = await '
            'self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        self.publisher.publish(String(data=response.message))\n',
        ),
        (
            "self.create_client(SetBool, 'move_door')",
            'self.create_client(\n'
            "            SetBool, 'move_door', "
            'callback_group=MutuallyExclusiveCallbackGroup()\n        )',
        ),
        (
            'from rclpy.node import Node\n',
            'from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n'
            'from rclpy.node import Node\n',
        ),
    ),
    right(
        'lambda',
        (
            '    def on_wish(self, msg):\n'
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(self.on_response)\n\n'
            '    def on_response(self, future):\n'
            '        self.publisher.publish(String(data=future.result().message))\n',
            '    def on_wish(self, msg):\n'
            '        future = self.client.call_async(SetBool.Request(data=msg.data))\n'
            '        future.add_done_callback(lambda done: self.say(done.result()))\n\n'
            '    def say(self, response):\n'
            '        self.publisher.publish(String(data=response.message))\n',
        ),
    ),
    right(
        'waits until the door is there',
        (
            "self.create_client(SetBool, 'move_door')",
            "self.create_client(SetBool, 'move_door')\n"
            '        while not self.client.wait_for_service(timeout_sec=1.0):\n'
            "            self.get_logger().info('waiting')",
        ),
    ),
    right('own process, two threads, and call()', run='process'),
    right('one wish at a time'),
    right('a thread that calls'),
    right('an executor of its own and call'),
]
