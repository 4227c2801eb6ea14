"""Answers to `asker`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'sends no goal',
        'No goal has come to /calculator.',
        (
            'future = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future.add_done_callback(self.on_accepted)\n',
            'self.order = msg.data\n',
        ),
    ),
    wrong(
        'two goals',
        '/calculator is asked more often than messages come.',
        (
            '        future = self',
            '        self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future = self',
        ),
    ),
    wrong(
        'not three',
        'Some messages lead to a goal, and others do not.',
        (
            '        future = self',
            '        if msg.data == 3:\n            return\n        future = self',
        ),
    ),
    wrong(
        'one more',
        'What is asked differs from what was heard.',
        ('order=msg.data', 'order=msg.data + 1'),
    ),
    wrong(
        'always ten',
        'The goal is always the same, whatever the message says.',
        ('order=msg.data', 'order=10'),
    ),
    wrong(
        'send_goal() in the callback, in a process of its own',
        'So it waits for ever: a deadlock.',
        (
            '        future = '
            'self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future.add_done_callback(self.on_accepted)\n\n'
            '    def on_accepted(self, future):\n'
            '        future.result().get_result_async().add_done_callback(self.on_re'
            'sult)\n\n    def on_result(self, future):\n'
            '        self.publisher.publish(Int32(data=future.result().result.sequen'
            'ce[-1]))\n',
            '        answer = self.client.send_goal(Fibonacci.Goal(order=msg.data))\n'
            '        self.publisher.publish(Int32(data=answer.result.sequence[-1]))\n',
        ),
        run='process',
    ),
    wrong(
        'drops a wish while the calculator adds',
        'Some messages lead to a goal, and others do not.',
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
        'a new wish cancels the goal before',
        'The goal before is canceled',
        (
            '        future.result().get_result_async().add_done_callback(self.on_result)\n',
            "        before, self.goal = getattr(self, 'goal', None), future.result()\n"
            '        if before is not None:\n            before.cancel_goal_async()\n'
            '        self.goal.get_result_async().add_done_callback(self.on_result)\n',
        ),
    ),
    wrong(
        'stops after twenty',
        'Some messages lead to a goal, and others do not.',
        (
            '        future = self',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count > 20:\n            return\n        future = self',
        ),
    ),
    wrong(
        'send_goal() in the callback',
        'inside a callback would wait for ever',
        (
            '    def on_wish(self, msg):\n'
            '        future = '
            'self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future.add_done_callback(self.on_accepted)\n\n'
            '    def on_accepted(self, future):\n'
            '        future.result().get_result_async().add_done_callback(self.on_re'
            'sult)\n\n    def on_result(self, future):\n'
            '        self.publisher.publish(Int32(data=future.result().result.sequen'
            'ce[-1]))\n',
            '    def on_wish(self, msg):\n'
            '        answer = self.client.send_goal(Fibonacci.Goal(order=msg.data))\n'
            '        self.publisher.publish(Int32(data=answer.result.sequence[-1]))\n',
        ),
        outcome=ERROR,
    ),
    wrong('another node name', 'a node called /asker'),
    wrong(
        'adds up itself',
        'That is not the last number of the result.',
        ('future.result().result.sequence[-1]', 'sum(range(4))'),
    ),
    wrong(
        'takes the handle for the result',
        'AttributeError',
        (
            'future.result().get_result_async().add_done_callback(self.on_result)',
            'self.on_result(future)',
        ),
        outcome=ERROR,
    ),
    wrong('asks another action', "Write the name as '/add_up'", ("'add_up'", "'add'")),
    wrong('asks the action of the lesson', 'it asks /fibonacci', ("'add_up'", "'fibonacci'")),
    wrong(
        'a server of its own beside the calculator',
        'one server of /add_up: /calculator',
        ('import ActionClient', 'import ActionClient, ActionServer'),
        (
            '        self.publisher =',
            "        self.server = ActionServer(self, Fibonacci, 'add_up', self.execute)\n"
            '        self.publisher =',
        ),
        (
            '    def on_wish',
            '    def execute(self, goal_handle):\n        goal_handle.succeed()\n'
            '        return Fibonacci.Result(sequence=[1])\n\n    def on_wish',
        ),
    ),
    wrong(
        'small numbers only',
        'Some messages lead to a goal, and others do not.',
        (
            '        future = self.client',
            '        if msg.data > 100:\n            return\n        future = self.client',
        ),
    ),
    right(
        'lambda',
        (
            '    def on_wish(self, msg):\n'
            '        future = '
            'self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future.add_done_callback(self.on_accepted)\n\n'
            '    def on_accepted(self, future):\n'
            '        future.result().get_result_async().add_done_callback(self.on_re'
            'sult)\n\n    def on_result(self, future):\n'
            '        self.publisher.publish(Int32(data=future.result().result.sequen'
            'ce[-1]))\n',
            '    def on_wish(self, msg):\n'
            '        sent = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        sent.add_done_callback(\n'
            '            lambda done: '
            'done.result().get_result_async().add_done_callback(self.say)\n        )\n\n'
            '    def say(self, done):\n        result = done.result().result\n'
            '        self.publisher.publish(Int32(data=result.sequence[-1]))\n',
        ),
    ),
    right(
        'await',
        (
            '    def on_wish(self, msg):\n'
            '        future = '
            'self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future.add_done_callback(self.on_accepted)\n\n'
            '    def on_accepted(self, future):\n'
            '        future.result().get_result_async().add_done_callback(self.on_re'
            'sult)\n\n    def on_result(self, future):\n'
            '        self.publisher.publish(Int32(data=future.result().result.sequen'
            'ce[-1]))\n',
            '    async def on_wish(self, msg):\n'
            '        handle = await '
            'self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        answer = await handle.get_result_async()\n'
            '        self.publisher.publish(Int32(data=answer.result.sequence[-1]))\n',
        ),
        (
            "ActionClient(self, Fibonacci, 'add_up')",
            'ActionClient(\n'
            "            self, Fibonacci, 'add_up', "
            'callback_group=MutuallyExclusiveCallbackGroup()\n        )',
        ),
        (
            'from rclpy.node import Node\n',
            'from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n'
            'from rclpy.node import Node\n',
        ),
    ),
    right('own process, several threads, and send_goal()', run='process'),
    right('a thread for each wish'),
]
