"""Answers to `countdown`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'raises until the first goal',
        "'Countdown' object has no attribute 'tick'",
        ('        self.tick = Future()\n        self.timer', '        self.timer'),
        outcome=ERROR,
    ),
    wrong('another topic', "Write the name as '/countdown'"),
    wrong(
        'no cancel_callback',
        'The request to cancel was rejected',
        ('        self.server.register_cancel_callback(self.on_cancel)\n', ''),
    ),
    wrong(
        'cancel_callback rejects',
        'The request to cancel was rejected',
        ('CancelResponse.ACCEPT', 'CancelResponse.REJECT'),
    ),
    wrong(
        'nobody looks',
        'Accepting a request to cancel does not end the goal.',
        (
            '            if goal_handle.is_cancel_requested:\n'
            '                goal_handle.canceled()\n'
            '                return Fibonacci.Result(sequence=numbers)\n',
            '',
        ),
        ('await self.tick', 'await self.tick'),
    ),
    wrong(
        'ended without a word',
        'without saying how the goal ended',
        ('                goal_handle.canceled()\n', ''),
    ),
    wrong(
        'succeeds though canceled',
        'and said succeed()',
        ('goal_handle.canceled()', 'goal_handle.succeed()'),
    ),
    wrong(
        'aborts though canceled',
        'execute_callback said abort()',
        ('goal_handle.canceled()', 'goal_handle.abort()'),
    ),
    wrong(
        'cancels the first time only',
        'The request to cancel was rejected',
        (
            '        return CancelResponse.ACCEPT\n',
            "        before, self.was_canceled = getattr(self, 'was_canceled', False), True\n"
            '        return CancelResponse.REJECT if before else CancelResponse.ACCEPT\n',
        ),
    ),
    wrong(
        'looks at the end only',
        'It goes on to count for a while',
        (
            '            if goal_handle.is_cancel_requested:\n'
            '                goal_handle.canceled()\n'
            '                return Fibonacci.Result(sequence=numbers)\n',
            '',
        ),
        (
            '        goal_handle.succeed()\n',
            '        if goal_handle.is_cancel_requested:\n'
            '            goal_handle.canceled()\n'
            '            return Fibonacci.Result(sequence=numbers)\n'
            '        goal_handle.succeed()\n',
        ),
    ),
    wrong(
        'thirty goals and no more',
        'execute_callback said abort()',
        (
            '        numbers = []\n',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count > 30:\n            goal_handle.abort()\n'
            '            return Fibonacci.Result()\n        numbers = []\n',
        ),
    ),
    wrong(
        'looks each ten numbers',
        'It goes on to count for a while',
        (
            'if goal_handle.is_cancel_requested:',
            'if number % 10 == 0 and goal_handle.is_cancel_requested:',
        ),
    ),
    wrong(
        'the first two numbers as the result of a canceled goal',
        'Those are not the numbers that it had counted',
        (
            'canceled()\n                return Fibonacci.Result(sequence=numbers)',
            'canceled()\n                return Fibonacci.Result(sequence=numbers[:2])',
        ),
    ),
    wrong(
        'all numbers in the result of a canceled goal',
        'The result holds numbers that no feedback had.',
        (
            'canceled()\n                return Fibonacci.Result(sequence=numbers)',
            'canceled()\n                order = goal_handle.request.order\n'
            '                return Fibonacci.Result(sequence=list(range(order, -1, -1)))',
        ),
    ),
    right('one second for each number', ('create_timer(0.05,', 'create_timer(1.0,')),
    right(
        'looks after it has counted',
        (
            '            numbers.append(number)\n',
            '',
        ),
        (
            '            if goal_handle',
            '            numbers.append(number)\n            if goal_handle',
        ),
    ),
    wrong(
        'time.sleep()',
        'is still running',
        (
            '            self.tick = Future()\n            await self.tick\n',
            '            time.sleep(0.05)\n',
        ),
        ('    async def', '    def'),
        ('from rclpy.action', 'import time\n\nfrom rclpy.action'),
    ),
    wrong('stops at 1', 'The numbers are not those of the task.', ('-1, -1)', '0, -1)')),
    wrong(
        'a typing error',
        'NameError',
        ('numbers.append(number)', 'numbers.append(nunber)'),
        outcome=ERROR,
        refused='The name is not defined.',
    ),
    right(
        'lambda',
        ('(self.on_cancel)', '(lambda handle: CancelResponse.ACCEPT)'),
        ('    def on_cancel(self, goal_handle):\n        return CancelResponse.ACCEPT\n\n', ''),
    ),
    right(
        'an executor of its own in a thread',
        (
            'from rclpy.node import Node\nfrom rclpy.task import Future\n',
            'from rclpy.callback_groups import ReentrantCallbackGroup\n'
            'from rclpy.node import Node\n',
        ),
        ('from rclpy.action', 'import time\n\nfrom rclpy.action'),
        (
            "        self.server = ActionServer(self, Fibonacci, 'countdown', self.execute)\n",
            '        group = ReentrantCallbackGroup()\n'
            '        self.server = ActionServer(\n'
            "            self, Fibonacci, 'countdown', self.execute, "
            'callback_group=group\n        )\n',
        ),
        (
            '        self.tick = Future()\n'
            '        self.timer = self.create_timer(0.05, self.on_timer)\n\n'
            '    def on_timer(self):\n        self.tick.set_result(True)\n',
            '',
        ),
        ('    async def', '    def'),
        (
            '            self.tick = Future()\n            await self.tick\n',
            '            time.sleep(0.05)\n',
        ),
        ('import time\n', 'import threading\nimport time\n'),
        (
            'from rclpy.node import Node\n',
            'from rclpy.executors import MultiThreadedExecutor\nfrom rclpy.node import Node\n',
        ),
        (
            'lab.spin(Countdown())',
            'executor = MultiThreadedExecutor()\nexecutor.add_node(Countdown())\n'
            'threading.Thread(target=executor.spin, daemon=True).start()',
        ),
    ),
    right('own process, several threads', run='process'),
]
